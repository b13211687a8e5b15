"""Consistency of boats: against independent implementations, known truth, and degenerate input."""

import datetime as dt

import numpy as np
import polars as pl
import pytest

from pipeline.consistency import reml
from pipeline.consistency.compared import compared_tows, hull_speed_statistics
from pipeline.consistency.components import variance_components
from pipeline.consistency.homogeneity import equal_possible, pooled_curves, type_homogeneity
from pipeline.consistency.lines import (
    quantities,
    type_lines,
)
from pipeline.consistency.observed import observe
from pipeline.consistency.outliers import type_outliers
from pipeline.consistency.repeats import repeat_pairs, reproducibility
from pipeline.consistency.tables import line_tables
from pipeline.consistency.tow_speed import slow_tows, speed_trend
from pipeline.tables.schemas import conform
from tests.pipeline.consistency_fleet import (
    consistency_tables,
    fleet,
    newest_lines,
)


def within(observed, expected, trials):
    """Whether a share of trials lies within four standard errors of what is expected."""
    return abs(observed - expected) <= 4.0 * np.sqrt(expected * (1 - expected) / trials)


# Equal boats, equal B?

TRIALS = 100
TRIALS_OF_LINES = 40


def humped():
    """One shape with a hump, towed at other speeds by each crew."""
    curves, tows, boats, runs = fleet(13, TRIALS, speeds_m_s=np.linspace(2.1, 2.9, 12))
    hump = 0.04 * (np.pi * (pl.col("speed_m_s") - 2.4)).cos()
    return curves, tows, boats, runs.with_columns(pl.col("cw_kg_m") * hump.exp())


@pytest.mark.parametrize(
    "tables",
    [
        lambda: fleet(11, TRIALS),
        humped,
        lambda: fleet(14, TRIALS, boats=4, noise=0.008, zero_sd_n=2.0),
    ],
    ids=["like boats", "no hyperbolas", "zeros of the load cell"],
)
def test_like_boats_raise_few_false_alarms(tables):
    p = type_homogeneity(observe(*tables()))["p_value"].to_numpy()
    assert within((p < 0.05).mean(), 0.05, TRIALS)


@pytest.mark.parametrize(
    ("p_value", "power", "verdict"),
    [(0.3, 0.9, True), (0.3, 0.5, None), (0.01, 0.9, False), (0.01, 0.5, False)],
)
def test_equal_bends_are_possible_only_by_a_test_that_could_have_failed(p_value, power, verdict):
    assert equal_possible(p_value, power) is verdict


def test_power_is_what_is_stated_and_enough():
    hulls = fleet(12, TRIALS, boats=12, noise=0.01, zero_sd_n=2.0, b_cv=0.10)
    found = type_homogeneity(observe(*hulls))
    rejected = (found["p_value"].to_numpy() < 0.05).mean()
    assert rejected >= 0.9
    # Stated with the estimated bend and noise, so a few points beside the sampling error.
    stated = found["power_at_10pct"].mean()
    assert abs(rejected - stated) < 3 * np.sqrt(stated * (1 - stated) / TRIALS) + 0.01


def test_pooling_halves_the_error_of_the_bend_of_like_boats():
    found = pooled_curves(observe(*fleet(11, TRIALS)))
    s = pl.col("q") / (1 + pl.col("q")) / pl.col("standard_speed_m_s") ** 2
    error = {
        kind: np.sqrt((((group.select(s).to_series() * 4.6**2) - 1) ** 2).mean())
        for (kind,), group in found.group_by("pooling")
    }
    assert error["partial"] <= 0.5 * error["own"]
    assert error["shared"] <= 0.5 * error["own"]


# Lines, outliers, tow speed


def of_two_classes(tables):
    """The fleet with its lightest half of the boats rowed by women."""
    curves, tows, boats, points = tables
    light = tows.filter(pl.col("weight_kg") < pl.col("weight_kg").median())["tow_id"]
    women = pl.when(pl.col("tow_id").is_in(light.to_list())).then(pl.lit("D"))
    return curves.with_columns(crew_class=women.otherwise(pl.lit("H"))), tows, boats, points


def test_r2_and_spread_are_those_of_the_line_as_drawn():
    """Tows weigh as they were measured, and boats with many tows less; a chart shows them alike."""
    of = {"seasons": (2012, 2014, 2016), "weights_kg": np.linspace(700, 1300, 8)}
    curves, *rest = of_two_classes(fleet(28, boats=8, height_sd=0.05, **of))
    counted = (pl.col("season") == 2016) | (pl.col("fsn_no") < "FSN003")
    observed = observe(curves.filter(counted), *rest)
    lines, drawn = type_lines(observed)
    of = {"tows": "all", "quantity": "cw_standard_kg_m", "explaining": "weight_kg"}
    row, places = lines.filter(**of).row(0, named=True), drawn.filter(**of)
    y, x = quantities(observed)["cw_standard_kg_m"][0], observed.column("weight_kg")
    about_line, about_mean = np.zeros(len(y)), np.zeros(len(y))
    for crew_class in ("D", "H"):
        mine = (observed.table["crew_class"] == crew_class).to_numpy()
        line = places.filter(crew_class=crew_class)
        about_line[mine] = y[mine] - np.interp(x[mine], line["x"], line["y"])
        about_mean[mine] = y[mine] - y[mine].mean()
    left = (about_line**2).sum()
    assert row["r2"] == pytest.approx(1 - left / (about_mean**2).sum(), rel=1e-9)
    spread = np.sqrt(left / (len(y) - 3)) / y.mean()
    assert row["residual_sd_ratio"] == pytest.approx(spread, rel=1e-9)


MEN = {"declared_speed_m_s": "men"}
"""The crews of `fleet`, in which a line against tow speed is drawn."""


def test_intervals_of_slopes_cover_the_truth():
    lines = newest_lines(observe(*fleet(13, TRIALS_OF_LINES, boats=8, b_cv=0.05, height_sd=0.02)))
    for quantity, explaining, truth in (
        ("ln_cw_standard", "ln_displacement", 0.8),
        ("b_m_s", "weight_kg", 0.0),
        ("b_m_s", "declared_speed_m_s", 0.0),
    ):
        row = lines.filter(
            quantity=quantity, explaining=explaining, within=MEN.get(explaining, "all")
        )
        inside = ((row["slope_lo"] <= truth) & (truth <= row["slope_hi"])).mean()
        assert within(inside, 0.95, TRIALS_OF_LINES)


def with_run_points(tables, tow_id, factor):
    """One tow with all its coefficients multiplied."""
    curves, tows, boats, points = tables
    grow = pl.when(pl.col("tow_id") == tow_id).then(factor).otherwise(1.0)
    points = points.with_columns(pl.col("cw_kg_m") * grow)
    curves = curves.with_columns(pl.col("cw_kg_m") * grow, pl.col("a_kg_m") * grow)
    return curves, tows, boats, points


def test_a_boat_pulled_askew_lies_outside_and_is_named():
    for season, candidates in ((2012, ["askew"]), (2016, [])):
        tables = fleet(16, height_sd=0.01, seasons=(season,))
        found = type_outliers(observe(*with_run_points(tables, f"{season}-003", 1.15))).filter(
            "outside"
        )
        assert found["tow_id"].to_list() == [f"{season}-003"]
        assert found["candidates"].to_list() == [candidates]


def test_a_bend_that_follows_tow_speed_is_seen_and_none_is_not_claimed():
    speeds = np.linspace(2.1, 2.7, 12)
    plain = speed_trend(observe(*fleet(18, speeds_m_s=speeds)))
    assert (plain["slope_lo"] < 0).all()
    assert (plain["slope_hi"] > 0).all()
    curves, tows, boats, points = fleet(18, speeds_m_s=speeds)
    slow = curves.select("tow_id", "declared_speed_m_s")
    # Cw of slow tows made to rise faster: (v/v0)^(3 (2.7 - v0)).
    points = points.join(slow, on="tow_id").with_columns(
        pl.col("cw_kg_m")
        * (pl.col("speed_m_s") / pl.col("declared_speed_m_s"))
        ** (3 * (2.7 - pl.col("declared_speed_m_s")))
    )
    assert (speed_trend(observe(curves, tows, boats, points))["slope_hi"] < 0).all()


def men_and_women(each, **differs):
    """Equal hulls, rowed by so many crews of women at 2.1 to 2.3 m/s and of men at 2.5 to 2.7."""
    speeds = np.concatenate([np.linspace(2.1, 2.3, each), np.linspace(2.5, 2.7, each)])
    weights = np.concatenate([np.linspace(895, 905, each), np.linspace(1095, 1105, each)])
    tables = fleet(19, boats=2 * each, speeds_m_s=speeds, weights_kg=weights, **differs)
    return of_two_classes(tables)


def test_no_line_against_tow_speed_holds_men_and_women():
    lines, places = type_lines(observe(*men_and_women(8, noise=0.005)))
    lines = lines.filter(explaining="declared_speed_m_s")
    assert lines.height > 0
    assert set(lines.select("within", "n").unique().rows()) == {("men", 8), ("women", 8)}
    heights = lines.filter(quantity="cw_standard_kg_m")
    assert (heights["slope_lo"] < 0).all()
    assert (heights["slope_hi"] > 0).all()
    places = places.filter(explaining="declared_speed_m_s")
    spans = places.group_by("crew_class").agg(lo=pl.col("x").min(), hi=pl.col("x").max())
    assert sorted(spans.rows()) == [("D", 2.1, 2.3), ("H", 2.5, 2.7)]


def test_a_bend_that_women_have_is_no_trend_with_tow_speed():
    curves, tows, boats, points = men_and_women(8, noise=0.002)
    women = pl.col("tow_id").is_in(curves.filter(crew_class="D")["tow_id"].to_list())
    v2 = pl.col("speed_m_s") ** 2
    another_b = (1 - v2 / 4.6**2) / (1 - v2 / 3.9**2)
    points = points.with_columns(pl.col("cw_kg_m") * pl.when(women).then(another_b).otherwise(1.0))
    found = speed_trend(observe(curves, tows, boats, points))
    assert found["slope"].count() == found.height > 0
    assert (found["slope_lo"] < 0).all()
    assert (found["slope_hi"] > 0).all()


@pytest.mark.parametrize("boats", [4, 5])
def test_no_slope_is_drawn_through_fewer_than_five_boats(boats):
    """Also not through many tows of few boats."""
    tables = fleet(
        21, boats=boats, seasons=(2014, 2016, 2018), speeds_m_s=[2.3, *[2.5] * (boats - 1)]
    )
    observed = observe(*tables)
    lines, places = type_lines(observed)
    of_men = lines.filter(pl.col("within") != "women", pl.col("quantity") != "ln_cw_standard")
    on_length = pl.col("explaining") == "waterline_length_m"  # equal in all
    drawn = of_men.filter(~on_length)["slope"].is_not_null()
    assert drawn.to_list() == [boats == 5] * len(drawn)
    assert (places.height > 0) == (boats == 5)
    assert speed_trend(observed)["slope"].is_not_null().to_list() == [boats == 5] * 2


def raced(tables, tow_id, speed_m_s):
    """A race of two hours by the crew of a tow."""
    line = tables[0].filter(tow_id=tow_id).select("fsn_no", "rowers", "crew_class")
    return line.with_columns(
        race_date=pl.lit(dt.date(2016, 6, 4)),
        distance_m=7200.0 * speed_m_s + 300.0,
        stream_m=300.0,
        rowing_time_s=7200.0,
    )


def test_a_slow_tow_raced_hard_says_whom_its_curve_favours():
    speeds = np.full(8, 2.5)
    speeds[2] = 2.0
    curves, tows, boats, points = fleet(19, boats=8, speeds_m_s=speeds, noise=1e-4)
    steeper = pl.when(tow_id="2016-002").then((pl.col("speed_m_s") / 2.0) ** 0.5).otherwise(1.0)
    points = points.with_columns(pl.col("cw_kg_m") * steeper)
    race = raced((curves,), "2016-002", 2.8)
    found = slow_tows(observe(curves, tows, boats, points), race).filter("slow").row(0, named=True)
    assert found["raced_speed_m_s"] == pytest.approx(2.8)
    assert found["speed_case"] == "low"
    assert found["raced_high"]
    # More power is computed than was delivered: that is the advantage.
    assert found["power_ratio_raced"] > 1.1


# Every choice of tows


def test_hull_speed_is_that_of_the_truth():
    found = compared_tows(observe(*fleet(19, boats=12, noise=0.002)))
    for lo, value, hi in (("cw_standard_lo_kg_m", "cw_standard_kg_m", "cw_standard_hi_kg_m"),
                          ("a_lo_kg_m", "a_kg_m", "a_hi_kg_m")):  # fmt: skip
        assert (found[lo] < found[value]).all()
        assert (found[value] < found[hi]).all()
    row = hull_speed_statistics(found).filter(boat_type="all").row(0, named=True)
    assert row["b_ratio_lo"] < 4.6 / (1.25 * 8.2**0.5) < row["b_ratio_hi"]
    assert row["b_is_hull_speed"] is False


@pytest.mark.parametrize(("middle", "is_hull_speed"), [(1.0, True), (1.06, False), (0.94, False)])
def test_b_is_hull_speed_where_the_interval_of_its_median_holds_1(middle, is_hull_speed):
    found = compared_tows(observe(*fleet(19, boats=12, noise=0.002)))
    ratio = pl.col("b_hull_ratio")
    moved = found.with_columns(ratio * middle / ratio.median())
    row = hull_speed_statistics(moved).filter(boat_type="all").row(0, named=True)
    assert row["b_is_hull_speed"] is is_hull_speed
    assert (row["b_share_within_5pct"] > 0.9) is is_hull_speed


# Repeats


def test_reproducibility_recovers_the_spread_of_a_tow():
    tables = fleet(20, boats=60, seasons=(2014, 2016, 2018), tow_sd=0.03, noise=0.001)
    pairs = repeat_pairs(tables[0], tables[1])
    found = reproducibility(pairs, observe(*tables)).row(0, named=True)
    assert found["scope"] == "all"
    assert found["n_pairs"] == 120
    # Pairs share a tow, so the spread rests on about 90 instead of 120 differences.
    assert found["sd_ratio"] == pytest.approx(0.03, rel=4 / np.sqrt(2 * 90))


def test_no_pair_across_an_alteration():
    curves, tows, *_ = fleet(22, boats=2, seasons=(2014, 2016))
    tows = tows.with_columns((pl.col("tow_id") == "2016-001").alias("altered"))
    assert repeat_pairs(curves, tows)["tow_id"].to_list() == ["2016-000"]


def test_variance_components_recover_the_truth():
    tables = fleet(
        24,
        boats=30,
        seasons=range(2009, 2019),
        height_sd=0.05,
        season_sd=0.03,
        tow_sd=0.015,
        weights_kg=np.full(30, 1000.0),
    )
    found = variance_components(observe(*tables)).filter(pl.col("scope") == "fleet")
    for name, sd, dof in (("boat", 0.05, 29), ("season", 0.03, 9), ("boat_season", 0.015, 250)):
        row = found.row(by_predicate=pl.col("component") == name, named=True)
        assert row["sd_ratio"] == pytest.approx(sd, rel=4 / np.sqrt(2 * dof))
        assert row["lo"] < row["sd_ratio"] < row["hi"]
    assert found["share"].sum() == pytest.approx(1.0)


# Degenerate input: nulls and a reason, never NaN, never a warning (warnings are errors here)


def undetermined(tables):
    curves, *rest = tables
    return curves.with_columns(pl.lit(None, pl.Float64).alias("b_m_s")), *rest


CASES = {
    "no tows": tuple(frame.clear() for frame in fleet(30)),
    "one boat": fleet(31, boats=1),
    "two boats": fleet(32, boats=2),
    "no type": fleet(33, boat_type=None),
    "equal weights": fleet(34, weights_kg=np.full(12, 1000.0), speeds_m_s=np.full(12, 2.5)),
    "no weights": fleet(35, weights_kg=np.full(12, np.nan)),
    "no B": undetermined(fleet(36)),
    "no scatter": fleet(37, noise=0.0, weights_kg=np.full(12, 1000.0)),
    "two seasons": fleet(38, boats=4, seasons=(2014, 2016)),
}


def everything(*tables):
    return line_tables(observe(*tables)) | consistency_tables(*tables)


REASONS = {
    "one boat": ("few_boats", 1),
    "two boats": ("few_boats", 2),
    "no type": ("no_type", 12),
    "equal weights": ("equal_values", 12),
    "no weights": ("few_boats", 0),
}
"""Why there is no line of A on weight, and through how many tows it would be."""


@pytest.mark.parametrize("case", CASES)
def test_degenerate_input_gives_a_reason_and_no_nan_and_fits_the_schemas(case):
    found = everything(*CASES[case])
    for name, frame in found.items():
        checked = conform(name, frame)
        for column in checked.select(pl.col(pl.Float64)):
            assert not column.is_nan().any(), (name, column.name)
            assert not column.is_infinite().any(), (name, column.name)
    of = {"quantity": "a_kg_m", "explaining": "weight_kg", "within": "all", "tows": "newest"}
    for row in found["type_lines"].filter(**of).iter_rows(named=True):
        if case in REASONS:
            assert (row["reason"], row["n"], row["slope"]) == (*REASONS[case], None)


SEARCHED = {
    "type_lines": "slope",
    "speed_trend": "slope",
    "predicted_cw": "predicted_cw_kg_m",
    "variance_components": "sd_ratio",
}


@pytest.mark.parametrize("limit", ["MAX_ITERATIONS", "MAX_HALVINGS"])
def test_a_search_that_does_not_come_to_rest_says_so(limit, monkeypatch):
    """No number that rests on it is given, and every table fits its schema."""
    tables = fleet(41, boats=24, seasons=(2014, 2016, 2018), height_sd=0.03, season_sd=0.02)
    settled = everything(*tables)
    monkeypatch.setattr(reml, limit, 0)
    forced = {name: conform(name, frame) for name, frame in everything(*tables).items()}
    for name, number in SEARCHED.items():
        assert settled[name].filter(reason="not_settled").is_empty()
        assert settled[name][number].count() > 0
        mute = forced[name].filter(reason="not_settled")
        assert mute.height > 0, name
        assert mute[number].count() == 0


def test_the_order_of_rows_does_not_matter():
    tables = fleet(40, boats=8, seasons=(2014, 2016, 2018), height_sd=0.03, season_sd=0.02)
    shuffled = [frame.sample(fraction=1.0, shuffle=True, seed=1) for frame in tables]
    ours, theirs = everything(*tables), everything(*shuffled)
    for name, frame in ours.items():
        assert conform(name, frame).equals(conform(name, theirs[name])), name
