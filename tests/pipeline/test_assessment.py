"""Every check fires when it should and keeps quiet when not; statuses follow from them.

The world here: six like boats, towed in 2012 and again in 2014, all of it sound.
"""

import datetime as dt
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import polars as pl
import pytest

from pipeline.assessment.assess import add_status, assess
from pipeline.assessment.checks import CODES
from pipeline.assessment.currents import estimate_currents
from pipeline.method.reading import parse_method, read_shipped_method

METHOD = "some-method"
V0 = 2.5
A, B = 30.0, 5.0
CW = A / (1 - (V0 / B) ** 2)
BOATS = range(1, 7)
SUBJECT = "boat1-2012"
LATER = "boat1-2014"


@dataclass(frozen=True)
class World:
    curves: pl.DataFrame
    run_points: pl.DataFrame
    tows: pl.DataFrame
    diagnosis: pl.DataFrame
    currents: pl.DataFrame

    def changed(self, table: str, tow_id: str, **columns: Any) -> "World":
        """The world with some values of one tow replaced, by a value or an expression."""
        frame: pl.DataFrame = getattr(self, table)
        mine = pl.col("tow_id") == tow_id
        if table == "diagnosis":
            mine = pl.col("season") == int(tow_id[-4:])
        if "gps_ratio" in columns:  # a season has one log
            mine = pl.col("tow_id").str.ends_with(tow_id[-4:])
        values = {
            name: pl.when(mine)
            .then(value if isinstance(value, pl.Expr) else pl.lit(value, frame.schema[name]))
            .otherwise(pl.col(name))
            for name, value in columns.items()
        }
        return replace(self, **{table: frame.with_columns(**values)})

    def assessed(self) -> pl.DataFrame:
        return assess(self.curves, self.run_points, self.tows, self.diagnosis, self.currents)

    def without_best_estimates(self) -> "World":
        """The same under a method that knows no boat by all of its tows."""
        none = pl.lit(None, pl.Float64)
        names = ("cw_best_kg_m", "cw_best_lo_kg_m", "cw_best_hi_kg_m")
        return replace(self, curves=self.curves.with_columns(**dict.fromkeys(names, none)))

    def flagged(self, tow_id: str) -> set[str]:
        return set(self.assessed().filter("flagged", tow_id=tow_id)["check"])


def _tow(boat: int, season: int) -> dict[str, Any]:
    return {
        "tow_id": f"boat{boat}-{season}",
        "season": season,
        "tow_date": dt.date(season, 3, 1 + boat % 2),
        "fsn_no": f"FSN{boat}",
        "boat_type": "Kuikensloep",
        "rowers": 8,
        "crew_class": "H",
        "declared_speed_m_s": V0,
        "waterline_length_m": 8.0,
        "beam_m": 2.2,
        "bow_height_m": 0.9,
        "listed_length_m": 8.04,
        "listed_beam_m": 2.2,
        "weight_kg": 1000.0 + 5.0 * boat,
        "weight_after_kg": 1008.0 + 5.0 * boat,
        "crew_weight_kg": 760.0,
        "altered": False,
        "runs_set_aside": 0,
        "gps_step_m_s": 0.01,
        "force_step_n": 1.0,
        "freeboard_lowest_m": 0.40,
        "freeboard_bow_m": 0.80,
        "freeboard_stern_m": 0.60,
        "doubts": [],
        "unusual": [],
        "lamp_ratio": 0.1,
        "water_off_c": 0.2,
        "water_depth_m": 6.0,
        "load_cell_ratio": 1.002,
    }


def _curve(tow: Mapping[str, Any]) -> dict[str, Any]:
    names = ("tow_id", "fsn_no", "season", "rowers", "crew_class", "declared_speed_m_s")
    return {
        "method": METHOD,
        **{name: tow[name] for name in names},
        "a_kg_m": A,
        "b_m_s": B,
        "cw_kg_m": CW,
        "cw_lo_kg_m": CW * math.exp(-0.0392),
        "cw_hi_kg_m": CW * math.exp(0.0392),
        "cw_others_kg_m": CW,
        "cw_best_kg_m": CW,
        "cw_best_lo_kg_m": CW * math.exp(-0.01),
        "cw_best_hi_kg_m": CW * math.exp(0.01),
        "power_w": CW * V0**3 / 8,
        "calibration_factor": 1.005,
        "runs_used": 6,
    }


def _run_points(tow_id: str) -> list[dict[str, Any]]:
    return [
        {
            "tow_id": tow_id,
            "run": run,
            "direction": 1 if run <= 3 else -1,
            "target_speed_ratio": ratio,
            "speed_m_s": 1.01 * ratio * V0,
            "speed_factor": 1.005,
            "cw_kg_m": 40.0 + 0.1 * run,
            "fitted_cw_kg_m": 40.2,
            "gross_cw_kg_m": 41.0,
            "cw_sd": 3.3,
            "cw_seconds_sd_kg_m": 1.4,
            "ends_ratio": 0.5,
            "log2_ratio": 0.997,
            "gps_ratio": 1.005,
            "used": True,
        }
        for run, ratio in enumerate([0.9, 1.0, 1.1] * 2, start=1)
    ]


@pytest.fixture(scope="module")
def sound() -> World:
    tows = [_tow(boat, season) for boat in BOATS for season in (2012, 2014)]
    points = [point for tow in tows for point in _run_points(tow["tow_id"])]
    names = pl.List(pl.String)
    integers = {"season": pl.Int32, "rowers": pl.Int32, "run": pl.Int8, "direction": pl.Int8}
    curves = pl.DataFrame([_curve(tow) for tow in tows], schema_overrides=integers)
    run_points = pl.DataFrame(points, schema_overrides=integers)
    return World(
        curves.cast({"runs_used": pl.Int8}),
        run_points,
        pl.DataFrame(tows, schema_overrides=integers | dict.fromkeys(("doubts", "unusual"), names)),
        pl.DataFrame(
            {
                "season": [2012, 2014],
                "instrument": "",
                "verdict": "sound",
                "alarm": False,
                "shown_by": pl.Series([None, None], dtype=pl.String),
            },
            schema_overrides=integers,
        ),
        estimate_currents(curves, run_points),
    )


def test_a_sound_world_is_checked_throughout_and_nothing_fires(sound: World) -> None:
    for world, others in ((sound, BY_ONE_TOW), (as_read(sound), BY_ALL_TOWS)):
        found = world.assessed()
        assert set(found["check"]) == set(CODES) - others
        assert found.filter("flagged").is_empty()
        assert found.height == found.select("method", "tow_id", "check").n_unique()


BY_ONE_TOW = {"curve_change_unexplained", "pulled_askew"}
BY_ALL_TOWS = {"unlike_other_tows", "boat_changed"}


def as_read(world: World) -> World:
    return world.without_best_estimates()


no_curve = {"a_kg_m": None, "b_m_s": None, "cw_kg_m": None, "power_w": None}
run1 = pl.col("run") == 1
back = pl.col("direction") == -1
lower_cw = pl.col("cw_kg_m") * 0.93
far_heavier = {"a_kg_m": 1.12 * A, "cw_kg_m": 1.12 * CW, "cw_best_kg_m": 1.12 * CW}
askew = {"a_kg_m": 1.08 * A, "cw_kg_m": 1.08 * CW}
heavier = {
    **askew,
    "cw_best_kg_m": 1.08 * CW,
    **{f"cw_best_{end}_kg_m": 1.08 * CW * math.exp(x) for end, x in (("lo", -0.01), ("hi", 0.01))},
}

# check: (table, tow, changes, observed, limit, what fires as well)
CASES: dict[str, tuple[str, str, dict[str, Any], float, float, set[str]]] = {
    **{
        f"{sensor}_{verdict}": ("tows", SUBJECT, {column: [f"{sensor}_{verdict}"]}, 1, 0, set())
        for sensor in ("force", "wind", "speed")
        for column, verdict in (("doubts", "not_plausible"), ("unusual", "unusual"))
    },
    "instrument_or_boat": (
        "diagnosis", SUBJECT, {"alarm": True, "shown_by": "FSN1, FSN99"}, 1, 0, {"season_in_doubt"},
    ),
    "season_in_doubt": ("diagnosis", SUBJECT, {"alarm": True}, 1, 0, set()),
    "coarse_readings": ("tows", SUBJECT, {"gps_step_m_s": 0.1}, 0.1 / V0, 0.01, set()),
    "lamps_burned": ("tows", SUBJECT, {"lamp_ratio": 0.3}, 0.3, 0.2, set()),
    "load_cell_off": ("tows", SUBJECT, {"load_cell_ratio": 0.985}, -0.015, -0.01, set()),
    "no_curve": ("curves", SUBJECT, no_curve, 0, 1, set()),
    "few_runs": ("curves", SUBJECT, {"runs_used": 5}, 5, 6, set()),
    "runs_set_aside": ("tows", SUBJECT, {"runs_set_aside": 1}, 1, 0, set()),
    "unbalanced_runs": ("run_points", SUBJECT, {"used": ~run1 & (pl.col("run") != 2)}, 2, 1, set()),
    "out_and_back_differ": (
        "run_points", SUBJECT, {"cw_kg_m": pl.when(back).then(lower_cw).otherwise("cw_kg_m")},
        40.2 / (40.5 * 0.93) - 1, 0.05, set(),
    ),
    "unusual_calibration": ("curves", SUBJECT, {"calibration_factor": 0.975}, 0.975, 0.98, set()),
    "log_not_linear": (
        "run_points", SUBJECT, {"gps_ratio": pl.col("speed_m_s") ** 0.03}, 0.03, 0.015, set(),
    ),
    "current_changed": (
        "currents", SUBJECT, {"current_change_m_s": -0.15, "current_verdict": "changed"},
        0.15, 0.1, set(),
    ),
    "log2_differs": (
        "run_points", SUBJECT, {"log2_ratio": pl.when(run1).then(0.99).otherwise(1.0)},
        0.01 * 1.01 * 0.9 * V0 / 1.005, 0.01, set(),
    ),
    "off_target_speed": (
        "run_points", SUBJECT, {"speed_m_s": pl.when(run1).then(2.40).otherwise("speed_m_s")},
        2.40 / (1.01 * 2.25) - 1, 0.05, set(),
    ),
    "large_scatter_in_run": (
        "run_points", SUBJECT, {"cw_seconds_sd_kg_m": pl.when(run1).then(4.51).otherwise(1.4)},
        0.11, 0.1, set(),
    ),
    "samples_scatter": (
        "run_points", SUBJECT, {"cw_sd": pl.when(run1).then(6.7).otherwise(3.3)},
        6.7 / 3.3, 2.0, set(),
    ),
    "range_not_covered": (
        "run_points", SUBJECT, {"used": pl.col("target_speed_ratio") < 1.1},
        1.1 - 1.01, 0.05, set(),
    ),
    "declared_speed_not_covered": (
        "run_points", SUBJECT, {"used": pl.col("target_speed_ratio") < 1.0},
        1 - 0.9 * 1.01, 0.05, {"range_not_covered"},
    ),
    "power_outside_range": ("curves", SUBJECT, {"power_w": 95.0}, 95, 90, set()),
    "slow_tow": ("curves", SUBJECT, {"power_w": 59.0}, 59, 60, {"power_outside_range"}),
    "crew_weight": ("tows", SUBJECT, {"crew_weight_kg": 500.0}, 62.5, 81, set()),
    "water_differs": ("tows", SUBJECT, {"water_off_c": 20.4}, 20.4, 3.0, set()),
    "shallow_water": (
        "tows", SUBJECT, {"water_depth_m": 2.5}, (1.1 * 1.01 * V0 / 0.5) ** 2 / 9.813 / 2.5, 1.0,
        set(),
    ),
    "weight_not_recorded": ("tows", SUBJECT, {"crew_weight_kg": None}, 1, 0, set()),
    "heavier_after": ("tows", SUBJECT, {"weight_after_kg": 1030.0}, 1030 / 1005 - 1, 0.02, set()),
    "boat_list_differs": ("tows", LATER, {"listed_length_m": 9.0}, 1 / 9, 0.05, set()),
    "weight_changed": (
        "tows", LATER, {"weight_kg": 980.0}, 980 / 1005 - 1, -0.02, {"heavier_after"},
    ),
    "length_changed": ("tows", LATER, {"waterline_length_m": 8.1}, 0.0125, 0.01, set()),
    "beam_changed": ("tows", LATER, {"beam_m": 2.1}, 2.1 / 2.2 - 1, -0.02, set()),
    "bow_height_changed": ("tows", LATER, {"bow_height_m": 0.96}, 0.96 / 0.9 - 1, 0.05, set()),
    "freeboard_changed": (
        "tows", LATER, {"freeboard_lowest_m": 0.36}, 0.04, 0.03, set(),
    ),
    "curve_change_unexplained": ("curves", LATER, askew, 0.08, 0.05, set()),
    "boat_changed": ("curves", LATER, heavier, 0.08, 0.03, set()),
    "unlike_its_type": (
        "curves", SUBJECT, far_heavier, 1.12 * math.sqrt(1780 / 1765) - 1, 0.1, set(),
    ),
    "unlike_other_tows": ("curves", LATER, askew, 0.08, 0.035, set()),
    "pulled_askew": (
        "curves", SUBJECT, askew, 0.08, 0.05, set(),
    ),
}  # fmt: skip


@pytest.mark.parametrize("check", CODES)
def test_a_check_fires_with_what_was_observed_and_its_limit(sound: World, check: str) -> None:
    table, tow_id, changes, observed, limit, others = CASES[check]
    world = as_read(sound) if check in BY_ONE_TOW else sound
    spoiled = world.changed(table, tow_id, **changes)
    assert spoiled.flagged(tow_id) == {check} | others
    row = spoiled.assessed().row(by_predicate=_row(tow_id, check), named=True)
    assert row["observed"] == pytest.approx(observed, abs=2e-4)
    assert row["limit"] == limit


def _row(tow_id: str, check: str) -> pl.Expr:
    return (pl.col("tow_id") == tow_id) & (pl.col("check") == check)


def checks_of(world: World, tow_id: str) -> set[str]:
    return set(world.assessed().filter(tow_id=tow_id)["check"])


def test_women_have_their_own_power_and_weight(sound: World) -> None:
    women = sound.changed("tows", SUBJECT, crew_class="D", rowers=10)
    for power_w, flagged in ((45.0, set()), (60.0, {"power_outside_range"}),
                             (33.0, {"power_outside_range", "slow_tow"})):  # fmt: skip
        assert women.changed("curves", SUBJECT, power_w=power_w).flagged(SUBJECT) == flagged
    of_men = women.changed("tows", SUBJECT, rowers=8).changed("curves", SUBJECT, power_w=45.0)
    assert of_men.flagged(SUBJECT) == {"crew_weight"}  # 95 kg each


def test_what_is_not_known_is_not_checked(sound: World) -> None:
    unknown = sound.changed(
        "tows", LATER, weight_after_kg=None, freeboard_lowest_m=None, freeboard_bow_m=None,
        freeboard_stern_m=None,
    ).changed("curves", LATER, calibration_factor=None)  # fmt: skip
    missing = {"freeboard_changed", "heavier_after", "unusual_calibration"} | BY_ONE_TOW
    missing |= {"unlike_its_type"}  # it was towed before
    assert checks_of(unknown, LATER) == set(CODES) - missing
    first = {"weight_changed", "length_changed", "beam_changed", "bow_height_changed"}
    first |= {"boat_changed", "freeboard_changed"} | BY_ONE_TOW
    assert checks_of(sound, SUBJECT) == set(CODES) - first


def test_what_explains_that_a_curve_changed(sound: World) -> None:
    altered = sound.changed("tows", LATER, altered=True, weight_kg=1100.0, beam_m=2.4)
    altered = altered.changed("tows", LATER, weight_after_kg=1100.0)
    assert altered.changed("curves", LATER, **heavier).flagged(LATER) == set()
    load = 1.08**2 * (1005.0 + 760.0) - 760.0
    loaded = sound.changed("tows", LATER, weight_kg=load, weight_after_kg=load)
    assert loaded.changed("curves", LATER, **heavier).flagged(LATER) == {"weight_changed"}


def test_a_difference_between_out_and_back_that_all_tows_have_marks_none(sound) -> None:
    """Gusts that outlast a run; the limit that is shown is the one that held."""
    sign = pl.when(pl.col("tow_id").str.ends_with("2012")).then(1.0).otherwise(-1.0)
    ratio = 1.0 + 0.03 * sign * pl.col("direction")
    runs = sound.run_points.with_columns(pl.col("cw_kg_m") * ratio)
    rows = replace(sound, run_points=runs).assessed().filter(check="out_and_back_differ")
    assert rows["observed"].abs().min() > 0.05
    assert not rows["flagged"].any()
    assert rows["limit"].abs().unique().item() > 0.15


@pytest.mark.parametrize(("ratio", "is_marked"), [(1.02, False), (1.04, True), (0.96, True)])
def test_a_boat_that_changed_by_all_its_tows_is_looked_at(sound, ratio, is_marked) -> None:
    names = ("a_kg_m", "cw_kg_m", "cw_best_kg_m")
    changes = {name: pl.col(name) * ratio for name in names}
    world = sound.changed("curves", LATER, **changes)
    assert world.flagged(LATER) == ({"boat_changed"} if is_marked else set())
    assert world.changed("tows", LATER, altered=True).flagged(LATER) == set()


def test_a_tow_that_is_off_does_not_make_the_boat_another(sound: World) -> None:
    """What the joint model takes for one tow's error is no change of the boat, then or later."""
    off = sound.changed("curves", SUBJECT, **askew)
    assert off.flagged(SUBJECT) == {"unlike_other_tows"}
    assert off.flagged(LATER) == set()
    assert as_read(off).flagged(LATER) == {"curve_change_unexplained"}


@pytest.mark.parametrize(("ratio", "is_marked"), [(1.03, False), (1.04, True), (0.96, True)])
def test_a_boat_needs_another_tow_to_be_unlike_its_others(sound, ratio, is_marked) -> None:
    moved = {"a_kg_m": ratio * A, "cw_kg_m": ratio * CW}
    world = sound.changed("curves", LATER, **moved)
    assert ("unlike_other_tows" in world.flagged(LATER)) == is_marked
    alone = replace(world, curves=world.curves.filter(pl.col("tow_id") != SUBJECT))
    assert "unlike_other_tows" not in checks_of(alone, LATER)


def test_scatter_is_judged_only_where_the_method_cuts_runs(sound: World) -> None:
    whole = sound.changed("run_points", SUBJECT, cw_seconds_sd_kg_m=9.0, cw_sd=9.0, ends_ratio=None)
    assert whole.flagged(SUBJECT) == set()
    assert not {"large_scatter_in_run", "samples_scatter"} & checks_of(whole, SUBJECT)


def test_samples_that_scatter_alike_all_season_are_the_instruments(sound: World) -> None:
    """What is usual is the season's own; below the 10 % of the source nothing is too much."""
    noisy = sound.run_points.with_columns(cw_sd=pl.lit(12.0))
    assert "samples_scatter" not in replace(sound, run_points=noisy).flagged(SUBJECT)
    quiet = sound.run_points.with_columns(cw_sd=pl.lit(1.0))
    for of_gross, is_marked in ((0.099, False), (0.101, True)):
        world = replace(sound, run_points=quiet)
        world = world.changed(
            "run_points", SUBJECT, cw_sd=pl.when(run1).then(41.0 * of_gross).otherwise(1.0)
        )
        assert ("samples_scatter" in world.flagged(SUBJECT)) == is_marked


def test_a_boat_is_compared_with_its_type_where_no_earlier_tow_can_be(sound: World) -> None:
    """At its first tow, or after an alteration; weight and length are allowed for."""
    light = {"a_kg_m": 0.8 * A, "cw_kg_m": 0.8 * CW, "cw_best_kg_m": 0.8 * CW}
    assert "unlike_its_type" in sound.changed("curves", SUBJECT, **light).flagged(SUBJECT)
    assert "unlike_its_type" not in checks_of(sound.changed("curves", LATER, **light), LATER)
    altered = sound.changed("tows", LATER, altered=True).changed("curves", LATER, **light)
    assert altered.flagged(LATER) == {"unlike_its_type"}
    smaller = 0.8**2 * (1005.0 + 760.0) - 760.0
    small = altered.changed("tows", LATER, weight_kg=smaller, weight_after_kg=smaller)
    assert small.flagged(LATER) == set()
    alone = sound.changed("tows", SUBJECT, boat_type="another")
    assert "unlike_its_type" not in checks_of(alone, SUBJECT)


def test_logs_that_are_not_to_scale_make_no_boat_unlike_its_type(sound: World) -> None:
    curves = sound.curves.with_columns(
        calibration_factor=pl.when(pl.col("season") == 2014).then("calibration_factor")
    )
    assert "unlike_its_type" not in checks_of(replace(sound, curves=curves), SUBJECT)


def test_askew_pulling_is_that_of_one_tow_without_a_steering_aid(sound: World) -> None:
    """A log that errs all season is none."""
    worn = pl.when(pl.col("season") == 2012).then(1.2).otherwise(1.0)
    curves = sound.curves.with_columns(pl.col("a_kg_m", "cw_kg_m") * worn)
    found = as_read(replace(sound, curves=curves)).assessed().filter(check="pulled_askew")
    assert found["tow_id"].sort().to_list() == [f"boat{boat}-2012" for boat in BOATS]
    assert not found["flagged"].any()


def test_what_all_boats_change_between_uncalibrated_seasons_is_not_the_boats(sound: World) -> None:
    worn, one = pl.col("season") == 2012, pl.col("tow_id") == LATER
    curves = sound.curves.with_columns(
        calibration_factor=pl.when(~worn).then("calibration_factor"),
        **{
            c: pl.when(worn).then(pl.col(c) * 1.2).when(one).then(pl.col(c) * 1.1).otherwise(c)
            for c in ("a_kg_m", "cw_kg_m")
        },
    )
    world = as_read(replace(sound, curves=curves))
    found = world.assessed().filter(check="curve_change_unexplained")
    assert found.filter("flagged")["tow_id"].to_list() == [LATER]
    assert found.filter(tow_id=LATER)["observed"][0] == pytest.approx(0.1, abs=1e-3)
    to_scale = world.changed("diagnosis", SUBJECT, verdict="estimated").assessed()
    assert to_scale.filter(check="curve_change_unexplained")["flagged"].all()


@pytest.mark.parametrize(
    ("verdict", "is_marked"),
    [("fault", True), ("alarm", True), ("not settled", True), ("cannot be told", False)],
)
def test_a_season_is_in_doubt_where_a_fault_is_likelier_than_not(sound, verdict, is_marked):
    world = sound.changed("diagnosis", SUBJECT, verdict=verdict, alarm=True)
    assert ("season_in_doubt" in world.flagged(SUBJECT)) == is_marked


def test_an_estimated_season_is_in_doubt_where_all_seasons_with_dgps_are(sound: World) -> None:
    """What its log was wrong rests on these alone."""
    old = pl.col("season") == 2012
    curves = sound.curves.with_columns(calibration_factor=pl.when(~old).then("calibration_factor"))
    world = replace(sound, curves=curves).changed("diagnosis", SUBJECT, verdict="estimated")
    assert "season_in_doubt" not in world.flagged(SUBJECT)
    doubted = world.changed("diagnosis", LATER, alarm=True)
    assert "season_in_doubt" in doubted.flagged(SUBJECT) & doubted.flagged(LATER)


@pytest.mark.parametrize("tow", [SUBJECT, LATER])
def test_all_seasons_are_in_doubt_where_all_boats_changed(sound: World, tow: str) -> None:
    """Another load cell looks the same, and nobody can say which of the two was right."""
    world = sound.changed("diagnosis", tow, instrument="fleet_step", verdict="fault")
    found = world.assessed().filter("flagged", check="season_in_doubt")["tow_id"]
    assert {SUBJECT, LATER} <= {*found}


@pytest.mark.parametrize(
    ("power_w", "rejecting", "status", "flags"),
    [
        (50.0, [(2012, "slow_tow")], "rejected", ["slow_tow"]),
        (50.0, [(2014, "slow_tow"), (2012, "few_runs")], "flagged", ["slow_tow"]),
        (75.0, [(2012, "slow_tow")], "accepted", []),
    ],
)
def test_a_method_rejects_and_the_numbers_stay(sound, power_w, rejecting, status, flags) -> None:
    world = sound.changed("curves", SUBJECT, power_w=power_w)
    curves = add_status(world.curves, world.assessed(), rejecting)
    assert curves.select(world.curves.columns).equals(world.curves)
    row = curves.row(by_predicate=pl.col("tow_id") == SUBJECT, named=True)
    assert (row["status"], row["flags"]) == (status, flags)


def test_a_method_says_which_checks_reject() -> None:
    text = (
        'name = "strict"\ntitle = "t"\nextends = "rebased-2015"\n'
        '[steps.assessment]\nreject = ["few_runs"]\n'
        '[[overrides]]\nrange = "2014:"\nassessment = { reject = ["few_runs", "slow_tow"] }\n'
    )
    strict, parent = parse_method(text, "strict.toml"), read_shipped_method("rebased-2015")
    assert strict.get_steps(2012).assessment.reject == ("few_runs",)
    assert strict.get_steps(2014).assessment.reject == ("few_runs", "slow_tow")
    assert parent.get_steps(2014).assessment.reject == ()
    assert strict.content_hash != parent.content_hash
