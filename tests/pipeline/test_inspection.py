"""What was last measured of each boat, and what it may be on a race day."""

import datetime as dt

import polars as pl
import pytest

from pipeline.register.inspection import TOLERANCES, list_inspections
from pipeline.tables.frames import get_dtypes
from pipeline.tables.lake import ListedBoats, ListedTows
from pipeline.tables.schemas import conform

DAY, LATER = dt.date(2014, 3, 1), dt.date(2018, 3, 10)
INFERRED = pl.DataFrame(
    [{"kind": kind, "size": size, "inferred": True} for kind, size in TOLERANCES.items()]
)


def frame_of(table, rows):
    return pl.DataFrame(rows, schema=get_dtypes(table))


def tow(tow_id, day, fsn_no="FSN1", rowers=8, **measured):
    return {"tow_id": tow_id, "tow_date": day, "fsn_no": fsn_no, "rowers": rowers} | measured


def inspect(*tows, boats=({"fsn_no": "FSN1"},), tolerances=INFERRED):
    """Rows of `inspections` by boat and measure."""
    listed = frame_of(ListedTows, tows), frame_of(ListedBoats, boats)
    rows = conform("inspections", list_inspections(*listed, tolerances))
    return {(row["fsn_no"], row["measure"]): row for row in rows.to_dicts()}


def test_a_later_measurement_wins_for_each_measure_by_itself():
    found = inspect(
        tow("2018-001", LATER, weight_kg=1100.0, photo_rudder="new.jpg"),
        tow("2014-001", DAY, weight_kg=1000.0, thwart_1_m=1.8, photo_rudder="old.jpg"),
    )
    weight, thwart = found["FSN1", "weight_kg"], found["FSN1", "thwart_1_m"]
    assert (weight["value"], weight["measured_on"], weight["tow_id"]) == (1100, LATER, "2018-001")
    assert (thwart["value"], thwart["measured_on"], thwart["tow_id"]) == (1.8, DAY, "2014-001")
    assert found["FSN1", "photo_rudder"]["photo"] == "new.jpg"


def test_limits_are_the_value_with_its_tolerance_in_the_unit_of_the_measure():
    found = inspect(tow("2014-001", DAY, weight_kg=1049.0, freeboard_bow_m=1.065, thwart_2_m=3.2))
    limits = {
        measure: (row["unit"], row["lowest"], row["highest"])
        for (_, measure), row in found.items()
        if row["value"] is not None
    }
    ratio, freeboard = TOLERANCES["weight"], TOLERANCES["freeboard"]
    thwart = TOLERANCES["thwart"]
    assert limits == {
        "weight_kg": ("kg", round(1049 * (1 - ratio)), round(1049 * (1 + ratio))),
        "freeboard_bow_m": (
            "m",
            pytest.approx(1.065 - freeboard),
            pytest.approx(1.065 + freeboard),
        ),
        "thwart_2_m": ("m", pytest.approx(3.2 - thwart), pytest.approx(3.2 + thwart)),
    }
    assert found["FSN1", "weight_kg"]["tolerance"] == pytest.approx(1049 * ratio)


def test_what_was_never_measured_has_no_number_and_no_limits():
    found = inspect(tow("2014-001", DAY, weight_kg=1000.0))
    for measure in ("freeboard_lowest_m", "thwart_1_m", "rudder_height_m", "photo_boat"):
        row = found["FSN1", measure]
        names = ("value", "photo", "source", "measured_on", "tow_id", "lowest", "highest")
        assert [row[name] for name in names] == [None] * len(names)


def test_a_weight_in_no_tow_list_is_that_of_the_boat_list_without_a_day():
    boats = [{"fsn_no": "FSN1", "weight_kg": 1417.0}, {"fsn_no": "FSN2", "weight_kg": 969.0}]
    found = inspect(
        tow("2014-001", DAY, thwart_1_m=1.8), tow("2014-002", DAY, "FSN2", weight_kg=900.0),
        boats=boats,
    )  # fmt: skip
    row = found["FSN1", "weight_kg"]
    assert (row["value"], row["source"], row["measured_on"]) == (1417, "boat_list", None)
    row = found["FSN2", "weight_kg"]
    assert (row["value"], row["source"]) == (900, "tow_list")


@pytest.mark.parametrize(
    ("rowers", "measured", "thwarts"), [(8, {}, 4), (9, {}, 5), (6, {"thwart_5_m": 6.0}, 4)]
)
def test_thwarts_are_those_of_the_largest_crew_and_those_measured(rowers, measured, thwarts):
    found = inspect(
        tow("2014-001", DAY, rowers=6), tow("2018-001", LATER, rowers=rowers, **measured)
    )
    assert sum(measure.startswith("thwart") for _, measure in found) == thwarts


def test_a_boat_that_was_never_towed_has_its_blanks():
    found = inspect(boats=[{"fsn_no": "FSN9"}])
    assert {fsn_no for fsn_no, _ in found} == {"FSN9"}
    assert {row["value"] for row in found.values()} == {None}
