"""The published editions as rows of the warehouse's tables, beside the drafts.

Editions are read as they lie; nothing is compared or computed again.
"""

import polars as pl

from herijk.pipeline.errors import MissingKnowledgeError
from herijk.pipeline.recompute.facts import samples_files
from herijk.tables.column import LINE
from herijk.tables.schemas import TABLES, conform
from herijk.warehouse.store.editions import (
    CHANGES,
    Edition,
    edition_names,
    read_about,
    read_edition,
)
from herijk.warehouse.store.store import Store


def published_made_from(store: Store) -> dict[str, str]:
    """The seals of all editions: what the rows of `published_tables` are made from."""
    return {name: read_about(store.editions / name).expected_seal for name in edition_names(store)}


def published_tables(store: Store) -> dict[str, pl.DataFrame]:
    """Rows of `editions`, and of `register`, `register_changes` and `lineage` of every edition.

    Raises:
        BrokenPromiseError: a file of an edition is missing or damaged.
    """
    rows: dict[str, list[pl.DataFrame]] = {
        name: [] for name in ("editions", "register", CHANGES, "lineage")
    }
    for name in edition_names(store):
        edition = read_edition(store, name)
        rows["editions"].append(_edition_row(edition))
        rows["register"].append(_with_later_columns(edition.register))
        if CHANGES in edition.tables:
            rows[CHANGES].append(edition.tables[CHANGES])
        if edition.about.kind == "recomputed":
            rows["lineage"].append(lineage_rows(edition))
    return {
        table: pl.concat([TABLES[table].create_empty(), *(conform(table, f) for f in frames)])
        for table, frames in rows.items()
    }


def _with_later_columns(register: pl.DataFrame) -> pl.DataFrame:
    """Lines of an edition, with what was not yet said of a line when it was published."""
    columns = TABLES["register"].columns()
    missing = [n for n, column in columns.items() if column.nullable and n not in register.columns]
    return register.with_columns(pl.lit(None, columns[n].dtype).alias(n) for n in missing)


def _edition_row(edition: Edition) -> pl.DataFrame:
    """What an edition says of itself."""
    about = edition.about.model_dump(include=set(TABLES["editions"].column_names()))
    return pl.DataFrame([about]).cast(
        {"previous": pl.String, "method": pl.String, "method_hash": pl.String}
    )


def lineage_rows(edition: Edition) -> pl.DataFrame:
    """Rows of the table `lineage` of an edition: one per line and samples file."""
    if edition.about.kind == "as_printed":
        raise MissingKnowledgeError("a register as printed has no lineage")
    lines = edition.register.drop_nulls("tow_id").select("edition", *LINE, "tow_id", "method")
    return lines.join(samples_files(edition.tables["tows"]), on="tow_id").with_columns(
        pl.lit(edition.about.method_hash).alias("method_hash"),
        pl.lit(edition.about.code_version).alias("code_version"),
    )
