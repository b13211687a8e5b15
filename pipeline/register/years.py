"""The register of every past year: as it was published, and as each method would have had it.

Newer tows supersede older ones, so the register of today says nothing about the errors of earlier
seasons. Here the lines that counted at the end of each season are compared, by the same rule of
validity on both sides: the difference is what the method of that time did to the races of that
time.
"""

import datetime as dt
from collections.abc import Sequence

import polars as pl

from pipeline.crews import STANDARD_CREWS
from pipeline.method.definition import Method, find_method_in_force
from pipeline.register.causes import assign_steps
from pipeline.register.changes import compare_lines
from pipeline.register.register import CURVE_COLUMNS, LINE, list_lines_on_days, name_draft
from pipeline.register.replay import RaceRules, compare_winners, replay
from pipeline.tables.register import RegisterYears, YearWinners

KEY = ("edition", "method") + LINE


def register_years(
    history: pl.DataFrame,
    correction_steps: pl.DataFrame,
    methods: Sequence[Method],
    seasons: Sequence[int],
) -> pl.DataFrame:
    """Compare the register at the end of each season as published with that of each method.

    Args:
        history: rows of the table `register_history`.
        correction_steps: the table of that name.
        methods: the methods that were applied; the steps of the others begin at the first.
        seasons: the seasons.

    Returns:
        Rows of the table `register_years`: of each season and method the valid lines, beside those
        of the method by which that season's register was published.
    """
    registers = make_registers_of_years(history, methods, seasons)
    own_facts = registers.select("year", "method", pl.col(LINE), "tow_date", "valid_until", "basis")
    compared: list[pl.DataFrame] = [RegisterYears.create_empty()]
    for season in seasons:
        published = published_method(season, methods)
        before = registers.filter(year=season, method=published.name)
        for method in methods:
            after = registers.filter(year=season, method=method.name)
            if before.is_empty() and after.is_empty():
                continue
            steps = find_steps_between(
                correction_steps, published.name, method.name, by_way_of=methods[0].name
            )
            lines = compare_lines(before, after, assign_steps(before, steps))
            named = lines.with_columns(
                year=pl.lit(season, pl.Int32),
                method=pl.lit(method.name),
                published_method=pl.lit(published.name),
            ).join(own_facts, on=("year", "method") + LINE, how="left", maintain_order="left")
            renamed = named.rename(_published_and_own)
            compared.append(renamed.select(RegisterYears.column_names()))
    return pl.concat(compared)


def make_registers_of_years(
    history: pl.DataFrame, methods: Sequence[Method], seasons: Sequence[int]
) -> pl.DataFrame:
    """Return the valid lines of the draft of every method at the end of each season.

    Args:
        history: rows of the table `register_history`.
        methods: the methods.
        seasons: the seasons.

    Returns:
        `year`, `edition`, `method`, `LINE` and `CURVE_COLUMNS`.
    """
    drafts = [name_draft(method.name) for method in methods]
    lines = history.filter(pl.col("edition").is_in(drafts)).sort(pl.col(KEY), "position")
    days = [dt.date(season, 12, 31) for season in seasons]
    valid = list_lines_on_days(lines, days, KEY).filter(status="valid")
    year = pl.col("as_of").dt.year().alias("year")
    return valid.select(year, pl.col(KEY), pl.col(CURVE_COLUMNS)).sort("year", pl.col(KEY))


def published_method(season: int, methods: Sequence[Method]) -> Method:
    """Return the method by which a season's register was published; the first if none says so."""
    return find_method_in_force(season, methods) or methods[0]


def find_steps_between(
    correction_steps: pl.DataFrame, start: str, end: str, by_way_of: str
) -> pl.DataFrame:
    """Return the steps from one method to another, by way of the first method of the rebuild.

    Args:
        correction_steps: the table of that name.
        start, end: names of methods.
        by_way_of: name of the method from which, or to which, the table has steps.

    Returns:
        `tow_id`, `position`, `step` and `factor`: the factors of both legs multiplied.
    """
    legs = [(start, by_way_of), (by_way_of, end)]
    steps = [correction_steps.filter(from_method=one, to_method=other) for one, other in legs]
    return (
        pl.concat(steps)
        .filter(pl.col("position") > 0)
        .group_by("tow_id", "position", "step", maintain_order=True)
        .agg(pl.col("factor").product())
    )


def year_winners(
    history: pl.DataFrame,
    results: pl.DataFrame,
    members: pl.DataFrame,
    methods: Sequence[Method],
    crew_classes: pl.DataFrame = STANDARD_CREWS,
) -> pl.DataFrame:
    """Return who won every race by the register of its time, and who would have by each method.

    Args:
        history: rows of the table `register_history`.
        results: rows of `listed_races`.
        members: rows of the table `ensemble`.
        methods: the methods that were applied.
        crew_classes: the table of that name.

    Returns:
        Rows of the table `year_winners`.
    """
    year = pl.col("race_date").dt.year()
    seasons = results["race_date"].dt.year().unique().sort().to_list()
    replayed = {}
    for method in methods:
        lines = history.filter(edition=name_draft(method.name))
        replayed[method.name] = replay(lines, results, RaceRules(), crew_classes)
    published = {season: published_method(season, methods).name for season in seasons}
    found: list[pl.DataFrame] = [YearWinners.create_empty()]
    if seasons:
        before = pl.concat(
            [replayed[name].filter(year == season) for season, name in published.items()]
        )
        for method in methods:
            own_members = members.filter(method=method.name)
            changes = compare_winners(before, replayed[method.name], own_members)
            named = changes.rename(_published_and_own, strict=False).with_columns(
                year=year,
                method=pl.lit(method.name),
                published_method=year.replace_strict(published, return_dtype=pl.String),
            )
            found.append(named.select(YearWinners.column_names()))
    return pl.concat(found)


def _published_and_own(name: str) -> str:
    """Return the name of a column in the tables of years."""
    return name.replace("old_", "published_", 1).removeprefix("new_")
