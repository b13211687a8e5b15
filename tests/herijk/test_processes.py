"""Fresh processes: the same archive gives the same tables, whatever the number of threads."""

import json
import os
import subprocess
import sys
from pathlib import Path

import polars as pl
import pytest

from tests.conftest import METHODS, SMALL, Workbench
from tests.herijk.conftest import hold_against_form
from tests.tables import digest_table

ROOT = Path(__file__).parents[2]
THREAD_LIMITS = ("POLARS_MAX_THREADS", "OPENBLAS_NUM_THREADS")


@pytest.mark.slow
def test_a_fresh_process_with_other_threads_gives_the_same_tables(built: Workbench, tmp_path: Path):
    threads = "2" if pl.thread_pool_size() == 1 else "1"  # `built` was made with other ones
    chosen = [part for name in METHODS for part in ("--method", name)]
    run = subprocess.run(
        [
            *(sys.executable, "-m", "herijk", "rebuild", "--json", *chosen),
            *("--archive", built.archive, "--data", tmp_path / "data"),
        ],
        cwd=ROOT,
        env=os.environ | dict.fromkeys(THREAD_LIMITS, threads),
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert any("recomputed" in line for line in run.stderr.splitlines())
    hold_against_form("rebuild", run.stdout)
    report = json.loads(run.stdout)
    assert report["since"]["done"]["seasons"] == list(SMALL.seasons)
    assert report["report"]["simulated"] is True
    made = Workbench(built.archive, tmp_path / "data").tables()
    assert made.keys() == built.tables().keys()
    for name, frame in built.tables().items():
        days = [c for c in frame.columns if c == "first_seen"]  # the day is not the archive's
        assert digest_table(made[name].drop(days)) == digest_table(frame.drop(days)), name


STOPPED = """
import os, signal, time
import assets.settings
from herijk.cli.main import main

def stopped(data):
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(10)

assets.settings.read_settings = stopped
main()
"""


STOPPED_IN_A_QUERY = """
import click
from herijk.cli.main import app, main

@click.command()
def ask():
    raise RuntimeError("Query interrupted")  # what DuckDB makes of SIGTERM, where it notices

app.add_command(ask)
main()
"""


def test_a_query_that_is_stopped_is_no_unexpected_error():
    run = subprocess.run(
        [sys.executable, "-c", STOPPED_IN_A_QUERY, "ask"],
        cwd=ROOT, capture_output=True, text=True, check=False, timeout=60,
    )  # fmt: skip
    assert run.returncode == 130
    assert run.stderr.lstrip().startswith("herijk: stopped as requested.")


def test_what_systemd_stops_says_so(tmp_path: Path):
    run = subprocess.run(
        [sys.executable, "-c", STOPPED, "rebuild", "--archive", tmp_path, "--data", tmp_path / "d"],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert run.returncode == 130
    assert run.stderr.lstrip().startswith(
        "herijk: stopped as requested. Earlier results are intact"
    )
