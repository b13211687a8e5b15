"""The documents say what the code does; the ledger of the sources names only what exists."""

import ast
import re

import pytest

from herijk.cli.main import app
from pipeline.assessment.checks import CODES
from pipeline.method.options import Steps
from pipeline.method.reading import list_shipped_methods
from pipeline.tables.schemas import TABLES
from pipeline.tables.views import VIEWS
from tests.architecture.repository import ROOT, modules, read, tracked_files
from warehouse.archive.remedies import REMEDIES

TEMPLATES = "dashboards/templates"
OPTIONS = {
    f"{step}.{option}"
    for step, options in Steps.model_fields.items()
    for option in options.annotation.model_fields
}

LINK = re.compile(r"\[[^\]]*\]\(([^)#\s]+)(?:#[^)]*)?\)")
LEDGER = read("docs/sources.md")
NAMED = re.compile(r"\b(table|view|command|page|test|check|method|option)s? `([^`]+)`")
COLUMNS = re.compile(r"columns? ((?:`\w+`(?:, | and )?)+) of table `(\w+)`")
ROWS = [line for line in LEDGER.splitlines() if re.match(r"\| [PCS]\d+ \|", line)]
COMMANDS = {
    " ".join(("herijk", *path))
    for name, command in app.commands.items()
    for path in [(name,), *((name, inner) for inner in getattr(command, "commands", ()))]
}
KNOWN = {
    "table": set(TABLES),
    "view": set(VIEWS),
    "page": {file.name.partition(".")[0] for file in (ROOT / TEMPLATES).glob("*.html.j2")},
    "check": set(CODES),
    "method": set(list_shipped_methods()),
    "option": OPTIONS,
    "command": COMMANDS,
}


def rows_named(page, known):
    """What the first cells of a page's tables name, of what is known."""
    cells = re.findall(r"^\| (`[^|]+`) \|", read(page), re.MULTILINE)
    return {name for cell in cells for name in re.findall(r"`([\w.]+)`", cell)} & known


def test_options_and_checks_are_documented():
    assert rows_named("docs/method-details.md", OPTIONS) == OPTIONS
    assert rows_named("docs/method-details.md", set(CODES)) == set(CODES)


@pytest.mark.parametrize("name", list_shipped_methods())
def test_every_shipped_method_is_documented(name):
    assert f"`{name}`" in read("docs/method.md")


def reason_codes_given():
    """Every text in the code that is given as a reason code, and every text at all."""
    given, texts = set(), set()
    for file in modules():
        if file.name == "remedies.py":
            continue
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            if isinstance(node, ast.Constant):
                texts.add(node.value)
            if isinstance(node, ast.Call):
                named = [k.value for k in node.keywords if k.arg == "reason_code"]
                called = ast.unparse(node.func).rpartition(".")[2]
                is_first = called.startswith("Defective") or called in ("lost", "lose_of_all")
                codes = [*named, *node.args[:is_first], *node.args[1 : 2 * (called == "lose")]]
                given |= {code.value for code in codes if isinstance(code, ast.Constant)}
    return given, texts


def test_reason_codes_have_remedies_and_no_others():
    given, texts = reason_codes_given()
    assert len(given) > 10
    assert given - set(REMEDIES) == set()
    assert set(REMEDIES) - texts == set()


def test_every_link_leads_somewhere():
    pages = [f for f in tracked_files() if f.suffix == ".md"]
    broken = [
        f"{page.relative_to(ROOT)}: {target}"
        for page in pages
        for target in LINK.findall(page.read_text(encoding="utf-8"))
        if "://" not in target and not (page.parent / target).exists()
    ]
    assert broken == []


def test_every_page_is_reached_from_the_map_or_the_page_on_development():
    maps = [read("docs/index.md"), read("docs/development.md")]
    linked = {(ROOT / "docs" / target).resolve() for page in maps for target in LINK.findall(page)}
    pages = set((ROOT / "docs").rglob("*.md")) - {ROOT / "docs" / "index.md"}
    assert {p.relative_to(ROOT) for p in pages if p.resolve() not in linked} == set()


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
