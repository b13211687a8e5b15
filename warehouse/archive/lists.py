"""Reading a list: from the bytes of a spreadsheet or CSV file to typed rows, and what is wrong.

file -> tables of text cells -> columns by their header -> values by the declared types
"""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
import polars as pl

from pipeline.arrays import BoolArray
from pipeline.channels import MOST_RUNS, SECOND_FILE_OFFSET
from pipeline.errors import DefectiveInputError
from pipeline.messages import Sentence, say
from pipeline.tables.frames import limits
from warehouse.archive.columns import (
    Column,
    DefectiveHeaderError,
    FoundColumn,
    Scale,
    count_names,
    decode,
    find_columns,
    find_header,
    fold,
    fold_names,
    fold_word,
    list_unknown_headers,
    quote_names,
    shorten,
    split_header,
    split_line,
    split_lines,
)
from warehouse.archive.faults import Fault, make_fault, say_at_line
from warehouse.archive.files import (
    REFUSED_SUFFIXES,
    TEXT_SUFFIXES,
    ArchiveFile,
    make_outside_archive_error,
    read_bytes,
)
from warehouse.archive.kinds import REMARK, ListKind
from warehouse.archive.profile import Profiles
from warehouse.archive.rows import Rows, find_declared_column, make_empty_rows
from warehouse.archive.workbooks import MERGED, TYPED_AS_TEXT, Sheet, read_workbook

LIST_MAX_BYTES: Final = 20_000_000
MAX_CELL_CHARACTERS: Final = 1_000
"""A longer cell is a fault before any pattern is tried on it."""
MAX_QUOTED_LINE: Final = 100_000
"""Characters of a line of which quotation marks are understood."""
NUMBER: Final = r"^[+-]?([0-9]+([.,][0-9]*)?|[.,][0-9]+)([eE][+-]?[0-9]+)?$"
"""An ordinary number with a decimal comma or point; no marks between thousands."""
_NOTHING: Final = ("", "-", "n.v.t.", "onbekend", "?")
DID_NOT_FINISH: Final = "uitgevallen"
"""Instead of a rowing time: no result, and no fault."""
_YES: Final = ("ja", "x", "1")
_NO: Final = ("nee", "0")
_BOAT: Final = r"^(?i:{})?[\s._-]*([0-9]{{1,6}}[a-zA-Z]?)$"
_RUN: Final = r"^[bB]?([1-9][0-9]?)$"
_RUN_RANGE: Final = re.compile(r"(b?)([0-9]{1,2})-b?([0-9]{1,2})")
_TIME: Final = r"^([0-9]{1,2}):([0-5]?[0-9]):([0-5]?[0-9])$"
_ISO_DATE: Final = r"^([0-9]{4}-[0-9]{1,2}-[0-9]{1,2})([T ][0-9]{1,2}:[0-9]{2}(:[0-9]{2})?)?$"
_DUTCH_DATE: Final = r"^([0-9]{1,2}-[0-9]{1,2}-[0-9]{4})( [0-9]{1,2}:[0-9]{2}(:[0-9]{2})?)?$"
"""A time behind a date, as programs export it, is not read."""
_SPREADSHEET_ERROR: Final = r"^#(N/[AB]|[A-Z]+(/0)?[!?])$"
"""As #N/A or #REF!, and as Dutch spreadsheets say it: #N/B, #VERW!"""
_FORMULA: Final = r"^="
_VALUE: Final = "{} value"
"""Name of the column with the values of a column of text, while a list is read."""


class Table(NamedTuple):
    """A table of text.

    Attributes:
        header: the cells of its header.
        line: the header's line.
        rows: each with its line, its cells, and whether a quotation mark in it is open.
        sheet: the sheet's name, where a workbook has several; else empty.
        hidden_columns: the places of columns that a person does not see, from 0.
    """

    header: Sequence[str]
    line: int
    rows: Sequence[tuple[int, Sequence[str], bool]]
    sheet: str = ""
    hidden_columns: frozenset[int] = frozenset()


def read_lists(files: Iterable[ArchiveFile], kind: ListKind, profiles: Profiles) -> Rows:
    """Read all lists of a kind; every row that cannot be used leaves a fault.

    A list with a column that nobody knows is not read: it can be a misspelt one, and left out in
    silence would change numbers. A list that cannot be read costs no other.
    """
    found = Rows(kind, make_empty_rows(kind), listed=make_empty_rows(kind))
    columns = profiles.rename_columns(kind.columns)
    for file in files:
        if file.kind != kind:
            continue
        try:
            tables, notes = read_tables(file, columns)
        except BaseException as error:
            tables, notes = [], [make_fault(error, file.path)]
            found.unread.add(file.path)
        found.faults += notes
        for table in tables:
            try:
                header = [profiles.whole_headers.get(fold(cell), cell) for cell in table.header]
                renamed = table._replace(header=header)
                places = _find_places(renamed, columns, profiles)
                _check_columns(renamed, columns, places, profiles)
                found.add(_parse_rows(renamed, file, kind, places, profiles))
            except BaseException as error:
                found.faults.append(make_fault(error, file.path))
                found.unread.add(file.path)
    return found


# From bytes to tables of text


def read_tables(file: ArchiveFile, columns: Sequence[Column]) -> tuple[list[Table], list[Fault]]:
    """Return the tables in a file, and what of it is not read.

    Of a workbook these are the visible sheets that name at least half as many columns as the best.

    Raises:
        DefectiveInputError: the file cannot be read.
    """
    if not file.inside:
        raise make_outside_archive_error(file.path)
    if file.full_path.suffix.lower() in REFUSED_SUFFIXES:
        text = say(
            "A {suffix} file, such as an old Excel workbook, is not read: save it as .xlsx "
            "or as CSV."
        )
        raise DefectiveInputError("unreadable_file", say(text, suffix=file.full_path.suffix))
    data = read_bytes(file.full_path, LIST_MAX_BYTES)
    if _is_text(file):
        return [_read_text_table(decode(data), columns)], []
    return _split_workbook(file.path, data, columns)


def _split_workbook(
    path: str, data: bytes, columns: Sequence[Column]
) -> tuple[list[Table], list[Fault]]:
    book = read_workbook(data)
    filled = [sheet for sheet in book.sheets if sheet.rows]
    if not filled:
        said = say("No visible sheet of the workbook holds anything.")
        raise DefectiveInputError("unreadable_file", said)
    tables = [_read_sheet_table(sheet, columns) for sheet in filled]
    scores = [count_names(table.header, columns) for table in tables]
    enough = max(scores) / 2
    kept = [table for table, score in zip(tables, scores, strict=True) if score >= enough]
    if max(scores) == 0:
        kept = kept[:1]
    named = {table.sheet for table in kept}
    notes = []
    for table, score in zip(tables, scores, strict=True):
        if 1 < score < enough:
            text = say("sheet '{sheet}' is not read: its header is not that of this list.")
            notes.append(_unread_fault(path, table.line, say(text, sheet=table.sheet)))
    for sheet in book.hidden:
        if sheet.rows and count_names(_read_sheet_table(sheet, columns).header, columns) >= enough:
            text = say("sheet '{sheet}' is hidden, and is not read. Show it, or remove it.")
            notes.append(_unread_fault(path, 1, say(text, sheet=sheet.name)))
    for sheet in filled:
        if sheet.name in named and sheet.hidden_lines:
            text = say(
                "{number} rows of sheet '{sheet}' are hidden, and are not read. Show them, or "
                "remove them."
            )
            said = say(text, number=len(sheet.hidden_lines), sheet=sheet.name)
            notes.append(_unread_fault(path, sheet.hidden_lines[0], said))
    if len(kept) == 1:
        kept = [kept[0]._replace(sheet="")]
    return kept, notes


def _unread_fault(path: str, line: int, said: Sentence) -> Fault:
    message = say_at_line(line, said)
    return Fault(path=path, line=line, reason_code="hidden", message=message, lost="row")


def _is_text(file: ArchiveFile) -> bool:
    return file.full_path.suffix.lower() in TEXT_SUFFIXES


def _read_text_table(text: str, columns: Sequence[Column]) -> Table:
    """Read line by line: a quotation mark left open would swallow the rows below."""
    lines = split_lines(text)
    place, delimiter = find_header(lines, columns)
    header = split_line(lines[place], delimiter)
    rows: list[tuple[int, Sequence[str], bool]] = []
    for number, line in enumerate(lines[place + 1 :], start=place + 2):
        try:
            is_plain = len(line) > MAX_QUOTED_LINE
            cells = line.split(delimiter) if is_plain else split_line(line, delimiter)
            rows.append((number, cells, False))
        except DefectiveInputError:
            rows.append((number, line.split(delimiter), True))
    return Table(header, place + 1, _keep_filled_rows(rows))


def _read_sheet_table(sheet: Sheet, columns: Sequence[Column]) -> Table:
    lines = []
    for _, cells in sheet.rows:
        on_one_line = [" ".join(cell.split()) for cell in cells]
        lines.append("\t".join(on_one_line))
    place, _ = find_header(lines, columns)
    line, header = sheet.rows[place]
    rows = [(number, cells, False) for number, cells in sheet.rows[place + 1 :]]
    return Table(
        header=header,
        line=line,
        rows=_keep_filled_rows(rows),
        sheet=sheet.name,
        hidden_columns=sheet.hidden_columns,
    )


def _keep_filled_rows(
    rows: Iterable[tuple[int, Sequence[str], bool]],
) -> list[tuple[int, Sequence[str], bool]]:
    """Return the rows that hold something, without remarks behind a `#`."""
    filled = []
    for row in rows:
        _, cells, _ = row
        first = cells[0].strip() if cells else ""
        is_remark = first.startswith("#") and not re.match(_SPREADSHEET_ERROR, first[:20])
        if "".join(cells).strip() and not is_remark:
            filled.append(row)
    return filled


# From a table of text to typed rows


def _find_places(
    table: Table, columns: Sequence[Column], profiles: Profiles
) -> dict[str, FoundColumn]:
    """Return the columns in the header of a list; raise with a question for every other header."""
    try:
        return find_columns(table.header, columns, table.line)
    except DefectiveHeaderError as error:
        ask = []
        for cell in table.header:
            name, unit = split_header(cell)
            namesakes = [column for column in columns if name in fold_names([column])]
            is_column = any(column.scale(unit) is not None for column in namesakes)
            if fold(cell) and fold(cell) not in profiles.ignore and not is_column:
                ask.append(_ask_header(cell.strip()))
        raise DefectiveHeaderError(error.reason_code, error.message, error.line, ask) from error


def _ask_header(header: str) -> str:
    quoted = header.replace("\\", "\\\\").replace('"', '\\"')
    return f'[headers]\n"{quoted}" = "?"'


def _check_columns(
    table: Table, columns: Iterable[Column], places: Mapping[str, FoundColumn], profiles: Profiles
) -> None:
    """Raise where a column is not known, or holds something and is hidden or without a name."""
    for index, header in enumerate(table.header):
        if fold(header):
            continue
        for line, row, _ in table.rows:
            cell = row[index].strip() if index < len(row) else ""
            if cell:
                text = say(
                    "Column {number} has no header, and holds '{cell}' on line {line}: give it a "
                    "header, or empty it."
                )
                said = say(text, number=index + 1, cell=shorten(cell), line=line)
                raise DefectiveHeaderError("unknown_column", said, table.line)
    others = list_unknown_headers(table.header, places)
    unknown = [header for header in others if fold(header) not in profiles.ignore]
    if unknown:
        text = say(
            "Column {names} is not known. Correct it, name it under [headers] in archief.toml, or "
            "put it there under ignore. Not used yet: {free}."
        )
        free = ", ".join(column.header for column in columns if column.key not in places) or "-"
        said = say(text, names=quote_names(unknown), free=free)
        ask = list(map(_ask_header, unknown))
        raise DefectiveHeaderError("unknown_column", said, table.line, ask)
    for key, place in places.items():
        is_filled = any(row[place.index] for _, row, _ in table.rows if place.index < len(row))
        if place.index in table.hidden_columns and is_filled and key != REMARK:
            text = say("Column '{column}' is hidden: show it, or remove it.")
            said = say(text, column=place.header)
            raise DefectiveHeaderError("hidden", said, table.line)


def _parse_rows(
    table: Table,
    file: ArchiveFile,
    kind: ListKind,
    places: Mapping[str, FoundColumn],
    profiles: Profiles,
) -> Rows:
    """Return the values of a table, by the types that its kind of list declares.

    Every cell that is wrong leaves a fault; a row is set aside unless the kind can spare the cell.
    """
    keys = kind.keys
    frame = _collect_cells(table, places, profiles.meaning, kind)
    needed = []
    for column in kind.columns:
        declared = find_declared_column(kind, column.key)
        if column.required and (declared is None or not declared.nullable):
            needed.append(column.key)
    shown = pl.col(needed).replace({MERGED: None})
    is_fragment = pl.sum_horizontal(shown.is_null()) * 2 > len(needed)
    about = (
        _parse_cell(kind, kind.about, places, profiles) if kind.about else pl.lit(None, pl.String)
    )
    rows = Rows(
        kind,
        frame.with_columns(
            path=pl.lit(file.path),
            sheet=pl.lit(table.sheet),
            season=pl.lit(file.season, pl.Int32),
            about=pl.when(~is_fragment).then(about),
            cells=pl.struct(keys),
        ),
    )
    if "rowing_time_s" in keys:
        did_finish = pl.col("rowing_time_s").str.to_lowercase() != DID_NOT_FINISH
        rows.frame = rows.frame.filter(did_finish.fill_null(value=True))
    every, width = rows.frame.filter(~is_fragment), len(table.header)
    rows.drop(pl.col("is_open"), say("a quotation mark is not closed, or in mid-field."))
    text = say("column '{column}' has more than {most} characters in this row.")
    rows.drop(pl.col("too_long") != "", text, column=pl.col("too_long"), most=MAX_CELL_CHARACTERS)
    text = say("the row has {fields} fields where the header has {width}.")
    rows.drop(pl.col("fields") != width, text, fields=pl.col("fields"), width=width)
    text = say(
        "there is only {cells} in this row. Remove it if it is a total or a heading; '#' before it "
        "will do."
    )
    shown = pl.col(keys).replace({MERGED: None})
    filled = pl.concat_str(shown, separator="', '", ignore_nulls=True)
    rows.drop(is_fragment, text, lost="row", cells=pl.format("'{}'", filled))
    is_text = _is_text(file)
    mark = _find_decimal_mark(rows.frame, places, is_text)
    is_kept = every["line"].is_in(rows.frame["line"].implode()).to_numpy()
    every = every.with_columns(
        _parse_cell(kind, key, places, profiles).alias(_VALUE.format(key)) for key in keys
    )
    rows.frame = every.filter(is_kept)
    is_lost = _note_empty(rows, every, needed, places)
    values = {}
    for column in kind.columns:
        checks = _list_checks(kind, column, places, mark, is_text, profiles)
        is_wrong_cell = _note_wrong_cells(rows, every, is_kept, column.key, checks)
        if column.key not in kind.spare:
            is_lost |= is_wrong_cell
        value = pl.col(_VALUE.format(column.key))
        values[column.key] = pl.when(~pl.lit(pl.Series(is_wrong_cell))).then(value)
    schema = make_empty_rows(kind).schema
    rows.listed = every.with_columns(**values).select(schema.names()).cast(schema)
    rows.frame = rows.listed.filter(is_kept & ~is_lost)
    return rows


def _is_number(kind: ListKind, key: str) -> bool:
    """Return whether the cells of a column are numbers."""
    declared = find_declared_column(kind, key)
    return declared is not None and declared.dtype.is_numeric() and key not in _BY_KEY


def _collect_cells(
    table: Table, places: Mapping[str, FoundColumn], words: Mapping[str, str], kind: ListKind
) -> pl.DataFrame:
    """Return the text of each column, trimmed and in known words.

    An empty cell is null. With the `line` of each row, whether a quotation mark in it `is_open`,
    the header of a cell that is `too_long`, and how many `fields` it has, blank ones behind the
    last column aside.
    """
    width = len(table.header)
    numbers = {key for key in kind.keys if _is_number(kind, key)}
    schema = {"line": pl.Int64, "is_open": pl.Boolean, "fields": pl.Int64, "too_long": pl.String}
    schema |= dict.fromkeys(kind.keys, pl.String)
    found: dict[str, list[object]] = {name: [] for name in schema}
    for line, row, is_open in table.rows:
        has_more = any(map(str.strip, row[width:]))
        too_long = ""
        for key in kind.keys:
            index = places[key].index if key in places else width
            cell = row[index].strip() if index < min(len(row), width) else ""
            if len(cell) > MAX_CELL_CHARACTERS:
                too_long = places[key].header
                cell = ""
            if key not in numbers:
                cell = cell.removeprefix(TYPED_AS_TEXT)
            meaning = words.get(fold_word(cell), cell) if words else cell
            found[key].append(None if meaning.casefold() in _NOTHING else meaning)
        found["line"].append(line)
        found["is_open"].append(is_open)
        found["fields"].append(len(row) if has_more else min(len(row), width))
        found["too_long"].append(too_long)
    return pl.DataFrame(found, schema)


def _find_decimal_mark(
    cells: pl.DataFrame, places: Mapping[str, FoundColumn], is_text: bool
) -> str:
    """Return the decimal mark of a list: a comma where any cell is a number with one.

    Else it is a point; or, in a workbook, unknown, as its numbers are no text.
    """
    has_comma = cells.select(pl.col(list(places)).str.contains(r"^[+-]?[0-9]*,[0-9]+$").any())
    return "," if any(has_comma.row(0)) else "." if is_text else ""


def _note_empty(
    rows: Rows, every: pl.DataFrame, needed: list[str], places: Mapping[str, FoundColumn]
) -> BoolArray:
    """Note which needed cells are empty; return in which of all rows any is."""
    names = [pl.when(pl.col(key).is_null()).then(pl.lit(places[key].header)) for key in needed]
    empty = pl.concat_str(names, separator="', '", ignore_nulls=True)
    is_empty = pl.any_horizontal(pl.col(needed).is_null())
    rows.note(is_empty, say("column '{column}' is empty."), column=empty)
    return np.array(every.select(is_empty).to_series(), bool)


class Check(NamedTuple):
    """What can be wrong with the cells of a column.

    Attributes:
        is_wrong: which rows.
        sentence: what is said of each.
        facts: what is filled in.
        code: the reason code; None for that of the list.
    """

    is_wrong: pl.Expr
    sentence: str
    facts: dict[str, Any]
    code: str | None = None


def _note_wrong_cells(
    rows: Rows, every: pl.DataFrame, is_kept: BoolArray, key: str, checks: Sequence[Check]
) -> BoolArray:
    """Note the cells of a column that are wrong, each by the first check that says so.

    Args:
        rows: the rows whose faults are noted.
        every: all rows of the list.
        is_kept: which of these `rows` has.
        key: of the column.
        checks: what can be wrong, in order.

    Returns:
        Which of all rows have a wrong cell here.
    """
    is_told = np.zeros(every.height, bool)
    found = every.select(
        check.is_wrong.fill_null(value=False).alias(str(place))
        for place, check in enumerate(checks)
    )
    for check, is_wrong in zip(checks, found.iter_columns(), strict=True):
        is_new = is_wrong.to_numpy() & ~is_told
        is_told |= is_new
        if (is_new & is_kept).any():
            rows.note(
                pl.lit(pl.Series(is_new[is_kept])),
                check.sentence,
                check.code,
                lost="cell" if key in rows.kind.spare else None,
                asks_word=check.sentence in ASKED_WORDS,
                **check.facts,
            )
    return is_told


def _list_checks(
    kind: ListKind,
    column: Column,
    places: Mapping[str, FoundColumn],
    mark: str,
    is_text: bool,
    profiles: Profiles,
) -> list[Check]:
    """Return the checks of the cells of a column, in order."""
    text, value = pl.col(column.key), pl.col(_VALUE.format(column.key))
    declared = find_declared_column(kind, column.key)
    place = places.get(column.key, FoundColumn(-1, column.header, Scale()))
    named: dict[str, Any] = {"column": place.header, "cell": text}
    if column.key == REMARK:
        return []
    error = say("column '{column}' is {cell}, an error of the spreadsheet: correct its formula.")
    formula = say(
        "column '{column}' is the formula {cell}, which was never calculated: open the list in a "
        "spreadsheet program and save it there, or type the value."
    )
    merged = say(
        "column '{column}' is one of merged cells, and only the first of them holds a value: split "
        "them, and fill in each."
    )
    checks: list[Check] = [
        Check(text == MERGED, merged, named),
        Check(text.str.contains(_SPREADSHEET_ERROR), error, named),
        Check(text.str.contains(_FORMULA), formula, named),
    ]
    if declared is None:
        return checks
    is_unread = text.is_not_null() & value.is_null()
    said = _describe_wrong_cell(column.key, declared.dtype)
    if column.key == "crew_class" and profiles.crew:
        said = _NO_OWN_CLASS
        named["classes"] = ", ".join(crew.code for crew in profiles.crew)
    checks.append(Check(is_unread, said, named))
    if _is_number(kind, column.key):
        is_double, said = _find_double_numbers(text, mark, is_text)
        checks.append(Check(is_double, said, named | {"mark": mark}, "ambiguous_number"))
    if declared.dtype.is_numeric() and column.key != "run":
        lowest, highest = limits(kind.table, column.key)
        low = -float("inf") if lowest is None else lowest
        high = float("inf") if highest is None else highest
        said = say("column '{column}' is {cell}; {low:g} to {high:g} can be right.")
        of_unit = place.scale.divided_by / place.scale.times
        shown = named | {"low": low * of_unit, "high": high * of_unit}
        checks.append(Check(~value.is_between(low, high), said, shown))
    return checks


def _find_double_numbers(text: pl.Expr, mark: str, is_text: bool) -> tuple[pl.Expr, Sentence]:
    """Return which cells can be read in two ways, and what is said of them.

    Args:
        text: the cells of a column of numbers.
        mark: the decimal mark of the list; empty where a workbook tells none.
        is_text: the list is no workbook, in which what is typed as a number is none of these.
    """
    if not mark:
        said = say(
            "column '{column}' is {cell}: text that can be a thousand or little more than one. "
            "Type it as a number."
        )
        return text.str.starts_with(TYPED_AS_TEXT), said
    said = say(
        "column '{column}' is {cell}, which can be a thousand or little more than one: other "
        "decimals of this list are behind a '{mark}'. Write it without a mark, or with a '{mark}'."
    )
    other = "," if mark == "." else "."
    first = "" if is_text else TYPED_AS_TEXT
    return text.str.contains(rf"^{first}[+-]?[1-9][0-9]{{0,2}}[{other}][0-9]{{3}}$"), said


_NO_CLASS: Final = say("column '{column}' is '{cell}'; H or D is expected.")
_NO_OWN_CLASS: Final = say("column '{column}' is '{cell}'; one of {classes} is expected.")
_NO_YES: Final = say("column '{column}' is '{cell}', not ja, nee or empty.")
_NO_TIME: Final = say(
    "column '{column}' is '{cell}', not a time such as 2:10:25. A word for a crew that did not "
    "finish means 'uitgevallen'."
)
_NO_SECONDS: Final = say(
    "column '{column}' is '{cell}', not a number of seconds since the first sample of the run or, "
    "where all runs are in one recording, of the recording."
)
ASKED_WORDS: Final = (_NO_CLASS, _NO_OWN_CLASS, _NO_YES, _NO_TIME)
"""What is said of a cell whose word can be given a meaning."""


def _describe_wrong_cell(key: str, dtype: pl.DataType) -> Sentence:
    """Return the sentence about a cell that is not of its column's type."""
    number = say("column '{column}' is '{cell}', which is not an ordinary number.")
    whole = say("column '{column}' is {cell}; it must be a whole number.")
    by_key = {
        "crew_class": _NO_CLASS,
        "run": say("column '{column}' is '{cell}'; runs are 1 to 20, of meetfile2 b1 to b20."),
        "rowing_time_s": _NO_TIME,
        "start_s": _NO_SECONDS,
        "end_s": _NO_SECONDS,
    }
    by_type = {
        pl.Date: say("column '{column}' is '{cell}', not a date such as 2014-03-01 or 01-03-2014."),
        pl.Boolean: _NO_YES,
        pl.Int32: whole,
        pl.Int16: whole,
    }
    return by_key.get(key) or by_type.get(dtype.base_type(), number)


def split_runs(written: str) -> list[str]:
    """Return the runs that a cell names, as written: `1-3,b4` names `1`, `2`, `3` and `b4`."""
    parts: list[str] = []
    for part in re.split(r"[\s,;]+", written.casefold()):
        match = _RUN_RANGE.fullmatch(part)
        if match is None:
            parts.append(part)
            continue
        file, first, last = match[1], int(match[2]), min(int(match[3]), MOST_RUNS)
        parts += [f"{file}{number}" for number in range(first, last + 1)]
    return parts


# The value of a cell of text, null where it has none


def _parse_cell(
    kind: ListKind, key: str, places: Mapping[str, FoundColumn], profiles: Profiles
) -> pl.Expr:
    """Return the value of a column, by its name or by the type that its table declares."""
    text, declared = pl.col(key), find_declared_column(kind, key)
    by_type = {pl.Boolean: _parse_yes_or_no, pl.Date: _parse_date}
    if key == "fsn_no":
        return _parse_boat(text, profiles.number_prefix)
    if key == "crew_class":
        return _parse_crew_class(text, profiles.crew_classes["crew_class"])
    if key in _BY_KEY:
        return _BY_KEY[key](text)
    if declared is None or declared.dtype == pl.String():
        return text
    if declared.dtype.base_type() in by_type:
        return by_type[declared.dtype.base_type()](text)
    return _parse_number(text, places.get(key), declared.dtype.is_integer())


def _parse_boat(text: pl.Expr, prefix: str) -> pl.Expr:
    """Return the number of a boat: with prefix FSN `FSN 101`, `fsn101` and `101` are FSN101."""
    number = text.str.extract(_BOAT.format(prefix)).str.to_uppercase()
    return pl.coalesce(prefix + number, text)


def _parse_tow_id(text: pl.Expr) -> pl.Expr:
    """Return the tow id with `-` for `/`, as 2014/17 would be a folder in names of files."""
    return text.str.replace_all("/", "-", literal=True)


def _parse_crew_class(text: pl.Expr, classes: pl.Series) -> pl.Expr:
    code = text.str.to_uppercase()
    return pl.when(code.is_in(classes.implode())).then(code)


def _parse_run(text: pl.Expr) -> pl.Expr:
    """Return the number of a run: 1 to 20, or 21 to 40 for b1 to b20."""
    number = text.str.extract(_RUN).cast(pl.Int16)
    offset = pl.when(text.str.contains("^[bB]")).then(SECOND_FILE_OFFSET).otherwise(0)
    return pl.when(number <= MOST_RUNS).then(number + offset)


def _parse_rowing_time(text: pl.Expr) -> pl.Expr:
    """Return the seconds of a rowing time such as `2:10:25`."""
    parts = text.str.extract_groups(_TIME).struct
    hours = parts.field("1").cast(pl.Float64)
    minutes = parts.field("2").cast(pl.Float64)
    seconds = parts.field("3").cast(pl.Float64)
    total = hours * 3600 + minutes * 60 + seconds
    return pl.when(total > 0).then(total)


def _parse_yes_or_no(text: pl.Expr) -> pl.Expr:
    word = text.fill_null("nee").str.to_lowercase()
    return pl.when(word.is_in(_YES + _NO)).then(word.is_in(_YES))


def _parse_date(text: pl.Expr) -> pl.Expr:
    iso = text.str.extract(_ISO_DATE).str.to_date("%Y-%m-%d", strict=False)
    return iso.fill_null(text.str.extract(_DUTCH_DATE).str.to_date("%d-%m-%Y", strict=False))


def _parse_number(text: pl.Expr, place: FoundColumn | None, is_whole: bool) -> pl.Expr:
    """Return a number in the SI unit of its column."""
    text = text.str.strip_prefix(TYPED_AS_TEXT)
    if place and place.unit:  # 3% under [%]: the unit may be repeated behind the number
        text = text.str.replace(rf"(?i)\s*{re.escape(place.unit)}$", "")
    digits = pl.when(text.str.contains(NUMBER)).then(text.str.replace(",", ".", literal=True))
    number = digits.cast(pl.Float64, strict=False)
    number = place.to_si(number) if place else number
    is_good = number.is_finite() & (number == number.round() if is_whole else pl.lit(value=True))
    return pl.when(is_good).then(number)


_BY_KEY: Final[Mapping[str, Callable[[pl.Expr], pl.Expr]]] = {
    "tow_id": _parse_tow_id,
    "run": _parse_run,
    "rowing_time_s": _parse_rowing_time,
}
