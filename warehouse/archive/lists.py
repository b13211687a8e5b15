"""Reading a list: from the bytes of a spreadsheet or CSV file to typed rows, and what is wrong.

file -> tables of text cells -> columns by their header -> values by the declared types
"""

import datetime as dt
import io
import re
import zipfile
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Final, NamedTuple

import polars as pl

from pipeline.channels import MOST_RUNS, SECOND_FILE_OFFSET
from pipeline.errors import DefectiveInputError
from pipeline.messages import Sentence, say
from pipeline.tables.frames import limits
from warehouse.archive.columns import (
    Column,
    FoundColumn,
    Scale,
    decode,
    find_columns,
    find_header,
    fold,
    fold_word,
    score_of,
    shorten,
    split_line,
    unknown_headers,
)
from warehouse.archive.faults import fault_from
from warehouse.archive.files import TEXT_SUFFIXES, ArchiveFile, outside_archive, read_bytes
from warehouse.archive.kinds import ListKind
from warehouse.archive.profile import Profiles
from warehouse.archive.rows import Rows, declared_column, no_rows

LIST_MAX_BYTES: Final = 20_000_000
MOST_ROWS: Final = 100_000
"""Of a sheet: a reader makes room for all that it reaches to."""
NUMBER: Final = r"^[+-]?([0-9]+([.,][0-9]*)?|[.,][0-9]+)([eE][+-]?[0-9]+)?$"
"""An ordinary number with a decimal comma or point; no marks between thousands."""
_NOTHING: Final = ("", "-", "n.v.t.", "onbekend", "?")
_YES: Final = ("ja", "x", "1")
_NO: Final = ("nee", "0")
_BOAT: Final = r"^(?i:fsn)?[\s._-]*([0-9]{1,6}[a-zA-Z]?)$"
_RUN: Final = r"^[bB]?([1-9][0-9]?)$"
_TIME: Final = r"^([0-9]{1,2}):([0-5]?[0-9]):([0-5]?[0-9])$"
_ISO_DATE: Final = r"^([0-9]{4}-[0-9]{1,2}-[0-9]{1,2})$"
_DUTCH_DATE: Final = r"^([0-9]{1,2}-[0-9]{1,2}-[0-9]{4})$"
_OLD_EXCEL: Final = bytes.fromhex("d0cf11e0a1b11ae1")
"""How a compound file begins: a workbook of Excel 97 to 2003, or a later one with a password."""
_LAST_CELL: Final = re.compile(rb'<dimension ref="[A-Z]+[0-9]+:([A-Z]+)([0-9]+)"')


class Table(NamedTuple):
    """A table of text.

    Attributes:
        header: the cells of its header.
        line: the header's line.
        rows: each with its line, its cells, and whether a quotation mark in it is open.
    """

    header: Sequence[str]
    line: int
    rows: Sequence[tuple[int, Sequence[str], bool]]


def read_lists(files: Iterable[ArchiveFile], kind: ListKind, profiles: Profiles) -> Rows:
    """The rows of all lists of a kind that can be read, and a fault for every other row.

    A list with a column that nobody knows is not read: it can be a misspelt one, and left out in
    silence would change numbers.
    """
    found = Rows(kind, no_rows(kind), listed=no_rows(kind))
    columns = profiles.named(kind.columns)
    for file in files:
        if file.kind != kind:
            continue
        try:
            for table in read_tables(file, columns):
                places = find_columns(table.header, columns, table.line)
                _check_known(table, columns, places, profiles)
                found.add(_typed(table, file, kind, places, profiles.meaning))
        except BaseException as error:
            found.faults.append(fault_from(error, file.path))
            found.unread.add(file.path)
    return found


# From bytes to tables of text


def read_tables(file: ArchiveFile, columns: Sequence[Column]) -> list[Table]:
    """The tables in a file: of a workbook the sheets that name at least half of the columns.

    Raises:
        DefectiveInputError: the file cannot be read.
    """
    if not file.inside:
        raise outside_archive(file.path)
    data = read_bytes(file.full_path, LIST_MAX_BYTES)
    if _is_text(file):
        return [_table_of_text(decode(data), columns)]
    sheets = [_table_of_cells(rows, columns) for rows in _sheets(data) if rows]
    scores = [score_of(sheet.header, columns) for sheet in sheets]
    return [s for s, score in zip(sheets, scores, strict=True) if 2 * score >= max(*scores, 1)]


def _is_text(file: ArchiveFile) -> bool:
    return file.full_path.suffix.lower() in TEXT_SUFFIXES


def _table_of_text(text: str, columns: Sequence[Column]) -> Table:
    """Reads line by line: a quotation mark left open would swallow the rows below."""
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    place, delimiter = find_header(lines, columns)
    header = split_line(lines[place], delimiter)
    rows: list[tuple[int, Sequence[str], bool]] = []
    for number, line in enumerate(lines[place + 1 :], start=place + 2):
        try:
            rows.append((number, split_line(line, delimiter), False))
        except DefectiveInputError:
            rows.append((number, line.split(delimiter), True))
    return Table(header, place + 1, _filled(rows))


def _table_of_cells(rows: Sequence[Sequence[str]], columns: Sequence[Column]) -> Table:
    lines = ["\t".join(" ".join(cell.split()) for cell in row) for row in rows]
    place, _ = find_header(lines, columns)
    below = enumerate(rows[place + 1 :], start=place + 2)
    return Table(rows[place], place + 1, _filled((number, row, False) for number, row in below))


def _filled(
    rows: Iterable[tuple[int, Sequence[str], bool]],
) -> list[tuple[int, Sequence[str], bool]]:
    """The rows that hold something, but for remarks behind a `#`."""
    return [row for row in rows if "".join(row[1]).strip() and not row[1][0].startswith("#")]


def _sheets(data: bytes) -> list[list[list[str]]]:
    """The cells of the sheets of a workbook, as text."""
    import python_calamine  # noqa: PLC0415 - only where there is a spreadsheet

    try:
        _check_last_cells(data)
        book = python_calamine.load_workbook(io.BytesIO(data))
        sheets = [book.get_sheet_by_name(name) for name in book.sheet_names]
        for sheet in sheets:
            _check_height(sheet.total_height)
        grids = [sheet.to_python(skip_empty_area=False) for sheet in sheets]
    except (python_calamine.CalamineError, zipfile.error, zlib.error, OSError, ValueError) as error:
        said = say("The file is not a spreadsheet that can be read: {error}.", error=error)
        raise DefectiveInputError("unreadable_file", said) from error
    return [[[_as_text(cell) for cell in row] for row in grid] for grid in grids]


def _check_last_cells(data: bytes) -> None:
    """Refuse an old workbook, and one that says itself that a sheet reaches too far.

    A reader makes room for every cell above the last one. An .xls file is refused unread: one whose
    sector table points at itself makes a reader ask for gigabytes.
    """
    if data.startswith(_OLD_EXCEL):
        said = say(
            "This is an old Excel workbook (.xls), or one with a password: save it as .xlsx, "
            "without a password."
        )
        raise DefectiveInputError("unreadable_file", said)
    with zipfile.ZipFile(io.BytesIO(data)) as book:
        for name in book.namelist():
            if name.startswith("xl/worksheets/sheet"):
                with book.open(name) as sheet:
                    match = _LAST_CELL.search(sheet.read(2000))
                if match:
                    _check_height(int(match[2]) * (1 if len(match[1]) < 3 else MOST_ROWS))


def _check_height(rows: int) -> None:
    if rows > MOST_ROWS:
        text = say(
            "A sheet of the workbook reaches beyond row {most}. Delete what is far below or beside "
            "the table, or copy it alone into a new workbook."
        )
        raise DefectiveInputError("too_large", say(text, most=MOST_ROWS))


def _as_text(value: object) -> str:
    """A cell of a spreadsheet as it would be in a table of text."""
    if isinstance(value, bool):
        return "ja" if value else "nee"
    if isinstance(value, float):
        return f"{value:.0f}" if value.is_integer() and abs(value) < 1e15 else repr(value)
    return value.date().isoformat() if isinstance(value, dt.datetime) else str(value)


# From a table of text to typed rows


def _check_known(
    table: Table, columns: Iterable[Column], places: Mapping[str, FoundColumn], profiles: Profiles
) -> None:
    """Raises where a column is not known, or one without a name holds something."""
    unknown = [h for h in unknown_headers(table.header, places) if fold(h) not in profiles.ignore]
    for index, header in enumerate(table.header):
        is_filled = any(row[index].strip() for _, row, _ in table.rows if index < len(row))
        if not fold(header) and is_filled:
            unknown.append(f"({index + 1})")
    if unknown:
        text = say(
            "Column {names} is not known. Correct it, name it under [headers] in archief.toml, or "
            "put it there under ignore. Not used yet: {free}."
        )
        names = ", ".join(f"'{shorten(header)}'" for header in unknown)
        free = ", ".join(column.header for column in columns if column.key not in places) or "-"
        said = say(text, names=names, free=free)
        raise DefectiveInputError("unknown_column", said, table.line)


def _typed(
    table: Table,
    file: ArchiveFile,
    kind: ListKind,
    places: Mapping[str, FoundColumn],
    words: Mapping[str, str],
) -> Rows:
    """The values of a table, by the types that its kind of list declares.

    Every cell that is wrong leaves a fault; a row is set aside unless the kind can spare the cell.
    """
    frame = _cells(table, places, words, [column.key for column in kind.columns])
    about = [
        _value(kind, column.key, places) for column in kind.columns if column.key == kind.about
    ]
    rows = Rows(
        kind,
        frame.with_columns(
            path=pl.lit(file.path),
            season=pl.lit(file.season, pl.Int32),
            about=about[0] if about else pl.lit(None, pl.String),
            cells=pl.struct(column.key for column in kind.columns),
        ),
    )
    every, fields, width = rows.frame, pl.col("fields"), len(table.header)
    rows.drop(pl.col("is_open"), say("a quotation mark is not closed, or in mid-field."))
    text = say("the row has {fields} fields where the header has {width}.")
    rows.drop(fields != width, text, fields=fields, width=width)
    mark = _decimal_mark(rows.frame, places) if _is_text(file) else ""
    is_lost, values = _note_empty(rows, kind, places), {}
    for column in kind.columns:
        value = _value(kind, column.key, places)
        for is_wrong, said, code, facts in _checks(kind, column, places, value, mark):
            wrong = is_wrong.fill_null(value=False)
            is_spare = column.key in kind.spare
            rows.note(wrong, said, code, "cell" if is_spare else None, **facts)
            is_lost = is_lost if is_spare else is_lost | wrong
            value = pl.when(~wrong).then(value)
        values[column.key] = value
    schema = no_rows(kind).schema
    rows.frame, rows.listed = (
        frame.with_columns(**values).select(schema.names()).cast(schema)
        for frame in (rows.frame.filter(~is_lost), every)
    )
    return rows


def _cells(
    table: Table, places: Mapping[str, FoundColumn], words: Mapping[str, str], keys: Sequence[str]
) -> pl.DataFrame:
    """What is written in each column, trimmed and in words that are known; null for nothing.

    With the `line` of each row, whether a quotation mark in it `is_open`, and how many `fields` it
    has, blank ones behind the last column aside.
    """

    def meant(cell: str) -> str | None:
        meaning = words.get(fold_word(cell), cell.strip())
        return None if meaning.casefold() in _NOTHING else meaning

    width = len(table.header)
    found: dict[str, list[object]] = {
        "line": [line for line, _, _ in table.rows],
        "is_open": [is_open for _, _, is_open in table.rows],
        "fields": [
            len(row) if any(map(str.strip, row[width:])) else min(len(row), width)
            for _, row, _ in table.rows
        ],
    }
    for key in keys:
        index = places[key].index if key in places else width
        found[key] = [
            meant(row[index]) if index < min(len(row), width) else None for _, row, _ in table.rows
        ]
    schema = {"line": pl.Int64, "is_open": pl.Boolean, "fields": pl.Int64}
    return pl.DataFrame(found, schema | dict.fromkeys(keys, pl.String))


def _decimal_mark(cells: pl.DataFrame, places: Mapping[str, FoundColumn]) -> str:
    """The decimal mark of a list: a comma where any cell is a number with one, else a point."""
    has_comma = cells.select(pl.col(*places).str.contains(r"^[+-]?[0-9]*,[0-9]+$").any())
    return "," if any(has_comma.row(0)) else "."


def _note_empty(rows: Rows, kind: ListKind, places: Mapping[str, FoundColumn]) -> pl.Expr:
    """Says of rows which cells are empty that may not be; returns which rows these are."""
    needed = [
        column.key
        for column in kind.columns
        if column.required
        and ((declared := declared_column(kind, column.key)) is None or not declared.nullable)
    ]
    names = [pl.when(pl.col(key).is_null()).then(pl.lit(places[key].header)) for key in needed]
    empty = pl.concat_str(names, separator="', '", ignore_nulls=True)
    is_empty = pl.any_horizontal(pl.col(needed).is_null())
    rows.note(is_empty, say("column '{column}' is empty."), column=empty)
    return is_empty


Check = tuple[pl.Expr, str, str | None, dict[str, Any]]
"""Which rows are wrong, the sentence, its reason code, and what is filled in."""


def _checks(
    kind: ListKind, column: Column, places: Mapping[str, FoundColumn], value: pl.Expr, mark: str
) -> list[Check]:
    """What can be wrong with the cells of a column."""
    text, declared = pl.col(column.key), declared_column(kind, column.key)
    place = places.get(column.key, FoundColumn(-1, column.header, Scale()))
    named: dict[str, Any] = {"column": place.header, "cell": text}
    if declared is None:
        return []
    is_unread = text.is_not_null() & value.is_null()
    checks: list[Check] = [(is_unread, _not_one(column.key, declared.dtype), None, named)]
    if declared.dtype.is_float() and mark:
        said = say(
            "column '{column}' is {cell}, which can be a thousand or little more than one: other "
            "decimals of this list are behind a '{mark}'."
        )
        is_double = text.str.contains(
            rf"^[+-]?[0-9]{{1,3}}[{',' if mark == '.' else '.'}][0-9]{{3}}$"
        )
        checks.append((is_double, said, "ambiguous_number", named | {"mark": mark}))
    if declared.dtype.is_numeric() and column.key != "run":
        lowest, highest = limits(kind.table, column.key)
        low = -float("inf") if lowest is None else lowest
        high = float("inf") if highest is None else highest
        said = say("column '{column}' is {cell}; {low:g} to {high:g} can be right.")
        of_unit = place.scale.divided_by / place.scale.times
        shown = named | {"low": low * of_unit, "high": high * of_unit}
        checks.append((~value.is_between(low, high), said, None, shown))
    return checks


def _not_one(key: str, dtype: pl.DataType) -> Sentence:
    """What is said of a cell that is not of its column's type."""
    number = say("column '{column}' is '{cell}', which is not an ordinary number.")
    whole = say("column '{column}' is {cell}; it must be a whole number.")
    by_key = {
        "crew_class": say("column '{column}' is '{cell}'; H or D is expected."),
        "run": say("column '{column}' is '{cell}'; runs are 1 to 20, of meetfile2 b1 to b20."),
        "rowing_time_s": say("column '{column}' is '{cell}', not a time such as 2:10:25."),
    }
    by_type = {
        pl.Date: say("column '{column}' is '{cell}', not a date such as 2014-03-01 or 01-03-2014."),
        pl.Boolean: say("column '{column}' is '{cell}', not ja, nee or empty."),
        pl.Int32: whole,
        pl.Int16: whole,
    }
    return by_key.get(key) or by_type.get(dtype.base_type(), number)


# The value of a cell of text, null where it has none


def _value(kind: ListKind, key: str, places: Mapping[str, FoundColumn]) -> pl.Expr:
    """The value of a column, by its name or by the type that its table declares."""
    text, declared = pl.col(key), declared_column(kind, key)
    by_type = {pl.Boolean: _yes_or_no, pl.Date: _date}
    if key in _BY_KEY:
        return _BY_KEY[key](text)
    if declared is None or declared.dtype == pl.String():
        return text
    if declared.dtype.base_type() in by_type:
        return by_type[declared.dtype.base_type()](text)
    return _number(text, places.get(key), declared.dtype.is_integer())


def _boat(text: pl.Expr) -> pl.Expr:
    """`FSN 101`, `fsn101` and `101` are FSN101."""
    return pl.coalesce("FSN" + text.str.extract(_BOAT).str.to_uppercase(), text)


def _tow_id(text: pl.Expr) -> pl.Expr:
    """2014/17 would be a folder in names of pages and files."""
    return text.str.replace_all("/", "-", literal=True)


def _crew_class(text: pl.Expr) -> pl.Expr:
    letter = text.str.to_uppercase()
    return pl.when(letter.is_in(["H", "D"])).then(letter)


def _run(text: pl.Expr) -> pl.Expr:
    """The number of a run: 1 to 20, or 21 to 40 for b1 to b20."""
    number = text.str.extract(_RUN).cast(pl.Int16)
    offset = pl.when(text.str.contains("^[bB]")).then(SECOND_FILE_OFFSET).otherwise(0)
    return pl.when(number <= MOST_RUNS).then(number + offset)


def _rowing_time(text: pl.Expr) -> pl.Expr:
    """Seconds of `2:10:25`."""
    parts = text.str.extract_groups(_TIME).struct
    hours, minutes, seconds = (parts.field(str(n)).cast(pl.Float64) for n in (1, 2, 3))
    total = hours * 3600 + minutes * 60 + seconds
    return pl.when(total > 0).then(total)


def _yes_or_no(text: pl.Expr) -> pl.Expr:
    word = text.fill_null("nee").str.to_lowercase()
    return pl.when(word.is_in([*_YES, *_NO])).then(word.is_in(_YES))


def _date(text: pl.Expr) -> pl.Expr:
    iso = text.str.extract(_ISO_DATE).str.to_date("%Y-%m-%d", strict=False)
    return iso.fill_null(text.str.extract(_DUTCH_DATE).str.to_date("%d-%m-%Y", strict=False))


def _number(text: pl.Expr, place: FoundColumn | None, is_whole: bool) -> pl.Expr:
    """A number in the SI unit of its column."""
    digits = pl.when(text.str.contains(NUMBER)).then(text.str.replace(",", ".", literal=True))
    number = digits.cast(pl.Float64, strict=False)
    number = place.to_si(number) if place else number
    is_good = number.is_finite() & (number == number.round() if is_whole else pl.lit(value=True))
    return pl.when(is_good).then(number)


_BY_KEY: Final[Mapping[str, Callable[[pl.Expr], pl.Expr]]] = {
    "fsn_no": _boat,
    "tow_id": _tow_id,
    "crew_class": _crew_class,
    "run": _run,
    "rowing_time_s": _rowing_time,
}
