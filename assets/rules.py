"""What people decided: methods to apply, decisions about tows, and published editions."""

import dagster as dg
import polars as pl

from assets.lake import Folders, incremental, outs
from pipeline.method.definition import Method
from warehouse.derive.registers import published_tables
from warehouse.store.decisions import FILE_NAME, decision_table, read_decisions
from warehouse.store.methods import KnownMethods

FACTS = ("title", "title_en", "interval", "content_hash", "definition")


@dg.asset
@incremental()
def applied_methods(folders: Folders) -> pl.DataFrame:
    """The methods to apply, in order: the others are compared with the first."""
    chosen = folders.chosen_methods()
    rows = [
        {"method": m.name, "rules": f"{m.validity} {m.interval}"}
        | {name: getattr(m, name) for name in FACTS}
        for m in chosen
    ]
    return pl.DataFrame(rows)


def methods_in(folders: Folders, applied_methods: pl.DataFrame) -> list[Method]:
    """The methods of the rows of `applied_methods`."""
    known = KnownMethods.of(folders.store)
    return [known.get(name) for name in applied_methods["method"]]


@dg.asset
@incremental()
def methods(applied_methods: pl.DataFrame, curves: pl.DataFrame) -> pl.DataFrame:
    """The methods that made the tables, in order: those of which no code of ours failed."""
    made = applied_methods.join(curves, on="method", how="semi", maintain_order="left")
    return made.select("method", *FACTS)


@dg.asset
@incremental()
def decisions(folders: Folders) -> pl.DataFrame:
    """What people decided about tows, in `besluiten.toml`."""
    return decision_table(read_decisions(folders.store.root / FILE_NAME))


PUBLISHED = ("editions", "register", "register_history", "register_changes", "lineage")


@dg.multi_asset(
    outs=outs("editions", *(f"published_{name}" for name in PUBLISHED[1:])), can_subset=True
)
@incremental()
def published(folders: Folders) -> dict[str, pl.DataFrame]:
    """The published editions: their tables as they lie in their folders."""
    tables = published_tables(folders.store)
    return {name if name == "editions" else f"published_{name}": t for name, t in tables.items()}
