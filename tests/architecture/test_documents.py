"""The documents say what the code does: options, reason codes, commands, links."""

import ast
import re
from collections import Counter
from typing import Literal, get_args, get_origin

import pytest
import typer.main

from dashboards.guides import GUIDES
from herijk.cli.main import app
from pipeline.assessment.checks import CHECKS
from pipeline.method.definition import Steps, shipped_methods
from pipeline.tables.schemas import TABLES
from pipeline.tables.views import VIEWS
from tests.architecture.repository import ROOT, modules, read, tracked_files
from tests.reason_codes import REASON_CODES

OPTIONS = [
    (step, option)
    for step, options in Steps.model_fields.items()
    for option in options.annotation.model_fields
]

LINK = re.compile(r"\[[^\]]*\]\(([^)#\s]+)(?:#[^)]*)?\)")


def commands():
    """Names of the commands that the command line has."""
    return sorted(typer.main.get_command(app).commands)


def option_row(step, option):
    """The line of method.md that explains an option."""
    start = f"| `{step}.{option}` |"
    return next((r for r in read("docs/method.md").splitlines() if r.startswith(start)), "")


@pytest.mark.parametrize(("step", "option"), OPTIONS)
def test_every_option_of_a_method_is_documented(step, option):
    row = option_row(step, option)
    field = Steps.model_fields[step].annotation.model_fields[option]
    values = get_args(field.annotation) if get_origin(field.annotation) is Literal else ()
    default = [] if field.is_required() else [field.default]
    assert row, f"docs/method.md has no row `{step}.{option}`"
    for value in (*values, *default):
        assert f"`{value}`" in row


def test_no_option_is_documented_that_is_not_there():
    found = set(re.findall(r"^\| `(\w+)\.(\w+)` \|", read("docs/method.md"), re.MULTILINE))
    assert found == set(OPTIONS)


def limit_text(check):
    """The limits of a check as method.md writes them."""

    def of_class(crew_class):
        low, high = check.limits(crew_class)
        if low is None:
            return f"at most {high:g}"
        return f"at least {low:g}" if high is None else f"{low:g} to {high:g}"

    men, women = map(of_class, "HD")
    limit = men if men == women else f"H {men}, D {women}"
    limit += "" if check.unit == "1" else f" {check.unit}"
    return f"{limit}; to {check.last_season}" if check.last_season else limit


DUTCH = {
    "refuse": "afwijzen",
    "look": "nakijken",
    "note": "opmerking",
    "at most": "hoogstens",
    "at least": "minstens",
    " to ": " tot ",
    ".": ",",
}


def test_the_checks_of_a_tow_are_documented_with_their_limits():
    row = re.compile(r"^\| `(\w+)` \| (\w+) \| [^|]+ \| ([^|]+) \| [^|]+ \|$", re.MULTILINE)
    stated = [(check.code, check.severity, limit_text(check)) for check in CHECKS]
    assert row.findall(read("docs/method.md")) == stated
    for english, dutch in DUTCH.items():
        stated = [(code, *(x.replace(english, dutch) for x in rest)) for code, *rest in stated]
    assert row.findall(read("docs/nl/method.md")) == stated


@pytest.mark.parametrize("name", shipped_methods())
def test_every_shipped_method_is_documented(name):
    assert f"\n| `{name}` |" in read("docs/method.md")


def sections(path):
    """The sections of a document, without its diagrams and commands."""
    text = re.sub(r"```.*?```", "", read(path), flags=re.DOTALL)
    return re.split(r"^(?=#)", text, flags=re.MULTILINE)[1:]


WORDS_IN_CODE = re.compile(r"[A-Za-zë]{4,} [a-zë]{3,}|[a-zë]{4,} [-+/(=]|[-+/(=] [a-zë]{4,}")


def names_and_formulas(section):
    """What is set as code, as often as it is; one that holds words only counts."""
    found = re.findall(r"`([^`]+)`", section)
    return Counter("words" if WORDS_IN_CODE.search(code) else code for code in found)


def numbers(section, comma):
    """The numbers of a text, as often as they are there, with what a comma in them stands for."""
    text = re.sub(r"`[^`]*`|\]\([^)]*\)", "", section)
    return Counter(re.findall(r"\d+(?:\.\d+)?", re.sub(r"(?<=\d),(?=\d)", comma, text)))


def shape(section):
    """Level of the heading, and the columns of every row of a table."""
    lines = section.splitlines()
    return [lines[0].count("#"), *(row.count(" | ") for row in lines if row.startswith("|"))]


@pytest.mark.parametrize("name", GUIDES)
def test_the_dutch_text_of_a_guide_has_what_the_english_has(name):
    """Section by section the same tables, names, formulas and numbers."""
    english, dutch = sections(f"docs/{name}.md"), sections(f"docs/nl/{name}.md")
    assert [shape(s) for s in dutch] == [shape(s) for s in english]
    for nl, en in zip(dutch, english, strict=True):
        assert names_and_formulas(nl) == names_and_formulas(en), nl.splitlines()[0]
        assert numbers(nl, ".") == numbers(en, ""), nl.splitlines()[0]


def reason_codes_given():
    """Every text in the code that is given as a reason code, and every text at all."""
    given, texts = set(), set()
    for file in modules():
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            if isinstance(node, ast.Constant):
                texts.add(node.value)
            if isinstance(node, ast.Call):
                named = [k.value for k in node.keywords if k.arg == "reason_code"]
                is_error = ast.unparse(node.func).startswith("Defective")
                codes = [*named, *node.args[:is_error]]
                given |= {code.value for code in codes if isinstance(code, ast.Constant)}
    return given, texts


def test_reason_codes_are_documented_and_no_others():
    given, texts = reason_codes_given()
    assert len(given) > 10
    assert given - REASON_CODES == set()
    assert REASON_CODES - texts == set()


def test_every_table_is_documented():
    found = set(re.findall(r"^\| `(\w+)` \|", read("docs/tables.md"), re.MULTILINE))
    assert found == {*TABLES, *VIEWS}


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


def test_every_page_is_reached_from_the_map():
    linked = {(ROOT / "docs" / target).resolve() for target in LINK.findall(read("docs/index.md"))}
    pages = set((ROOT / "docs").rglob("*.md")) - {ROOT / "docs" / "index.md"}
    assert {p.relative_to(ROOT) for p in pages if p.resolve() not in linked} == set()
