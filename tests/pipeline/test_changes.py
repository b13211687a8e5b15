"""What changes between two registers: ratios, kinds of change, causes."""

import json

import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.register.changes import register_changes


def edition(name, lines):
    """Lines of (boat, tow, v0, A, B)."""
    rows = [
        {
            "edition": name,
            "fsn_no": boat,
            "rowers": 8,
            "crew_class": "H",
            "empty_thwart": "",
            "tow_id": tow,
            "declared_speed_m_s": v0,
            "a_kg_m": a,
            "b_m_s": b,
            "cw_kg_m": None if a is None else a / (1 - (v0 / b) ** 2 if b else 1),
            "cw_lo_kg_m": None,
            "cw_hi_kg_m": None,
        }
        for boat, tow, v0, a, b in lines
    ]
    numbers = ("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m")
    return pl.DataFrame(rows, schema_overrides=dict.fromkeys(numbers, pl.Float64))


def change(old, new):
    return register_changes(edition("old", old), edition("new", new)).sort("fsn_no")


@given(
    a=st.tuples(st.floats(10, 60), st.floats(10, 60)),
    b=st.tuples(st.floats(3.5, 9), st.floats(3.5, 9)),
    v0=st.floats(1.5, 3.0),
)
def test_ratios_follow_from_the_two_curves(a, b, v0):
    row = change([("FSN1", "t", v0, a[0], b[0])], [("FSN1", "t", v0, a[1], b[1])]).row(
        0, named=True
    )

    def power(i, v):
        return a[i] / (1 - (v / b[i]) ** 2) * v**3

    assert row["cw_ratio"] == pytest.approx(power(1, v0) / power(0, v0), rel=1e-12)
    assert row["power_ratio"] == row["cw_ratio"]
    new_speed = v0 / row["time_ratio"]
    assert power(1, new_speed) == pytest.approx(power(0, v0), rel=1e-9)
    (cause,) = json.loads(row["causes"])
    assert cause == {"cause": "method", "factor": row["cw_ratio"]}


def test_kinds_of_change():
    old = [
        ("FSN1", "t1", 2.5, 40.0, 5.0),
        ("FSN2", "t2", 2.5, 40.0, 5.0),
        ("FSN3", "t3", 2.5, 40.0, 5.0),
    ]
    new = [
        ("FSN1", "t1", 2.5, 40.01, 5.0),
        ("FSN2", "t9", 2.5, 42.0, 5.0),
        ("FSN4", "t4", 2.5, 40.0, 5.0),
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
    assert (
        change([("FSN1", "t", 2.5, 40.0, 5.0)], [("FSN1", "t", 2.5, 40.0 * factor, 5.0)])[
            "change"
        ].item()
        == kind
    )
