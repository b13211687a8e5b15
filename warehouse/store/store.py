"""Where everything of a data folder lies, and how tables are written there.

The lake holds Parquet: the samples and the blocks of each tow, written once and named by content,
and the tables, one file per table or per partition of it (a season, a method). Each table file
carries the fingerprint of what it was made from, so that a rebuild does only what changed. What a
table means is in `tables.schemas`; the database that readers use is `warehouse.store.database`.
"""

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Self

import polars as pl
import pyarrow as pa  # type: ignore[import-untyped]
import pyarrow.parquet as pq  # type: ignore[import-untyped]

from pipeline.errors import BrokenPromiseError, MissingKnowledgeError
from pipeline.messages import say
from warehouse.store.files import write_beside
from warehouse.store.machine_faults import is_machine_fault

FINGERPRINT_KEY: Final = "herijk.fingerprint"
CONTENTS_KEY: Final = "herijk.contents"
FAILED_KEY: Final = "herijk.failed"


def fingerprint(*parts: object) -> str:
    """Return a hash of anything that JSON can hold, equal wherever the parts are equal."""
    text = json.dumps(parts, sort_keys=True, default=str, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


@dataclass(frozen=True)
class Store:
    """The data folder."""

    root: Path

    @property
    def lake(self) -> Path:
        """Samples, blocks and tables."""
        return self.root / "lake"

    @property
    def editions(self) -> Path:
        """The published editions, each under its name."""
        return self.root / "editions"

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
        """Content hashes of archive files already seen: a cache, of this machine only."""
        return self.lake / "file_hashes.json"

    def samples_path(self, season: int, key: str) -> Path:
        """Return the path of the samples of one tow."""
        return self.lake / "samples" / f"season={season}" / f"{key}.parquet"

    def blocks_path(self, season: int, key: str) -> Path:
        """Return the path of the blocks of one tow."""
        return self.lake / "blocks" / f"season={season}" / f"{key}.parquet"

    @property
    def table_folder(self) -> Path:
        """The tables."""
        return self.lake / "tables"

    def table_path(self, table: str) -> Path:
        """Return the path of a table."""
        return self.table_folder / f"{table}.parquet"

    def write(self, table: str, frame: pl.DataFrame, made_from: str = "", failed: str = "") -> None:
        """Write a table with the fingerprint of what it was made from."""
        about = {FINGERPRINT_KEY: made_from, CONTENTS_KEY: digest_contents(table, frame)}
        about |= {FAILED_KEY: failed} if failed else {}
        write_parquet(frame, self.table_path(table), about)

    def read(
        self, table: str, method: str | None = None, columns: Sequence[str] | None = None
    ) -> pl.DataFrame:
        """Read a table as written, or its rows of one method, or some of its columns."""
        asked = columns
        if method is not None and columns is not None:
            asked = list(set(columns) | {"method"})
        frame = read_parquet(self.table_path(table), asked)
        if method is None:
            return frame
        own = frame.filter(pl.col("method") == method)
        return own if columns is None else own.select(columns)

    def read_fingerprint(self, table: str) -> str | None:
        """Return the fingerprint of the inputs of a table; None if it is missing or damaged."""
        return read_file_metadata(self.table_path(table), FINGERPRINT_KEY)

    def contents(self, table: str) -> str | None:
        """Hash of what is in a table: equal for equal tables, whatever they were made from."""
        return read_file_metadata(self.table_path(table), CONTENTS_KEY)

    def get_failure(self, table: str) -> str | None:
        """Return the traceback of a table whose rows are missing because our code failed."""
        return read_file_metadata(self.table_path(table), FAILED_KEY)

    def count_rows(self, table: str) -> int:
        """Return the number of rows of a table; raises as `read_parquet`."""
        return count_rows(self.table_path(table))


def digest_contents(name: str, frame: pl.DataFrame) -> str:
    """Return a hash of what a table says; where an archive lies says nothing about it."""
    told = frame.drop("root") if name == "about_archive" else frame
    hashed = hashlib.sha256(str(told.schema).encode())
    hashed.update(told.write_ipc(None, compat_level=pl.CompatLevel.oldest()).getbuffer())
    return hashed.hexdigest()


def find_archive_root(store: Store) -> Path | None:
    """Return where the archive was at the last rebuild; None if it is not there now."""
    if store.read_fingerprint("about_archive") is None:
        return None
    root = Path(store.read("about_archive")["root"][0])
    return root if root.is_dir() else None


def make_no_warehouse_error(store: Store) -> MissingKnowledgeError:
    """Return the error about a data folder in which nothing was ever rebuilt."""
    return MissingKnowledgeError(
        "{} holds no warehouse; make it with: herijk rebuild --archive DIR --data {}",
        store.root,
        store.root,
    )


class DamagedFileError(BrokenPromiseError):
    """A file that Herijk wrote cannot be read any more; it can be made again."""

    def __init__(self, path: Path) -> None:
        super().__init__(
            say(
                "{} is damaged. Run herijk rebuild to make it again; if this recurs, check the disk"
            ),
            path,
        )
        self.path = path

    def __reduce__(self) -> tuple[type[Self], tuple[Path]]:
        return type(self), (self.path,)  # a helping process hands it over by its path


_UNREADABLE: Final = (
    pa.ArrowException,
    pl.exceptions.PolarsError,
    pl.exceptions.PanicException,
    OSError,
    ValueError,
)


def read_parquet(
    path: Path, columns: Sequence[str] | None = None, use_threads: bool = True
) -> pl.DataFrame:
    """Read a frame that was written with `write_parquet`, and verify its checksums.

    Args:
        path: the file.
        columns: those to read; None for all.
        use_threads: decode columns side by side; not where files already are.

    Raises:
        FileNotFoundError: it is not there.
        DamagedFileError: it was changed since, by a failing disk or by hand.
    """
    # Not read_table: it imports Arrow's data sets, and with them pandas if that is there.
    with _damage_named(path), pq.ParquetFile(path, page_checksum_verification=True) as file:
        return pl.DataFrame(pl.from_arrow(file.read(columns, use_threads=use_threads)))


def read_file_metadata(path: Path, key: str) -> str | None:
    """Return the metadata of a file under a key; None if it has none or is damaged."""
    if not path.exists():
        return None
    try:
        stored = (pq.read_metadata(path).metadata or {}).get(key.encode())
        return None if stored is None else bytes(stored).decode()
    except _UNREADABLE as error:
        if is_machine_fault(error):
            raise
        return None


def count_rows(path: Path) -> int:
    """Return the number of rows of a Parquet file of ours; raises as `read_parquet`."""
    with _damage_named(path):
        return int(pq.read_metadata(path).num_rows)


@contextmanager
def _damage_named(path: Path) -> Iterator[None]:
    try:
        yield
    except FileNotFoundError:
        raise
    except _UNREADABLE as error:
        if is_machine_fault(error):
            raise
        raise DamagedFileError(path) from error


def write_parquet(
    frame: pl.DataFrame,
    path: Path,
    metadata: dict[str, str] | None = None,
    form: Mapping[str, object] | None = None,
) -> None:
    """Write a frame as Parquet, whole or not at all, with a checksum of every page.

    Without checksums a changed byte can be read as another number.

    Args:
        frame: what to write.
        path: where.
        metadata: what else the file says.
        form: how it is packed, in the words of Arrow; None for the form of tables.
    """
    table = frame.to_arrow()
    fields = []
    for field, column in zip(table.schema, table.columns, strict=True):
        fields.append(field.with_nullable(column.null_count > 0))  # read in half the time if not
    tight = pa.Table.from_arrays(table.columns, schema=pa.schema(fields))
    packed = _table_form(table.schema) if form is None else form
    with (
        write_beside(path) as target,
        pq.ParquetWriter(target, tight.schema, write_page_checksum=True, **packed) as writer,
    ):
        writer.write_table(tight)
        if metadata is not None:
            writer.add_key_value_metadata(metadata)


def _table_form(schema: pa.Schema) -> dict[str, object]:
    """Return how a table is packed: without a dictionary where most numbers occur once."""
    numbers = [column.name for column in schema if pa.types.is_floating(column.type)]
    others = [column.name for column in schema if column.name not in numbers]
    return {
        "compression": "zstd",
        "use_byte_stream_split": numbers,
        "use_dictionary": others,
    }
