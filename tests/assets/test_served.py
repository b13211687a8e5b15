"""`herijk serve` as people use it: its processes, its page, and what the daemon does by itself."""

import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from tests.conftest import METHODS
from warehouse.derive.inputs import ARCHIVE_TABLES

ROOT = Path(__file__).parents[2]
PATIENCE_S = 600

RUNS = "{runsOrError {... on Runs {results {jobName status}}}}"
BACKFILL = """mutation ($what: LaunchBackfillParams!) {
  launchPartitionBackfill(backfillParams: $what) {... on LaunchBackfillSuccess {backfillId}}
}"""
BACKFILLED = """query ($id: String!) {
  partitionBackfillOrError(backfillId: $id) {... on PartitionBackfill {status}}
}"""


@contextmanager
def served(bench):
    """Serves; gives a function that asks Dagster's page something, once that is there."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
    folders = ("--archive", str(bench.archive), "--data", str(bench.data))
    process = subprocess.Popen(
        [sys.executable, "-m", "herijk", "serve", *folders, "--port", str(port), "--may-start"],
        cwd=ROOT, env=os.environ | {"LC_ALL": "C"},
    )  # fmt: skip

    def ask(query, **variables):
        request = urllib.request.Request(
            f"http://127.0.0.1:{port}/graphql",
            json.dumps({"query": query, "variables": variables}).encode(),
            {"Content-Type": "application/json"},
        )
        with urllib.request.urlopen(request) as answer:  # noqa: S310
            (found,) = json.load(answer)["data"].values()
        return found

    try:
        yield ask
    finally:
        process.send_signal(signal.SIGINT)
        assert process.wait(PATIENCE_S) == 0


def wait_for(look):
    """Looks until something is so; the page takes a while to answer at all."""
    for _ in range(PATIENCE_S):
        with suppress(OSError):
            if look():
                return
        time.sleep(1)
    raise TimeoutError


def lose(bench, season):
    """Takes away what was made of a season."""
    for kind in ("samples", "blocks"):
        shutil.rmtree(bench.data / "lake" / kind / f"season={season}")
    for table in (f"season_index/{season}", f"blocks/{season}", "tows"):
        (bench.data / "lake" / "tables" / f"{table}.parquet").unlink()


@pytest.mark.slow
def test_a_rebuild_begins_by_itself_and_a_season_is_backfilled_with_what_follows(bench, built):
    (bench.data / "beheer.toml").write_text(f"methods = {list(METHODS)}")
    lose(bench, 2014)
    with served(bench) as ask:
        wait_for(lambda: {"jobName": "rebuild", "status": "SUCCESS"} in ask(RUNS)["results"])
        lose(bench, 2009)
        names = ("samples", "blocks", *ARCHIVE_TABLES)
        what = {"assetSelection": [{"path": [name]} for name in names], "partitionNames": ["2009"]}
        (begun,) = ask(BACKFILL, what=what).values()
        wait_for(lambda: ask(BACKFILLED, id=begun)["status"] == "COMPLETED_SUCCESS")
    assert bench.lake_files().keys() == built.lake_files().keys()
    assert bench.store.read("tows").equals(built.store.read("tows"))
