"""The due list: the federation's rule for the speed of the next tow, with its exceptions."""

import datetime as dt

import polars as pl
import pytest

from pipeline.crews import STANDARD_CREWS
from pipeline.register.due import IN_RANGE as REALISTIC
from pipeline.register.due import (
    LIKE_BOATS,
    NOT_RACED,
    NOTHING_KNOWN,
    REALLY_ROWED_SO,
    ROWED_FASTER,
    TOO_FAST,
    due_list,
)

AS_OF = dt.date(2018, 6, 1)
A, B, ROWERS = 31.6, 4.44, 8
"""The worked example of the presentation: 71.2 W per rower at 2.35 m/s."""

RACES = {
    "fsn_no": pl.String(),
    "rowers": pl.Int32(),
    "crew_class": pl.String(),
    "race_date": pl.Date(),
    "distance_m": pl.Float64(),
    "stream_m": pl.Float64(),
    "rowing_time_s": pl.Float64(),
}


def power(speed):
    return A / (1 - (speed / B) ** 2) * speed**3 / ROWERS


def line(fsn_no, declared, crew_class="H", a=A, b=B):
    known = declared is not None
    return {
        "fsn_no": fsn_no,
        "rowers": ROWERS,
        "crew_class": crew_class,
        "empty_thwart": "",
        "status": "valid" if known else "never_towed",
        "tow_id": f"2014-{fsn_no}" if known else None,
        "tow_date": dt.date(2014, 3, 1) if known else None,
        "valid_until": dt.date(2019, 12, 31) if known else None,
        "declared_speed_m_s": declared,
        "a_kg_m": a if known else None,
        "b_m_s": b if known else None,
        "cw_kg_m": None if not known else a if b is None else a / (1 - (declared / b) ** 2),
    }


def due(*lines, raced=(), types=(), crew_classes=STANDARD_CREWS):
    register = pl.DataFrame(
        list(lines),
        schema_overrides={"rowers": pl.Int32, "a_kg_m": pl.Float64, "b_m_s": pl.Float64},
    )
    boats = pl.DataFrame({"fsn_no": register["fsn_no"].unique().sort()}).with_columns(
        pl.col("fsn_no")
        .replace_strict(dict(types), default=None)
        .cast(pl.String)
        .alias("boat_type")
    )
    races = pl.DataFrame(
        [
            (f, ROWERS, "H", day, speed * 7200 + stream, stream, 7200.0)
            for f, day, speed, stream in raced
        ],
        schema=RACES,
        orient="row",
    )
    return {
        r["fsn_no"]: r
        for r in due_list(register, boats, races, AS_OF, crew_classes).iter_rows(named=True)
    }


@pytest.mark.parametrize(
    ("declared", "raced", "reason", "proposed"),
    [
        (2.35, {}, REALISTIC, 2.35),
        (2.8, {(2018, 5, 1): 2.8}, TOO_FAST, "highest_speed_m_s"),
        (2.1, {(2018, 5, 1): 2.3}, ROWED_FASTER, 2.3),
        (2.1, {(2018, 5, 1): 2.45}, ROWED_FASTER, 2.45),
        (2.1, {(2018, 5, 1): 2.9}, ROWED_FASTER, "highest_speed_m_s"),
        (2.1, {(2018, 5, 1): 2.05}, REALLY_ROWED_SO, 2.1),
        # Over a year ago, and after the day of the list.
        (2.1, {(2017, 6, 1): 2.6, (2018, 6, 2): 2.6}, NOT_RACED, "lowest_speed_m_s"),
    ],
)
def test_the_rule_for_the_next_speed(declared, raced, reason, proposed):
    races = [("X", dt.date(*day), speed, 0.0) for day, speed in raced.items()]
    row = due(line("X", declared), raced=races)["X"]
    assert row["speed_reason"] == reason
    assert row["tow_speed_m_s"] == pytest.approx(row.get(proposed, proposed))
    assert power(row["lowest_speed_m_s"]) == pytest.approx(70)
    assert power(row["highest_speed_m_s"]) == pytest.approx(90)


def test_power_is_that_of_the_example():
    row = due(line("X", 2.35))["X"]
    assert row["power_w"] == pytest.approx(71.21, abs=0.01)
    assert not row["beyond_curve"]


def test_a_boat_without_a_curve_gets_the_middle_of_like_boats():
    types = [("X", "Kuiken"), ("Y", "Kuiken"), ("Z", "Vlet")]
    found = due(line("X", 2.35), line("Y", None), line("Z", None), types=types)
    middle = (found["X"]["lowest_speed_m_s"] + found["X"]["highest_speed_m_s"]) / 2
    assert found["Y"]["speed_reason"] == LIKE_BOATS
    assert found["Y"]["tow_speed_m_s"] == pytest.approx(middle)
    assert (found["Z"]["tow_speed_m_s"], found["Z"]["speed_reason"]) == (None, NOTHING_KNOWN)


def test_the_range_of_another_federation_is_that_of_its_classes():
    mixed = STANDARD_CREWS.head(1).with_columns(
        crew_class=pl.lit("X"), lowest_power_w=50.0, highest_power_w=60.0
    )
    found = due(line("FSN1", 2.35, "X"), crew_classes=mixed)["FSN1"]
    assert found["speed_reason"] == TOO_FAST
    assert power(found["lowest_speed_m_s"]) == pytest.approx(50.0)
    assert power(found["tow_speed_m_s"]) == pytest.approx(60.0)
