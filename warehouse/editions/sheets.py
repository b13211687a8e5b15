"""The register as people read it: CSV and XLSX with Dutch headers, and the data package.

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
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

import polars as pl
import python_calamine
import xlsxwriter  # type: ignore[import-untyped,unused-ignore]

from pipeline.register.register import NO_EMPTY_THWART
from warehouse.editions.words import STATUSES
from warehouse.store.editions import CSV, INPUTS, Manifest
from warehouse.store.package import Rights

REGISTER_SHEET: Final = "register"
A4: Final = 9
"""The paper's number in a spreadsheet."""
BOM: Final = "\ufeff"
CODE_LENGTH: Final = 10
CODE_HEADER: Final = "controlecode"
FORMULA: Final = re.compile(r"(^|[;,\t\r\n])(\s*)([=+\-@])")
"""What a spreadsheet takes for a formula, also behind a separator that it splits a cell at."""

FieldType = Literal["string", "number", "integer", "date"]

BASIS_WORDS: Final = {
    "measured": "herrekend",
    "printed": "gedrukt",
    "printed_rebased": "gedrukt, omgerekend",
    "printed_not_rebased": "gedrukt, niet herijkt",
}


@dataclass(frozen=True)
class Field:
    """A column of a sheet: its Dutch header, where its values come from, and how they look."""

    header: str
    column: str
    type: FieldType
    description: str
    decimals: int = 3


LOWER_END: Final = (
    "ondergrens van het 95 %-interval; bij een methode die de fout van de log niet schat: van de "
    "spreiding van de runs alleen, de fout van de log zit er niet in"
)
REGISTER_FIELDS: Final = (
    Field("fsn_nr", "fsn_no", "string", "nummer van de sloep bij de federatie"),
    Field("ht_nr", "ht_no", "string", "nummer in het HT-register"),
    Field("sloep", "name", "string", "naam"),
    Field("type", "boat_type", "string", "type sloep"),
    Field("roeiers", "rowers", "integer", "aantal roeiers waarvoor de regel geldt"),
    Field("klasse", "crew_class", "string", "H heren, D dames"),
    Field(
        "lege doft",
        "empty_thwart",
        "string",
        "doft waarop geen roeiers zitten: de kromme is alleen geldig als die leeg is",
    ),
    Field("status", "status", "string", "geldig, of waarom er geen geldige kromme is"),
    Field("nakijken", "flags", "string", "ja: de commissie moet nog naar deze sleep kijken"),
    Field("roeisnelheid [m/s]", "declared_speed_m_s", "number", "opgegeven snelheid", 2),
    Field("A [kg/m]", "a_kg_m", "number", "de weerstand bij snelheid 0"),
    Field(
        "B [m/s]",
        "b_m_s",
        "number",
        "leeg waar hij niet bepaald is: Cw stijgt daar niet met de snelheid, en A en Cw "
        "bij de roeisnelheid bepalen samen de kromme",
    ),
    Field("Cw [kg/m]", "cw_kg_m", "number", "Cw bij de roeisnelheid"),
    Field("Cw laagst [kg/m]", "cw_lo_kg_m", "number", LOWER_END),
    Field("Cw hoogst [kg/m]", "cw_hi_kg_m", "number", "bovengrens"),
    Field("sleep_id", "tow_id", "string", "sleep die telt"),
    Field("sleepdatum", "tow_date", "date", "dag van die sleep"),
    Field("geldig tot en met", "valid_until", "date", "laatste dag waarop de regel telt"),
    Field("beoordeeld op", "as_of", "date", "dag waarop de geldigheid is bekeken"),
    Field("lengte [m]", "waterline_length_m", "number", "lengte op de waterlijn die dag", 2),
    Field("breedte [m]", "beam_m", "number", "breedte die dag", 2),
    Field("hoogte [m]", "bow_height_m", "number", "boeghoogte die dag", 2),
    Field("gewicht [kg]", "weight_kg", "number", "lege sloep met riemen die dag", 0),
    Field("basis", "basis", "string", "waar de getallen vandaan komen"),
    Field("editie", "edition", "string", "uitgave van het register"),
    Field("methode", "method", "string", "rekenmethode"),
)
LINE_KEY: Final = ["fsn_nr", "roeiers", "klasse", "lege doft"]
CODE_FIELD: Final = Field(
    CODE_HEADER, "verification_code", "string", "hash van invoer, methode en getallen van de regel"
)
SHEET_FIELDS: Final = (*REGISTER_FIELDS, CODE_FIELD)
"""The columns of the sheet; the code is over those of `REGISTER_FIELDS`."""

INPUT_FIELDS: Final = (
    Field("bestand", "path", "string", "bestand, vanaf de map van het archief"),
    Field("soort", "kind", "string", "meetdata, lijst of register"),
    Field("sha256", "sha256", "string", "hash van de inhoud"),
)

Cells = list[list[str]]


def printed_cells(frame: pl.DataFrame, fields: Sequence[Field]) -> Cells:
    """The cells of a sheet as they are printed, without the header."""
    words = _in_words(frame)
    columns = [
        [_printed(value, field) for value in words[field.column].to_list()] for field in fields
    ]
    return [list(row) for row in zip(*columns, strict=True)]


def verification_codes(frame: pl.DataFrame, method_hash: str | None) -> list[str]:
    """The code of every line: ten letters and digits that follow from all that made it.

    Args:
        frame: lines with the columns of `REGISTER_FIELDS` and `inputs_sha256`.
        method_hash: content hash of the method; None for a register as printed.
    """
    cells = printed_cells(frame, REGISTER_FIELDS)
    return [
        _code([inputs, method_hash, *row])
        for inputs, row in zip(frame["inputs_sha256"].to_list(), cells, strict=True)
    ]


def csv_bytes(frame: pl.DataFrame, fields: Sequence[Field]) -> bytes:
    """A sheet as CSV for a Dutch spreadsheet: BOM, semicolons, decimal commas, no formulas."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, delimiter=";", lineterminator="\r\n")
    writer.writerow([field.header for field in fields])
    writer.writerows(printed_cells(frame, fields))
    return (BOM + text.getvalue()).encode("utf-8")


def read_inputs(edition: Path) -> list[tuple[str, str, str]]:
    """File, kind and SHA-256 of what an edition was made from.

    A row of another width was changed, which is found where the files themselves are looked at.
    """
    text = (edition / INPUTS).read_bytes().decode("utf-8-sig", errors="replace")
    rows = list(csv.reader(io.StringIO(text, newline=""), delimiter=";"))[1:]
    return [(row[0], row[1], row[2]) for row in rows if len(row) == len(INPUT_FIELDS)]


def xlsx_bytes(frame: pl.DataFrame, fields: Sequence[Field], manifest: Manifest) -> bytes:
    """A sheet as XLSX, numbers as numbers and days as days, with what the edition is beside it."""
    target = io.BytesIO()
    options = {
        "in_memory": True,
        "strings_to_formulas": False,
        "strings_to_urls": False,
        "strings_to_numbers": False,
    }
    words = _in_words(frame)
    columns = [words[f.column].alias(f.header) for f in fields]
    rounded = pl.DataFrame(
        column.round(field.decimals) if field.type == "number" else column
        for column, field in zip(columns, fields, strict=True)
    )
    with xlsxwriter.Workbook(target, options) as book:
        created = dt.datetime.combine(manifest.published_on, dt.time())
        book.set_properties({"title": f"Sloepenregister {manifest.edition}", "created": created})
        rounded.write_excel(
            book,
            REGISTER_SHEET,
            column_formats={field.header: _number_format(field) for field in fields},
            autofit=True,
            freeze_panes=(1, 1),
        )
        sheet = book.get_worksheet_by_name(REGISTER_SHEET)
        sheet.repeat_rows(0)
        sheet.set_landscape()
        sheet.set_paper(A4)
        sheet.fit_to_pages(1, 0)
        said = pl.DataFrame(list(_said(manifest).items()), ["editie", "waarde"], orient="row")
        said.write_excel(book, "editie", include_header=False, autofit=True)
    return target.getvalue()


def _number_format(field: Field) -> str:
    if field.type == "number":
        return "0." + "0" * field.decimals if field.decimals else "0"
    return {"date": "dd-mm-yyyy", "integer": "0"}.get(field.type, "@")


def _said(manifest: Manifest) -> dict[str, str]:
    """What an edition is, in words."""
    return {
        "editie": manifest.edition,
        "geldt vanaf": manifest.valid_from.isoformat(),
        "vastgesteld op": manifest.published_on.isoformat(),
        "besluit": manifest.decision,
        "methode": manifest.method or "zoals gedrukt",
        "methode-hash": manifest.method_hash or "",
        "programmaversie": manifest.code_version,
        "gesimuleerd": "ja: geen metingen van de federatie" if manifest.simulated else "nee",
    }


def read_xlsx_cells(content: bytes) -> dict[str, list[list[Any]]]:
    """The cells of all sheets, by the sheet's name.

    Raises:
        ValueError: this is no XLSX.
    """
    try:
        book = python_calamine.load_workbook(io.BytesIO(content))
        return {name: book.get_sheet_by_name(name).to_python() for name in book.sheet_names}
    except python_calamine.CalamineError as error:
        raise ValueError(f"no XLSX: {error}") from error


def package_bytes(
    manifest: Manifest, contents: dict[str, bytes], notes: str, rights: Rights
) -> bytes:
    """The Frictionless descriptor of the CSV files of an edition."""
    package = {
        "profile": "tabular-data-package",
        "name": manifest.edition.lower(),
        "title": f"Sloepenregister {manifest.edition}",
        "description": notes,
        "version": manifest.edition,
        "created": f"{manifest.published_on}T00:00:00Z",
        **rights.described,
        "resources": [
            _resource("register", CSV, contents[CSV], SHEET_FIELDS, LINE_KEY),
            _resource("inputs", INPUTS, contents[INPUTS], INPUT_FIELDS, ["bestand"]),
        ],
    }
    return (json.dumps(package, indent=1, ensure_ascii=False) + "\n").encode("utf-8")


def _resource(
    name: str, path: str, content: bytes, fields: Sequence[Field], key: list[str]
) -> dict[str, object]:
    return {
        "profile": "tabular-data-resource",
        "name": name,
        "path": path,
        "format": "csv",
        "mediatype": "text/csv",
        "encoding": "utf-8-sig",
        "bytes": len(content),
        "hash": f"sha256:{hashlib.sha256(content).hexdigest()}",
        "dialect": {"delimiter": ";", "lineTerminator": "\r\n", "quoteChar": '"', "header": True},
        "schema": {
            "fields": [_field(field) for field in fields],
            "primaryKey": key,
            "missingValues": [""],
        },
    }


def _field(field: Field) -> dict[str, Any]:
    described = {"name": field.header, "type": field.type, "description": field.description}
    if field.type == "number":
        described |= {"decimalChar": ","}
    return described


def _in_words(frame: pl.DataFrame) -> pl.DataFrame:
    """Codes in the words that people read."""
    words = {
        "status": {code: dutch for code, (dutch, _) in STATUSES.items()},
        "basis": BASIS_WORDS,
        "empty_thwart": {NO_EMPTY_THWART: "geen"},
    }
    if "flags" in frame.columns:
        to_look_at = pl.col("flags").list.len() > 0
        frame = frame.with_columns(pl.when(to_look_at).then(pl.lit("ja")).alias("flags"))
    return frame.with_columns(
        pl.col(column).replace(words[column]) for column in words if column in frame.columns
    )


def _printed(value: Any, field: Field) -> str:
    if value is None:
        return ""
    if field.type == "number":
        return f"{value:.{field.decimals}f}".replace(".", ",")
    text = str(value)
    return FORMULA.sub(r"\1\2'\3", text) if field.type == "string" else text


def _code(parts: Sequence[str | None]) -> str:
    text = json.dumps(list(parts), ensure_ascii=False, separators=(",", ":"))
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return base64.b32encode(digest).decode("ascii")[:CODE_LENGTH]
