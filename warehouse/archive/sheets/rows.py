"""The rows of a list in a frame: those that can be used go on, each other leaves a fault."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Final, NamedTuple

import polars as pl

from pipeline.messages import Sentence, say
from pipeline.tables.declare import dy
from pipeline.tables.frames import limits
from pipeline.tables.row import Row
from warehouse.archive.faults import Fault, at_line, place
from warehouse.archive.spelling.text import shorten

PLACE: Final[dict[str, pl.DataType]] = {
    "path": pl.String(),
    "line": pl.Int64(),
    "sheet": pl.String(),
    "of_tow": pl.String(),
}
"""Where a row is: its list, its line, the sheet where a workbook has several; and the tow that is
lost with it."""
_QUOTED: Final = ("cell", "tow")


class Problem(NamedTuple):
    """What is wrong in a row: in the cell of a column, or without one in the row as a whole."""

    row: int
    key: str
    code: str
    text: str


def cell(key: str) -> pl.Expr:
    """What is written in a column, null for nothing."""
    return pl.col("cells").struct.field(key)


def header(key: str) -> pl.Expr:
    """What the list calls a column."""
    return pl.col("headers").struct.field(key).fill_null(key)


def place_of(line: str, path: str) -> pl.Expr:
    """Another row, for a sentence."""
    return pl.struct(line=line, path=path)


def keep(
    rows: pl.DataFrame, faults: list[Fault], unless: pl.Expr, code: str, text: str, **facts: object
) -> pl.DataFrame:
    """The rows of which something wrong does not hold; each other leaves a fault.

    Args:
        rows: with `PLACE`.
        faults: those of the other rows are added.
        unless: what is wrong; what is not known is not.
        code: its reason code.
        text: the sentence.
        facts: what is filled in: a value, or an expression of the rows.
    """
    is_wrong = unless.fill_null(value=False)
    of_rows = {f"_{name}": fact for name, fact in facts.items() if isinstance(fact, pl.Expr)}
    wrong = rows.filter(is_wrong).select(*PLACE, **of_rows)
    for row in wrong.iter_rows(named=True):
        filled = facts | {name[1:]: _filled(name[1:], row[name]) for name in of_rows}
        faults.append(fault_at(row, code, say(text, **filled)))
    return rows.filter(~is_wrong)


def one_of_each(
    rows: pl.DataFrame,
    faults: list[Fault],
    about: Sequence[str],
    content: Sequence[str],
    code: str,
    text: str,
    **facts: object,
) -> pl.DataFrame:
    """One row about each thing: of equal rows the first counts, of others none.

    Args:
        rows: as in `keep`, as are the others.
        faults: those of the other rows are added.
        about: the columns that say what a row is about.
        content: the columns in which rows can differ.
        code: reason code.
        text: the sentence; `ending` says what becomes of the rows.
        facts: what is filled in.
    """
    same = pl.struct(about)
    is_twice = same.is_duplicated() & pl.all_horizontal(pl.col(about).is_not_null())
    differ = pl.struct(content).n_unique().over(about) > 1
    is_again = is_twice & ~same.is_first_distinct() & ~differ
    rows = rows.with_columns(is_again=is_again, is_in_doubt=is_twice & differ)
    for unless, ending in (
        ("is_again", say("the rows are equal and the first counts.")),
        ("is_in_doubt", say("the rows differ, so neither counts.")),
    ):
        rows = keep(rows, faults, pl.col(unless), code, text, **facts, ending=ending)
    return rows


def _filled(name: str, value: object) -> object:
    if isinstance(value, dict):
        return place(**value)
    return shorten(value) if name in _QUOTED and isinstance(value, str) else value


def fault_at(row: Row, code: str, text: str) -> Fault:
    """The fault of a row with `PLACE`."""
    if row["sheet"]:
        text = say("sheet '{sheet}': {what}", sheet=row["sheet"], what=text)
    return Fault(row["path"], row["of_tow"], row["line"], code, at_line(row["line"], text))


def faults_of(rows: pl.DataFrame, problems: Iterable[Problem]) -> list[Fault]:
    """The faults that problems of these rows are."""
    listed = list(problems)
    numbers = pl.Series([problem.row for problem in listed], dtype=pl.Int64)
    wrong = rows.filter(pl.col("row").is_in(numbers.implode())).select("row", *PLACE)
    places = {row["row"]: row for row in wrong.iter_rows(named=True)}
    return [fault_at(places[p.row], p.code, p.text) for p in listed if p.row in places]


def sound_rows(
    rows: pl.DataFrame,
    problems: Iterable[Problem],
    faults: list[Fault],
    more: list[Fault] | None = None,
) -> pl.DataFrame:
    """The rows without a problem; each other leaves its first as a fault, the rest in `more`."""
    first: dict[int, Problem] = {}
    rest = [p for p in problems if first.setdefault(p.row, p) is not p]
    faults += faults_of(rows, first.values())
    if more is not None:
        more += faults_of(rows, rest)
    return rows.filter(~pl.col("row").is_in(pl.Series(list(first), dtype=pl.Int64).implode()))


def to_table(
    table: type[dy.Schema], rows: pl.DataFrame, faults: list[Fault], code: str
) -> pl.DataFrame:
    """The rows within the declared limits, with the declared columns; each other leaves a fault."""
    frame = table.cast(rows.select(table.column_names()))
    for misfit, why in misfits(table, frame):
        where = misfit["path"], None, misfit["line"]
        faults.append(Fault(*where, code, at_line(misfit["line"], why)))
    return table.filter(frame).result


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


def check_year(rows: pl.DataFrame, faults: list[Fault], key: str, code: str) -> pl.DataFrame:
    """The rows whose day is in the year of their list, where its name tells it."""
    day, season = pl.col(key), pl.col("season")
    text = say("the date {day} is not in {season}, the year of the list.")
    is_other = (season != 0) & (day.dt.year() != season)
    return keep(rows, faults, is_other, code, text, day=day, season=season)
