"""Decisions of people in a register, and how long a tow counts by the method's rule."""

import datetime as dt

import polars as pl
import pytest

from pipeline.method.definition import (
    MethodFileError,
    RegisterRule,
    parse_method,
    shipped_method,
)
from pipeline.method.writing import method_text
from pipeline.register.register import DECISION_SCHEMA, draft_register

NUMBERS = (*("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m"),)
TOWS = pl.DataFrame(
    {
        "tow_id": ["old", "middle", "new", "later"],
        "tow_date": [dt.date(year, 3, 1) for year in (2012, 2013, 2014, 2016)],
        "empty_thwart": pl.Series([None] * 4, dtype=pl.String),
    }
)
CURVES = TOWS.select(
    "tow_id",
    *(pl.lit(1.0).alias(name) for name in NUMBERS),
    pl.lit("FSN1").alias("fsn_no"),
    pl.lit(8, pl.Int32).alias("rowers"),
    pl.lit("H").alias("crew_class"),
    pl.lit("accepted").alias("status"),
    pl.lit([], pl.List(pl.String)).alias("flags"),
)
NOBODY = pl.DataFrame(schema={"fsn_no": pl.String, "rowers": pl.Int32, "crew_class": pl.String})
ON = dt.date(2015, 1, 1)


def line(*decisions, on=ON, rule=RegisterRule()):  # noqa: B008 - frozen
    table = pl.DataFrame(list(decisions), schema=DECISION_SCHEMA, orient="row")
    return draft_register(CURVES, TOWS, NOBODY, on, rule, table).row(0, named=True)


def test_an_excluded_tow_gives_way_to_the_one_before():
    assert line(("new", "exclude"))["tow_id"] == "middle"


def test_a_preferred_tow_counts_although_newer_ones_exist():
    assert line(("old", "prefer"))["tow_id"] == "old"
    assert line(("old", "prefer"), ("middle", "prefer"))["tow_id"] == "middle"


def test_a_line_of_excluded_tows_alone_says_so():
    found = line(("old", "exclude"), ("middle", "exclude"), ("new", "exclude"))
    assert found["status"] == "excluded"
    assert found["tow_id"] is found["cw_kg_m"] is None


@pytest.mark.parametrize(("season", "year"), [(2014, 2020), (2015, 2019)])
def test_tows_of_the_season_in_the_rule_and_later_count_six_years(season, year):
    rule = RegisterRule(six_years_from=season)
    assert line(rule=rule)["valid_until"] == dt.date(year, 12, 31)


def test_the_rule_stands_in_the_method_and_changes_no_curve():
    text = method_text(shipped_method("rebased"))
    assert "six_years_from = 2023" in text
    other = parse_method(text.replace("valid_years = 5", "valid_years = 4"), "x.toml")
    assert other.validity.valid_years == 4
    assert other.content_hash == shipped_method("rebased").content_hash


def test_an_unknown_key_of_the_rule_is_named():
    text = 'name = "own"\ntitle = "own"\nextends = "rebased"\n[register]\nyears = 2\n'
    with pytest.raises(
        MethodFileError, match=r"own.toml, line 5: 'years': unknown key.*valid_years"
    ):
        parse_method(text, "own.toml")


@pytest.mark.parametrize("name", ["as-published", "corrected-2013", "rebased-2015", "rebased"])
def test_a_method_written_out_reads_back_as_itself(name):
    method = shipped_method(name)
    read = parse_method(method_text(method), "x.toml")
    assert (read.definition, read.validity, read.title, read.title_en, read.description) == (
        method.definition,
        method.validity,
        method.title,
        method.title_en,
        method.description,
    )
