"""A Dask cluster on loopback, and whether what they made is what is made here."""

import hashlib
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from polars.testing import assert_frame_equal

from warehouse.derive.database import DATABASE_TABLE
from warehouse.intake.seasons import INDEXED
from warehouse.store.store import Store, read_parquet

ROOT = Path(__file__).parents[1]
PATIENCE_S = 120.0


@dataclass(frozen=True)
class Cluster:
    """A Dask scheduler's address, and its workers: processes of one thread each."""

    address: str
    workers: list[subprocess.Popen[bytes]]


@contextmanager
def dask_cluster(workers: int, dagster_home: Path) -> Iterator[Cluster]:
    """A scheduler and workers as processes of their own, all there; stopped afterwards."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        settings = {
            "PYTHONPATH": str(ROOT),
            "DAGSTER_HOME": str(dagster_home),
            "POLARS_MAX_THREADS": "1",
            "OMP_NUM_THREADS": "1",
            "OPENBLAS_NUM_THREADS": "1",
            "DASK_DISTRIBUTED__SCHEDULER__WORK_STEALING": "False",
        }
        file = folder / "scheduler.json"

        def start(kind: str, *options: str) -> subprocess.Popen[bytes]:
            shared = ("--no-dashboard", "--scheduler-file", str(file))
            command = [sys.executable, "-m", "dask", kind, *shared, *options]
            with (folder / f"{kind}.log").open("a") as log:
                process = subprocess.Popen(
                    command, cwd=folder, env=os.environ | settings, stdout=log, stderr=log
                )
            stack.callback(_stop, process)
            return process

        start("scheduler", "--host", "127.0.0.1", "--port", "0")
        alone = ("--nthreads", "1", "--no-nanny", "--local-directory", str(folder))
        started = [start("worker", *alone) for _ in range(workers)]  # they wait for the file
        address = _wait_for(file)
        if workers:
            from distributed import Client  # noqa: PLC0415 - takes seconds to import

            with Client(address) as client:
                client.wait_for_workers(workers, timeout=PATIENCE_S)
        yield Cluster(address, started)


def _wait_for(file: Path) -> str:
    """The address that a scheduler wrote down."""
    limit = time.monotonic() + PATIENCE_S
    while time.monotonic() < limit:
        try:
            return str(json.loads(file.read_text())["address"])
        except (FileNotFoundError, json.JSONDecodeError):
            time.sleep(0.05)
    raise TimeoutError(f"no scheduler after {PATIENCE_S} s")


def _stop(process: subprocess.Popen[bytes]) -> None:
    process.kill()
    process.wait()


def assert_same_lake(one: Store, other: Store) -> None:
    """Samples, blocks and tables are the same and made from the same, wherever they lie.

    The hash of the database file is of no concern: DuckDB never writes the same bytes twice. Nor is
    what lists were made from: they name it only where the archive had lain still for a while.
    """
    files, others = _files_below(one.lake), _files_below(other.lake)
    assert files.keys() == others.keys()
    for name in files.keys() - {f"tables/{DATABASE_TABLE}.parquet"}:
        assert_frame_equal(read_parquet(files[name]), read_parquet(others[name]), check_exact=True)
    made = {_table(name) for name in files if name.startswith("tables/")}
    for table, partition in made - {(table, None) for table in INDEXED}:
        assert one.made_from(table, partition) == other.made_from(table, partition), table


def _files_below(folder: Path, above: str = "") -> dict[str, Path]:
    """Parquet files at any depth below a folder, by path."""
    found: dict[str, Path] = {}
    for below in folder.iterdir():
        if below.name.endswith(".parquet"):
            found[above + below.name] = below
        elif not below.name.endswith(".json"):  # the cache of hashes stays on the machine
            found |= _files_below(below, f"{above}{below.name}/")
    return found


def _table(name: str) -> tuple[str, str | None]:
    """Table and partition that lie under a path of the lake."""
    table, _, partition = name.removeprefix("tables/").removesuffix(".parquet").partition("/")
    return table, partition or None


def edition_hashes(store: Store, edition: str) -> dict[str, str]:
    """SHA-256 of every file of an edition, by name."""
    files = (store.editions / edition).iterdir()
    return {file.name: hashlib.sha256(file.read_bytes()).hexdigest() for file in files}
