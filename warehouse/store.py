"""Where everything lies under the data folder, and how tables are written there.

The lake holds Parquet: the samples and the blocks of each tow, written once and named by content,
and the tables, one file per table or per partition of it (a season, a method). Each table file
carries the fingerprint of what it was made from, so that a rebuild does only what changed. What a
table means stands in `warehouse.schemas`; the database that readers use is `warehouse.database`.
"""

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import polars as pl
import pyarrow as pa  # type: ignore[import-untyped]
import pyarrow.parquet as pq  # type: ignore[import-untyped]

from pipeline.errors import BrokenPromiseError
from warehouse.files import written_beside
from warehouse.obstacles import is_obstacle

FINGERPRINT_KEY: Final = "herijk.fingerprint"
TABLE_FORM: Final = {"compression": "zstd"}


def fingerprint(*parts: Any) -> str:
    """A hash of anything that JSON can hold, equal wherever the parts are equal."""
    text = json.dumps(parts, sort_keys=True, default=str, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def table_digest(frame: pl.DataFrame) -> str:
    """A hash of a table's values as they are read: 13 significant digits, in row order."""
    lists = [c for c, dtype in frame.schema.items() if isinstance(dtype, pl.List)]
    flat = frame.with_columns(pl.col(lists).list.join("\x1f")) if lists else frame
    text = flat.write_csv(float_scientific=True, float_precision=12)
    return hashlib.sha256(text.encode()).hexdigest()


@dataclass(frozen=True)
class Store:
    """The data folder."""

    root: Path

    @property
    def database(self) -> Path:
        """The DuckDB file with all tables."""
        return self.root / "warehouse.duckdb"

    @property
    def dagster_home(self) -> Path:
        """Dagster's runs and asset history."""
        return self.root / "dagster"

    @property
    def file_hashes(self) -> Path:
        """Content hashes of archive files already seen."""
        return self.root / "lake" / "file_hashes.json"

    def samples_path(self, season: int, key: str) -> Path:
        """The samples of one tow."""
        return self.root / "lake" / "samples" / f"season={season}" / f"{key}.parquet"

    def blocks_path(self, season: int, key: str) -> Path:
        """The blocks of one tow."""
        return self.root / "lake" / "blocks" / f"season={season}" / f"{key}.parquet"

    def table_path(self, table: str, partition: str | None = None) -> Path:
        """A table, or one partition of it."""
        folder = self.root / "lake" / "tables"
        if partition is None:
            return folder / f"{table}.parquet"
        return folder / table / f"{partition}.parquet"

    def partitions(self, table: str) -> list[str]:
        """The partitions of a table that have been written, sorted."""
        folder = self.root / "lake" / "tables" / table
        return sorted(f.stem for f in folder.glob("[!.]*.parquet"))

    def write(
        self, table: str, frame: pl.DataFrame, made_from: str, partition: str | None = None
    ) -> None:
        """Writes a table or partition with the fingerprint of what it was made from."""
        write_parquet(frame, self.table_path(table, partition), {FINGERPRINT_KEY: made_from})

    def read(self, table: str, partition: str | None = None) -> pl.DataFrame:
        """A table or partition as written."""
        return read_parquet(self.table_path(table, partition))

    def read_all(self, table: str, partitions: Iterable[str] | None = None) -> pl.DataFrame:
        """Partitions of a table, one below the other: the given ones, or all."""
        chosen = self.partitions(table) if partitions is None else partitions
        return pl.concat([self.read(table, p) for p in chosen])

    def made_from(self, table: str, partition: str | None = None) -> str | None:
        """Fingerprint of what a table was made from; None if it is not there or is damaged."""
        path = self.table_path(table, partition)
        if not path.exists():
            return None
        try:
            return pl.read_parquet_metadata(path).get(FINGERPRINT_KEY)
        except _UNREADABLE as error:
            if is_obstacle(error):
                raise
            return None

    def remove(self, table: str, partition: str) -> None:
        """Removes a partition whose season or method is no more."""
        self.table_path(table, partition).unlink(missing_ok=True)


class DamagedFileError(BrokenPromiseError):
    """A file that Herijk wrote cannot be read any more; it can be made again."""

    def __init__(self, path: Path) -> None:
        super().__init__(
            f"{path} is damaged. It can be made again: run herijk rebuild; when that comes back, "
            "look at the disk"
        )
        self.path = path


_UNREADABLE: Final = (
    pa.ArrowException,
    pl.exceptions.PolarsError,
    pl.exceptions.PanicException,
    OSError,
    ValueError,
)


def read_parquet(path: Path) -> pl.DataFrame:
    """A frame that was written with `write_parquet`, its checksums verified.

    Raises:
        FileNotFoundError: it is not there.
        DamagedFileError: it was changed since, by a failing disk or by hand.
    """
    with _damage_named(path):
        table = pq.read_table(path, partitioning=None, page_checksum_verification=True)
        return pl.DataFrame(pl.from_arrow(table))


def count_rows(path: Path) -> int:
    """Rows of a frame that was written with `write_parquet`; raises as `read_parquet`."""
    with _damage_named(path):
        return int(pq.read_metadata(path).num_rows)


@contextmanager
def _damage_named(path: Path) -> Iterator[None]:
    try:
        yield
    except FileNotFoundError:
        raise
    except _UNREADABLE as error:
        if is_obstacle(error):
            raise
        raise DamagedFileError(path) from error


def write_parquet(
    frame: pl.DataFrame,
    path: Path,
    metadata: dict[str, str] | None = None,
    form: Mapping[str, Any] = TABLE_FORM,
) -> None:
    """Writes a frame as Parquet, whole or not at all, with a checksum of every page.

    Without checksums a changed byte can be read as another number.
    """
    with written_beside(path) as beside:
        pq.write_table(
            frame.to_arrow().replace_schema_metadata(metadata),
            beside,
            write_page_checksum=True,
            **form,
        )
