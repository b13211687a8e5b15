"""What the documents tell a reader to type runs, and prints what they say."""

import re
import runpy
import shlex
import tomllib

import duckdb
import pytest

from assets.settings import Settings
from herijk.cli.main import app
from tests.architecture.repository import ROOT, read
from tests.conftest import METHODS
from warehouse.archive.profile import parse_profiles

PAGES = sorted(
    str(path.relative_to(ROOT))
    for path in (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md"))
)
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
CALL = re.compile(r"`(?:\.venv/bin/)?herijk ([a-z][^`]*)`")
NOTEBOOK = ROOT / "docs" / "notebooks" / "from_tow_to_register.py"


def blocks(page, *languages):
    return [text for language, text in BLOCK.findall(read(page)) if language in languages]


def shell_lines(page):
    """The calls of herijk in the blocks of a page, each split as a shell does."""
    for block in blocks(page, "", "sh"):
        for line in block.splitlines():
            if re.match(r"(\.venv/bin/)?herijk ", line):
                yield shlex.split(line, comments=True)[1:]


def command_of(words):
    """The command that a call names, with the words that follow."""
    command, left = app, list(words)
    while getattr(command, "commands", None) and left and left[0] in command.commands:
        command = command.commands[left.pop(0)]
    return command, left


@pytest.mark.parametrize("page", PAGES)
def test_every_call_has_its_command_and_options(page):
    """A call in a block is parsed as the command would; one in a sentence may leave things out."""
    for words in shell_lines(page):
        command, left = command_of(words)
        command.make_context(command.name, left)
    for call in CALL.findall(read(page)):
        command, left = command_of(re.split(r"[\s|\[\]]+", call))
        assert command.name in {*call.split(), "methods"}, (page, call)
        known = {name for parameter in command.params for name in parameter.opts} | {"--help"}
        assert {word for word in left if word.startswith("--")} <= known | {"--lang"}, (page, call)


@pytest.fixture
def reader(built, monkeypatch, tmp_path):
    """The folder of a reader who did what the pages say until here."""
    for folder in ("data", "demo/data"):
        (tmp_path / folder).parent.mkdir(exist_ok=True)
        (tmp_path / folder).symlink_to(built.data)
    (tmp_path / "tests").symlink_to(ROOT / "tests")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def with_what_is_there(code, built):
    """Tows and the method of the fixture in place of those of the reader's demo."""
    some = iter(built.table("tows")["tow_id"])
    code = re.sub(r"(?<=[\"'])20\d\d-\d{3}(?=[\"'])", lambda _: next(some), code)
    return re.sub(r"\brebased(?=[\"']|\.parquet)", METHODS[1], code)


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page, "python")])
def test_code_runs(page, reader, built):
    code = "\n".join(blocks(page, "python"))
    code = with_what_is_there(code, built)
    (reader / "snippets.py").write_text(code, "utf-8")
    assert runpy.run_path(str(reader / "snippets.py"))


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page, "sql")])
def test_queries_run(page, reader, built):
    with duckdb.connect("data/warehouse.duckdb", read_only=True) as db:
        for query in blocks(page, "sql"):
            assert db.sql(with_what_is_there(query, built)).columns, query


def test_no_block_is_left_out_in_silence():
    """Diagrams, and settings of systemd and Kubernetes, are for programs that are not here."""
    tried, left_out = {"", "sh", "python", "sql", "toml", "text"}, {"mermaid", "ini", "yaml"}
    assert {language for page in PAGES for language, _ in BLOCK.findall(read(page))} <= (
        tried | left_out
    )
    targets = set(re.findall(r"^([\w-]+):", read("Makefile"), re.MULTILINE))
    calls = r"^make (?:[A-Z]+=\S+ )*([a-z-]+)|`make (?:[A-Z]+=\S+ )*([a-z-]+)"
    for page in PAGES:
        named = {name for pair in re.findall(calls, read(page), re.MULTILINE) for name in pair}
        assert named - {""} <= targets, page


def test_settings_are_understood():
    for page in PAGES:
        for text in blocks(page, "toml"):
            tomllib.loads(text)
    for text in blocks("docs/archive.md", "toml"):
        parse_profiles(text)
    (settings,) = blocks("docs/operations.md", "toml")
    Settings.model_validate(tomllib.loads(settings))


def test_the_notebook_ends_at_the_line_of_the_register(built, monkeypatch):
    monkeypatch.setenv("HERIJK_DATA", str(built.data))
    shown, found = runpy.run_path(str(NOTEBOOK))["app"].run()
    assert found["curve"]["cw_kg_m"] == pytest.approx(found["line"]["cw_kg_m"], rel=1e-9)
    assert f"{found['line']['cw_kg_m']:.2f} kg/m" in shown[-1].text
