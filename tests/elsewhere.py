"""Storage and machines other than this process: an S3 server and a Dask cluster on loopback."""

import json
import logging
import os
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

from distributed import Client
from moto.server import ThreadedMotoServer

ROOT = Path(__file__).parents[1]
BUCKET = "herijk-test"
PATIENCE_S = 120.0


@contextmanager
def s3_server() -> Iterator[None]:
    """An S3 server with an empty bucket; the environment of this process leads there."""
    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    server = ThreadedMotoServer("127.0.0.1", 0, verbose=False)
    server.start()
    host, port = server.get_host_and_port()
    address = f"http://{host}:{port}"
    there = {
        "AWS_ENDPOINT_URL": address,
        "AWS_ALLOW_HTTP": "true",
        "AWS_REGION": "us-east-1",
        "AWS_ACCESS_KEY_ID": "loopback",
        "AWS_SECRET_ACCESS_KEY": "not-a-secret",
    }
    try:
        make = urllib.request.Request(f"{address}/{BUCKET}", method="PUT")  # noqa: S310
        urllib.request.urlopen(make).close()  # noqa: S310 - our own server
        with mock.patch.dict(os.environ, there):
            yield
    finally:
        server.stop()


def lie_in_bucket(data: Path, prefix: str) -> None:
    """Settles that lake and editions of a data folder lie in the bucket."""
    data.mkdir(parents=True, exist_ok=True)
    places = {name: f"s3://{BUCKET}/{prefix}/{name}" for name in ("lake", "editions")}
    text = "".join(f'{name} = "{url}"\n' for name, url in places.items())
    (data / "opslag.toml").write_text(text, encoding="utf-8")


@dataclass(frozen=True)
class Cluster:
    """A Dask scheduler's address, and its workers: processes of one thread each."""

    address: str
    workers: list[subprocess.Popen]


@contextmanager
def dask_cluster(workers: int, dagster_home: Path) -> Iterator[Cluster]:
    """A scheduler and workers as processes of their own, all ready; stopped afterwards."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        settings = {
            "PYTHONPATH": str(ROOT),
            "DAGSTER_HOME": str(dagster_home),
            "POLARS_MAX_THREADS": "1",
            "OMP_NUM_THREADS": "1",
        }

        def start(kind: str, *options: str) -> subprocess.Popen:
            command = [sys.executable, "-m", "dask", kind, "--no-dashboard", *options]
            with (folder / f"{kind}.log").open("a") as log:
                process = subprocess.Popen(
                    command, cwd=folder, env=os.environ | settings, stdout=log, stderr=log
                )
            stack.callback(_stop, process)
            return process

        file = folder / "scheduler.json"
        start("scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file))
        address = _wait_for(file)
        options = (address, "--nthreads", "1", "--no-nanny", "--local-directory", str(folder))
        cluster = Cluster(address, [start("worker", *options) for _ in range(workers)])
        with Client(address) as client:
            client.wait_for_workers(workers, timeout=PATIENCE_S)
            client.run(__import__, "assets.cluster")  # imports take seconds, which nobody measures
        yield cluster


def _wait_for(file: Path) -> str:
    """The address that a scheduler wrote down."""
    limit = time.monotonic() + PATIENCE_S
    while time.monotonic() < limit:
        try:
            return json.loads(file.read_text())["address"]
        except (FileNotFoundError, json.JSONDecodeError):
            time.sleep(0.05)
    raise TimeoutError(f"no scheduler after {PATIENCE_S} s")


def _stop(process: subprocess.Popen) -> None:
    process.kill()
    process.wait()
