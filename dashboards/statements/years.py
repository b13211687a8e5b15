"""What a method would have made of the register of a past year, in one sentence."""

import polars as pl

from dashboards import labels
from dashboards.statements import Change, Statement, told
from pipeline.messages import say


def most_changed_year(summary: pl.DataFrame) -> int:
    """Return the year whose register a method changes most; 0 where there is none.

    Args:
        summary: rows of `warehouse.queries.years.summarise_years`, of one method.
    """
    by_change = summary.drop_nulls("median_ratio").sort(
        pl.col("median_ratio").log().abs(), "year", descending=[True, False]
    )
    return int(by_change["year"][0]) if by_change.height else 0


def register_then(summary: pl.DataFrame, year: int) -> Statement:
    """Say how far the register of a year was from that of a method.

    Args:
        summary: as for `most_changed_year`.
        year: the year.
    """
    of_year = summary.filter(year=year)
    if of_year.is_empty():
        return told("register_then", say("There is no register of a past year."))
    row = of_year.row(0, named=True)
    wording = say(
        "At the end of {year} the published Cw differed {by} from that of \u201c{method}\u201d "
        "(median of {lines} lines), of {beyond} lines by more than the uncertainty of both."
    )
    return told(
        "register_then",
        wording,
        {},
        "register_years",
        year=str(year),
        by=Change(1.0 / row["median_ratio"]),
        method=labels.method(row["method"]),
        lines=row["lines"],
        beyond=row["exceeds_interval"],
    )
