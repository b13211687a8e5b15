"""What people decided: methods to apply, decisions about tows, and published editions."""

from typing import Final

import dagster as dg
import polars as pl

from assets.lake import Folders, incremental, make_outs
from pipeline.method.definition import Method
from warehouse.derive.registers import read_published_tables
from warehouse.store.decisions import FILE_NAME, read_decisions, tabulate_decisions
from warehouse.store.methods import KnownMethods

FACTS: Final = ("title", "title_en", "interval", "content_hash", "definition")


@dg.asset
@incremental()
def applied_methods(folders: Folders) -> pl.DataFrame:
    """Return the methods to apply, in order: the others are compared with the first."""
    rows = []
    for method in folders.get_methods():
        row = {"method": method.name, "rules": f"{method.validity} {method.interval}"}
        for name in FACTS:
            row[name] = getattr(method, name)
        rows.append(row)
    return pl.DataFrame(rows)


def read_methods(folders: Folders, table: pl.DataFrame) -> list[Method]:
    """Return the methods that the rows of a table name."""
    known = KnownMethods.from_store(folders.store)
    return list(map(known.get, table["method"]))


@dg.asset
@incremental()
def methods(applied_methods: pl.DataFrame, curves: pl.DataFrame) -> pl.DataFrame:
    """Return the methods that made the tables, in order: those of which no code of ours failed."""
    computed = applied_methods.join(curves, on="method", how="semi", maintain_order="left")
    return computed.select("method", pl.col(FACTS))


@dg.asset
@incremental()
def decisions(folders: Folders) -> pl.DataFrame:
    """Return the decisions of people about tows, in `besluiten.toml`."""
    return tabulate_decisions(read_decisions(folders.store.root / FILE_NAME))


@dg.multi_asset(
    outs=make_outs(
        "editions",
        "published_register",
        "published_register_history",
        "published_register_changes",
        "published_lineage",
    ),
    can_subset=True,
)
@incremental()
def published(folders: Folders) -> dict[str, pl.DataFrame]:
    """Return the published editions: their tables as they lie in their folders."""
    tables = read_published_tables(folders.store)
    return {
        "editions": tables["editions"],
        "published_register": tables["register"],
        "published_register_history": tables["register_history"],
        "published_register_changes": tables["register_changes"],
        "published_lineage": tables["lineage"],
    }
