"""The database that readers use: all tables in one DuckDB file, built beside and swapped in.

A reader that has the old file open keeps reading the old tables; one that opens the file later
sees the new ones. Nobody sees half of either.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import duckdb
import polars as pl

from pipeline.tables.declare import dy
from pipeline.tables.display import find_number_form
from pipeline.tables.schemas import ABOUT, STUDY, TABLES
from pipeline.tables.views import VIEWS
from warehouse.store.code import code_version
from warehouse.store.database import DATABASE_TABLE
from warehouse.store.files import file_sha256, write_beside
from warehouse.store.store import Store

LAKE_ONLY: Final = ("ensemble",)
"""Tables that are not in the database: 200 rows per tow would make up most of it."""

IN_DATABASE: Final = tuple(name for name in TABLES if name not in LAKE_ONLY)

STORAGE: Final = "v1.0.0"
"""Any DuckDB since 1.1 reads the file; the newest form would shut out programs of last year."""


def _describe_table(schema: type[dy.Schema]) -> tuple[str, dict[str, str]]:
    """Return the meaning of a table with its key, and that of its columns, each with its unit."""
    key = ", ".join(schema.primary_key())
    meaning = f"{schema.__doc__} Key: {key}." if key else str(schema.__doc__)
    columns = {}
    for name, column in schema.columns().items():
        unit = (column.metadata or {}).get("unit")
        if unit is None and column.dtype.is_numeric():
            unit = find_number_form(name).unit
        columns[name] = f"{column.description} [{unit}]" if unit else str(column.description)
    return meaning, columns


MEANINGS: Final = {name: _describe_table(schema) for name, schema in (TABLES | ABOUT).items()}
"""What the file says of its tables and their columns."""


def describe_contents() -> str:
    """Return all that the file says of its tables, columns and views, as one text."""
    return str((MEANINGS, VIEWS))


def warehouse_database(
    tables: dict[str, pl.DataFrame],
    about_archive: pl.DataFrame,
    objection_terms: pl.DataFrame,
    store: Store,
) -> pl.DataFrame:
    """Write all tables into one DuckDB file, swapped in whole; return its contents and hash."""
    known_terms = objection_terms.filter(pl.col("value") != "")
    tables["about"] = pl.concat([_describe_archive(about_archive), known_terms])
    tables["contents"] = _list_contents(tables)
    build_database(store.database, tables)
    sha256 = pl.lit(file_sha256(store.database)).alias("sha256")
    return tables["contents"].select("table", "rows", sha256)


def find_stray_wal(path: Path) -> Path:
    """Return the path of a write-ahead log that another program left beside the database.

    DuckDB would replay it into a new database.
    """
    return path.with_name(f"{path.name}.wal")


def build_database(path: Path, tables: Mapping[str, pl.DataFrame]) -> None:
    """Write tables, and the views of them, with the meaning of each as a comment.

    Args:
        path: the database file; replaced at once when the new one is complete.
        tables: frames by table name.
    """
    with write_beside(path) as beside:
        beside.unlink()
        with duckdb.connect() as connection:
            connection.execute("SET threads = 1")
            connection.execute(f"ATTACH {_quote(str(beside))} AS w (STORAGE_VERSION '{STORAGE}')")
            connection.execute("USE w; CREATE SCHEMA study")
            for name, frame in sorted(tables.items()):
                # Each comment by itself would sync the disk; all tables at once would fill memory.
                connection.execute("BEGIN")
                _add_table(connection, name, frame)
                connection.execute("COMMIT")
            if "register" in tables:
                connection.execute("BEGIN")
                _add_views(connection)
                connection.execute("COMMIT")
            connection.execute("CHECKPOINT w")  # closing would keep silent where it does not fit
        find_stray_wal(path).unlink(missing_ok=True)


def _add_table(connection: duckdb.DuckDBPyConnection, name: str, frame: pl.DataFrame) -> None:
    place = f'study."{name}"' if name in STUDY else f'main."{name}"'
    connection.register("frame", frame.to_arrow())
    connection.execute(f"CREATE TABLE {place} AS SELECT * FROM frame")  # noqa: S608
    connection.unregister("frame")
    meaning, columns = MEANINGS.get(name, ("", {}))
    comments = [f"COMMENT ON TABLE {place} IS {_quote(meaning)}"]
    for column, text in columns.items():
        comments.append(f'COMMENT ON COLUMN {place}."{column}" IS {_quote(text)}')
    connection.execute(";".join(comments))  # one by one they take half as long again


def _add_views(connection: duckdb.DuckDBPyConnection) -> None:
    for name, view in VIEWS.items():
        connection.execute(f'CREATE VIEW "{name}" AS {view.query}')
        connection.execute(f'COMMENT ON VIEW "{name}" IS {_quote(view.meaning)}')
        known: dict[str, str] = {}
        for table in reversed(view.tables):
            known |= MEANINGS[table][1]
        known |= view.own
        for column in connection.table(name).columns:
            connection.execute(f'COMMENT ON COLUMN "{name}"."{column}" IS {_quote(known[column])}')


def _quote(text: str) -> str:
    return "'" + text.replace("'", "''") + "'"


def _describe_archive(about_archive: pl.DataFrame) -> pl.DataFrame:
    archive = about_archive.row(0, named=True)
    about = {"simulated": str(archive["simulated"]).lower(), "code_version": code_version()}
    for key in ("publisher", "licence", "crew_names", "languages"):
        if archive[key]:
            about[key] = archive[key]
    return pl.DataFrame({"key": list(about), "value": list(about.values())})


def _list_contents(tables: Mapping[str, pl.DataFrame]) -> pl.DataFrame:
    """Return every table with its rows and meaning, for those who open the database."""
    names = sorted(set(tables) & set(TABLES))
    return pl.DataFrame(
        {
            "table": names,
            "rows": [tables[name].height for name in names],
            "meaning": [TABLES[name].__doc__ for name in names],
        }
    )


def is_whole(store: Store) -> bool:
    """Return whether the database is there, byte for byte as it was made."""
    made = store.read(DATABASE_TABLE)["sha256"][0]
    left = find_stray_wal(store.database).exists()  # a reader would replay it
    return store.database.exists() and not left and made == file_sha256(store.database)
