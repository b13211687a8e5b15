"""Tables of an archive up to the registers, made without Dagster: what editions are made from."""

import datetime as dt
import hashlib
from collections.abc import Sequence
from pathlib import Path

import polars as pl

from pipeline.method.definition import Method
from pipeline.tables.schemas import TABLES, conform
from warehouse.derive.archive_tables import add_first_seen, read_archive, read_earlier
from warehouse.derive.database import build_database
from warehouse.derive.recomputing import ArchiveRuns, recompute_archive
from warehouse.derive.registers import read_published_tables, register_tables
from warehouse.store.decisions import FILE_NAME, read_decisions, tabulate_decisions
from warehouse.store.store import Store


def digest_table(frame: pl.DataFrame) -> str:
    """Return a hash of a table's values as they are read: 13 significant digits, in row order."""
    lists = [c for c, dtype in frame.schema.items() if isinstance(dtype, pl.List)]
    flat = frame.with_columns(pl.col(lists).list.join("\x1f")) if lists else frame
    text = flat.write_csv(float_scientific=True, float_precision=12)
    return hashlib.sha256(text.encode()).hexdigest()


def make_tables(store: Store, archive: Path, methods: Sequence[Method], today: dt.date) -> None:
    """Read the archive and compute curves and registers under some methods."""
    read_archive(store, archive, today)
    if methods:
        compute_tables(store, methods, today)


def fill_database(store: Store, tables: dict[str, pl.DataFrame]) -> None:
    """Make a database of some tables of a simulated archive; the others are empty."""
    empty = {name: schema.create_empty() for name, schema in TABLES.items()}
    about = pl.DataFrame({"key": ["simulated"], "value": ["true"]})
    build_database(store.database, empty | {"about": about} | tables)


def compute_tables(store: Store, methods: Sequence[Method], today: dt.date) -> None:
    """Compute curves and registers from the tables about the archive as they are in the lake."""
    names = ("boats", "tows", "tow_runs", "hand_windows", "blocks", "crew_classes")
    archive = ArchiveRuns(**{name: store.read(name) for name in names})
    made = recompute_archive(methods, archive)
    earlier = store.read("quarantine")
    failed = conform("quarantine", add_first_seen(made.set_aside, earlier, today))
    tables = made.tables | {
        "tows": made.tows,
        "tow_runs": made.tow_runs,
        "quarantine": pl.concat([earlier, failed]),
        "methods": pl.DataFrame([describe(method) for method in methods]),
    }
    for name, frame in tables.items():
        store.write(name, conform(name, frame))
    make_registers(store, methods)


def make_registers(store: Store, methods: Sequence[Method]) -> None:
    """Make the drafts and their lineage, beside the editions that are published."""
    published = read_published_tables(store)
    made = register_tables(
        curves=store.read("curves"),
        tows=store.read("tows"),
        boats=store.read("boats"),
        listed_boats=store.read("listed_boats"),
        listed_races=store.read("listed_races"),
        listed_tows=store.read("listed_tows"),
        printed_registers=store.read("printed_registers"),
        log_factors=store.read("log_factors"),
        decisions=tabulate_decisions(read_decisions(store.root / FILE_NAME)),
        published=published,
        correction_steps=read_earlier(store, "correction_steps"),
        crew_classes=store.read("crew_classes"),
        methods=methods,
    )
    for name, frame in (made | {"editions": published["editions"]}).items():
        store.write(name, conform(name, frame))


def describe(method: Method) -> dict[str, object]:
    """Return a row of `methods`."""
    columns = TABLES["methods"].column_names()
    return {"method": method.name} | {n: getattr(method, n) for n in columns if n != "method"}
