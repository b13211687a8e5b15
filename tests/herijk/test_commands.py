"""The command line itself: its help in two languages, its folders, its errors and exit status."""

import re

import pytest
from click.testing import CliRunner

from herijk.cli.forms import FORMS
from herijk.cli.main import SECTIONS, app


def named(command, *path):
    for name, inner in getattr(command, "commands", {}).items():
        yield (*path, name), inner
        yield from named(inner, *path, name)


COMMANDS = dict(named(app))


@pytest.mark.parametrize(("lang", "usage"), [("en", "Usage:"), ("nl", "Gebruik:")])
@pytest.mark.parametrize("path", [(), *COMMANDS], ids=" ".join)
def test_help_explains_itself_in_either_language(path, lang, usage):
    shown = CliRunner().invoke(app, [*path, "--help", "--lang", lang])
    assert (shown.exit_code, shown.stderr) == (0, "")
    assert shown.output.startswith(usage)
    assert ("Toon deze uitleg." in shown.output) == (lang == "nl")


def test_the_overview_has_every_command_in_a_section_with_its_whole_first_sentence():
    assert sorted(sum(SECTIONS.values(), ())) == sorted(app.commands)
    shown = CliRunner().invoke(app, ["--help", "--lang", "en"]).output
    assert "..." not in shown.split("Begin:")[1]
    for name in app.commands:
        assert re.search(rf"^  {name} +\w", shown, re.MULTILINE), name


@pytest.mark.parametrize("path", COMMANDS, ids=" ".join)
def test_every_command_and_parameter_has_a_help_text(path):
    command = COMMANDS[path]
    assert command.help
    assert [p.name for p in command.params if not p.help] == []
    assert sum("--lang" in p.opts for p in command.params) == 1


def test_every_result_has_a_documented_form():
    with_json = {
        path[0]
        for path, command in COMMANDS.items()
        if any("--json" in parameter.opts for parameter in command.params)
    }
    assert {call.split()[0] for call in FORMS} == with_json


def test_a_folder_comes_from_its_option_or_else_from_the_environment(herijk, monkeypatch):
    monkeypatch.setenv("HERIJK_DATA", "from environment")
    assert "from environment" in herijk("seasons")[2]
    assert "from option" in herijk("seasons", "--data", "from option")[2]


@pytest.mark.parametrize(
    ("call", "said"),
    [
        ("rebuild", "Missing option '--archive'"),
        ("rebuild --archive x --seasons 2016:2014", "write a season"),
        ("simulate", "name the folder"),
        ("simulate x --rate 0", "0 is not in the range"),
        ("audit a b c", "one or two types"),
        ("rebuildd", "Did you mean 'rebuild'?"),
        ("compare a b --fatigue x", "'x' is not one of 'none', 'known', 'extend'"),
        ("register --as-of 1-6-2014", "write a day as 2026-05-08"),
        ("publish x --valid-from 2014-06-01 --decision d", "give --method NAME, or --printed"),
        (
            "publish x --printed 2014 --carry y --valid-from 2014-06-01 --decision d",
            "--carry goes with --method",
        ),
    ],
)
def test_wrong_arguments_are_status_2_and_a_sentence(herijk, call, said):
    status, out, err = herijk("--lang", "en", *call.split())
    assert (status, out) == (2, "")
    assert said in err


@pytest.mark.parametrize(
    ("call", "said"),
    [
        ("rebuild", "Er ontbreekt een optie: '--archive'"),
        ("rebuildd", "Er is geen opdracht 'rebuildd'. Bedoelt u 'rebuild'?"),
        ("register --as-of gisteren", "schrijf een dag als 2026-05-08"),
        ("compare a b --fatigue x", "'--fatigue': 'x' is niet een van 'none', 'known'"),
    ],
)
def test_wrong_arguments_are_named_in_dutch(herijk, call, said):
    status, _, err = herijk("--lang", "nl", *call.split())
    assert status == 2
    assert said in err
    assert err.startswith("Gebruik: herijk ")


@pytest.mark.parametrize("given", ["nothing", "folder", "boats"])
def test_an_archive_that_is_none_is_status_1_and_a_sentence(herijk, built, tmp_path, given):
    archive, data = tmp_path / "archive", tmp_path / "data"
    boats = archive / "sloepregister/sloependata.csv"
    if given != "nothing":
        archive.mkdir()
    if given == "boats":
        boats.parent.mkdir()
        boats.write_bytes((built.archive / "sloepregister/sloependata.csv").read_bytes())
    status, out, err = herijk("rebuild", "--archive", archive, "--data", data)
    assert (status, out) == (1, "")
    expected = "sleeplijsten/sleeplijst_<jaar>.csv" if given == "boats" else str(archive)
    assert expected in err
    assert not (data / "warehouse.duckdb").exists()


@pytest.mark.parametrize(
    ("call", "said"),
    [
        ("rebuild --archive {archive} --data {tmp} --method best", "rebased-2015"),
        ("methods show best", "rebased-2015"),
        ("audit FSN101 --data {data} --method best", "rebased-2015"),
        ("audit FSN99999 --data {data}", "for example FSN"),
        ("audit FSN101 --data {tmp}", "herijk rebuild --archive"),
        ("register --due --data {data}", "herijk rebuild"),
        ("register --due nothing --data {data}", "rebased-2015"),
        ("register --data {data} --as-of 1995-01-01", "no tow of 1995-01-01 or before"),
        ("simulate {archive} --rate 20", "nothing was written"),
        ("init {file}/archief", "no archive can be made in"),
        ("verify --data {tmp}/typo", "holds no editions and no tables"),
        ("compare rebased nothing --data {data}", "rebased-2015"),
        ("export pages --out {tmp} --data {data}", "holds no pages"),
    ],
)
def test_what_cannot_be_done_is_status_1_with_the_way_out(herijk, built, tmp_path, call, said):
    (tmp_path / "file").write_text("")
    folders = {"archive": built.archive, "data": built.data, "tmp": tmp_path}
    words = [word.format(file=tmp_path / "file", **folders) for word in call.split()]
    status, out, err = herijk(*words)
    assert (status, out) == (1, "")
    assert said in err


def test_check_says_what_is_sound_and_what_is_not(herijk, built, tmp_path):
    status, out, _ = herijk("check", built.archive, "--data", built.data)
    assert status == 0
    assert "40 tows in 2 seasons" in out
    (tmp_path / "beheer.toml").write_text("nightly = 3\n", encoding="utf-8")
    (tmp_path / "methods").mkdir()
    (tmp_path / "methods" / "ours.toml").write_text('name = "theirs"\n', encoding="utf-8")
    status, out, _ = herijk("check", "--data", tmp_path)
    assert status == 1
    wrong = [line.split(":")[0] for line in out.splitlines() if line.startswith("WRONG")]
    assert wrong == ["WRONG  settings", "WRONG  method ours", "WRONG  tables"]
