"""The command: what it prints where, and with which exit status."""

import json
import re

import pytest
from typer.main import get_command

from herijk.cli.json_schemas import schemas
from herijk.cli.main import app
from pipeline.method.definition import Steps
from tests.conftest import METHODS

COMMANDS = ("simulate", "rebuild", "methods", "audit")


@pytest.mark.parametrize("command", [(), *((name,) for name in COMMANDS), ("methods", "show")])
def test_help_explains_itself(herijk, command):
    status, out, err = herijk(*command, "--help")
    assert (status, err) == (0, "")
    assert "Usage:" in out


def commands(command):
    yield command
    for inner in getattr(command, "commands", {}).values():
        yield from commands(inner)


def test_every_command_and_parameter_has_a_help_text():
    for command in commands(get_command(app)):
        assert command.help, command.name
        silent = [p.name for p in command.params if not getattr(p, "help", None)]
        assert silent == [], command.name


def test_the_overview_names_every_command(herijk):
    out = herijk("--help")[1]
    for name in COMMANDS:
        assert re.search(rf"^  {name} +\w", out, re.MULTILINE), name


def test_every_command_is_in_a_section(herijk):
    assert "More:" not in herijk("--help")[1]


def test_the_overview_cuts_no_line(herijk):
    assert "..." not in herijk("--help")[1].split("Begin:")[1]


def test_folders_come_from_option_environment_and_file_in_that_order(herijk, tmp_path, monkeypatch):
    below = tmp_path / "below"
    below.mkdir()
    (tmp_path / "herijk.toml").write_text('data = "from file"\n', encoding="utf-8")
    monkeypatch.chdir(below)
    assert str(tmp_path / "from file") in herijk("due")[2]
    monkeypatch.setenv("HERIJK_DATA", "from environment")
    assert "from environment" in herijk("due")[2]
    assert "from option" in herijk("due", "--data", "from option")[2]


@pytest.mark.parametrize("text", ["data = 1", 'folder = "x"', "data ="])
def test_a_wrong_folders_file_is_said(herijk, tmp_path, monkeypatch, text):
    (tmp_path / "herijk.toml").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    status, _, err = herijk("due")
    assert status == 1
    assert "herijk.toml" in err


@pytest.mark.parametrize(
    "arguments",
    [
        ("rebuild",),
        ("rebuild", "--archive"),
        ("rebuild", "--archive", "x", "--seasons", "2016:2014"),
        ("rebuild", "--archive", "x", "--seasons", "14"),
        ("rebuild", "--archive", "x", "--fast"),
        ("simulate",),
        ("simulate", "x", "--rate", "0"),
        ("audit",),
        ("methods", "show"),
        ("recalculate",),
    ],
)
def test_wrong_arguments_are_status_2(herijk, arguments):
    status, out, err = herijk(*arguments)
    assert status == 2
    assert out == ""
    assert len(err) > 20


def test_a_missing_archive_is_status_1_and_a_sentence(herijk, tmp_path):
    status, out, err = herijk("rebuild", "--archive", tmp_path / "no", "--data", tmp_path / "data")
    assert (status, out) == (1, "")
    assert str(tmp_path / "no") in err
    for expected in ("sloepregister/sloependata.csv", "sleeplijsten/", "meetdata_<jaar>/"):
        assert expected in err
    assert not (tmp_path / "data" / "warehouse.duckdb").exists()


def test_an_empty_archive_is_status_1_and_a_sentence(herijk, tmp_path):
    (tmp_path / "archive").mkdir()
    status, out, err = herijk(
        "rebuild", "--archive", tmp_path / "archive", "--data", tmp_path / "d"
    )
    assert (status, out) == (1, "")
    assert str(tmp_path / "archive") in err
    assert "sloepregister/sloependata.csv" in err


def test_an_archive_without_tow_lists_is_status_1_and_a_sentence(herijk, built, tmp_path):
    boats = tmp_path / "archive/sloepregister/sloependata.csv"
    boats.parent.mkdir(parents=True)
    boats.write_bytes((built.archive / "sloepregister/sloependata.csv").read_bytes())
    status, out, err = herijk(
        "rebuild", "--archive", tmp_path / "archive", "--data", tmp_path / "d"
    )
    assert (status, out) == (1, "")
    assert "sleeplijsten/sleeplijst_<jaar>.csv" in err


def test_an_unknown_method_names_those_that_exist(herijk, built, tmp_path):
    for arguments in (
        ("rebuild", "--archive", built.archive, "--data", tmp_path, "--method", "best"),
        ("methods", "show", "best"),
        ("audit", "FSN101", "--data", built.data, "--method", "best"),
    ):
        status, out, err = herijk(*arguments)
        assert (status, out) == (1, "")
        assert "'best'" in err
        assert "rebased-2015" in err


def test_methods_lists_and_shows(herijk):
    listed = herijk("methods")[1]
    for name in METHODS:
        assert name in listed
        shown = herijk("methods", "show", name)[1]
        assert name in shown
        for step in ("Speed", "Calibration", "Window", "Wind", "Run point", "Runs", "Curve"):
            assert re.search(rf"^  {step}\b.*\. ", shown, re.MULTILINE), step


def test_a_method_is_shown_with_every_option_and_what_differs_is_marked(herijk):
    shown = " ".join(herijk("methods", "show", "corrected-2013")[1].split())
    first, *others = shown.split("Season")[1:]
    assert "Prescribed factor: 1.06 *" in first
    assert not any("*" in seasons for seasons in others)
    steps = Steps.model_json_schema()["$defs"].values()
    assert first.count(";") + len(steps) == sum(len(step["properties"]) for step in steps)


def named(command, *path):
    for name, inner in getattr(command, "commands", {}).items():
        yield " ".join((*path, name)), inner
        yield from named(inner, *path, name)


def test_every_result_has_a_documented_form():
    with_json = {
        name
        for name, command in named(get_command(app))
        if any("--json" in parameter.opts for parameter in command.params)
    }
    assert with_json == set(schemas())
    assert {name for name, _ in named(get_command(app))} - with_json == {
        *(
            "serve",
            "workbench",
            "pages",
            "schema",
        ),  # pages to look at, and the forms
    }


@pytest.mark.parametrize(
    "call",
    [
        ("log-error", "--method", METHODS[1], "{data}"),
        ("verify", "{data}"),
        ("methods", "{data}"),
        ("methods", "show", "rebased", "{data}"),
        ("methods", "check", "rebased", "{data}"),
        ("methods", "new", "ours", "{data}"),
        ("register", f"concept-{METHODS[0]}", "{data}"),
        ("certificate", "--edition", f"concept-{METHODS[1]}", "--out", "c.html", "{data}"),
        ("proposal", METHODS[1], "--out", "p.pdf", "{data}"),
        ("rebase", METHODS[1], "{data}"),
        ("check", "{archive}"),
        ("init", "new"),
        ("simulate", "s", "--seasons", "2014", "--tows-per-season", "1", "--rate", "5"),
    ],
    ids=" ".join,
)
def test_results_have_their_documented_form(herijk, built, tmp_path, monkeypatch, call):
    """The fixture compares; results of other commands are compared where these are tested."""
    monkeypatch.chdir(tmp_path)
    words = [word.format(data=f"--data={built.data}", archive=built.archive) for word in call]
    status, out, err = herijk(*words, "--json")
    assert out, (status, err)


def test_a_schema_is_shown_by_the_name_of_its_command(herijk):
    assert "methods diff" in herijk("schema")[1].splitlines()
    assert json.loads(herijk("schema", "methods", "diff")[1])["title"].endswith("diff --json")
    assert herijk("schema", "serve")[0] == 2


def test_json_is_json_and_nothing_else(herijk, built):
    listed = json.loads(herijk("methods", "--json")[1])
    assert {m["method"] for m in listed["methods"]} >= set(METHODS)
    boat = built.table("tows")["fsn_no"][0]
    report = json.loads(herijk("audit", boat, "--data", built.data, "--json")[1])
    assert report["boat"]["fsn_no"] == boat
    assert {c["method"] for tow in report["tows"] for c in tow["curves"]} == set(METHODS)


def test_audit_shows_every_tow_and_step(herijk, built):
    boat = built.table("tows")["fsn_no"][0]
    status, out, err = herijk("audit", boat, "--data", built.data)
    assert (status, err) == (0, "")
    assert out.startswith("SIMULATED")
    for tow_id in built.table("tows").filter(fsn_no=boat)["tow_id"]:
        assert f"Tow {tow_id}" in out
    curve = built.table("curves").filter(fsn_no=boat, method="as-published").row(0, named=True)
    assert f"Cw {curve['cw_kg_m']:.2f} kg/m" in out
    points = built.table("run_points").filter(tow_id=curve["tow_id"], method="as-published")
    for speed in points["speed_m_s"]:
        assert f"{speed:.3f}" in out


def test_audit_of_one_method_shows_that_one(herijk, built):
    boat = built.table("tows")["fsn_no"][0]
    out = herijk("audit", boat, "--data", built.data, "--method", "rebased-2015")[1]
    assert "rebased-2015" in out
    assert "as-published" not in out


def test_audit_of_an_unknown_boat_gives_the_way_out(herijk, built):
    status, out, err = herijk("audit", "FSN99999", "--data", built.data)
    assert (status, out) == (1, "")
    assert "FSN99999" in err
    assert re.search(r"for example FSN\d+", err)


def test_audit_without_a_database_says_how_to_make_one(herijk, tmp_path):
    status, out, err = herijk("audit", "FSN101", "--data", tmp_path)
    assert (status, out) == (1, "")
    assert "herijk rebuild --archive" in err


def test_simulate_refuses_to_overwrite(herijk, built):
    status, out, err = herijk("simulate", built.archive, "--rate", "20")
    assert (status, out) == (1, "")
    assert "nothing was written" in err


def test_an_archive_where_none_can_be_is_refused_in_a_sentence(herijk, tmp_path):
    (tmp_path / "file").write_text("")
    status, _, err = herijk("init", tmp_path / "file" / "archief")
    assert status == 1
    assert "no archive can be made in" in err
