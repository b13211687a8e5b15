"""The database that readers use: all tables in one file, made from the lake."""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import polars as pl

from pipeline.tables.declare import dy
from pipeline.tables.schemas import ABOUT, TABLES, ordered
from pipeline.tables.views import VIEWS
from warehouse.store.code import code_version
from warehouse.store.database import build_database, left_wal
from warehouse.store.files import file_sha256
from warehouse.store.package import package_is_whole, write_package
from warehouse.store.store import Store, fingerprint


def _meanings(schema: type[dy.Schema]) -> list[str]:
    return [f"{name}: {column.description}" for name, column in schema.columns().items()]


DATABASE_TABLE: Final = "warehouse_database"
"""The tables in the file, and its hash."""

MEANINGS: Final = str(
    {name: [schema.__doc__, *_meanings(schema)] for name, schema in (TABLES | ABOUT).items()}
    | VIEWS
)
"""What the file says of its tables, and its views."""


def warehouse_database(
    all_tables: dict[str, pl.DataFrame], about_archive: pl.DataFrame, store: Store
) -> pl.DataFrame:
    """All tables in one DuckDB file, swapped in whole; then those of the lake are described."""
    tables = {name: ordered(name, all_tables.pop(name)) for name in tuple(all_tables)}
    tables["about"] = _about(about_archive)
    tables["contents"] = _contents(tables)
    build_database(store.database, tables)
    about = dict(tables["about"].rows())
    write_package(store.table_folder, _files(store, tables), about, _sources(tables))
    sha256 = pl.lit(file_sha256(store.database)).alias("sha256")
    return tables["contents"].select("table", "rows", sha256)


def _files(store: Store, tables: Mapping[str, pl.DataFrame]) -> dict[Path, type[dy.Schema]]:
    """The files of the lake with the tables; of those with a file per method, the applied ones."""
    known = TABLES.keys() & tables.keys()
    methods = [None, *tables["methods"]["method"]]
    paths = {store.table_path(name, method): TABLES[name] for name in known for method in methods}
    return {path: schema for path, schema in paths.items() if path.exists()}


def _about(about_archive: pl.DataFrame) -> pl.DataFrame:
    archive = about_archive.row(0, named=True)
    about = {
        "simulated": str(archive["simulated"]).lower(),
        "code_version": code_version(),
        **{key: archive[key] for key in ("publisher", "licence") if archive[key]},
    }
    return pl.DataFrame({"key": list(about), "value": list(about.values())})


def _sources(tables: Mapping[str, pl.DataFrame]) -> list[tuple[str, str]]:
    """What the tables come from, each with a hash: the archive's files, and the methods."""
    tows = tables["tows"]
    hashes = sorted({*tows["samples_sha256"], *tows["second_sha256"].drop_nulls()})
    seasons = tows["season"].to_list()
    archive = f"samples of {tows.height} tows, {min(seasons)} to {max(seasons)}"
    methods = tables["methods"].select(pl.format("method {}", "method"), "content_hash").rows()
    return [(archive, fingerprint(hashes)), *methods]


def _contents(tables: Mapping[str, pl.DataFrame]) -> pl.DataFrame:
    """Every table with its rows and meaning, for those who open the database."""
    names = sorted(set(tables) & set(TABLES))
    return pl.DataFrame(
        {
            "table": names,
            "rows": [tables[name].height for name in names],
            "meaning": [TABLES[name].__doc__ for name in names],
        }
    )


def is_whole(store: Store) -> bool:
    """Whether the files are there as they were made; they may have been damaged since."""
    made = store.read(DATABASE_TABLE)["sha256"][0]
    left = left_wal(store.database).exists()  # a reader would replay it
    whole = store.database.exists() and not left and made == file_sha256(store.database)
    return whole and package_is_whole(store.table_folder)
