"""The database that readers use: all tables in one DuckDB file, built beside and swapped in.

A reader that has the old file open keeps reading the old tables; one that opens the file later
sees the new ones. Nobody sees half of either.
"""

from collections.abc import Mapping
from pathlib import Path

import duckdb
import polars as pl

from warehouse.files import written_beside
from warehouse.schemas import TABLES


def build_database(path: Path, tables: Mapping[str, pl.DataFrame]) -> None:
    """Writes the tables, with the meaning of each column as a comment.

    Args:
        path: the database file; replaced at once when the new one is complete.
        tables: frames by table name; those of `warehouse.schemas.TABLES` get comments.
    """
    with written_beside(path) as beside:
        beside.unlink()
        with duckdb.connect(beside) as connection:
            connection.execute("SET threads = 1")
            connection.execute("BEGIN")  # one commit: a hundred comments would each sync the disk
            for name, frame in sorted(tables.items()):
                connection.register("frame", frame.to_arrow())
                connection.execute(f'CREATE TABLE "{name}" AS SELECT * FROM frame')  # noqa: S608
                connection.unregister("frame")
                _comment(connection, name)
            connection.execute("COMMIT")


def _comment(connection: duckdb.DuckDBPyConnection, name: str) -> None:
    schema = TABLES.get(name)
    if schema is None:
        return
    connection.execute(f'COMMENT ON TABLE "{name}" IS {_quoted(schema.__doc__)}')
    for column, definition in schema.columns().items():
        unit = (definition.metadata or {}).get("unit")
        text = f"{definition.description} [{unit}]" if unit else definition.description
        connection.execute(f'COMMENT ON COLUMN "{name}"."{column}" IS {_quoted(text)}')


def _quoted(text: str | None) -> str:
    return "'" + (text or "").replace("'", "''") + "'"
