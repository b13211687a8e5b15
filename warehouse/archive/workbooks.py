"""Reading a workbook: its visible sheets as rows of text, in which a cell says what a person sees.

Every workbook is loaded twice, for its formulas and for its values: only so is it known that a
formula was never calculated. Both loads are bounded by what the directory of the zip file says.
"""

import datetime as dt
import io
import re
import warnings
import zipfile
from dataclasses import dataclass
from typing import Any, Final

from pipeline.errors import DefectiveInputError
from pipeline.messages import Sentence, say

MAX_PART_BYTES: Final = 12_000_000
"""Size of one part of a workbook, unpacked: 10,000 rows of a tow list take 9 MB."""
MAX_ALL_BYTES: Final = 40_000_000
"""Size of all parts of a workbook, unpacked."""
MAX_PARTS: Final = 2_000
MAX_ROWS: Final = 20_000
MAX_COLUMNS: Final = 300
MAX_CELLS: Final = 1_000_000
"""Cells of a sheet, empty ones between filled ones included."""
MAX_PASSED_CELLS: Final = 20_000_000
"""Empty cells that are passed over in a search of the filled ones."""
MERGED: Final = "(samengevoegd)"
"""Stands in every cell of merged ones but the first, which alone holds their value."""
TYPED_AS_TEXT: Final = "'"
"""Stands before a number that is typed as text and that can be a thousand or little more than one,
as spreadsheets show it."""
_COMPOUND_FILE: Final = bytes.fromhex("d0cf11e0a1b11ae1")
"""How a workbook of Excel 97 to 2003 begins, or a later one with a password."""
_DOUBLE_NUMBER: Final = re.compile(r"[+-]?[1-9][0-9]{0,2}[.,][0-9]{3}")
_FORMAT_TOKEN: Final = re.compile(r'"([^"]*)"|\\(.)|(\[[^\]]*\]|_.|\*.)|([0#?.,%]+)|(.)')
"""A part of a number format: quoted text, one letter, what is not shown, or digits."""


@dataclass(frozen=True)
class Sheet:
    """A visible sheet.

    Attributes:
        name: its title.
        rows: the visible rows, each with its line (from 1) and its cells.
        hidden_lines: the lines of hidden rows that hold something.
        hidden_columns: the places of hidden columns, from 0.
    """

    name: str
    rows: list[tuple[int, list[str]]]
    hidden_lines: list[int]
    hidden_columns: frozenset[int]


@dataclass(frozen=True)
class Workbook:
    """What a person sees in a workbook, and which sheets are hidden."""

    sheets: list[Sheet]
    hidden: list[Sheet]


@dataclass(frozen=True)
class _Written:
    """What is written in a sheet.

    Attributes:
        rows: the last row in which a cell holds something; cells that are only coloured do not.
        columns: the last such column.
        formulas: the formulas by row and column.
    """

    rows: int
    columns: int
    formulas: dict[tuple[int, int], str]


def read_workbook(data: bytes) -> Workbook:
    """Read the sheets of an .xlsx or .xlsm file.

    Raises:
        DefectiveInputError: `unreadable_file` or `too_large`.
    """
    _check_size(data)
    import openpyxl  # type: ignore[import-untyped]  # noqa: PLC0415 - a tenth of a second

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of drawings and rules that a list has no use for
            formulas = openpyxl.load_workbook(io.BytesIO(data), read_only=True, keep_links=False)
            written = {sheet.title: _find_written(sheet) for sheet in formulas.worksheets}
            values = openpyxl.load_workbook(io.BytesIO(data), data_only=True, keep_links=False)
    except DefectiveInputError:
        raise
    except Exception as error:  # a damaged workbook makes the library raise almost anything
        text = say("The file is not a workbook that can be read: {error}. Save it again as .xlsx.")
        said = say(text, error=f"{type(error).__name__}: {error}"[:200])
        raise DefectiveInputError("unreadable_file", said) from error
    visible: list[Sheet] = []
    hidden: list[Sheet] = []
    for sheet in values.worksheets:
        is_visible = sheet.sheet_state == "visible"
        (visible if is_visible else hidden).append(_read_sheet(sheet, written[sheet.title]))
    return Workbook(visible, hidden)


def _find_written(sheet: Any) -> _Written:
    """Return how far the filled cells of a sheet reach, and its formulas.

    Raises:
        DefectiveInputError: `too_large`.
    """
    sheet.reset_dimensions()  # what the file says of them can be wrong
    last_row = last_column = passed = 0
    formulas = {}
    for line, values in enumerate(sheet.iter_rows(values_only=True), start=1):
        passed += len(values)
        if passed > MAX_PASSED_CELLS:
            raise DefectiveInputError("too_large", _reaches_too_far(sheet.title))
        for column, value in enumerate(values, start=1):
            if value is None:
                continue
            last_row, last_column = line, max(last_column, column)
            if line > MAX_ROWS or column > MAX_COLUMNS:
                raise DefectiveInputError("too_large", _reaches_too_far(sheet.title))
            formula = getattr(value, "text", value)  # of several cells together
            if isinstance(formula, str) and formula.startswith("="):
                formulas[line, column] = formula
    if last_row * last_column > MAX_CELLS:
        raise DefectiveInputError("too_large", _reaches_too_far(sheet.title))
    return _Written(last_row, last_column, formulas)


def _check_size(data: bytes) -> None:
    """Raise unless the directory of the zip file says that the workbook is small."""
    if data.startswith(_COMPOUND_FILE):
        said = say(
            "This is an old Excel workbook (.xls), or one with a password: save it as .xlsx, "
            "without a password."
        )
        raise DefectiveInputError("unreadable_file", said)
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as book:
            sizes = [part.file_size for part in book.infolist()]
    except (zipfile.BadZipFile, ValueError, OSError, NotImplementedError) as error:
        said = say("The file is not a workbook (.xlsx). Save it again as .xlsx.")
        raise DefectiveInputError("unreadable_file", said) from error
    if max(sizes, default=0) > MAX_PART_BYTES or sum(sizes) > MAX_ALL_BYTES:
        text = say(
            "The workbook is too large: a part of it unpacks to {size:.0f} MB, and {most:.0f} is "
            "the limit. Copy the list alone into a new workbook, or save it as CSV."
        )
        said = say(text, size=max(sizes) / 1e6, most=MAX_PART_BYTES / 1e6)
        raise DefectiveInputError("too_large", said)
    if len(sizes) > MAX_PARTS:
        said = say("The workbook has {parts} parts: copy the list alone into a new workbook.",
                   parts=len(sizes))  # fmt: skip
        raise DefectiveInputError("too_large", said)


def _read_sheet(sheet: Any, written: _Written) -> Sheet:
    """Return the rows of a sheet as text."""
    merged = _find_merged(sheet, written)
    visible, hidden_lines = [], []
    for line in range(1, written.rows + 1):
        cells = []
        for column in range(1, written.columns + 1):
            place = line, column
            text = _cell_text(sheet.cell(line, column), written.formulas.get(place))
            cells.append(MERGED if place in merged else text)
        if not any(cells):
            continue
        shape = sheet.row_dimensions[line]
        if shape.hidden or shape.height == 0:
            hidden_lines.append(line)
        else:
            visible.append((line, cells))
    hidden_columns: set[int] = set()
    for shape in sheet.column_dimensions.values():
        if shape.hidden or shape.width == 0:
            first, last = shape.min or 1, min(shape.max or 1, written.columns)
            hidden_columns.update(range(first - 1, last))
    return Sheet(sheet.title, visible, hidden_lines, frozenset(hidden_columns))


def _find_merged(sheet: Any, written: _Written) -> set[tuple[int, int]]:
    """Return row and column of merged cells that show the value of the first of them."""
    merged = set()
    for area in sheet.merged_cells.ranges:
        if sheet.cell(area.min_row, area.min_col).value is None:
            continue
        for line in range(area.min_row, min(area.max_row, written.rows) + 1):
            for column in range(area.min_col, min(area.max_col, written.columns) + 1):
                merged.add((line, column))
        merged.discard((area.min_row, area.min_col))
    return merged


def _reaches_too_far(title: str) -> Sentence:
    text = say(
        "Sheet '{sheet}' reaches beyond row {rows} or column {columns}. Delete what is far below "
        "or beside the table, or copy it alone into a new workbook."
    )
    return say(text, sheet=title, rows=MAX_ROWS, columns=MAX_COLUMNS)


def _cell_text(cell: Any, formula: str | None) -> str:
    """Return a cell as a person sees it, or its formula where that was never calculated."""
    value = cell.value
    if value is None:
        is_calculated = cell.data_type == "str"  # a formula whose result is an empty text
        return "" if is_calculated else formula or ""
    if isinstance(value, bool):
        return "ja" if value else "nee"
    if isinstance(value, int | float):
        return show_number(value, cell.number_format or "")
    if isinstance(value, dt.timedelta):
        seconds = round(value.total_seconds())
        return f"{seconds // 3600}:{seconds // 60 % 60:02}:{seconds % 60:02}"
    if isinstance(value, dt.datetime):
        return value.date().isoformat()
    text = str(value).strip()
    return TYPED_AS_TEXT + text if _DOUBLE_NUMBER.fullmatch(text) else text


def show_number(value: float, number_format: str) -> str:
    """Return a number as its format shows it, but with all of its decimals.

    A percentage, thousands that are left out, leading zeros and text beside the number are shown;
    how many decimals, marks between thousands and currencies are not.
    """
    section = number_format.split(";", maxsplit=1)[0]
    if not section or "General" in section or "@" in section or re.search("[eE][+-]", section):
        return _plain(value)
    before, after, digits = "", "", ""
    for quoted, escaped, _, number, other in _FORMAT_TOKEN.findall(section):
        if number:
            digits += number
        elif digits:
            after += quoted + escaped + other
        else:
            before += quoted + escaped + other
    if "%" in digits:
        value, after = round(value * 100, 12), f"%{after}"
    digits = digits.replace("%", "")
    left_out = len(digits) - len(digits.rstrip(","))
    shown = _plain(value / 1000**left_out)
    whole = digits.partition(".")[0]
    if set(whole) == {"0"} and shown.isdigit():
        shown = shown.zfill(len(whole))
    return f"{before.strip(' -+()/')}{shown}{after.strip(' -+()/')}"


def _plain(value: float) -> str:
    if isinstance(value, float):
        return f"{value:.0f}" if value.is_integer() and abs(value) < 1e15 else repr(value)
    return str(value)
