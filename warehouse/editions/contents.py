"""The files of an edition: tables, sheets, texts, and its manifest.

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
    CHANGES,
    CSV,
    DECISIONS,
    INPUTS,
    MANIFEST,
    METHOD,
    PARQUET,
    XLSX,
    Edition,
    read_edition,
)
from warehouse.store.store import Store


def contents_of(store: Store, edition: Edition, files: pl.DataFrame) -> dict[str, bytes]:
    """An edition's files: tables, sheets, texts, and last its manifest.

    Args:
        store: the data folder.
        edition: the edition, without its comparison with the one before.
        files: what it was made from, as `input_files` gives it.
    """
    manifest = edition.manifest
    tables = dict(edition.tables)
    previous = None
    if manifest.previous is not None:
        previous = compare(store, read_edition(store, manifest.previous), edition)
        tables[CHANGES] = previous.lines
    written = notes.texts(edition, previous)
    if edition.method is not None:
        decisions = decisions_up_to(store, manifest.published_on)
        written |= {
            METHOD: method_text(edition.method),
            DECISIONS: json.dumps([d.model_dump(mode="json") for d in decisions], indent=1),
        }
    contents = {
        CSV: sheets.csv_bytes(edition.register, sheets.SHEET_FIELDS),
        XLSX: sheets.xlsx_bytes(edition.register, sheets.SHEET_FIELDS, manifest),
        INPUTS: sheets.csv_bytes(files, sheets.INPUT_FIELDS),
        **{name: text.encode("utf-8") for name, text in written.items()},
        **{name + PARQUET: _parquet(frame) for name, frame in tables.items()},
    }
    hashes = {name: hashlib.sha256(c).hexdigest() for name, c in sorted(contents.items())}
    sealed = manifest.model_copy(update={"files": hashes}).sealed()
    contents[MANIFEST] = (sealed.model_dump_json(indent=1) + "\n").encode("utf-8")
    return contents


def _parquet(frame: pl.DataFrame) -> bytes:
    target = io.BytesIO()
    frame.write_parquet(target, compression="zstd")
    return target.getvalue()


def decisions_up_to(store: Store, day: dt.date) -> tuple[decided.Decision, ...]:
    """Decisions about tows taken up to a day."""
    decisions = decided.read_decisions(store.root / decided.FILE_NAME)
    return tuple(d for d in decisions if d.datum <= day)
