"""The register of every past year: which line counted then, and what a method changes in it."""

import datetime as dt
import json

import polars as pl
import pytest

from pipeline.method.definition import find_method_in_force
from pipeline.method.reading import read_shipped_method
from pipeline.register.register import CURVE_COLUMNS, LINE
from pipeline.register.years import find_steps_between, make_registers_of_years, register_years

METHODS = [read_shipped_method(name) for name in ("as-published", "as-published-2014", "rebased")]
NUMBERS = ("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m")


def row(method, tow, position, a):
    """A line of one boat, towed early in the year that its tow is called after."""
    year = int(tow)
    numbers = dict(zip(NUMBERS, (2.5, a, 5.0, a / 0.75, None, None), strict=True))
    line = dict(zip(LINE, ("FSN1", 8, "H", ""), strict=True))
    days = {"tow_date": dt.date(year, 3, 1), "valid_until": dt.date(year + 5, 12, 31)}
    name = {"edition": f"concept-{method}", "method": method, "tow_id": tow}
    return name | line | days | numbers | {"position": position, "flags": [], "basis": "measured"}


HISTORY = pl.DataFrame(
    [
        *(row("as-published", tow, n, 40.0) for n, tow in ((1, "2010"), (2, "2014"))),
        *(row("as-published-2014", tow, n, 40.0) for n, tow in ((1, "2010"), (2, "2014"))),
        row("rebased", "2010", 1, 36.0),
        row("rebased", "2014", 2, 40.0),
    ],
    schema_overrides=dict.fromkeys(NUMBERS, pl.Float64)
    | {"rowers": pl.Int32, "position": pl.Int32, "flags": pl.List(pl.String)},
)
STEPS = pl.DataFrame(
    [
        ("as-published-2014", "as-published", "2010", 1, "speed", 1.0),
        ("as-published-2014", "as-published", "2014", 3, "window", 0.98),
        ("as-published", "rebased", "2010", 1, "speed", 0.9),
        ("as-published", "rebased", "2014", 3, "window", 1 / 0.98),
    ],
    schema=["from_method", "to_method", "tow_id", "position", "step", "factor"],
    orient="row",
)


def test_on_every_last_day_the_newest_tow_counts_until_it_expires():
    found = make_registers_of_years(HISTORY, METHODS, [2009, 2010, 2013, 2014, 2019, 2020])
    own = found.filter(method="rebased").select("year", "tow_id").rows()
    assert own == [(2010, "2010"), (2013, "2010"), (2014, "2014"), (2019, "2014")]
    assert set(found.columns) == {"year", "edition", "method", *LINE, *CURVE_COLUMNS}


def test_an_error_of_old_tows_shows_in_the_years_in_which_they_counted():
    years = register_years(HISTORY, STEPS, METHODS, [2010, 2013, 2014])
    lines = years.filter(method="rebased")
    assert lines["published_method"].unique().to_list() == ["as-published-2014"]
    assert lines["cw_ratio"].to_list() == pytest.approx([0.9, 0.9, 1.0])
    assert lines["change"].to_list() == ["changed", "changed", "same"]
    (cause,) = json.loads(lines["causes"][0])
    assert cause == {"cause": "method", "step": "speed", "factor": 0.9}
    assert set(years.filter(method="as-published-2014")["change"]) == {"same"}


def test_the_register_of_2014_is_that_of_before_the_recomputation():
    found = [find_method_in_force(season, METHODS).name for season in (2013, 2014, 2015)]
    assert found == ["as-published-2014", "as-published-2014", "as-published"]
    of_2014 = find_steps_between(STEPS, "as-published-2014", "rebased", by_way_of="as-published")
    own = of_2014.filter(tow_id="2014")
    assert own.select("step", "factor").rows() == [("window", pytest.approx(1.0))]
    of_2015 = find_steps_between(STEPS, "as-published", "rebased", by_way_of="as-published")
    assert of_2015.filter(tow_id="2014")["factor"].item() == pytest.approx(1 / 0.98)


def test_without_a_method_that_says_so_the_first_counts_as_published():
    corrected, rebased = read_shipped_method("corrected-2013"), read_shipped_method("rebased")
    history = HISTORY.with_columns(
        pl.col("method", "edition").str.replace("as-published$", "corrected-2013")
    )
    lines = register_years(history, STEPS, [corrected, rebased], [2010])
    assert lines["published_method"].unique().to_list() == ["corrected-2013"]
