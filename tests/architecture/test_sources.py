"""The ledger of the sources names only what exists."""

import re

import pytest

from dashboards.figures import FIGURES
from herijk.cli.main import app
from pipeline.assessment.checks import CODES
from pipeline.method.definition import Steps, shipped_methods
from pipeline.tables.schemas import TABLES
from pipeline.tables.views import VIEWS
from tests.architecture.repository import ROOT, read

LEDGER = read("docs/sources.md")
NAMED = re.compile(r"\b(table|view|command|figure|test|check|method|option)s? `([^`]+)`")
COLUMNS = re.compile(r"columns? ((?:`\w+`(?:, | and )?)+) of table `(\w+)`")
ROWS = [line for line in LEDGER.splitlines() if re.match(r"\| [PCS]\d+ \|", line)]

OPTIONS = {
    f"{step}.{option}"
    for step, options in Steps.model_fields.items()
    for option in options.annotation.model_fields
}
COMMANDS = {
    " ".join(("herijk", *path))
    for name, command in app.commands.items()
    for path in [(name,), *((name, inner) for inner in getattr(command, "commands", ()))]
}
KNOWN = {
    "table": set(TABLES),
    "view": set(VIEWS),
    "figure": set(FIGURES),
    "check": set(CODES),
    "method": set(shipped_methods()),
    "option": OPTIONS,
    "command": COMMANDS,
}


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.split("|")[1].strip())
def test_a_row_names_what_exists_or_says_why_not(row):
    answer = row.split("|")[3]
    named = NAMED.findall(answer)
    assert named or "not answered" in answer or "`" in answer
    for kind, name in named:
        if kind == "test":
            assert (ROOT / name).is_file(), name
        else:
            assert name in KNOWN[kind], (kind, name)
    for columns, table in COLUMNS.findall(answer):
        for column in re.findall(r"`(\w+)`", columns):
            assert column in TABLES[table].column_names(), (table, column)
