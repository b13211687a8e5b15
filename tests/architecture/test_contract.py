"""Tables explain themselves."""

import re

from pipeline.channels import MOST_RUNS, SECOND_FILE_OFFSET
from pipeline.tables.schemas import TABLES

UNITS = {
    "m_s": "m/s", "kg_m": "kg/m", "kg": "kg", "m": "m", "s": "s", "n": "N", "w": "W", "c": "C",
    "hz": "Hz", "deg": "deg",
}  # fmt: skip
"""Parts of column names and the unit each stands for, longest first."""


def columns():
    """Every column of every table, with the name of its table."""
    for table, schema in TABLES.items():
        for name, column in schema.columns().items():
            yield f"{table}.{name}", column


def test_a_unit_in_a_name_is_the_declared_unit_and_every_unit_is_in_the_name():
    part_of = {unit: part for part, unit in UNITS.items()}
    wrong = []
    for name, column in columns():
        declared = (column.metadata or {}).get("unit")
        ending = re.search(rf"_({'|'.join(UNITS)})$", name)
        if ending and declared not in (None, "1", UNITS[ending[1]]):
            wrong.append(f"{name} is in {declared}")
        named = re.search(rf"_{part_of.get(declared)}(_|$)", name) or name.endswith(".cw_sd")
        if (declared in part_of and not named) or re.search(r"_(km_h|kn|kgf|cm|pct)$", name):
            wrong.append(f"{name} does not name its unit {declared}")
    assert wrong == []


def test_every_run_that_a_plan_or_a_second_file_can_have_fits_every_table():
    most = {name: t.columns()["run"].max for name, t in TABLES.items() if "run" in t.columns()}
    assert set(most.values()) == {SECOND_FILE_OFFSET + MOST_RUNS}, most
