"""A data folder as Polars frames: the tables that a rebuild made, read only."""

from pathlib import Path

import polars as pl

from pipeline.errors import MissingKnowledgeError
from pipeline.register.changes import compare_lines
from pipeline.tables.register import RegisterChanges
from warehouse.store.database import open_database
from warehouse.store.store import Store, read_parquet


class DataFolder:
    """The tables of a data folder. Each call opens the database anew and sees the last rebuild."""

    def __init__(self, root: Path) -> None:
        self._store = Store(root)
        self._database = self._store.database
        self.tables  # noqa: B018 - says at once when there is no database

    def __repr__(self) -> str:
        """Name the folder."""
        return f"DataFolder({str(self._store.root)!r})"

    @property
    def tables(self) -> dict[str, str]:
        """The tables by name, each with what a row of it is."""
        query = """
SELECT table_name, comment FROM duckdb_tables()
UNION ALL SELECT view_name, comment FROM duckdb_views() WHERE NOT internal ORDER BY ALL
"""
        return dict(self.sql(query).rows())

    def table(self, name: str) -> pl.DataFrame:
        """Return one table, whole.

        Raises:
            MissingKnowledgeError: there is no such table.
        """
        if name not in self.tables:
            raise MissingKnowledgeError(
                "there is no table {!r}; the tables are {}", name, ", ".join(self.tables)
            )
        return self.sql(f'FROM "{name}"')

    def register(self, edition: str) -> pl.DataFrame:
        """Return the lines of one edition; a draft is called `concept-<method>`.

        Raises:
            MissingKnowledgeError: there is no such edition.
        """
        lines = self.table("register")
        chosen = lines.filter(pl.col("edition") == edition)
        if chosen.is_empty():
            known = ", ".join(lines["edition"].unique().sort())
            raise MissingKnowledgeError("there is no edition {!r}; there are {}", edition, known)
        return chosen

    def samples(self, tow_id: str) -> pl.DataFrame:
        """Return the samples of one tow as `apply_method` takes them, calibrated by nothing yet.

        Raises:
            MissingKnowledgeError: there is no such tow.
        """
        tow = self.sql("SELECT tow_id, season FROM tows").filter(pl.col("tow_id") == tow_id)
        if tow.is_empty():
            raise MissingKnowledgeError("there is no tow {!r} in the table tows", tow_id)
        season = int(tow["season"][0])
        index = self._store.read("samples").filter(season=season)
        key = str(index.filter(pl.col("tow_id") == tow_id)["samples_key"][0])
        return read_parquet(self._store.samples_path(season, key))

    def sql(self, query: str) -> pl.DataFrame:
        """Return the result of an SQL query; nothing can be written."""
        with open_database(self._database) as connection:
            return pl.DataFrame(connection.sql(query).pl())


def open_data(folder: str | Path) -> DataFolder:
    """Return the tables of a data folder that `herijk rebuild` made.

    Raises:
        MissingKnowledgeError: nothing was rebuilt there.
    """
    return DataFolder(Path(folder))


def compare_registers(old: pl.DataFrame, new: pl.DataFrame) -> pl.DataFrame:
    """Compare two registers, per boat and crew.

    Args:
        old, new: rows of `DataFolder.register`, each of one edition.

    Returns:
        Rows of the table `register_changes`: `cw_ratio`, `power_ratio`, `time_ratio` are new over
        old at the old declared speed.
    """
    return compare_lines(old, new).select(RegisterChanges.column_names())
