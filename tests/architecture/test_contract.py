"""Tables explain themselves."""

import re

from pipeline.channels import MOST_RUNS, SECOND_FILE_OFFSET
from pipeline.tables.display import find_number_form
from pipeline.tables.schemas import TABLES


def columns():
    """Every column of every table, with the name of its table."""
    for table, schema in TABLES.items():
        for name, column in schema.columns().items():
            yield f"{table}.{name}", column


def test_a_number_says_its_unit_by_its_name_alone():
    wrong = []
    for name, column in columns():
        declared = (column.metadata or {}).get("unit")
        by_name = find_number_form(name.split(".")[1]).unit
        if declared and (by_name or not declared.startswith("as ")):
            wrong.append(f"{name}: unit {declared} beside that of its name")
        if column.dtype.is_integer() and by_name not in ("", "s"):
            wrong.append(f"{name} is a count and has the unit {by_name}")
        if re.search(r"_(km_h|kn|kgf|cm|pct)$", name):
            wrong.append(f"{name} is not in an SI unit")
    assert wrong == []


def test_every_run_that_a_plan_or_a_second_file_can_have_fits_every_table():
    most = {name: t.columns()["run"].max for name, t in TABLES.items() if "run" in t.columns()}
    assert set(most.values()) == {SECOND_FILE_OFFSET + MOST_RUNS}, most
