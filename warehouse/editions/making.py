"""An edition as archive and code of today give it: to publish it, or to see whether it still is so.

Which tow counts is decided in `pipeline.register.register`; here the facts of its tow are put
beside it, and numbers are left out where no valid curve is. Nothing but samples, lists and blocks
is read: tables that a rebuild made of them are not. Sheets and texts follow from the tables.
"""

import datetime as dt
import hashlib
import io
import json
from collections.abc import Collection
from dataclasses import replace
from typing import Final

import polars as pl

from pipeline.blocks.run_blocks import stack_blocks
from pipeline.errors import BrokenPromiseError, MissingKnowledgeError
from pipeline.method.definition import Method
from pipeline.method.writing import method_text
from pipeline.recompute.recompute import recompute
from pipeline.register.register import (
    LINE,
    NEWER_TOW_UNMEASURED,
    draft_register,
    flag_unmeasured,
)
from pipeline.tables.archive import Boats
from pipeline.tables.frames import dtypes
from pipeline.tables.keys import SIZES
from pipeline.tables.register import Register
from pipeline.tables.schemas import conform
from warehouse.derive.registers import decisions_of, members_of
from warehouse.editions import notes, sheets
from warehouse.editions.compare import compare
from warehouse.editions.inputs import INPUTS_HASH, JUDGED, tables_of_today
from warehouse.editions.printed import (
    NOT_REBASED,
    PRINTED_METHOD,
    carry_over,
    printed_lines,
)
from warehouse.intake import seasons as intake
from warehouse.store import decisions as decided
from warehouse.store.editions import (
    CHANGES,
    CSV,
    DECISIONS,
    INPUTS,
    MANIFEST,
    MEASURED,
    METHOD,
    PARQUET,
    XLSX,
    Edition,
    Manifest,
    edition_path,
    read_edition,
)
from warehouse.store.store import Store

BOAT_FACTS: Final = ("ht_no", "name", "boat_type")
LINE_SCHEMA: Final = {
    **{n: c.dtype for n, c in Register.columns().items() if n != sheets.CODE_FIELD.column},
    **{name: dtypes(Boats)[name] for name in BOAT_FACTS},
    INPUTS_HASH: pl.String(),
    "basis": pl.String(),
}
"""What an edition says of a line, but for its verification code."""
NUMBERS: Final = ("a_kg_m", "b_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m")

MADE: Final = ("curves", "run_points", "log_factors", "season_links", "tow_instruments")
"""What a method makes of the tows, and an edition keeps."""


def recomputed(
    store: Store,
    manifest: Manifest,
    method: Method,
    decisions: pl.DataFrame,
    never_towed: pl.DataFrame,
    unmeasured: pl.DataFrame,
    judged: pl.DataFrame | None = None,
    counting: Collection[str] = ("valid",),
) -> Edition:
    """The edition that a method gives.

    Args:
        store: the data folder.
        manifest: its day, and the printed edition of which lines are carried over.
        method: the method.
        decisions: those about tows.
        never_towed: boats with their crews of which lines without a tow are made.
        unmeasured: rows of `unmeasured_tows`, the newest tows that have no samples.
        judged: the tows to take, with what was judged of them; all, as they are judged now, when
            left out.
        counting: statuses of lines that have numbers.
    """
    today = tables_of_today(store)
    if judged is not None:
        today = {name: t.join(judged, on="tow_id", how="semi") for name, t in today.items()}
    tows, runs = today.values()
    if judged is not None:
        tows = tows.drop(JUDGED, strict=False).join(judged, on="tow_id", maintain_order="left")
    blocks = stack_blocks(intake.all_blocks(store), runs)
    made = recompute(method, tows, blocks, with_bands=False)
    draft = draft_register(
        made.curves, tows, never_towed, manifest.valid_from, method.validity, decisions
    )
    lines = _with_facts(draft, tows, counting)
    if manifest.carried_from is not None:
        printed = read_edition(store, manifest.carried_from)
        lines = carry_over(lines, printed, made.log_factors, method, tows, manifest.valid_from)
    lines = flag_unmeasured(lines, unmeasured, decisions)
    tables = {
        **today,
        **{name: conform(name, getattr(made, name)) for name in MADE},
        "ensemble": conform("ensemble", members_of(method, made)).join(
            lines.drop_nulls("cw_kg_m"), on="tow_id", how="semi"
        ),
        "register": _completed(store, lines, manifest, method),
    }
    return Edition(manifest, tables, method)


def as_printed(store: Store, manifest: Manifest, path: str) -> Edition:
    """The edition that a printed register of the archive gives."""
    lines = printed_lines(store, path)
    return Edition(manifest, {"register": _completed(store, lines, manifest, None)}, None)


def with_changes(store: Store, edition: Edition) -> Edition:
    """The edition with its comparison with the one before, where there is one."""
    previous = _previous(store, edition)
    if previous is None:
        return edition
    changes = compare(store, previous, edition)
    return replace(edition, tables={**edition.tables, CHANGES: changes})


def _previous(store: Store, edition: Edition) -> Edition | None:
    previous = edition.manifest.previous
    return None if previous is None else read_edition(store, previous)


def made_again(store: Store, edition: Edition) -> Edition:
    """A published edition again, by its own method, decisions and day.

    Measured lines are computed from those of its tows that the warehouse still has; lines carried
    over are re-based again from the printed edition; a printed register is read again. Which lines
    have a newer tow without samples is taken as the edition has it.

    Raises:
        MissingKnowledgeError: there is no warehouse, or the archive is not there.
        BrokenPromiseError: the printed edition that lines were carried over from is damaged, or
            the list of what a printed one was made from.
    """
    if store.made_from("tows") is None:
        raise MissingKnowledgeError("there is no warehouse to make it from; run herijk rebuild")
    if edition.method is None:
        path = edition_path(store, edition.manifest.edition)
        files = sheets.read_inputs(path)
        if files.is_empty():
            raise BrokenPromiseError("{}/{} names no file", path.name, INPUTS)
        return with_changes(store, as_printed(store, edition.manifest, files["path"][0]))
    tows = edition.tables["tows"]
    known = [name for name in JUDGED if name in tows.columns]
    again = recomputed(
        store,
        edition.manifest,
        edition.method,
        decisions_of(store, edition),
        edition.register.filter(status="never_towed"),
        edition.register.filter(pl.col("flags").list.contains(NEWER_TOW_UNMEASURED)).select(
            *LINE, tow_date=edition.manifest.valid_from
        ),
        tows.select("tow_id", *known),
    )
    return with_changes(store, again)


def _with_facts(draft: pl.DataFrame, tows: pl.DataFrame, counting: Collection[str]) -> pl.DataFrame:
    """Lines with the facts of their tows; numbers only where they count."""
    facts = tows.select("tow_id", *SIZES, INPUTS_HASH)
    counts = pl.col("status").is_in(list(counting))
    return draft.join(facts, on="tow_id", how="left", maintain_order="left").with_columns(
        *(pl.when(counts).then(pl.col(name)).alias(name) for name in (*NUMBERS, "flags")),
        pl.when(counts).then(pl.lit(MEASURED)).alias("basis"),
    )


def _completed(
    store: Store, lines: pl.DataFrame, manifest: Manifest, method: Method | None
) -> pl.DataFrame:
    """Lines with the facts of their boats and their verification codes, checked and sorted."""
    own = PRINTED_METHOD if method is None else method.name
    boats = store.read("boats").select("fsn_no", *BOAT_FACTS)
    named = lines.join(boats, on="fsn_no", how="left", maintain_order="left").with_columns(
        pl.lit(manifest.edition).alias("edition"),
        pl.when(basis=NOT_REBASED)
        .then(pl.lit(PRINTED_METHOD))
        .otherwise(pl.lit(own))
        .alias("method"),
        pl.lit(manifest.valid_from).alias("as_of"),
    )
    missing = [pl.lit(None).alias(name) for name in LINE_SCHEMA if name not in named.columns]
    full = (
        named.with_columns(missing)
        .select(pl.col(name).cast(dtype) for name, dtype in LINE_SCHEMA.items())
        .sort(LINE)
    )
    codes = sheets.verification_codes(full, None if method is None else method.content_hash)
    coded = full.with_columns(pl.Series(sheets.CODE_FIELD.column, codes, pl.String))
    conform("register", coded)
    return coded


# Files


def sheets_and_texts(store: Store, edition: Edition, files: pl.DataFrame) -> dict[str, bytes]:
    """What people read of an edition, by file name: all of it follows from its tables.

    Args:
        store: the data folder.
        edition: the edition, with its comparison with the one before.
        files: what it was made from, as `input_files` gives it.
    """
    manifest = edition.manifest
    written = notes.texts(edition, _previous(store, edition))
    if edition.method is not None:
        decisions = decisions_up_to(store, manifest.published_on)
        written |= {
            METHOD: method_text(edition.method),
            DECISIONS: json.dumps([d.model_dump(mode="json") for d in decisions], indent=1),
        }
    return {
        CSV: sheets.csv_bytes(edition.register, sheets.SHEET_FIELDS),
        XLSX: sheets.xlsx_bytes(edition.register, sheets.SHEET_FIELDS, manifest),
        INPUTS: sheets.csv_bytes(files, sheets.INPUT_FIELDS),
        **{name: text.encode("utf-8") for name, text in written.items()},
    }


def contents_of(store: Store, edition: Edition, files: pl.DataFrame) -> dict[str, bytes]:
    """All files of an edition, last its manifest; takes arguments as `sheets_and_texts`."""
    contents = sheets_and_texts(store, edition, files)
    for name, frame in edition.tables.items():
        target = io.BytesIO()
        frame.write_parquet(target, compression="zstd")
        contents[name + PARQUET] = target.getvalue()
    hashes = {name: hashlib.sha256(c).hexdigest() for name, c in sorted(contents.items())}
    sealed = edition.manifest.model_copy(update={"files": hashes}).sealed()
    contents[MANIFEST] = (sealed.model_dump_json(indent=1) + "\n").encode("utf-8")
    return contents


def decisions_up_to(store: Store, day: dt.date) -> tuple[decided.Decision, ...]:
    """Decisions about tows taken up to a day."""
    decisions = decided.read_decisions(store.root / decided.FILE_NAME)
    return tuple(d for d in decisions if d.datum <= day)
