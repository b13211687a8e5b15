"""What users rely on stays: `kept.toml` says what, where it is found and its value.

Run `python -m tests.test_kept` to write the numbers of `kept.toml` anew, after a change that
CHANGELOG.md names.
"""

import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

import pypdf
import pytest
import tomlkit

from herijk.cli.main import main
from tests.architecture.repository import ROOT, read
from tests.conftest import shared
from warehouse.store.database import open_database

KEPT = tomlkit.parse(read("tests/kept.toml")).unwrap()
SAMPLE = ROOT / "tests" / "data" / "sample-archive"
EDITIONS = (
    "publish 2014-gedrukt --printed 2014 --valid-from 2014-05-01 --decision ALV",
    "publish 2017-herijkt --method rebased --valid-from 2017-04-01 --decision ALV",
)


def herijk(command, folder):
    """What a command of `herijk` prints, run as a user does; fails where it does not end with 0."""
    ended = subprocess.run(
        [sys.executable, "-m", "herijk", "--lang", "en", *shlex.split(command)],
        env=os.environ | {"HERIJK_DATA": str(folder / "data"), "COLUMNS": "200"},
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


def said(command, folder, monkeypatch, capsys):
    """The same without a process of its own, which takes longer than most commands."""
    for name, value in (
        ("HERIJK_DATA", str(folder / "data")),
        ("COLUMNS", "200"),
        ("LANGUAGE", ""),
    ):
        monkeypatch.setenv(name, value)
    monkeypatch.chdir(folder)
    monkeypatch.setattr(sys, "argv", ["herijk", "--lang", "en", *shlex.split(command)])
    with pytest.raises(SystemExit) as ended:
        main()
    printed = capsys.readouterr()
    assert not ended.value.code, printed.err
    return printed.out


def make_sample(folder):
    herijk(f"rebuild --archive {SAMPLE}", folder)
    for edition in EDITIONS:
        herijk(edition, folder)


def make_demo(folder):
    """The archive of `make demo`, and its rebuild."""
    world = re.search(r"^DEMO_WORLD = (.*)$", read("Makefile"), re.MULTILINE)[1]
    herijk(f"simulate archief {world}", folder)
    herijk("rebuild --archive archief", folder)


MAKE = {"sample": make_sample, "demo": make_demo}


def lines_of(number, folder):
    """Rows of a query on the database, a line each, at printed digits."""
    with open_database(folder / "data" / "warehouse.duckdb") as db:
        rows = db.execute(number["sql"]).fetchall()
    return "\n" + "".join(
        " ".join("-" if cell is None else str(cell) for cell in row) + "\n" for row in rows
    )


@pytest.fixture(scope="session")
def world(tmp_path_factory):
    """Gives the folder of a world, made by the first test that asks."""
    return lambda name: shared(tmp_path_factory, f"kept-{name}", MAKE[name])


def entries(kind, *, of=None):
    chosen = [entry for entry in KEPT[kind] if of in (None, entry.get("world"))]
    marks = {entry["run"]: pytest.mark.more for entry in chosen if entry.get("takes_long")}
    return pytest.mark.parametrize(
        "entry",
        [pytest.param(entry, marks=marks.get(entry.get("run"), ())) for entry in chosen],
        ids=lambda e: e.get("of") or e.get("run") or e.get("path") or e.get("name"),
    )


@entries("number", of="sample")
def test_a_number_of_the_sample_archive(entry, world):
    assert lines_of(entry, world("sample")) == entry["lines"]


@pytest.mark.slow
@entries("number", of="demo")
def test_a_number_of_the_demo(entry, world):
    assert lines_of(entry, world("demo")) == entry["lines"]


@entries("command")
def test_a_command_prints(entry, world, monkeypatch, capsys):
    command = entry["run"].format(data=SAMPLE.parent)
    printed = said(command, world("sample"), monkeypatch, capsys)
    assert [text for text in entry["shows"] if text not in printed] == []


@entries("document")
def test_a_document_shows(entry, world, tmp_path, monkeypatch, capsys):
    said(entry["run"].format(out=tmp_path), world("sample"), monkeypatch, capsys)
    (made,) = tmp_path.glob("**/*.pdf")
    text = "\n".join(page.extract_text() for page in pypdf.PdfReader(made).pages)
    assert [shown for shown in entry["shows"] if shown not in text] == []


@entries("page")
def test_a_page_shows(entry, world):
    page = (world("sample") / "data" / "site" / entry["path"]).read_text(encoding="utf-8")
    assert [text for text in entry["shows"] if text not in page] == []


@entries("table")
def test_a_table_has_its_columns(entry, world):
    with open_database(world("sample") / "data" / "warehouse.duckdb") as db:
        there = db.table(entry["name"]).columns
    assert set(entry["columns"].split()) - set(there) == set()


def test_the_lines_of_the_sources_are_answered_as_they_were():
    rows = [
        [cell.strip() for cell in row.split("|")] for row in read("docs/sources.md").split("\n")
    ]
    answers = {row[1]: row[3] for row in rows if len(row) > 3 and re.match(r"[PCS]\d+$", row[1])}
    assert set(KEPT["sources"]["lines"].split()) == set(answers)
    unanswered = {line for line, answer in answers.items() if answer.startswith("not answered")}
    assert unanswered == set(KEPT["sources"]["not_answered"].split())


def write_numbers_anew():
    """Puts the values of today in `kept.toml`."""
    path = ROOT / "tests" / "kept.toml"
    document = tomlkit.parse(path.read_text(encoding="utf-8"))
    for name, make in MAKE.items():
        with tempfile.TemporaryDirectory() as folder:
            make(Path(folder))
            for number in document["number"]:
                if number["world"] == name:
                    lines = lines_of(number, Path(folder))
                    number["lines"] = tomlkit.string(lines, multiline=True)
    path.write_text(tomlkit.dumps(document), encoding="utf-8")


if __name__ == "__main__":
    write_numbers_anew()
