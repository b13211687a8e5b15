"""The database that readers use: all tables in one DuckDB file; see `warehouse.derive.database`."""

from collections.abc import Iterable
from pathlib import Path
from typing import Final

import duckdb

from pipeline.errors import MissingKnowledgeError, UnavailableError
from pipeline.messages import say
from pipeline.tables.row import Row

DATABASE_TABLE: Final = "warehouse_database"
"""The table of the lake that holds the hash of the file and what it was made of."""

_HELD: Final = say(
    "another program has it open for writing. Close that program, or let it open the file to "
    "read only, and try again"
)
_SPOILT: Final = say(
    "it is damaged, or another program wrote in it. Run herijk rebuild to make it again"
)


def open_database(path: Path) -> duckdb.DuckDBPyConnection:
    """Open the database to read; tables of the schema `study` are found by their name alone.

    Raises:
        MissingKnowledgeError: it was not made yet.
        UnavailableError: another program has it open to write, or it cannot be read.
    """
    if not path.exists():
        raise MissingKnowledgeError(
            "{} is not there; make it with: herijk rebuild --archive DIR --data {}",
            path,
            path.parent,
        )
    try:
        connection = duckdb.connect(path, read_only=True)
    except duckdb.Error as error:
        locked = isinstance(error, duckdb.IOException) and "lock" in str(error).casefold()
        raise UnavailableError(
            "{} cannot be opened: {}", path, _HELD if locked else _SPOILT
        ) from error
    connection.execute("SET search_path = 'main,study'")
    return connection


def make_unknown_edition_error(edition: str, known: Iterable[str]) -> MissingKnowledgeError:
    """Return the error about an edition or draft that the database does not hold."""
    return MissingKnowledgeError(
        "the last rebuild has no edition {}; it has {}. One published since is there after herijk "
        "rebuild",
        edition,
        ", ".join(sorted(known)),
    )


def rows(connection: duckdb.DuckDBPyConnection, query: str, *values: object) -> list[Row]:
    """Run a query; return a dictionary per row. `values` fill its question marks."""
    cursor = connection.execute(query, list(values))
    names = [column[0] for column in cursor.description or []]
    return [dict(zip(names, row, strict=True)) for row in cursor.fetchall()]


def is_simulated(connection: duckdb.DuckDBPyConnection) -> bool:
    """Return whether the archive behind a database was made by the simulator."""
    row = connection.execute("SELECT value FROM about WHERE key = 'simulated'").fetchone()
    return row is not None and row[0] == "true"
