"""The register as people read it: CSV with Dutch headers, for a spreadsheet.

The cells of the CSV are the printed register: they are what the verification code of a line covers,
together with the line's inputs and method. Nothing is computed here but text and hashes.
"""

import base64
import csv
import hashlib
import io
import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, Literal, NamedTuple

import polars as pl

from pipeline.register.register import NO_EMPTY_THWART
from warehouse.store.editions import INPUTS

CODE_LENGTH: Final = 10
FORMULA: Final = re.compile(r"(^|[;,\t\r\n])(\s*)([=+\-@])")
"""What a spreadsheet takes for a formula, also behind a separator that it splits a cell at."""

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
SHEET_FIELDS: Final = (*REGISTER_FIELDS, CODE_FIELD)
"""The columns of the sheet; the code is over those of `REGISTER_FIELDS`."""

INPUT_FIELDS: Final = (Field("bestand", "path"), Field("soort", "kind"), Field("sha256", "sha256"))


def printed(frame: pl.DataFrame, fields: Sequence[Field]) -> pl.DataFrame:
    """The cells of a sheet as they are printed, by header."""
    words = _in_words(frame)
    return pl.DataFrame(
        {
            field.header: [_printed(value, field) for value in words[field.column]]
            for field in fields
        },
        schema={field.header: pl.String() for field in fields},
    )


def verification_codes(frame: pl.DataFrame, method_hash: str | None) -> list[str]:
    """The code of every line: ten letters and digits that follow from all that made it.

    Args:
        frame: lines with the columns of `REGISTER_FIELDS` and `inputs_sha256`.
        method_hash: content hash of the method; None for a register as printed.
    """
    lines = printed(frame, REGISTER_FIELDS).rows()
    return [
        _code([inputs, method_hash, *line])
        for inputs, line in zip(frame["inputs_sha256"], lines, strict=True)
    ]


def csv_bytes(frame: pl.DataFrame, fields: Sequence[Field]) -> bytes:
    """A sheet as CSV for a Dutch spreadsheet: BOM, semicolons, decimal commas, no formulas."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, delimiter=";", lineterminator="\r\n")
    writer.writerow([field.header for field in fields])
    writer.writerows(printed(frame, fields).rows())
    return text.getvalue().encode("utf-8-sig")


def read_inputs(edition: Path) -> pl.DataFrame:
    """What an edition was made from: `path`, `kind` and `sha256` of each file.

    A row of another width was changed, which is found where the files themselves are looked at.
    """
    path, names = edition / INPUTS, [field.column for field in INPUT_FIELDS]
    content = path.read_bytes() if path.exists() else b""
    text = content.decode("utf-8-sig", errors="replace")
    rows = [
        row
        for row in csv.reader(io.StringIO(text, newline=""), delimiter=";")
        if len(row) == len(names)
    ]
    return pl.DataFrame(rows[1:], schema=dict.fromkeys(names, pl.String()), orient="row")


def _in_words(frame: pl.DataFrame) -> pl.DataFrame:
    """Codes in the words that people read."""
    if "flags" in frame.columns:
        to_look_at = pl.col("flags").list.len() > 0
        frame = frame.with_columns(pl.when(to_look_at).then(pl.lit("ja")).alias("flags"))
    return frame.with_columns(
        pl.col(column).replace(words) for column, words in WORDS.items() if column in frame.columns
    )


def _printed(value: Any, field: Field) -> str:
    if value is None:
        return ""
    if field.type == "number":
        return f"{value:.{field.decimals}f}".replace(".", ",")
    text = str(value)
    return FORMULA.sub(r"\1\2'\3", text) if field.type == "string" else text


def _code(parts: Sequence[str | None]) -> str:
    text = json.dumps(parts, ensure_ascii=False, separators=(",", ":"))
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return base64.b32encode(digest).decode("ascii")[:CODE_LENGTH]
