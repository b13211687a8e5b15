"""The lines that a method gives on a day: at publication, and when an edition is made again.

Which tow counts is decided in `pipeline.register.register`; here the facts of its tow are put
beside it, and numbers are left out where no valid curve is.
"""

import datetime as dt
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import polars as pl

from pipeline.blocks.run_blocks import stack_blocks
from pipeline.errors import BrokenPromiseError, MissingKnowledgeError
from pipeline.method.definition import Method, RegisterRule
from pipeline.recompute.recompute import recompute
from pipeline.register.register import LINE, as_ruled, draft_register
from pipeline.tables.archive import Boats
from pipeline.tables.frames import dtypes
from pipeline.tables.keys import SIZES
from pipeline.tables.register import Register
from pipeline.tables.schemas import conform
from pipeline.uncertainty.ensemble import tow_ensemble
from warehouse.derive.published import decisions_of
from warehouse.editions import sheets
from warehouse.editions.inputs import INPUTS_HASH, JUDGED, tows_of_today
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
    About,
    Edition,
    edition_path,
    read_edition,
)
from warehouse.store.store import Store

SAME_NUMBER: Final = 1e-9
"""Relative difference up to which a number made again is the same.

Other processors leave other last bits, which come to no more in any table (docs/decisions/0017)."""

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


def method_lines(
    of_method: dict[str, pl.DataFrame],
    crews: pl.DataFrame,
    valid_from: dt.date,
    rule: RegisterRule,
    decisions: pl.DataFrame,
) -> pl.DataFrame:
    """The lines of a method on a day, each with the facts of its tow; numbers only where valid."""
    draft = draft_register(
        of_method["curves"], of_method["tows"], crews, valid_from, rule, decisions
    )
    valid = pl.col("status") == "valid"
    return draft.join(
        of_method["tows"].select("tow_id", *SIZES, INPUTS_HASH),
        on="tow_id",
        how="left",
        maintain_order="left",
    ).with_columns(
        *(pl.when(valid).then(pl.col(name)).alias(name) for name in (*NUMBERS, "flags")),
        pl.when(valid).then(pl.lit(MEASURED)).alias("basis"),
    )


@dataclass(frozen=True)
class Again:
    """A published edition as archive and code of today give it.

    Attributes:
        lines: its lines, for boats never towed those that it has.
        tables: its tows and runs, what the method made of them, and the members of its lines; none
            for a register as printed.
    """

    lines: pl.DataFrame
    tables: Mapping[str, pl.DataFrame]


def completed(
    store: Store, lines: pl.DataFrame, about: About, method: Method | None
) -> pl.DataFrame:
    """Lines with the facts of their boats and their verification codes, checked and sorted."""
    own = PRINTED_METHOD if method is None else method.name
    boats = store.read("boats").select("fsn_no", *BOAT_FACTS)
    named = lines.join(boats, on="fsn_no", how="left", maintain_order="left").with_columns(
        pl.lit(about.edition).alias("edition"),
        pl.when(basis=NOT_REBASED)
        .then(pl.lit(PRINTED_METHOD))
        .otherwise(pl.lit(own))
        .alias("method"),
        pl.lit(about.valid_from).alias("as_of"),
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


def made_again(store: Store, edition: Edition) -> Again:
    """Makes a published edition again, by its own method, decisions and day.

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
        path = edition_path(store, edition.about.edition)
        files = sheets.read_inputs(path)
        if not files:
            raise BrokenPromiseError("{}/{} names no file", path.name, INPUTS)
        as_printed = printed_lines(store, files[0][0])
        return Again(completed(store, as_printed, edition.about, None), {})
    known = [name for name in JUDGED if name in edition.tables["tows"].columns]
    judged = edition.tables["tows"].select("tow_id", *known)
    today = tows_of_today(store)
    tows = today.drop(JUDGED, strict=False).join(judged, on="tow_id", maintain_order="left")
    runs = intake.runs_with_windows(store).join(judged, on="tow_id", how="semi")
    blocks = stack_blocks(intake.all_blocks(store), runs)
    recomputed = recompute(edition.method, tows, blocks)
    about = edition.about
    lines = method_lines(
        {"curves": recomputed.curves, "tows": tows},
        edition.register.filter(status="never_towed"),
        about.valid_from,
        edition.method.validity,
        decisions_of(store, edition),
    )
    if about.carried_from is not None:
        printed = read_edition(store, about.carried_from)
        lines = with_carried(
            lines, printed, recomputed.log_factors, about.valid_from, edition.method
        )
    members = tow_ensemble(
        edition.method.name,
        recomputed.curves,
        as_ruled(recomputed.curves, edition.method.validity),
        recomputed.uncertainty_budget,
        recomputed.factors,
    )
    own = {"tows": today, "tow_runs": intake.runs_with_windows(store)}
    tables: dict[str, pl.DataFrame] = {
        **{name: frame.join(judged, on="tow_id", how="semi") for name, frame in own.items()},
        **{name: getattr(recomputed, name) for name in MADE},
        "ensemble": members.join(lines.drop_nulls("cw_kg_m"), on="tow_id", how="semi"),
    }
    return Again(completed(store, lines, about, edition.method), tables)
