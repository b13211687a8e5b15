"""A small part of the suite that kills rebuilds; the whole is `make survive`."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_killed_rebuilds_leave_nothing_half_done():
    """In a process of its own: rebuilds are forked, and this one has threads already."""
    done = subprocess.run(
        [sys.executable, "benchmarks/robustness/survive.py", "4", "7"],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert "kills: 4, reruns with other tables: 0" in done.stdout
