"""Boats of a type: verdicts from runs of known truth, men's and women's crews together."""

import numpy as np
import polars as pl
import pytest

from pipeline.tables.schemas import conform
from tests.pipeline.consistency_fleet import POWER, compared, consistency_tables, fleet

REPETITIONS = 30
SEASONS = {"seasons": (2014, 2016), "seasons_in_turn": True}
ALIKE = {"boats": 12, "women": 6, "noise": 0.012, "others": 20} | SEASONS
"""Equal hulls; boats of no type are towed twice, which tells the measuring errors."""


@pytest.fixture(scope="module")
def verdicts():
    """Verdicts on equal hulls with men's and women's crews."""
    return compared(*fleet(1, REPETITIONS, **ALIKE)).consistency.filter(boat_type="like")


def share(rows, column, *values):
    return rows[column].is_in(values).mean()


def test_equal_hulls_of_men_and_women_are_equal_and_none_stands_out(verdicts):
    for quantity in ("cw_standard_kg_m", "b_m_s", "a_kg_m"):
        rows = verdicts.filter(quantity=quantity)
        assert share(rows, "verdict", "equal") >= 0.9, quantity
        assert share(rows, "verdict", "differ") <= 0.1, quantity
        assert (rows["outside"].list.len() == 0).mean() >= 0.9, quantity


def test_tow_speed_does_not_stand_for_the_mass_of_the_crew(verdicts):
    """Women are towed slower and lie lower; pooled, Cw would seem to rise with tow speed."""
    rows = verdicts.filter(quantity="cw_standard_kg_m")
    assert share(rows, "tow_speed_verdict", "rises") <= 0.1
    mass_ratio = (1000 + 600) / (1000 + 760)
    assert rows["women_ratio"].mean() == pytest.approx(mass_ratio**POWER, abs=0.005)


def test_weight_explains_cw_and_not_b(verdicts):
    cw, b = (verdicts.filter(quantity=name) for name in ("cw_standard_kg_m", "b_m_s"))
    assert share(cw, "weight_verdict", "rises") == 1.0
    assert cw["weight_slope"].mean() == pytest.approx(POWER * 100 / 1700, rel=0.05)
    assert share(b, "weight_verdict", "none", "open") >= 0.9


def test_boats_that_differ_are_said_to():
    differing = compared(*fleet(2, REPETITIONS, **ALIKE, height_sd=0.05, b_cv=0.10)).consistency
    for quantity, spread in (("cw_standard_kg_m", 0.05), ("b_m_s", 0.10)):
        rows = differing.filter(quantity=quantity, boat_type="like")
        assert share(rows, "verdict", "equal") <= 0.1
        assert share(rows, "verdict", "differ") >= 0.9
        assert rows["spread_ratio"].mean() == pytest.approx(spread, rel=0.25)


def test_a_boat_far_off_is_named_with_what_could_explain_it():
    for season, candidates in ((2012, ["askew"]), (2016, [])):
        like = ALIKE | {"seasons": (season, season + 1)}
        tables = consistency_tables(*fleet(16, **like, boat_off=0.15))
        row = tables["type_consistency"].filter(quantity="cw_standard_kg_m", boat_type="like")
        assert row["outside"].to_list() == [["FSN000"]]
        tow = tables["compared_tows"].filter("cw_outside").row(0, named=True)
        assert (tow["fsn_no"], tow["candidates"]) == ("FSN000", candidates)
        ratio = tow["cw_standard_kg_m"] / tow["cw_expected_kg_m"]
        assert np.log(ratio) == pytest.approx(0.15, abs=0.03)


def test_mens_and_womens_crews_of_a_hull_are_one_boat_whatever_was_altered_between():
    curves, tows, boats, points = fleet(19, **ALIKE | {"women": 0}, height_sd=0.05)
    newer = {"tow_id": pl.concat_str(pl.lit("w"), "tow_id"), "season": pl.col("season") + 1}
    women = pl.col("tow_id").is_in([f"{year}-{b:03d}" for b in range(6) for year in (2014, 2016)])
    doubled = (
        pl.concat([curves, curves.filter(women).with_columns(**newer, crew_class=pl.lit("D"))]),
        pl.concat(
            [
                tows,
                tows.filter(women).with_columns(
                    tow_id=newer["tow_id"],
                    tow_date=pl.col("tow_date").dt.offset_by("1y"),
                    altered=pl.lit(value=True),
                ),
            ]
        ),
        boats,
        pl.concat([points, points.filter(women).with_columns(tow_id=newer["tow_id"])]),
    )
    row = compared(*doubled).consistency.filter(quantity="cw_standard_kg_m", boat_type="like")
    assert (row["n"][0], row["n_boats"][0]) == (18, 12)
    # The women's tows are copies of the men's: they add nothing to what boats differ by.
    alone = compared(curves, tows, boats, points).consistency
    alone = alone.filter(quantity="cw_standard_kg_m", boat_type="like")
    assert row["spread_ratio"][0] == pytest.approx(alone["spread_ratio"][0], rel=0.1)


def test_tows_whose_curve_does_not_count_at_the_common_speed_have_no_part_in_cw():
    speeds = np.r_[np.linspace(2.4, 2.6, 11), 2.0]
    tables = consistency_tables(*fleet(17, speeds_m_s=speeds))
    n = dict(tables["type_consistency"].select("quantity", "n").rows())
    assert n == {"cw_standard_kg_m": 11, "b_m_s": 12, "a_kg_m": 12}
    slow = tables["compared_tows"].filter(fsn_no="FSN011").row(0, named=True)
    assert slow["beyond_curve"]
    assert slow["cw_deviation_sd"] is None


def test_lines_are_drawn_within_the_classes_and_hold_the_slope():
    results = compared(*fleet(18, **ALIKE))
    of = {"quantity": "cw_standard_kg_m", "boat_type": "like"}
    row = results.consistency.filter(**of).row(0, named=True)
    for crew_class in ("H", "D"):
        line = results.lines.filter(
            quantity="cw_standard_kg_m", explaining="weight_kg", crew_class=crew_class
        )
        first, last = line.row(0, named=True), line.row(-1, named=True)
        rise = np.log(last["y"] / first["y"]) / (last["x"] - first["x"]) * 100.0
        assert rise == pytest.approx(row["weight_slope"], rel=1e-9)
        assert (line["lo"] < line["y"]).all()
        assert (line["y"] < line["hi"]).all()


# Degenerate input: nulls and a reason, never NaN, never a warning (warnings are errors here)

CASES = {
    "no tows": (tuple(frame.clear() for frame in fleet(30)), None),
    "one boat": (fleet(31, boats=1), "few_boats"),
    "four boats": (fleet(32, boats=4), "few_boats"),
    "no type": (fleet(33, boat_type=None), "no_type"),
    "equal weights": (
        fleet(34, weights_kg=np.full(12, 1000.0), speeds_m_s=np.full(12, 2.5)),
        "equal_values",
    ),
    "no weights": (fleet(35, weights_kg=np.full(12, np.nan)), "equal_values"),
    "no scatter": (fleet(37, noise=0.0, weights_kg=np.full(12, 1000.0)), None),
    "five boats": (fleet(38, boats=5, women=2), "few_boats"),
    "four in each class": (fleet(41, boats=8, women=4), "few_boats"),
    "two seasons": (fleet(39, boats=6, seasons=(2014, 2016)), None),
}


@pytest.mark.parametrize("case", CASES)
def test_degenerate_input_gives_a_reason_and_no_nan_and_fits_the_schemas(case):
    tables, reason = CASES[case]
    found = consistency_tables(*tables)
    for name, frame in found.items():
        for column in conform(name, frame).select(pl.col(pl.Float64)):
            assert not column.is_nan().any(), (name, column.name)
            assert not column.is_infinite().any(), (name, column.name)
    if reason is not None:
        rows = found["type_consistency"].filter(quantity="a_kg_m")
        assert rows["weight_verdict"].to_list() == [reason]
        assert rows["weight_slope"].null_count() == 1


def test_the_order_of_rows_does_not_matter():
    tables = fleet(40, boats=8, women=3, seasons=(2014, 2016, 2018), height_sd=0.03)
    shuffled = [frame.sample(fraction=1.0, shuffle=True, seed=1) for frame in tables]
    ours, theirs = consistency_tables(*tables), consistency_tables(*shuffled)
    for name, frame in ours.items():
        assert conform(name, frame).equals(conform(name, theirs[name])), name
