"""The tables and files of an edition: from the samples and lists of an archive, and the same again.

Which tow counts is decided in `pipeline.register.register` and, between measured and printed lines,
in `pipeline.register.printed`. Only samples, lists and blocks are read, no tables that a rebuild
made of them; sheets and texts follow from the tables of the edition.
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
from pipeline.method.writing import write_method_text
from pipeline.recompute.recompute import recompute
from pipeline.register.printed import NOT_REBASED, carry_lines
from pipeline.register.register import (
    LINE,
    NEWER_TOW_UNMEASURED,
    TOW_DAY,
    draft_register,
    find_unmeasured_tows,
    flag_unmeasured,
)
from pipeline.tables.archive import Boats
from pipeline.tables.frames import get_dtypes
from pipeline.tables.keys import SIZES
from pipeline.tables.register import Register
from pipeline.tables.schemas import conform
from warehouse.derive.edition_lines import read_decisions_of_edition
from warehouse.derive.registers import draw_members
from warehouse.editions import notes, sheets
from warehouse.editions import printed as prints
from warehouse.editions.compare import compare
from warehouse.editions.inputs import (
    INPUTS_HASH,
    JUDGED,
    list_sources,
    read_tables_of_today,
)
from warehouse.intake import seasons as intake
from warehouse.store import decisions as decided
from warehouse.store import editions as folder
from warehouse.store.crew_classes import read_crew_classes
from warehouse.store.editions import (
    Edition,
    Manifest,
    get_edition_path,
    read_edition,
)
from warehouse.store.store import Store

BOAT_FACTS: Final = ("ht_no", "name", "boat_type")
LINE_SCHEMA: Final = (
    get_dtypes(Register)
    | {name: get_dtypes(Boats)[name] for name in BOAT_FACTS}
    | {INPUTS_HASH: pl.String(), "basis": pl.String()}
)
"""Columns of a line of an edition."""
del LINE_SCHEMA[sheets.CODE_FIELD.column]  # is over the others

OF_CURVE: Final = ("a_kg_m", "b_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m", "flags", "basis")
"""What a line of which no tow counts is without."""
MADE: Final = ("curves", "run_points", "log_factors", "season_links", "tow_instruments")
"""Tables that a method makes of the tows, and that an edition keeps."""


def make_edition(
    store: Store, manifest: Manifest, method: Method, counting: Collection[str] = ("valid",)
) -> Edition:
    """Make the edition that a method gives of the archive as it is now.

    Args:
        store: the data folder.
        manifest: its days, and the printed edition of which lines are carried over.
        method: the method.
        counting: statuses of lines that have numbers.

    Raises:
        MissingKnowledgeError: a decision is about a tow that is not in the warehouse.
    """
    decisions = decided.tabulate_decisions(read_decisions_up_to(store, manifest.published_on))
    today = read_tables_of_today(store)
    unknown = decisions.join(today["tows"], on="tow_id", how="anti")["tow_id"].to_list()
    if unknown:
        raise MissingKnowledgeError(
            "{} decides about {}, which is not a tow of the warehouse; mend the "
            "sleep_id, or take the decision out",
            decided.FILE_NAME,
            ", ".join(unknown),
        )
    crews = store.read("listed_boats")
    printed = store.read("printed_registers")
    listed = store.read("listed_tows")
    unmeasured = find_unmeasured_tows(listed, printed, today["tows"], manifest.valid_from)
    return _recompute(store, manifest, method, today, decisions, crews, unmeasured, counting)


def make_printed(store: Store, manifest: Manifest, path: str) -> Edition:
    """Make the edition that a printed register of the archive gives."""
    lines = prints.printed_lines(store, path)
    return Edition(manifest, {"register": _complete_lines(store, lines, manifest, None)}, None)


def make_again(store: Store, edition: Edition) -> Edition:
    """Make a published edition again, by its own method, decisions and day.

    Measured lines are computed from those of its tows that the warehouse still has, carried lines
    re-based again from the printed edition, and a printed register read again. What other tows
    said of a tow, and which tows had no samples, is taken as the edition has it.

    Raises:
        MissingKnowledgeError: there is no warehouse, or the archive is not there.
        BrokenPromiseError: the printed edition that lines were carried over from is damaged, or
            the list of what a printed one was made from.
    """
    if store.read_fingerprint("tows") is None:
        raise MissingKnowledgeError("there is no warehouse to make it from; run herijk rebuild")
    manifest = edition.manifest
    if edition.method is None:
        path = get_edition_path(store, manifest.edition)
        registers = list(list_sources(path, manifest))
        if len(registers) != 1:
            raise BrokenPromiseError("{} does not say which printed register it is", path.name)
        return add_changes(store, make_printed(store, manifest, registers[0]))
    own = edition.tables["tows"]
    judged = own.select("tow_id", pl.selectors.by_name(JUDGED, require_all=False))
    today = read_tables_of_today(store)
    runs = today["tow_runs"].join(own, on="tow_id", how="semi")
    tows = today["tows"].join(own, on="tow_id", how="semi").drop(JUDGED, strict=False)
    tows = tows.join(judged, on="tow_id", maintain_order="left")
    is_flagged = pl.col("flags").list.contains(NEWER_TOW_UNMEASURED)
    again = _recompute(
        store,
        manifest,
        edition.method,
        {"tows": tows, "tow_runs": runs},
        read_decisions_of_edition(store, edition),
        crews=edition.register.filter(status="never_towed"),
        unmeasured=edition.register.filter(is_flagged).select(
            pl.col(LINE), tow_date=manifest.valid_from
        ),
    )
    return add_changes(store, again)


def add_changes(store: Store, edition: Edition) -> Edition:
    """Add the comparison with the edition before, where there is one."""
    previous = _read_previous(store, edition)
    if previous is None:
        return edition
    changes = compare(store, previous, edition)
    return replace(edition, tables=edition.tables | {folder.CHANGES: changes})


def _read_previous(store: Store, edition: Edition) -> Edition | None:
    previous = edition.manifest.previous
    return None if previous is None else read_edition(store, previous)


def _recompute(
    store: Store,
    manifest: Manifest,
    method: Method,
    inputs: dict[str, pl.DataFrame],
    decisions: pl.DataFrame,
    crews: pl.DataFrame,
    unmeasured: pl.DataFrame,
    counting: Collection[str] = ("valid",),
) -> Edition:
    """Compute all tables of an edition from tows and runs; `inputs` holds both tables."""
    tows, runs = inputs["tows"], inputs["tow_runs"]
    blocks = stack_blocks(intake.read_all_blocks(store), runs)
    made = recompute(method, tows, blocks, with_bands=False, crew_classes=read_crew_classes(store))
    carried = _read_carried_lines(store, manifest, method, made.log_factors, tows)
    draft = draft_register(
        made.curves, tows, crews, manifest.valid_from, method.validity, decisions, carried
    )
    counts = pl.col("status").is_in(list(counting))
    own_hash = carried.select(pl.col(TOW_DAY), printed_sha256=INPUTS_HASH)
    lines = (
        draft.join(
            tows.select("tow_id", pl.col(SIZES), INPUTS_HASH),
            on="tow_id",
            how="left",
            maintain_order="left",
        )
        .join(own_hash, on=TOW_DAY, how="left", maintain_order="left")
        .with_columns(
            pl.coalesce(INPUTS_HASH, "printed_sha256").alias(INPUTS_HASH),
            pl.when(counts).then(pl.col(OF_CURVE)),
        )
    )
    lines = flag_unmeasured(lines, unmeasured, decisions)
    members = conform("ensemble", draw_members(method, made))
    tables = inputs | {name: conform(name, getattr(made, name)) for name in MADE}
    tables["ensemble"] = members.join(lines.drop_nulls("cw_kg_m"), on="tow_id", how="semi")
    tables["register"] = _complete_lines(store, lines, manifest, method)
    return Edition(manifest, tables, method)


def _read_carried_lines(
    store: Store, manifest: Manifest, method: Method, log_factors: pl.DataFrame, tows: pl.DataFrame
) -> pl.DataFrame:
    """Return the lines of the printed edition that is carried over; none where none is.

    Raises:
        MissingKnowledgeError: the edition is not a printed one.
    """
    if manifest.carried_from is None:
        return pl.DataFrame(schema=pl.Schema(LINE_SCHEMA))
    printed = read_edition(store, manifest.carried_from)
    if printed.manifest.kind != "as_printed":
        raise MissingKnowledgeError(
            "edition {} was recomputed; only lines of an edition as printed can be carried over",
            printed.manifest.edition,
        )
    return carry_lines(printed.register, log_factors, method, tows)


def _complete_lines(
    store: Store, lines: pl.DataFrame, manifest: Manifest, method: Method | None
) -> pl.DataFrame:
    """Add the facts of boats and the verification codes; check and sort."""
    own = prints.PRINTED_METHOD if method is None else method.name
    boats = store.read("boats").select("fsn_no", pl.col(BOAT_FACTS))
    is_printed = pl.col("basis") == NOT_REBASED
    named = lines.join(boats, on="fsn_no", how="left", maintain_order="left").with_columns(
        edition=pl.lit(manifest.edition),
        method=pl.when(is_printed).then(pl.lit(prints.PRINTED_METHOD)).otherwise(pl.lit(own)),
        as_of=pl.lit(manifest.valid_from),
    )
    missing = [pl.lit(None).alias(name) for name in LINE_SCHEMA if name not in named.columns]
    full = named.with_columns(missing).select(LINE_SCHEMA.keys()).cast(pl.Schema(LINE_SCHEMA))
    full = full.sort(LINE)
    codes = sheets.compute_verification_codes(full, None if method is None else method.content_hash)
    coded = full.with_columns(pl.Series(sheets.CODE_FIELD.column, codes, pl.String))
    conform("register", coded)
    return coded


# Files


def make_sheet_files(store: Store, edition: Edition) -> dict[str, bytes]:
    """Write the sheets, method and decisions of an edition, by file name."""
    contents = {
        folder.CSV: sheets.encode_csv(edition.register, sheets.SHEET_FIELDS),
        folder.XLSX: sheets.write_workbook(
            edition.register, sheets.SHEET_FIELDS, edition.manifest.published_on
        ),
    }
    if edition.method is not None:
        decisions = read_decisions_up_to(store, edition.manifest.published_on)
        decided_then = json.dumps([d.model_dump(mode="json") for d in decisions], indent=1)
        contents[folder.METHOD] = write_method_text(edition.method).encode("utf-8")
        contents[folder.DECISIONS] = decided_then.encode("utf-8")
    return contents


def make_edition_files(store: Store, edition: Edition) -> dict[str, bytes]:
    """Write all files of an edition, last its manifest."""
    contents = make_sheet_files(store, edition)
    for name, text in notes.texts(edition, _read_previous(store, edition)).items():
        contents[name] = text.encode("utf-8")
    for name, frame in edition.tables.items():
        target = io.BytesIO()
        frame.write_parquet(target, compression="zstd")
        contents[name + folder.PARQUET] = target.getvalue()
    hashes = {name: hashlib.sha256(c).hexdigest() for name, c in sorted(contents.items())}
    sealed = edition.manifest.model_copy(update={"files": hashes}).sealed()
    contents[folder.MANIFEST] = (sealed.model_dump_json(indent=1) + "\n").encode("utf-8")
    return contents


def read_decisions_up_to(store: Store, day: dt.date) -> tuple[decided.Decision, ...]:
    """Return the decisions about tows taken up to a day."""
    decisions = decided.read_decisions(store.root / decided.FILE_NAME)
    return tuple(d for d in decisions if d.datum <= day)
