"""Rows that a declared table does not allow, each with a sentence that says why."""

from collections.abc import Iterator

import polars as pl

from pipeline.messages import Sentence, say
from pipeline.tables.declare import dy
from pipeline.tables.frames import limits
from pipeline.tables.row import Row


def misfits(table: type[dy.Schema], frame: pl.DataFrame) -> Iterator[tuple[Row, Sentence]]:
    """Each row outside the declared limits, with the first limit that it breaks."""
    _, failure = table.filter(frame)
    for row in failure.details().iter_rows(named=True):
        broken = next(name for name, state in row.items() if state == "invalid")
        yield row, _why(table, row, *broken.split("|"))


def _why(table: type[dy.Schema], row: Row, column: str, rule: str) -> Sentence:
    named = {"column": column, "cell": row[column]}
    if rule not in {"min", "max"}:
        return say("column '{column}' is '{cell}', which cannot be right.", **named)
    low, high = limits(table, column)
    message = say("column '{column}' is {cell}; {low:g} to {high:g} can be right.")
    if column == "season":  # of the file's name, or of a date: no list has such a column
        message = say("the year is {cell}; {low:g} to {high:g} can be right.")
    return say(message, **named, low=low, high=high)
