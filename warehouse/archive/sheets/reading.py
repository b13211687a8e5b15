"""Reading a list: a small table with one header, and the values in its rows."""

import re
import unicodedata
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import polars as pl

from pipeline.errors import DefectiveInputError
from pipeline.messages import Sentence, say
from pipeline.tables.declare import dy
from pipeline.tables.frames import frame_of, limits
from pipeline.tables.row import Row
from warehouse.archive.faults import Fault, at_line, fault_from
from warehouse.archive.files.contents import read_bytes
from warehouse.archive.files.finding import list_files, path_inside
from warehouse.archive.files.list_kinds import ListKind
from warehouse.archive.files.names import split_sheet
from warehouse.archive.limits import LIST_MAX_BYTES
from warehouse.archive.sheets.row import ListRow, Reading
from warehouse.archive.sheets.sheet import Sheet, read_sheets
from warehouse.archive.spelling.columns import (
    Column,
    FoundColumn,
    find_columns,
    nearest_columns,
    unknown_headers,
)
from warehouse.archive.spelling.dates import date_order
from warehouse.archive.spelling.numbers import decimal_mark
from warehouse.archive.spelling.synonyms import CLASSES, NOTHING
from warehouse.archive.spelling.text import fold, fold_word, shorten
from warehouse.archive.spelling.wording import Wording

CREW: Final = ("rowers", "crew_class")
_CREW: Final = re.compile(r"([0-9]{1,2})\s*([^\W\d_]+)")
"""Rowers and class in one cell: `8H`."""


def read_list(root: Path, kind: ListKind, path: str, wording: Wording) -> list[ListRow]:
    """The rows of a list of the archive; empty ones are left out.

    Args:
        root: folder of the archive.
        kind: which list.
        path: the list, relative to the archive.
        wording: how the lists of this archive are worded.

    Raises:
        DefectiveInputError: the list as a whole cannot be read, or has a column that nobody knows:
            it can be a misspelt one, and left out in silence would change numbers.
    """
    file, sheet = split_sheet(path)
    data = read_bytes(path_inside(root, file), LIST_MAX_BYTES)
    wanted = wording.with_names(kind.columns)
    suffix = file[file.rfind(".") :].casefold()
    sheets = read_sheets(data, wanted, suffix, sheet, wording.header_lines.get(path))
    cells = [cell.strip() for sheet in sheets for row in sheet.rows for cell in row.fields]
    order = wording.dates.get(path, wording.dates.get("*", "")) or date_order(cells)
    told = wording.decimals.get(path, wording.decimals.get("*", ""))
    return [
        row
        for sheet in sheets
        for row in _rows(
            sheet,
            Reading(
                _columns_of(sheet, wanted, wording),
                kind.reason_code,
                wording.words,
                order,
                told or decimal_mark(cells),
                kind.table,
                sheet.name,
                bool(told),
            ),
        )
    ]


def read_lists(
    root: Path,
    kind: ListKind,
    wording: Wording,
    read_row: Callable[[ListRow, int], Row],
) -> tuple[pl.DataFrame, tuple[Fault, ...]]:
    """Reads the lists of a kind: rows of its table, and a fault for each that cannot be read.

    Args:
        root: folder of the archive.
        kind: which lists; its table has `path` and `line` too.
        wording: how the lists are worded.
        read_row: from a row and the year in the file's name to the other values.
    """
    good: list[Row] = []
    faults: list[Fault] = []
    for file in list_files(root, kind, wording.files):
        try:
            rows = read_list(root, kind, file.path, wording)
        except BaseException as error:
            faults.append(fault_from(error, file.path))
            continue
        for row in rows:
            try:
                row.check_whole()
                values = read_row(row, file.season)
            except BaseException as error:
                faults.append(fault_from(error, file.path))
            else:
                good.append({**values, "path": file.path, "line": row.line})
    frame = frame_of(kind.table, good)
    for misfit, why in misfits(kind.table, frame):
        place, said = (misfit["path"], None, misfit["line"]), at_line(misfit["line"], why)
        faults.append(Fault(*place, kind.reason_code, said))
    return kind.table.filter(frame).result, tuple(faults)


def _columns_of(sheet: Sheet, wanted: Sequence[Column], wording: Wording) -> dict[str, FoundColumn]:
    """The columns of a list; one that nobody knows is a fault."""
    optional = [replace(column, required=False) for column in wanted]
    places = find_columns(sheet.header, optional, sheet.line)
    strange = [h for h in unknown_headers(sheet.header, places) if fold(h) not in wording.ignore]
    _check_named(sheet, {column.index for column in places.values()})
    if strange:
        free = [column for column in wanted if column.key not in places]
        raise DefectiveInputError("unknown_column", _about_unknown(strange, free), sheet.line)
    serving = {c.key: places[c.or_else] for c in wanted if c.or_else in places}
    of_both = [places[k] for k in CREW if k in places and _has_crews(sheet, places[k].index)]
    serving |= dict.fromkeys(CREW, of_both[0]) if of_both else {}
    wanted = [replace(c, required=c.required and c.key not in serving) for c in wanted]
    return serving | find_columns(sheet.header, wanted, sheet.line)


def _has_crews(sheet: Sheet, place: int) -> bool:
    cells = (row.fields[place] for row in sheet.rows if place < len(row.fields))
    return any(_crew_in(cell) for cell in cells)


def _crew_in(cell: str) -> tuple[str, str] | None:
    """Rowers and class of `8H`; None of another cell."""
    match = _CREW.fullmatch(cell.strip())
    return (match[1], match[2]) if match and fold_word(match[2]) in CLASSES else None


def _rows(sheet: Sheet, reading: Reading) -> list[ListRow]:
    return [
        ListRow(row.line, _cells(row.fields, reading), reading, row.problem) for row in sheet.rows
    ]


def _cells(fields: Sequence[str], reading: Reading) -> dict[str, str]:
    cells = {
        key: _meant(fields[column.index].strip(), reading.words)
        for key, column in reading.columns.items()
        if column.index < len(fields)
    }
    if "tow_id" in cells:  # 2014/17 would be a folder in names of pages and files
        cells["tow_id"] = cells["tow_id"].replace("/", "-")
    return cells | _crew_apart(cells)


def _crew_apart(cells: Mapping[str, str]) -> dict[str, str]:
    """Rowers and class of a cell with both, where the class is empty or the same."""
    rowers, crew_class = (cells.get(key, "") for key in CREW)
    crew = _crew_in(rowers)
    if crew is None:
        return {}
    said = CLASSES.get(fold_word(crew_class))
    is_its_own = crew_class in {"", rowers} or said == CLASSES[fold_word(crew[1])]
    return dict(zip(CREW, crew, strict=True)) if is_its_own else {}


def _meant(cell: str, words: Mapping[str, str]) -> str:
    """What a cell stands for: the archive's own words first, then nothing for `n.v.t.`."""
    folded = fold_word(cell)
    if folded in words:
        return words[folded]
    return "" if folded in NOTHING else unicodedata.normalize("NFC", cell)


def _check_named(sheet: Sheet, known: Collection[int]) -> None:
    """Raises where a column without a name holds something: its header may have been lost."""
    for place, header in enumerate(sheet.header):
        if place in known or fold(header):
            continue
        cells = (row.fields[place].strip() for row in sheet.rows if place < len(row.fields))
        content = next((cell for cell in cells if cell and fold_word(cell) not in NOTHING), None)
        if content is not None:
            said = say(
                "Column {number} has no name and holds '{cell}'. Give it its name; one that is not "
                "needed can be put under ignore in archief.toml.",
                number=place + 1,
                cell=shorten(content),
            )
            raise DefectiveInputError("unknown_column", said, sheet.line)


def _about_unknown(unknown: Iterable[str], free: Sequence[Column]) -> str:
    """The sentence about columns that nobody knows.

    Args:
        unknown: their headers.
        free: the columns that no header has; of each, those with the nearest names are offered.
    """
    near = {header: [c.header for c in nearest_columns(header, free, 0.7)] for header in unknown}
    return say(
        "Column {names} is not known. Correct it, name it under [headers] in archief.toml, or put "
        "it there under ignore.",
        names=", ".join(
            f"'{shorten(header)}'" + (f" ({', '.join(names)}?)" if names else "")
            for header, names in near.items()
        ),
        near=tuple((header, tuple(names)) for header, names in near.items()),
        lacking=tuple(c.header for c in sorted(free, key=lambda c: not c.required)),
    )


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
