"""The register of every past year: which line counted then, and what a method changes in it."""

import datetime as dt
import json

import polars as pl
import pytest

from pipeline.register.register import CURVE_COLUMNS, LINE
from pipeline.register.years import (
    compare_years,
    method_in_force,
    registers_of_years,
    steps_from_print,
)

NUMBERS = ("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m")


def row(method, tow, position, a):
    """A line of one boat, towed early in the year that its tow is called after."""
    year = int(tow)
    numbers = dict(zip(NUMBERS, (2.5, a, 5.0, a / 0.75, None, None), strict=True))
    line = dict(zip(LINE, ("FSN1", 8, "H", ""), strict=True))
    days = {"tow_date": dt.date(year, 3, 1), "valid_until": dt.date(year + 5, 12, 31)}
    name = {"edition": f"concept-{method}", "method": method, "tow_id": tow}
    return name | line | days | numbers | {"position": position, "flags": []}


HISTORY = pl.DataFrame(
    [
        *(row("as-published", tow, n, 40.0) for n, tow in ((1, "2010"), (2, "2014"))),
        *(row("as-published-2014", tow, n, 40.0) for n, tow in ((1, "2010"), (2, "2014"))),
        row("rebased", "2010", 1, 36.0),
        row("rebased", "2014", 2, 40.0),
    ],
    schema_overrides=dict.fromkeys(NUMBERS, pl.Float64),
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
    found = registers_of_years(HISTORY, [2009, 2010, 2013, 2014, 2019, 2020])
    own = found.filter(method="rebased").select("year", "tow_id").rows()
    assert own == [(2010, "2010"), (2013, "2010"), (2014, "2014"), (2019, "2014")]
    assert set(found.columns) == {"year", "edition", "method", *LINE, *CURVE_COLUMNS}


def test_an_error_of_old_tows_shows_in_the_years_in_which_they_counted():
    lines = compare_years(registers_of_years(HISTORY, [2010, 2013, 2014]), STEPS, "rebased")
    assert lines["cw_ratio"].to_list() == pytest.approx([0.9, 0.9, 1.0])
    assert lines["change"].to_list() == ["changed", "changed", "same"]
    (cause,) = json.loads(lines["causes"][0])
    assert cause == {"cause": "method", "step": "speed", "factor": 0.9}


def test_the_register_of_2014_is_that_of_before_the_recomputation():
    assert [method_in_force(year) for year in (2013, 2014, 2015)] == [
        "as-published-2014", "as-published-2014", "as-published",
    ]  # fmt: skip
    of_2014 = steps_from_print(STEPS, 2014, "rebased").filter(tow_id="2014")
    assert of_2014.select("step", "factor").rows() == [("window", pytest.approx(1.0))]
    of_2015 = steps_from_print(STEPS, 2015, "rebased").filter(tow_id="2014")
    assert of_2015["factor"].item() == pytest.approx(1 / 0.98)
