"""Fresh processes: the same archive gives the same tables, whatever the number of threads."""

import json
import os
import subprocess
import sys
from pathlib import Path

from tests.conftest import METHODS, SMALL, Workbench
from warehouse.store import table_digest

ROOT = Path(__file__).parents[2]
THREAD_LIMITS = ("POLARS_MAX_THREADS", "OPENBLAS_NUM_THREADS")


def herijk(*arguments: object, threads: int) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "herijk", *map(str, arguments)],
        cwd=ROOT,
        env=os.environ | dict.fromkeys(THREAD_LIMITS, str(threads)),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def test_rebuilds_in_fresh_processes_give_identical_tables(built: Workbench, tmp_path: Path):
    chosen = [part for name in METHODS for part in ("--method", name)]
    running = {
        threads: herijk(
            "rebuild", "--archive", built.archive, "--data", tmp_path / f"{threads}", *chosen,
            "--json", threads=threads,
        )
        for threads in (1, 2)
    }  # fmt: skip
    for threads, process in running.items():
        out, err = process.communicate(timeout=120)
        assert process.returncode == 0, err
        assert err == ""
        report = json.loads(out)
        assert report["done"]["seasons"] == list(SMALL.seasons)
        assert report["simulated"] is True
        made = Workbench(built.archive, tmp_path / f"{threads}").tables()
        assert made.keys() == built.tables().keys()
        for name, frame in built.tables().items():
            if name == "quarantine":
                frame = frame.drop("first_seen")  # noqa: PLW2901 - the day is not the archive's
                made[name] = made[name].drop("first_seen")
            assert table_digest(made[name]) == table_digest(frame), name
