"""What changes between two registers: ratios, kinds of change, causes, numbers side by side."""

import json
import math

import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.register.causes import assign_steps
from pipeline.register.changes import compare_lines

KEY = ("fsn_no", "rowers", "crew_class", "empty_thwart")
NUMBERS = ("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m")


def line(boat, a, b=5.0, v0=2.5, tow="t", crew="H", width=None):
    """A line of eight rowers; width: half that of the interval of ln Cw."""
    cw = a / (1 - (v0 / b) ** 2)
    ends = [None if width is None else cw * math.exp(side * width) for side in (-1, 1)]
    names = (*KEY, "tow_id", *NUMBERS)
    return dict(zip(names, (boat, 8, crew, "", tow, v0, a, b, cw, *ends), strict=True))


def edition(name, *lines):
    rows = [{"edition": name} | one for one in lines]
    return pl.DataFrame(rows, schema_overrides=dict.fromkeys(NUMBERS, pl.Float64))


def change(old, new):
    return compare_lines(edition("old", *old), edition("new", *new)).sort("fsn_no")


@given(
    a=st.tuples(st.floats(10, 60), st.floats(10, 60)),
    b=st.tuples(st.floats(3.5, 9), st.floats(3.5, 9)),
    v0=st.floats(1.5, 3.0),
)
def test_ratios_follow_from_the_two_curves(a, b, v0):
    old, new = ([line("FSN1", a[i], b[i], v0)] for i in (0, 1))
    row = change(old, new).row(0, named=True)

    def power(i, v):
        return a[i] / (1 - (v / b[i]) ** 2) * v**3

    assert row["cw_ratio"] == pytest.approx(power(1, v0) / power(0, v0), rel=1e-12)
    assert row["power_ratio"] == row["cw_ratio"]
    new_speed = v0 / row["time_ratio"]
    assert power(1, new_speed) == pytest.approx(power(0, v0), rel=1e-9)
    (cause,) = json.loads(row["causes"])
    assert cause == {"cause": "method", "factor": row["cw_ratio"]}


def test_kinds_of_change():
    old = [line(f"FSN{i}", 40.0, tow=f"t{i}") for i in (1, 2, 3)]
    new = [
        line("FSN1", 40.01, tow="t1"),
        line("FSN2", 42.0, tow="t9"),
        line("FSN4", 40.0, tow="t4"),
    ]
    found = change(old, new)
    assert found.select("fsn_no", "change").rows() == [
        ("FSN1", "same"), ("FSN2", "changed"), ("FSN3", "removed"), ("FSN4", "added"),
    ]  # fmt: skip
    assert found["cw_ratio"].is_null().to_list() == [False, False, True, True]
    assert json.loads(found["causes"][1])[0]["cause"] == "tow"
    assert json.loads(found["causes"][3]) == []


@pytest.mark.parametrize(
    ("factor", "kind"), [(1.0004, "same"), (1.0006, "changed"), (0.9994, "changed")]
)
def test_five_hundredths_of_a_per_cent_is_the_same(factor, kind):
    found = change([line("FSN1", 40.0)], [line("FSN1", 40.0 * factor)])
    assert found["change"].item() == kind


def test_a_new_curve_that_ends_below_the_old_speed_gives_no_ratio():
    low = line("FSN1", 44.0) | {"b_m_s": 2.0}
    row = change([line("FSN1", 40.0)], [low]).row(0, named=True)
    assert row["change"] == "changed"
    assert row["cw_ratio"] is row["time_ratio"] is None
    assert json.loads(row["causes"]) == []


# Known parts of a change, and the ground of the rest


@given(st.lists(st.floats(0.8, 1.25), max_size=6))
def test_whatever_is_known_all_factors_multiply_to_the_change(factors):
    of_line = ("FSN1", 8, "H", "")
    parts = [(*of_line, "method", f"step{i}", factor) for i, factor in enumerate(factors)]
    known = pl.DataFrame(parts, schema=[*KEY, "cause", "step", "factor"], orient="row")
    grounds = pl.DataFrame([(*of_line, "code")], schema=[*KEY, "ground"], orient="row")
    old, new = edition("old", line("FSN1", 40.0)), edition("new", line("FSN1", 44.0))
    causes = json.loads(compare_lines(old, new, known, grounds)["causes"].item())
    assert math.prod(c["factor"] for c in causes) == pytest.approx(1.1, rel=1e-12)


def test_the_steps_of_a_ladder_go_to_the_lines_of_their_tow_in_order():
    rows = [("t", 1, "b", 2.0), ("t", 0, "a", 1.0), ("u", 0, "c", 3.0)]
    ladder = pl.DataFrame(rows, schema=["tow_id", "position", "step", "factor"], orient="row")
    found = assign_steps(edition("old", line("FSN1", 40.0)), ladder)
    assert found.select("cause", "step", "factor").rows() == [
        ("method", "a", 1.0), ("method", "b", 2.0),
    ]  # fmt: skip


# Numbers side by side


def test_both_numbers_in_watt_seconds_and_rank():
    others = line("FSN2", 42.0), line("FSN3", 60.0, crew="D")
    old = edition("o", line("FSN1", 40.0), *others)
    new = edition("n", line("FSN1", 44.0), *others)
    first, second, third = compare_lines(old, new).iter_rows(named=True)
    assert first["old_power_w"] == pytest.approx(40 / 0.75 * 2.5**3 / 8)
    assert first["new_power_w"] == pytest.approx(1.1 * first["old_power_w"])
    assert (first["old_rank"], first["new_rank"]) == (1, 2)
    assert (second["old_rank"], second["new_rank"]) == (2, 1)
    assert (third["old_rank"], third["new_rank"]) == (1, 1)
    assert first["gain_in_two_hours_s"] > 0
    assert second["gain_in_two_hours_s"] == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize(("width", "exceeds"), [(0.01, True), (0.09, False), (None, None)])
def test_a_change_is_held_against_the_intervals_of_both(width, exceeds):
    """ln 1.1 is 0.0953; two half widths of 0.09 make 0.127."""
    old, new = (
        edition(name, line("FSN1", a, tow=name, width=width))
        for name, a in (("o", 40.0), ("n", 44.0))
    )
    assert compare_lines(old, new)["exceeds_interval"].item() is exceeds
