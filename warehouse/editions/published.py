"""The published editions as rows of the warehouse's tables, beside the drafts.

Editions are read as they lie; nothing is compared or computed again.
"""

import polars as pl

from warehouse.editions.folder import (
    CHANGES,
    edition_names,
    read_about,
    read_edition,
)
from warehouse.editions.lineage import lineage_rows
from warehouse.schemas import TABLES, conform
from warehouse.store import Store


def published_made_from(store: Store) -> dict[str, str]:
    """The seals of all editions: what the rows of `published_tables` are made from."""
    return {name: read_about(store.editions / name).expected_seal for name in edition_names(store)}


def published_tables(store: Store) -> dict[str, pl.DataFrame]:
    """Rows of `register`, `register_changes` and `lineage` of every published edition.

    Raises:
        BrokenPromiseError: a file of an edition is missing or damaged.
    """
    rows: dict[str, list[pl.DataFrame]] = {name: [] for name in ("register", CHANGES, "lineage")}
    for name in edition_names(store):
        edition = read_edition(store, name)
        rows["register"].append(edition.register)
        if CHANGES in edition.tables:
            rows[CHANGES].append(edition.tables[CHANGES])
        if edition.about.kind == "recomputed":
            rows["lineage"].append(lineage_rows(edition))
    return {
        table: pl.concat([TABLES[table].create_empty(), *(conform(table, f) for f in frames)])
        for table, frames in rows.items()
    }
