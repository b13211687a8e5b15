"""A command does not import what it does not need: `--help` is there at once."""

import subprocess
import sys
from pathlib import Path

import pytest

READING = "warehouse.intake"
HEAVY = {"dagster", "dataframely", "duckdb", "numpy", "polars", "scipy", "sqlalchemy"}
WEB = {"starlette", "uvicorn"}
HEAVY |= {READING} | WEB
DECLARED = {"dataframely", "sqlalchemy"}
"""What declares and checks tables; the second comes with the first."""

NEEDED = {
    "herijk.cli.main": set(),
    "herijk.cli.options": set(),
    "dashboards.terminal": set(),
    "dashboards.queries.boats": HEAVY - WEB - {"dagster", READING},
    "pipeline.method.definition": set(),
    "warehouse.queries.reports": {"duckdb", "numpy", "polars"},
    "dashboards.queries.pages": HEAVY - WEB - {"dagster", READING},
    "warehouse.queries.types": HEAVY - WEB - {"dagster", READING},
    "warehouse.editions.compare": DECLARED | {"numpy", "polars", "scipy"},
    # Columns of later, which an old edition lacks, are read from their declaration.
    "warehouse.editions.lineage": DECLARED | {"numpy", "polars"},
    "assets.rebuild": HEAVY - WEB - {"dagster"},
}
UNUSED_PARTS = {"scipy.optimize", "scipy.signal", "scipy.sparse", "scipy.special", "scipy.stats"}

THREADS = """
import os
import polars as pl
import assets.definitions, herijk.cli.main, dashboards.site, herijk.library
imported = len(os.listdir("/proc/self/task"))
pl.DataFrame({"x": [1]}).lazy().select("x").collect()
print(imported, len(os.listdir("/proc/self/task")))
"""
"""How many threads there are when all is imported, and when Polars has computed something."""


@pytest.mark.parametrize("module", NEEDED)
def test_a_module_imports_no_more_than_it_needs(module):
    code = f"import {module}, sys; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    imported = set(done.stdout.split())
    assert module in imported
    assert imported & HEAVY <= NEEDED[module]
    assert imported & UNUSED_PARTS == set()


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="threads are counted on Linux")
def test_importing_computes_nothing():
    """A process forked after Polars has threads waits for them for ever."""
    found = subprocess.run(
        [sys.executable, "-c", THREADS], capture_output=True, text=True, check=True
    )
    imported, computed = map(int, found.stdout.split())
    assert imported < computed
