"""A Dask cluster on loopback."""

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
