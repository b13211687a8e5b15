"""A command does not import what it does not need: `--help` is there at once."""

import subprocess
import sys

import pytest

READING = "warehouse.intake"
HEAVY = {"dagster", "dataframely", "duckdb", "numpy", "polars", "scipy", "sqlalchemy"}
WEB = {"starlette", "uvicorn"}
HEAVY |= {READING} | WEB
DECLARED = {"dataframely", "sqlalchemy"}
"""What declares and checks tables; the second comes with the first."""

OF_PAGES = HEAVY - WEB - {"dagster", READING}
NEEDED = {
    "herijk.cli.main herijk.cli.options dashboards.terminal pipeline.method.definition": set(),
    "warehouse.queries.reports": {"duckdb", "numpy", "polars"},
    "dashboards.queries.boats dashboards.queries.pages warehouse.queries.types": OF_PAGES,
    "warehouse.editions.compare": DECLARED | {"numpy", "polars", "scipy"},
    # Columns of later, which an old edition lacks, are read from their declaration.
    "warehouse.editions.lineage": DECLARED | {"numpy", "polars"},
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
