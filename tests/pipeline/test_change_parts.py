"""Known parts of a change, the ground of the rest, and the numbers side by side."""

import json
import math

import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.register.changes import (
    PART_SCHEMA,
    compare_lines,
    register_changes,
    steps_of_lines,
)

LINE = ("FSN1", 8, "H", "")
NUMBERS = ("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m")


def edition(name, *lines):
    """Lines of (boat, class, A, B, half width of ln Cw), declared 2.5 m/s, eight rowers."""
    rows = []
    for boat, crew, a, b, width in lines:
        height = a / (1 - (2.5 / b) ** 2)
        rows.append(
            {
                "edition": name,
                "fsn_no": boat,
                "rowers": 8,
                "crew_class": crew,
                "empty_thwart": "",
                "tow_id": "t",
                "declared_speed_m_s": 2.5,
                "a_kg_m": a,
                "b_m_s": b,
                "cw_kg_m": height,
                "cw_lo_kg_m": None if width is None else height * math.exp(-width),
                "cw_hi_kg_m": None if width is None else height * math.exp(width),
            }
        )
    return pl.DataFrame(rows, schema_overrides=dict.fromkeys(NUMBERS, pl.Float64))


def parts(*rows):
    return pl.DataFrame([(*LINE, *row) for row in rows], schema=PART_SCHEMA, orient="row")


OLD, NEW = (
    edition("old", ("FSN1", "H", 40.0, 5.0, 0.01)),
    edition("new", ("FSN1", "H", 44.0, 5.0, 0.01)),
)


def causes(found, *rest):
    grounds = pl.DataFrame(
        [(*LINE, "code")],
        schema=["fsn_no", "rowers", "crew_class", "empty_thwart", "ground"],
        orient="row",
    )
    return json.loads(register_changes(OLD, NEW, found, grounds)["causes"].item())


@given(st.lists(st.floats(0.8, 1.25), max_size=6))
def test_whatever_is_known_all_factors_multiply_to_the_change(factors):
    found = causes(parts(*(("method", f"step{i}", f) for i, f in enumerate(factors))))
    assert math.prod(c["factor"] for c in found) == pytest.approx(1.1, rel=1e-12)


def test_the_steps_of_a_ladder_go_to_the_lines_of_their_tow_in_order():
    ladder = pl.DataFrame(
        {
            "tow_id": ["t", "t", "u"],
            "position": [1, 0, 0],
            "step": ["b", "a", "c"],
            "factor": [2.0, 1.0, 3.0],
        }
    )
    found = steps_of_lines(OLD, ladder)
    assert found.select("cause", "step", "factor").rows() == [
        ("method", "a", 1.0),
        ("method", "b", 2.0),
    ]


def test_both_numbers_in_watt_seconds_and_rank():
    old = edition(
        "o",
        ("FSN1", "H", 40.0, 5.0, 0.01),
        ("FSN2", "H", 42.0, 5.0, 0.01),
        ("FSN3", "D", 60.0, 5.0, 0.01),
    )
    new = edition(
        "n",
        ("FSN1", "H", 44.0, 5.0, 0.01),
        ("FSN2", "H", 42.0, 5.0, 0.01),
        ("FSN3", "D", 60.0, 5.0, 0.01),
    )
    first, second, third = compare_lines(old, new).iter_rows(named=True)
    assert first["old_power_w"] == pytest.approx(40 / 0.75 * 2.5**3 / 8)
    assert first["new_power_w"] == pytest.approx(1.1 * first["old_power_w"])
    assert (first["old_rank"], first["new_rank"]) == (1, 2)
    assert (second["old_rank"], second["new_rank"]) == (2, 1)
    assert (third["old_rank"], third["new_rank"]) == (1, 1)
    assert (
        first["gain_in_two_hours_s"] > 0 == pytest.approx(second["gain_in_two_hours_s"], abs=1e-6)
    )


@pytest.mark.parametrize(("width", "exceeds"), [(0.01, True), (0.09, False), (None, None)])
def test_a_change_is_held_against_the_intervals_of_both(width, exceeds):
    """ln 1.1 is 0.0953; two half widths of 0.09 make 0.127."""
    old, new = (
        edition(name, ("FSN1", "H", a, 5.0, width)).with_columns(tow_id=pl.lit(name))
        for name, a in (("o", 40.0), ("n", 44.0))
    )
    assert compare_lines(old, new)["exceeds_interval"].item() is exceeds


def test_a_new_curve_that_ends_below_the_old_speed_gives_no_ratio():
    low = edition("n", ("FSN1", "H", 44.0, 5.0, 0.01)).with_columns(pl.lit(2.0).alias("b_m_s"))
    row = register_changes(OLD, low).row(0, named=True)
    assert row["change"] == "changed"
    assert row["cw_ratio"] is row["time_ratio"] is None
    assert json.loads(row["causes"]) == []
