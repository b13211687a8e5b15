"""A command does not import what it does not need: `--help` is there at once."""

import subprocess
import sys

import pytest

READING = "warehouse.intake"
HEAVY = {"dagster", "dataframely", "duckdb", "numpy", "polars", "scipy", "sqlalchemy"}
WEB = {"starlette", "uvicorn"}
HEAVY |= {READING} | WEB
READS_TABLES = {"duckdb", "numpy", "polars"}
"""What reads finished tables; SciPy and declarations would add a third to each command."""

NEEDED = {
    "herijk.cli.main herijk.cli.options dashboards.terminal pipeline.method.definition": set(),
    "dashboards.document dashboards.queries.boats dashboards.queries.methods": READS_TABLES,
    "dashboards.queries.pages dashboards.queries.types warehouse.queries.reports": READS_TABLES,
    "dashboards.queries.comparison warehouse.editions.compare": READS_TABLES,
    "warehouse.editions.lineage": {"numpy", "polars"},
    "assets.rebuild": HEAVY - WEB - {"dagster"},
}
"""What modules, imported together, may need."""
UNUSED_PARTS = {"scipy.optimize", "scipy.signal", "scipy.sparse", "scipy.special", "scipy.stats"}


@pytest.mark.parametrize("modules", NEEDED)
def test_modules_import_no_more_than_they_need(modules):
    code = f"import {', '.join(modules.split())}, sys; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    imported = set(done.stdout.split())
    assert {*modules.split()} <= imported
    assert imported & HEAVY <= NEEDED[modules]
    assert imported & UNUSED_PARTS == set()
