"""The database that readers use: all tables in one DuckDB file, built beside and swapped in.

A reader that has the old file open keeps reading the old tables; one that opens the file later
sees the new ones. Nobody sees half of either. What is asked of it is in `warehouse.queries.reports`
and `warehouse.queries.audit`.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Final

import duckdb
import polars as pl

from pipeline.errors import MissingKnowledgeError, UnavailableError
from pipeline.messages import say
from pipeline.tables.row import Row
from pipeline.tables.views import VIEWS
from warehouse.store.files import written_beside

if TYPE_CHECKING:
    from pipeline.tables.declare import dy

STORAGE: Final = "v1.0.0"
"""Any DuckDB since 1.1 reads the file; the newest form would shut out programs of last year."""

_HELD: Final = say(
    "another program has it open for writing. Close that program, or let it open the file to "
    "read only, and try again"
)
_SPOILT: Final = say(
    "it is damaged, or another program wrote in it. Make it again with herijk rebuild, which knows "
    "the archive"
)


def left_wal(path: Path) -> Path:
    """What another program left beside the database; DuckDB would replay it into a new one."""
    return path.with_name(f"{path.name}.wal")


def build_database(path: Path, tables: Mapping[str, pl.DataFrame]) -> None:
    """Writes the tables and the views, with key and meaning of each as a comment.

    Args:
        path: the database file; replaced at once when the new one is complete.
        tables: frames by table name; those of `pipeline.tables.schemas.TABLES` get comments.
    """
    with written_beside(path) as beside:
        beside.unlink()
        with duckdb.connect() as connection:
            connection.execute("SET threads = 1")
            connection.execute(f"ATTACH {_quoted(str(beside))} AS w (STORAGE_VERSION '{STORAGE}')")
            connection.execute("USE w; CREATE SCHEMA study")
            for name, frame in sorted(tables.items()):
                # Each comment by itself would sync the disk; all tables at once would fill memory.
                connection.execute("BEGIN")
                connection.register("frame", frame.to_arrow())
                connection.execute(f"CREATE TABLE {_place(name)} AS SELECT * FROM frame")  # noqa: S608
                connection.unregister("frame")
                _describe(connection, name)
                connection.execute("COMMIT")
            connection.execute("BEGIN")
            _add_views(connection, tables)
            connection.execute("COMMIT")
        left_wal(path).unlink(missing_ok=True)


def _place(name: str) -> str:
    """A table with its schema."""
    from pipeline.tables.schemas import STUDY  # noqa: PLC0415 - half a second that readers need not wait

    return f'study."{name}"' if name in STUDY else f'main."{name}"'


def _describe(connection: duckdb.DuckDBPyConnection, name: str) -> None:
    """What a table and its columns mean."""
    from pipeline.tables.schemas import ABOUT, TABLES  # noqa: PLC0415 - as above

    schema = (TABLES | ABOUT).get(name)
    if schema is None:
        return
    place = _place(name)
    comments = [f"COMMENT ON TABLE {place} IS {_quoted(_meaning(schema))}"]
    comments += (
        f'COMMENT ON COLUMN {place}."{column}" IS {_quoted(text)}'
        for column, text in _column_meanings(schema).items()
    )
    connection.execute(";".join(comments))  # one by one they take half as long again


def _column_meanings(schema: "type[dy.Schema]") -> dict[str, str]:
    """What the columns of a table mean, each with its unit."""
    return {
        name: f"{column.description} [{unit}]"
        if (unit := (column.metadata or {}).get("unit"))
        else str(column.description)
        for name, column in schema.columns().items()
    }


def _meaning(schema: "type[dy.Schema]") -> str:
    """What a table is, with its key."""
    key = ", ".join(schema.primary_key())
    return f"{schema.__doc__} Key: {key}." if key else str(schema.__doc__)


def _add_views(connection: duckdb.DuckDBPyConnection, tables: Mapping[str, pl.DataFrame]) -> None:
    """The views, where the tables are those of a rebuild."""
    from pipeline.tables.schemas import TABLES  # noqa: PLC0415 - as above

    if "register" not in tables:
        return
    for name, view in VIEWS.items():
        connection.execute(f'CREATE VIEW "{name}" AS {view.query}')
        connection.execute(f'COMMENT ON VIEW "{name}" IS {_quoted(view.meaning)}')
        known: dict[str, str] = {}
        for table in reversed(view.tables):
            known |= _column_meanings(TABLES[table])
        known |= view.own
        for column in connection.table(name).columns:
            connection.execute(f'COMMENT ON COLUMN "{name}"."{column}" IS {_quoted(known[column])}')


def _quoted(text: str | None) -> str:
    return "'" + (text or "").replace("'", "''") + "'"


def open_database(path: Path) -> duckdb.DuckDBPyConnection:
    """The database, to read only; tables of the schema `study` are found by their name alone.

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


def no_such_edition(edition: str, known: Iterable[str]) -> MissingKnowledgeError:
    """What to say of an edition or draft that the database does not hold."""
    return MissingKnowledgeError(
        "the last rebuild has no edition {}; it has {}. One published since is there after herijk "
        "rebuild",
        edition,
        ", ".join(sorted(known)),
    )


def rows(connection: duckdb.DuckDBPyConnection, query: str, *values: object) -> list[Row]:
    """What a query gives, a dictionary per row; `values` fill its question marks."""
    cursor = connection.execute(query, list(values))
    names = [column[0] for column in cursor.description or []]
    return [dict(zip(names, row, strict=True)) for row in cursor.fetchall()]


def is_simulated(connection: duckdb.DuckDBPyConnection) -> bool:
    """Whether the archive behind it was made by the simulator."""
    row = connection.execute("SELECT value FROM about WHERE key = 'simulated'").fetchone()
    return row is not None and row[0] == "true"
