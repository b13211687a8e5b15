"""Tables explain themselves; `tests/kept.toml` has the columns that other programs rely on."""

import re

from pipeline.channels import MOST_RUNS, SECOND_FILE_OFFSET
from pipeline.tables.schemas import TABLES

UNITS = {"m_s": "m/s", "n": "N", "kg_m": "kg/m", "kg": "kg", "m": "m", "s": "s", "w": "W", "c": "C"}
"""Endings of column names and the unit each stands for, longest first."""


def columns():
    """Every column of every table, with the name of its table."""
    for table, schema in TABLES.items():
        for name, column in schema.columns().items():
            yield f"{table}.{name}", column


def test_a_unit_in_a_name_is_the_declared_unit():
    wrong = []
    for name, column in columns():
        declared = (column.metadata or {}).get("unit")
        ending = re.search(r"_(m_s|kg_m|kg|m|s|n|w|c)$", name)
        if ending and declared not in (None, "1", UNITS[ending[1]]):
            wrong.append(f"{name} is in {declared}")
    assert wrong == []


def test_every_run_that_a_plan_or_a_second_file_can_have_fits_every_table():
    most = {name: t.columns()["run"].max for name, t in TABLES.items() if "run" in t.columns()}
    assert set(most.values()) == {SECOND_FILE_OFFSET + MOST_RUNS}, most
