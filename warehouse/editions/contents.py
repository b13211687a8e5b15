"""The files of an edition: tables, sheets, texts, and what it says of itself.

Publishing writes them, `verify` makes them again.
"""

import datetime as dt
import hashlib
import io
import json

import polars as pl

from pipeline.method.writing import method_text
from warehouse.editions import notes, sheets
from warehouse.editions.compare import compare
from warehouse.store import decisions as decided
from warehouse.store.editions import (
    ABOUT,
    CHANGES,
    CSV,
    DECISIONS,
    INPUTS,
    METHOD,
    PACKAGE,
    TABLES,
    XLSX,
    Edition,
    TableDigest,
    read_edition,
)
from warehouse.store.package import Rights
from warehouse.store.store import Store, table_digest


def contents_of(store: Store, edition: Edition, files: pl.DataFrame) -> dict[str, bytes]:
    """An edition's files: tables, sheets, texts, and last what it says of itself.

    Args:
        store: the data folder.
        edition: the edition, without its comparison with the one before.
        files: what it was made from, as `input_files` gives it.
    """
    about = edition.about
    tables = dict(edition.tables)
    previous = None
    if about.previous is not None:
        previous = compare(store, read_edition(store, about.previous), edition)
        tables[CHANGES] = previous.lines
    written = notes.texts(edition, previous)
    if edition.method is not None:
        decisions = decisions_of(store, about.published_on)
        written |= {
            METHOD: method_text(edition.method),
            DECISIONS: json.dumps([d.model_dump(mode="json") for d in decisions], indent=1),
        }
    contents = {
        CSV: sheets.csv_bytes(edition.register, sheets.SHEET_FIELDS),
        XLSX: sheets.xlsx_bytes(edition.register, sheets.SHEET_FIELDS, about),
        INPUTS: sheets.csv_bytes(files, sheets.INPUT_FIELDS),
        **{name: text.encode("utf-8") for name, text in written.items()},
        **{f"{name}.parquet": _parquet(tables[name]) for name in TABLES if name in tables},
    }
    summary, rights = notes.summary(edition), Rights.of(store)
    contents[PACKAGE] = sheets.package_bytes(about, contents, summary, rights)
    sealed = about.model_copy(
        update={
            "tables": {
                name: TableDigest(rows=frame.height, digest=table_digest(frame))
                for name, frame in tables.items()
            },
            "files": {n: hashlib.sha256(c).hexdigest() for n, c in sorted(contents.items())},
        }
    ).sealed()
    contents[ABOUT] = (sealed.model_dump_json(indent=1) + "\n").encode("utf-8")
    return contents


def _parquet(frame: pl.DataFrame) -> bytes:
    target = io.BytesIO()
    frame.write_parquet(target, compression="zstd")
    return target.getvalue()


def decisions_of(store: Store, published_on: dt.date) -> tuple[decided.Decision, ...]:
    """Decisions about tows taken up to the day of publication."""
    decisions = decided.read_decisions(store.root / decided.FILE_NAME)
    return tuple(d for d in decisions if d.datum <= published_on)
