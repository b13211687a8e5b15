"""What the documents tell a reader to type runs, and prints what they say."""

import re
import runpy
import shlex
import shutil
import tomllib

import duckdb
import pytest

from assets.settings import Settings
from herijk.cli.main import app
from pipeline.messages import LANGUAGES, make_translator
from tests.architecture.repository import ROOT, read
from tests.texts import said as texts_said
from warehouse.archive.profile import parse_profiles

PAGES = sorted(
    str(path.relative_to(ROOT))
    for path in (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md"))
)
BLOCK = re.compile(r"^ *```(\S*)\n(.*?)^ *```", re.MULTILINE | re.DOTALL)
HERIJK = ("herijk", ".venv/bin/herijk")
IN_CI = {"README.md": "make", "docs/operations.md": "pip", "docs/other-registers.md": "cp"}
"""Pages with other lines, and the command of those: `.ci/run`, `.ci/wheel` or a test of the page
runs them."""
CALL = re.compile(r"`(?:\.venv/bin/)?herijk ([a-z][^`]*)`")
SECTIONS = re.compile(r"\| (?:section|onderdeel) \|.*?\n\n|\Z", re.DOTALL)
"""A table of what a command prints, section by section, if there is one."""
IF_ANY = ("if there are any: ", "als die er zijn: ")
START = "README.md"
OTHER = "docs/other-registers.md"
"""Begins in an empty folder: `test_other_registers`."""
NOTEBOOK = ROOT / "docs" / "notebooks" / "from_tow_to_register.py"


def blocks(page, *languages):
    return [text for language, text in BLOCK.findall(read(page)) if language in languages]


def shell_lines(page):
    """The lines of the blocks of a page that are meant to run, each split as a shell does."""
    lines = [line for block in blocks(page, "sh") for line in block.splitlines()]
    return [shlex.split(line, comments=True) for line in lines]


def herijk_lines(page):
    """What these lines tell `herijk` to do."""
    return [words for name, *words in shell_lines(page) if name in HERIJK]


def command_of(words):
    """The command that a call names, with the words that follow."""
    command, left = app, list(words)
    while getattr(command, "commands", None) and left and left[0] in command.commands:
        command = command.commands[left.pop(0)]
    return command, left


@pytest.mark.parametrize("page", PAGES)
def test_every_call_has_its_command_and_options(page):
    """A call in a sentence may leave things out; one in a block is run below."""
    for call in CALL.findall(read(page)):
        command, left = command_of(re.split(r"[\s|\[\]]+", call))
        assert command.name in {*call.split(), "methods"}, (page, call)
        known = {name for parameter in command.params for name in parameter.opts} | {"--help"}
        assert {word for word in left if word.startswith("--")} <= known | {"--lang"}, (page, call)


@pytest.fixture
def reader(demo, monkeypatch, tmp_path):
    """The folder of a reader who made the demo, also as `data`, where this reader may publish."""
    shutil.copytree(demo / "data", tmp_path / "data")
    (tmp_path / "demo").mkdir()
    (tmp_path / "demo" / "data").symlink_to(tmp_path / "data")
    (tmp_path / "tests").symlink_to(ROOT / "tests")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def type_in(herijk):
    """Runs the lines of a page in their order, all of which must end well; gives what they print.

    `check` also ends well with 1: it found what the reader has to correct, as in the example of a
    new archive.
    """

    def run(page):
        printed = []
        for words in herijk_lines(page):
            status, out, err = herijk(*words)
            assert status == 0 or (words[0], status) == ("check", 1), (words, err)
            printed.append(out)
        return " ".join(" ".join(printed).split())

    return run


@pytest.mark.parametrize(
    "page", [page for page in PAGES if herijk_lines(page) and page not in (START, OTHER)]
)
def test_lines_run(page, reader, type_in):
    """A section that a page describes is printed, or can be where the page says "if any"."""
    printed = type_in(page)
    table = SECTIONS.search(read(page) + "\n\n")[0]
    titles = dict(re.findall(r"^\| ([^|]+?) \| (.+) \|$", table, re.MULTILINE)[2:])
    said = [text for file, (text, _) in texts_said() if file.startswith("dashboards/templates")]
    known = {
        make_translator(language)(text)
        for language in LANGUAGES
        for text in said
        if isinstance(text, str)
    }
    for title, described in titles.items():
        assert title in printed or title in known
        assert title in printed or described.startswith(IF_ANY)


def test_lines_run_in_an_empty_folder(type_in, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert type_in(START)


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page, "python")])
def test_code_runs(page, reader):
    (reader / "snippets.py").write_text("\n".join(blocks(page, "python")), "utf-8")
    assert runpy.run_path(str(reader / "snippets.py"))


QUERIES = [
    query
    for page in PAGES
    for block in blocks(page, "sql")
    for query in block.split(";\n")
]  # fmt: skip


@pytest.mark.parametrize("query", QUERIES)
def test_a_query_finds_what_the_comments_above_it_promise(query, demo, monkeypatch):
    """Each finds something in every column."""
    monkeypatch.chdir(demo)
    with duckdb.connect("data/warehouse.duckdb", read_only=True) as db:
        found = db.sql(query).pl()
    assert found.height > 0
    assert [column.name for column in found if column.null_count() == found.height] == []
    for name, promised in re.findall(r"^-- (\w+): (.+)$", query, re.MULTILINE):
        if name == "rows":
            assert found.height == int(promised)
        else:
            assert set(found[name].cast(str)) == set(promised.split(", "))


def test_no_block_is_left_out_in_silence():
    """Diagrams, and settings of systemd and Kubernetes, are for programs that are not here."""
    tried = {"sh", "python", "sql", "toml"}
    left_out = {"text", "mermaid", "ini", "yaml", "{toctree}", "{eval-rst}"}
    assert {language for page in PAGES for language, _ in BLOCK.findall(read(page))} <= (
        tried | left_out
    )
    for page in PAGES:
        others = {name for name, *_ in shell_lines(page)} - {*HERIJK}
        assert others <= {IN_CI.get(page)}, page
    targets = set(re.findall(r"^([\w-]+):", read("Makefile"), re.MULTILINE))
    calls = r"^make (?:[A-Z]+=\S+ )*([a-z-]+)|`make (?:[A-Z]+=\S+ )*([a-z-]+)"
    for page in PAGES:
        named = {name for pair in re.findall(calls, read(page), re.MULTILINE) for name in pair}
        assert named - {""} <= targets, page


def test_settings_are_understood():
    for page in PAGES:
        for text in blocks(page, "toml"):
            tomllib.loads(text)
    for page in ("docs/archive.md", "docs/nl/archive.md"):
        for text in blocks(page, "toml"):
            parse_profiles(text)
    (settings,) = blocks("docs/operations.md", "toml")
    Settings.model_validate(tomllib.loads(settings))


def test_the_notebook_ends_at_the_line_of_the_register(built, monkeypatch):
    monkeypatch.setenv("HERIJK_DATA", str(built.data))
    shown, found = runpy.run_path(str(NOTEBOOK))["app"].run()
    assert found["curve"]["cw_kg_m"] == pytest.approx(found["line"]["cw_kg_m"], rel=1e-9)
    assert f"{found['line']['cw_kg_m']:.2f} kg/m" in shown[-1].text
