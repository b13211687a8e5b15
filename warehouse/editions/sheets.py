"""The register as people read it: CSV and XLSX with Dutch headers, for a spreadsheet.

The cells of the CSV are the printed register: they are what the verification code of a line covers,
together with the line's inputs and method. Nothing is computed here but text and hashes.
"""

import base64
import csv
import datetime as dt
import hashlib
import io
import json
import re
from collections.abc import Sequence
from typing import Any, Final, Literal, NamedTuple

import polars as pl

from pipeline.register.register import NO_EMPTY_THWART

CODE_LENGTH: Final = 10
FORMULA: Final = re.compile(r"(^|[;,\t\r\n])(\s*)([=+\-@])")
"""What a spreadsheet takes for a formula, also behind a separator that it splits a cell at."""

TEXT_STAYS_TEXT: Final = dict.fromkeys(
    ("strings_to_formulas", "strings_to_urls", "strings_to_numbers"), False
)
SHEET: Final = "register"
OLDER_SECOND_SHEET: Final = "editie"
"""What workbooks up to version 1.0.0 have besides."""

FieldType = Literal["string", "number", "integer", "date"]

WORDS: Final = {
    "status": {
        "valid": "geldig",
        "expired": "verlopen",
        "rejected": "geen kromme",
        "doubted": "eerst nakijken",
        "excluded": "uitgesloten",
        "never_towed": "niet gesleept",
        "no_valid_curve": "geen geldige kromme",
    },
    "basis": {
        "measured": "herrekend",
        "printed": "gedrukt",
        "printed_rebased": "gedrukt, omgerekend",
        "printed_not_rebased": "gedrukt, niet herijkt",
    },
    "empty_thwart": {NO_EMPTY_THWART: "geen"},
}
"""Codes by their column in the words that people read. The verification codes of published lines
are over these words, so they stay."""


class Field(NamedTuple):
    """A column of a sheet: its Dutch header, where its values come from, and how they look."""

    header: str
    column: str
    type: FieldType = "string"
    decimals: int = 3


REGISTER_FIELDS: Final = (
    Field("fsn_nr", "fsn_no"),
    Field("ht_nr", "ht_no"),
    Field("sloep", "name"),
    Field("type", "boat_type"),
    Field("roeiers", "rowers", "integer"),
    Field("klasse", "crew_class"),
    Field("lege doft", "empty_thwart"),
    Field("status", "status"),
    Field("nakijken", "flags"),
    Field("roeisnelheid [m/s]", "declared_speed_m_s", "number", 2),
    Field("A [kg/m]", "a_kg_m", "number"),
    Field("B [m/s]", "b_m_s", "number"),
    Field("Cw [kg/m]", "cw_kg_m", "number"),
    Field("Cw laagst [kg/m]", "cw_lo_kg_m", "number"),
    Field("Cw hoogst [kg/m]", "cw_hi_kg_m", "number"),
    Field("sleep_id", "tow_id"),
    Field("sleepdatum", "tow_date", "date"),
    Field("geldig tot en met", "valid_until", "date"),
    Field("beoordeeld op", "as_of", "date"),
    Field("lengte [m]", "waterline_length_m", "number", 2),
    Field("breedte [m]", "beam_m", "number", 2),
    Field("hoogte [m]", "bow_height_m", "number", 2),
    Field("gewicht [kg]", "weight_kg", "number", 0),
    Field("basis", "basis"),
    Field("editie", "edition"),
    Field("methode", "method"),
)
CODE_FIELD: Final = Field("controlecode", "verification_code")
SHEET_FIELDS: Final = REGISTER_FIELDS + (CODE_FIELD,)
"""The columns of the sheet; the code is over those of `REGISTER_FIELDS`."""


def print_cells(frame: pl.DataFrame, fields: Sequence[Field]) -> pl.DataFrame:
    """Return the cells of a sheet as they are printed, by header."""
    words = _write_words(frame)
    columns = []
    for field in fields:
        texts = [_print_cell(value, field) for value in words[field.column]]
        columns.append(pl.Series(field.header, texts, pl.String))
    return pl.DataFrame(columns)


def compute_verification_codes(frame: pl.DataFrame, method_hash: str | None) -> list[str]:
    """Return the code of every line: ten letters and digits that follow from all that made it.

    Args:
        frame: lines with the columns of `REGISTER_FIELDS` and `inputs_sha256`.
        method_hash: content hash of the method; None for a register as printed.
    """
    codes = []
    lines = print_cells(frame, REGISTER_FIELDS).rows()
    for inputs, line in zip(frame["inputs_sha256"], lines, strict=True):
        covered = [inputs, method_hash] + list(line)
        text = json.dumps(covered, ensure_ascii=False, separators=(",", ":"))
        digest = hashlib.sha256(text.encode("utf-8")).digest()
        codes.append(base64.b32encode(digest).decode("ascii")[:CODE_LENGTH])
    return codes


def encode_csv(frame: pl.DataFrame, fields: Sequence[Field]) -> bytes:
    """Write a sheet as CSV for Dutch spreadsheets: BOM, semicolons, decimal commas, no formulas."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, delimiter=";", lineterminator="\r\n")
    writer.writerow([field.header for field in fields])
    writer.writerows(print_cells(frame, fields).rows())
    return text.getvalue().encode("utf-8-sig")


def write_workbook(frame: pl.DataFrame, fields: Sequence[Field], made_on: dt.date) -> bytes:
    """Write a sheet as XLSX: numbers as numbers, days as days, and no text as a formula.

    Args:
        frame: rows of the register.
        fields: the columns of the sheet.
        made_on: what the file says of when it was made, so that equal sheets have equal bytes.
    """
    import xlsxwriter  # type: ignore[import-untyped,unused-ignore]  # noqa: PLC0415 - 0.15 s

    target = io.BytesIO()
    formats: dict[Any, str] = {field.header: _choose_number_format(field) for field in fields}
    with xlsxwriter.Workbook(target, {"in_memory": True, **TEXT_STAYS_TEXT}) as book:
        book.set_properties({"created": dt.datetime.combine(made_on, dt.time())})
        _tabulate_cells(frame, fields).write_excel(
            book, SHEET, column_formats=formats, autofit=True, freeze_panes=(1, 1)
        )
    return target.getvalue()


def shows_the_same(workbook: bytes, frame: pl.DataFrame, fields: Sequence[Field]) -> bool:
    """Return whether a workbook shows a sheet as `write_workbook` writes it, and nothing else.

    Compared are the cells with their number formats; hidden rows, columns and sheets show nothing.
    """
    import openpyxl  # type: ignore[import-untyped]  # noqa: PLC0415 - a tenth of a second

    from warehouse.archive.workbooks import read_workbook  # noqa: PLC0415 - all of that room

    try:
        read_workbook(workbook)  # refuses what would unpack to more than a list needs
        book = openpyxl.load_workbook(io.BytesIO(workbook))
    except Exception:
        return False
    if book.sheetnames not in ([SHEET], [SHEET, OLDER_SECOND_SHEET]):
        return False
    sheet = book[SHEET]
    for shape in list(sheet.row_dimensions.values()) + list(sheet.column_dimensions.values()):
        size = (getattr(shape, "height", None), getattr(shape, "width", None))
        if shape.hidden or 0 in size:
            return False
    if sheet.sheet_state != "visible" or sheet.conditional_formatting:
        return False
    cells = _tabulate_cells(frame, fields)
    formats = list(map(_choose_number_format, fields))
    expected: list[list[object]] = [list(cells.columns)]
    expected += [list(map(_read_cell, row)) for row in cells.iter_rows()]
    shown = []
    is_formatted = True
    for place, row in enumerate(sheet.iter_rows()):
        shown.append([cell.value for cell in row])
        for cell, number_format in zip(row, formats, strict=False):
            is_formatted &= place == 0 or cell.value is None or cell.number_format == number_format
    return shown == expected and is_formatted


def _tabulate_cells(frame: pl.DataFrame, fields: Sequence[Field]) -> pl.DataFrame:
    """Return the values of the cells of a workbook, by header."""
    words = _write_words(frame)
    cells = []
    for field in fields:
        value = pl.col(field.column)
        rounded = value.round(field.decimals) if field.type == "number" else value
        cells.append(rounded.alias(field.header))
    return words.select(cells)


def _read_cell(value: object) -> object:
    """Return a value as a workbook gives it back: a day with a time, no empty text."""
    if isinstance(value, dt.date):
        return dt.datetime.combine(value, dt.time())
    return None if value == "" else value


def _choose_number_format(field: Field) -> str:
    if field.type == "number":
        return "0." + "0" * field.decimals if field.decimals else "0"
    return {"date": "dd-mm-yyyy", "integer": "0"}.get(field.type, "@")


def _write_words(frame: pl.DataFrame) -> pl.DataFrame:
    """Replace codes by the words that people read."""
    if "flags" in frame.columns:
        to_look_at = pl.col("flags").list.len() > 0
        frame = frame.with_columns(pl.when(to_look_at).then(pl.lit("ja")).alias("flags"))
    return frame.with_columns(
        pl.col(column).replace(words) for column, words in WORDS.items() if column in frame.columns
    )


def _print_cell(value: Any, field: Field) -> str:
    if value is None:
        return ""
    if field.type == "number":
        return f"{value:.{field.decimals}f}".replace(".", ",")
    text = str(value)
    return FORMULA.sub(r"\1\2'\3", text) if field.type == "string" else text
