"""An edition as archive and code of today give it: to publish it, or to see whether it still is so.

Which tow counts is decided in `pipeline.register.register`; here the facts of its tow are put
beside it, and numbers are left out where no valid curve is. Nothing but samples, lists and blocks
is read: tables that a rebuild made of them are not.
"""

from typing import Final

import polars as pl

from pipeline.blocks.run_blocks import stack_blocks
from pipeline.errors import BrokenPromiseError, MissingKnowledgeError
from pipeline.method.definition import Method
from pipeline.recompute.recompute import recompute
from pipeline.register.register import LINE, draft_register
from pipeline.tables.archive import Boats
from pipeline.tables.frames import dtypes
from pipeline.tables.keys import SIZES
from pipeline.tables.register import Register
from pipeline.tables.schemas import conform
from warehouse.derive.graph import members_of
from warehouse.derive.published import decisions_of
from warehouse.editions import sheets
from warehouse.editions.inputs import INPUTS_HASH, JUDGED, tables_of_today
from warehouse.editions.printed import (
    NOT_REBASED,
    PRINTED_METHOD,
    printed_lines,
    with_carried,
)
from warehouse.intake import seasons as intake
from warehouse.store.editions import (
    INPUTS,
    MEASURED,
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
    judged: pl.DataFrame | None = None,
) -> Edition:
    """The edition that a method gives.

    Args:
        store: the data folder.
        manifest: its day, and the printed edition of which lines are carried over.
        method: the method.
        decisions: those about tows.
        never_towed: boats with their crews of which lines without a tow are made.
        judged: the tows to take, with what was judged of them; all, as they are judged now, when
            left out.
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
    lines = _with_facts(draft, tows)
    if manifest.carried_from is not None:
        printed = read_edition(store, manifest.carried_from)
        lines = with_carried(lines, printed, made.log_factors, manifest.valid_from, method)
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


def made_again(store: Store, edition: Edition) -> Edition:
    """A published edition again, by its own method, decisions and day.

    Measured lines are computed from those of its tows that the warehouse still has; lines carried
    over are re-based again from the printed edition; a printed register is read again.

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
        return as_printed(store, edition.manifest, files["path"][0])
    tows = edition.tables["tows"]
    known = [name for name in JUDGED if name in tows.columns]
    return recomputed(
        store,
        edition.manifest,
        edition.method,
        decisions_of(store, edition),
        edition.register.filter(status="never_towed"),
        tows.select("tow_id", *known),
    )


def _with_facts(draft: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Lines with the facts of their tows; numbers only where they are valid."""
    facts = tows.select("tow_id", *SIZES, INPUTS_HASH)
    valid = pl.col("status") == "valid"
    return draft.join(facts, on="tow_id", how="left", maintain_order="left").with_columns(
        *(pl.when(valid).then(pl.col(name)).alias(name) for name in (*NUMBERS, "flags")),
        pl.when(valid).then(pl.lit(MEASURED)).alias("basis"),
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
