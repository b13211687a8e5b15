"""The documents say what the code does: options, reason codes, commands, links."""

import ast
import re

import pytest

from herijk.cli.main import app
from pipeline.assessment.checks import CODES
from pipeline.method.definition import Steps, shipped_methods
from tests.architecture.repository import ROOT, modules, read, tracked_files
from tests.reason_codes import REASON_CODES

OPTIONS = {
    f"{step}.{option}"
    for step, options in Steps.model_fields.items()
    for option in options.annotation.model_fields
}

LINK = re.compile(r"\[[^\]]*\]\(([^)#\s]+)(?:#[^)]*)?\)")


def commands():
    """Names of the commands that the command line has."""
    return sorted(app.commands)


def rows_named(page, known):
    """What the first cells of a page's tables name, of what is known."""
    cells = re.findall(r"^\| (`[^|]+`) \|", read(page), re.MULTILINE)
    return {name for cell in cells for name in re.findall(r"`([\w.]+)`", cell)} & known


def test_options_and_checks_are_documented():
    assert rows_named("docs/method-details.md", OPTIONS) == OPTIONS
    assert rows_named("docs/method-details.md", set(CODES)) == set(CODES)


@pytest.mark.parametrize("name", shipped_methods())
def test_every_shipped_method_is_documented(name):
    assert f"`{name}`" in read("docs/method.md")


def reason_codes_given():
    """Every text in the code that is given as a reason code, and every text at all."""
    given, texts = set(), set()
    for file in modules():
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


def test_reason_codes_are_documented_and_no_others():
    given, texts = reason_codes_given()
    assert len(given) > 10
    assert given - REASON_CODES == set()
    assert REASON_CODES - texts == set()


def test_readme_names_no_command_that_is_not_there():
    named = set(re.findall(r"herijk ([a-z][a-z-]+)", read("README.md")))
    assert named - set(commands()) == set()


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
