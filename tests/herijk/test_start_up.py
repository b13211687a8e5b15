"""A command does not import what it does not need: `--help` is there at once."""

import subprocess
import sys

import pytest

READING = "warehouse.intake"
HEAVY = {"altair", "dagster", "dataframely", "duckdb", "numpy", "polars", "scipy", "sqlalchemy"}
HEAVY |= {READING}
NEEDED = {
    "herijk.cli.main": set(),
    "herijk.cli.render": set(),
    "herijk.cli.registers_text": {"duckdb", "numpy", "polars"},
    "herijk.cli.audit_text": HEAVY - {"altair", "dagster", "sqlalchemy"},
    "pipeline.method.definition": set(),
    "warehouse.queries.reports": {"duckdb", "numpy", "polars"},
    "warehouse.queries.audit": HEAVY - {"altair", "dagster", "sqlalchemy", READING},
    "warehouse.editions.compare": {"dataframely", "numpy", "polars", "scipy"},
    # Columns of later, which an old edition lacks, are read from their declaration.
    "warehouse.editions.lineage": {"dataframely", "numpy", "polars"},
    "assets.rebuild": HEAVY - {"altair", "dagster", "sqlalchemy"},
}
UNUSED_PARTS = {"scipy.optimize", "scipy.signal", "scipy.sparse", "scipy.special", "scipy.stats"}


@pytest.mark.parametrize("module", NEEDED)
def test_a_module_imports_no_more_than_it_needs(module):
    code = f"import {module}, sys; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    imported = set(done.stdout.split())
    assert module in imported
    assert imported & HEAVY <= NEEDED[module]
    assert imported & UNUSED_PARTS == set()
