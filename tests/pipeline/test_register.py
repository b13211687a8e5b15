"""The draft register: newest sound tow, validity, decisions of people, lines without a curve."""

import datetime as dt

import polars as pl
import pytest

from pipeline.method.definition import RegisterRule
from pipeline.method.reading import (
    MethodFileError,
    list_shipped_methods,
    parse_method,
    read_shipped_method,
)
from pipeline.method.writing import write_method_text
from pipeline.register.printed import carry_lines, rebase_printed
from pipeline.register.register import (
    DECISION_SCHEMA,
    NEWER_TOW_UNMEASURED,
    NO_DECISIONS,
    draft_register,
    find_unmeasured_tows,
    flag_unmeasured,
    list_lines_of_all_days,
)

ON = dt.date(2016, 6, 1)
NUMBERS = ("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m")


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


def register(rows=ROWS, on=ON, rule=RegisterRule(), decisions=()):  # noqa: B008 - frozen
    decided = pl.DataFrame(list(decisions), schema=DECISION_SCHEMA, orient="row")
    return draft_register(*frames(rows), BOATS, on, rule, decided)


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
    ("on", "first_of_six", "until", "status"),
    [
        (dt.date(2015, 12, 31), 2023, 2015, "valid"),
        (dt.date(2016, 1, 1), 2023, 2015, "expired"),
        (dt.date(2016, 1, 1), 2011, 2015, "expired"),
        (dt.date(2016, 1, 1), 2010, 2016, "valid"),
    ],
)
def test_a_tow_is_valid_to_the_end_of_the_fifth_or_sixth_calendar_year(
    on, first_of_six, until, status
):
    rule = RegisterRule(six_years_from=first_of_six)
    line = register(on=on, rule=rule).filter(fsn_no="FSN2").row(0, named=True)
    assert (line["valid_until"], line["status"]) == (dt.date(until, 12, 31), status)


@pytest.mark.parametrize(
    ("tow_date", "until"),
    [
        (dt.date(2015, 3, 1), dt.date(2018, 3, 1)),
        (dt.date(2016, 2, 29), dt.date(2019, 2, 28)),
    ],
)
def test_elsewhere_a_tow_counts_to_the_day(tow_date, until):
    rule = RegisterRule(valid_years=3, counts_until="same_day")
    rows = [("t", tow_date, "FSN1", 8, "H", "accepted")]
    for day, status in ((until, "valid"), (until + dt.timedelta(days=1), "expired")):
        line = register(rows, day, rule=rule).filter(fsn_no="FSN1").row(0, named=True)
        assert (line["valid_until"], line["status"]) == (until, status)


def test_a_method_drops_the_exception_of_the_one_that_it_extends():
    head = 'name = "own"\ntitle = "own"\nextends = "rebased"\n[register]\nvalid_years = 3\n'
    kept, dropped = (
        parse_method(head + line, "x.toml").validity for line in ("", 'six_years_from = "never"\n')
    )
    assert kept.six_years_from == 2023
    assert dropped == RegisterRule(valid_years=3)
    own = parse_method(head + 'counts_until = "same_day"\n', "x.toml")
    assert parse_method(write_method_text(own), "x.toml").validity == own.validity


def test_a_tow_with_a_thwart_left_free_is_a_line_of_its_own():
    """Sleepproef 2017, "Bemanning": its curve holds only with that thwart free."""
    rows = [*ROWS[:2], ("t7", dt.date(2015, 3, 1), "FSN1", 8, "H", "accepted", "3")]
    found = register(rows).filter(fsn_no="FSN1").select("empty_thwart", "tow_id", "as_of").rows()
    assert found == [("", "t2", ON), ("3", "t7", ON)]


def test_on_each_day_the_same_line_counts_in_the_history_as_in_the_register():
    history = list_lines_of_all_days(*frames(ROWS), RegisterRule())
    for day in (dt.date(2009, 1, 1), dt.date(2012, 6, 1), dt.date(2014, 6, 1), ON):
        begun = history.filter(pl.col("tow_date") <= day)
        newest = begun.group_by("fsn_no", "rowers", "crew_class", maintain_order=True).last()
        lines = register(on=day).drop_nulls("tow_id")
        assert sorted(newest["tow_id"]) == sorted(lines["tow_id"])
        valid = newest.filter(pl.col("valid_until") >= day)
        assert sorted(valid["tow_id"]) == sorted(lines.filter(status="valid")["tow_id"])


@pytest.mark.parametrize(
    ("decisions", "tow_id"),
    [
        ([("new", "exclude")], "middle"),
        ([("old", "prefer")], "old"),
        ([("old", "prefer"), ("middle", "prefer")], "middle"),
        ([("old", "exclude"), ("middle", "exclude"), ("new", "exclude")], None),
    ],
)
def test_people_exclude_a_tow_or_prefer_one(decisions, tow_id):
    days = {"old": 2012, "middle": 2013, "new": 2014, "later": 2016}
    rows = [(t, dt.date(y, 3, 1), "FSN1", 8, "H", "accepted") for t, y in days.items()]
    line = register(rows, dt.date(2015, 1, 1), decisions=decisions).row(0, named=True)
    assert line["tow_id"] == tow_id
    assert (line["status"] == "excluded") == (line["cw_kg_m"] is None) == (tow_id is None)


def test_the_rule_stands_in_the_method_and_changes_no_curve():
    text = write_method_text(read_shipped_method("rebased"))
    assert "six_years_from = 2023" in text
    other = parse_method(text.replace("valid_years = 5", "valid_years = 4"), "x.toml")
    assert other.validity.valid_years == 4
    assert other.content_hash == read_shipped_method("rebased").content_hash
    wrong = 'name = "own"\ntitle = "own"\nextends = "rebased"\n[register]\nyears = 2\n'
    with pytest.raises(MethodFileError, match=r"x.toml, line 5: 'years': unknown key.*valid_years"):
        parse_method(wrong, "x.toml")


@pytest.mark.parametrize("name", list_shipped_methods())
def test_a_method_written_out_reads_back_as_itself(name):
    method = read_shipped_method(name)
    read = parse_method(write_method_text(method), "x.toml")
    for part in ("definition", "validity", "title", "title_en", "description", "description_en"):
        assert getattr(read, part) == getattr(method, part)


def test_a_line_is_flagged_where_a_newer_tow_has_no_samples():
    days = {"tow_date": pl.Date, "empty_thwart": pl.String}
    crew = ("FSN1", 8, "H")
    names = ["fsn_no", "rowers", "crew_class", "tow_date", "empty_thwart"]
    tows = pl.DataFrame([(*crew, dt.date(2014, 3, 1), None)], names, orient="row")
    tows = tows.cast(days)
    listed = pl.concat([tows, tows.with_columns(tow_date=dt.date(2016, 3, 1))])
    printed = tows.with_columns(empty_thwart=pl.lit(""), has_valid_curve=pl.lit(value=True))
    unmeasured = find_unmeasured_tows(listed, printed, tows, ON)
    assert unmeasured["tow_date"].to_list() == [dt.date(2016, 3, 1)]
    assert find_unmeasured_tows(listed, printed, tows, dt.date(2016, 2, 1)).is_empty()
    preferred = pl.DataFrame([("t2", "prefer")], DECISION_SCHEMA, orient="row")
    for decisions, flags in ((NO_DECISIONS, [NEWER_TOW_UNMEASURED]), (preferred, [])):
        lines = flag_unmeasured(register(), unmeasured, decisions)
        assert lines.filter(tow_id="t2")["flags"].to_list() == [flags]
        assert lines.filter(tow_id="t6")["flags"].to_list() == [[]]


def printed(*lines):
    """Lines of a printed register from (boat, day, A): eight men, B = 5 m/s."""
    rows = [
        {"fsn_no": boat, "rowers": 8, "crew_class": "H", "empty_thwart": "", "tow_date": day,
         "declared_speed_m_s": 2.5, "a_kg_m": a, "b_m_s": 5.0, "cw_kg_m": a / 0.75}
        for boat, day, a in lines
    ]  # fmt: skip
    return pl.DataFrame(rows, schema_overrides={"rowers": pl.Int64})


FACTORS = pl.DataFrame({"season": [2010, 2011], "factor": [1.05, 1.04]})


@pytest.mark.parametrize(
    ("lines", "tow_id", "basis", "tow_date"),
    [
        ([("FSN1", dt.date(2014, 9, 1), 40.0)], None, "printed_not_rebased", dt.date(2014, 9, 1)),
        ([("FSN1", dt.date(2011, 9, 1), 40.0)], "t2", "measured", dt.date(2014, 3, 1)),
        ([("FSN1", dt.date(2014, 3, 1), 40.0)], "t2", "measured", dt.date(2014, 3, 1)),
    ],
    ids=["newer and without samples", "older", "of a tow with samples"],
)
def test_a_printed_line_counts_where_the_newest_tow_has_no_samples(lines, tow_id, basis, tow_date):
    curves, tows = frames(ROWS)
    crews = {"rowers": 8, "crew_class": "H"}
    facts = tows.join(curves.select("tow_id", "fsn_no", "rowers", "crew_class"), on="tow_id")
    method = read_shipped_method("rebased")
    carried = carry_lines(printed(*lines), FACTORS, method, facts)
    register = draft_register(curves, tows, BOATS, ON, method.validity, NO_DECISIONS, carried)
    line = register.filter(fsn_no="FSN1", **crews).row(0, named=True)
    assert (line["tow_id"], line["basis"], line["tow_date"]) == (tow_id, basis, tow_date)
    assert line["status"] == "valid"


def test_a_printed_line_is_rebased_by_the_log_factor_of_its_season():
    method = read_shipped_method("rebased")
    lines = printed(("FSN9", dt.date(2011, 9, 1), 40.0))
    line = rebase_printed(lines, FACTORS, method).row(0, named=True)
    assert (line["a_kg_m"], line["b_m_s"]) == pytest.approx((40.0 / 1.04**2, 5.0 * 1.04))
    assert line["basis"] == "printed_rebased"
