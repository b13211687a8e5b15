"""The register of every past year: as it was published, and as a method would have had it.

Newer tows supersede older ones, so the register of today says nothing about the errors of earlier
seasons. Here the lines that counted at the end of each season are compared, by the same rule of
validity on both sides: the difference is what the method of that time did to the races of that
time.
"""

import datetime as dt
from collections.abc import Sequence
from typing import Final

import polars as pl

from pipeline.register.changes import compare_lines, steps_of_lines
from pipeline.register.register import CURVE_COLUMNS, LINE, draft_name, lines_on_days
from pipeline.register.replay import RaceRules, replay, winner_changes

FIRST_PUBLISHED: Final = "as-published-2014"
PUBLISHED: Final = "as-published"
RECOMPUTED_IN: Final = 2015
"""The tows of 2014 were recomputed early in 2015: registers before that have them as they first
came out (presentation R. Pot, 24 January 2015)."""


def method_in_force(year: int) -> str:
    """Return the name of the method by which the register of a year was published."""
    return FIRST_PUBLISHED if year < RECOMPUTED_IN else PUBLISHED


def registers_of_years(history: pl.DataFrame, years: Sequence[int]) -> pl.DataFrame:
    """Return the valid lines of every method at the end of each season.

    Args:
        history: rows of the table `register_history`, of drafts.
        years: the seasons.

    Returns:
        `year`, `edition`, `method`, `LINE` and `CURVE_COLUMNS`.
    """
    key = ("edition", "method", *LINE)
    days = [dt.date(year, 12, 31) for year in years]
    lines = lines_on_days(history.sort(*key, "position"), days, key).filter(status="valid")
    year = pl.col("as_of").dt.year().alias("year")
    return lines.select(year, *key, *CURVE_COLUMNS).sort("year", *key)


def steps_from_print(correction_steps: pl.DataFrame, year: int, method: str) -> pl.DataFrame:
    """Return the steps from the method in force in a year to another, one row per tow and step.

    Args:
        correction_steps: the table of that name, of all methods.
        year: the season of the register.
        method: the method that the steps lead to.
    """
    legs = correction_steps.filter(from_method=PUBLISHED, to_method=method)
    if method_in_force(year) == FIRST_PUBLISHED:
        first_leg = correction_steps.filter(from_method=FIRST_PUBLISHED, to_method=PUBLISHED)
        legs = pl.concat([first_leg, legs])
    return (
        legs.filter(pl.col("position") > 0)
        .group_by("tow_id", "position", "step", maintain_order=True)
        .agg(pl.col("factor").product())
    )


def compare_years(
    registers: pl.DataFrame, correction_steps: pl.DataFrame, method: str
) -> pl.DataFrame:
    """Compare the register of every year as published with that of a method, line by line.

    Args:
        registers: rows of `registers_of_years`.
        correction_steps: the table of that name.
        method: name of the method.

    Returns:
        The columns of `pipeline.register.changes.compare_lines`, with `year`.
    """
    known = set(registers["method"])
    compared = []
    for year in registers["year"].unique().sort():
        published = method_in_force(year)
        if published not in known:
            published = PUBLISHED
        old = registers.filter(year=year, method=published)
        new = registers.filter(year=year, method=method)
        parts = steps_of_lines(old, steps_from_print(correction_steps, year, method))
        lines = compare_lines(old, new, parts)
        compared.append(lines.select(pl.lit(year, pl.Int32).alias("year"), pl.all()))
    return pl.concat(compared)


def winners_of_years(
    history: pl.DataFrame, results: pl.DataFrame, members: pl.DataFrame, method: str
) -> pl.DataFrame:
    """Return who won every race by the register of its time, and who would have by a method.

    Args:
        history: rows of the table `register_history`, of drafts.
        results: rows of `listed_races`.
        members: the ensemble of the method; may be empty.
        method: name of the method.

    Returns:
        The columns of `pipeline.register.replay.winner_changes`, with `year`.
    """
    known = set(history["method"])
    after = history.filter(edition=draft_name(method))
    winners = []
    for (year,), of_year in results.group_by(pl.col("race_date").dt.year(), maintain_order=True):
        published = method_in_force(int(str(year)))
        before = history.filter(method=published if published in known else PUBLISHED)
        replayed = [replay(lines, of_year, RaceRules()) for lines in (before, after)]
        changes = winner_changes(replayed[0], replayed[1], members)
        winners.append(changes.select(pl.lit(year, pl.Int32).alias("year"), pl.all()))
    return pl.concat(winners) if winners else pl.DataFrame()
