"""The draft register: newest sound tow, validity, and lines without a curve."""

import datetime as dt

import polars as pl
import pytest

from pipeline.method.definition import RegisterRule
from pipeline.register.register import draft_register, lines_of_all_days

ON = dt.date(2016, 6, 1)
NUMBERS = (*("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m"),)


def frames(rows):
    """Curves and tows from (tow_id, day, boat, rowers, class, status), thwart left free if any."""
    curves = pl.DataFrame(
        [
            {"tow_id": t, "fsn_no": b, "rowers": r, "crew_class": c, "status": s, "flags": []}
            | {n: None if s == "rejected" else float(i + 1) for i, n in enumerate(NUMBERS)}
            for t, _, b, r, c, s, *_ in rows
        ],
        schema_overrides=dict.fromkeys(NUMBERS, pl.Float64),
    )
    tows = [(r[0], r[1], r[6] if len(r) > 6 else None) for r in rows]
    schema = {"tow_id": pl.String, "tow_date": pl.Date, "empty_thwart": pl.String}
    return curves, pl.DataFrame(tows, schema=schema, orient="row")


ROWS = [
    ("t1", dt.date(2010, 3, 1), "FSN1", 8, "H", "accepted"),
    ("t2", dt.date(2014, 3, 1), "FSN1", 8, "H", "flagged"),
    ("t3", dt.date(2015, 3, 1), "FSN1", 8, "H", "rejected"),
    ("t4", dt.date(2010, 3, 1), "FSN2", 6, "D", "accepted"),
    ("t5", dt.date(2015, 3, 1), "FSN3", 6, "D", "rejected"),
    ("t6", dt.date(2011, 1, 1), "FSN1", 8, "D", "accepted"),
]
BOATS = pl.DataFrame(
    {"fsn_no": ["FSN1", "FSN4", "FSN5"], "rowers": [8, 10, None], "crew_class": ["H", "H", "D"]}
)


def register(rows=ROWS, on=ON):
    return draft_register(*frames(rows), BOATS, on, RegisterRule())


def test_one_line_per_boat_and_crew_with_its_newest_sound_tow():
    found = register().select("fsn_no", "rowers", "crew_class", "tow_id", "status").rows()
    assert found == [
        ("FSN1", 8, "D", "t6", "valid"),
        ("FSN1", 8, "H", "t2", "valid"),
        ("FSN2", 6, "D", "t4", "expired"),
        ("FSN3", 6, "D", None, "rejected"),
        ("FSN4", 10, "H", None, "never_towed"),
    ]


@pytest.mark.parametrize(
    ("on", "status"), [(dt.date(2015, 12, 31), "valid"), (dt.date(2016, 1, 1), "expired")]
)
def test_a_tow_is_valid_to_the_end_of_the_fifth_calendar_year(on, status):
    line = register(on=on).filter(fsn_no="FSN2")
    assert line["valid_until"].item() == dt.date(2015, 12, 31)
    assert line["status"].item() == status


def test_a_tow_with_a_thwart_left_free_is_a_line_of_its_own():
    """Sleepproef 2017, "Bemanning": its curve holds only with that thwart free."""
    rows = [*ROWS[:2], ("t7", dt.date(2015, 3, 1), "FSN1", 8, "H", "accepted", "3")]
    found = register(rows).filter(fsn_no="FSN1").select("empty_thwart", "tow_id", "as_of").rows()
    assert found == [("", "t2", ON), ("3", "t7", ON)]


def test_on_each_day_the_same_line_counts_in_the_history_as_in_the_register():
    history = lines_of_all_days(*frames(ROWS), RegisterRule())
    for day in (dt.date(2009, 1, 1), dt.date(2012, 6, 1), dt.date(2014, 6, 1), ON):
        begun = history.filter(pl.col("tow_date") <= day)
        newest = begun.group_by("fsn_no", "rowers", "crew_class", maintain_order=True).last()
        lines = register(on=day).drop_nulls("tow_id")
        assert sorted(newest["tow_id"]) == sorted(lines["tow_id"])
        valid = newest.filter(pl.col("valid_until") >= day)
        assert sorted(valid["tow_id"]) == sorted(lines.filter(status="valid")["tow_id"])
