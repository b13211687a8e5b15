"""The command line itself: its help in two languages, its folders, its errors and exit status."""

import re
import shlex
import shutil

import click
import pytest
from click.testing import CliRunner

from herijk.cli.main import app
from pipeline.messages import LANGUAGES
from tests.herijk.conftest import FIELDS


def named(command, *path):
    for name, inner in getattr(command, "commands", {}).items():
        yield (*path, name), inner
        yield from named(inner, *path, name)


COMMANDS = dict(named(app))


@pytest.mark.parametrize("path", [(), *COMMANDS], ids=" ".join)
def test_help_explains_itself_in_either_language(path):
    for language, usage in (("en", "Usage:"), ("nl", "Gebruik:")):
        shown = CliRunner().invoke(app, [*path, "--help", "--lang", language])
        assert (shown.exit_code, shown.stderr) == (0, "")
        assert shown.output.startswith(usage)
        assert ("Toon deze uitleg." in shown.output) == (language == "nl")


def test_the_overview_has_every_command_in_a_section_with_its_whole_first_sentence():
    listed = [name for names in app.sections.values() for name in names]
    assert sorted(listed) == sorted(app.commands)
    shown = CliRunner().invoke(app, ["--help", "--lang", "en"]).output
    assert "..." not in shown.split("Begin:")[1]
    for name in app.commands:
        assert re.search(rf"^  {name} +\w", shown, re.MULTILINE), name


@pytest.mark.parametrize("path", COMMANDS, ids=" ".join)
def test_help_ends_with_examples_that_the_command_takes(path):
    command = COMMANDS[path]
    assert command.examples
    for example in command.examples:
        name, *words = shlex.split(example.partition(" >> ")[0])
        assert (name, *words[: len(path)]) == ("herijk", *path)
        command.make_parser(click.Context(command)).parse_args(words[len(path) :])
    shown = CliRunner().invoke(app, [*path, "--help", "--lang", "en"]).output
    assert shown.endswith(f"  {command.examples[-1]}\n")


def test_a_shell_completes_commands():
    script = CliRunner().invoke(app, ["completion", "bash"]).output
    assert "_HERIJK_COMPLETE=bash_complete" in script
    asked = {"_HERIJK_COMPLETE": "bash_complete", "COMP_WORDS": "herijk se", "COMP_CWORD": "1"}
    given = CliRunner().invoke(app, prog_name="herijk", env=asked).output
    assert given.split() == ["plain,seasons", "plain,serve"]


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
    assert {call.split()[0] for call in FIELDS} == with_json


def test_a_folder_comes_from_its_option_or_else_from_the_environment(herijk, monkeypatch):
    monkeypatch.setenv("HERIJK_DATA", "from environment")
    assert "from environment" in herijk("seasons")[2]
    assert "from option" in herijk("seasons", "--data", "from option")[2]


REFUSED = {
    2: """
        rebuild
        rebuild --archive x --seasons 2016:2014
        simulate
        simulate x --rate 0
        audit a b c
        rebuildd
        compare a b --fatigue x
        register --as-of 1-6-2014
        publish x --valid-from 2014-06-01 --decision d
        publish x --printed 2014 --carry y --valid-from 2014-06-01 --decision d
    """,
    1: """
        rebuild --archive {tmp}/nothing --data {tmp}/data
        rebuild --archive {empty} --data {tmp}/data
        rebuild --archive {boats} --data {tmp}/data
        rebuild --archive {archive} --data {tmp}/data --method best
        methods show best
        methods new rebased
        methods new taken
        methods check {tmp}/wrong.toml
        methods check {tmp}/cmp.py
        audit FSN101 --data {data} --method best
        audit FSN101 --data {data} --tow 1999-001
        audit FSN99999 --data {data}
        audit FSN101 --data {empty}
        assess 2014-999 --archive {archive} --data {data}
        register --due concept-rebased --data {data}
        register --due nothing --data {data}
        register --data {data} --as-of 1995-01-01
        simulate {archive} --rate 20
        init {file}/archief
        verify --data {tmp}/typo
        compare rebased nothing --data {data}
        export pages --out {archive} --data {data}
    """,
}
"""Calls by the status they end with."""
WRONG = 'name = "wrong"\ntitle = "x"\nextends = "rebased"\n[steps.wind]\nzij = 1\n'


@pytest.fixture
def folders(built, tmp_path, monkeypatch):
    """What the calls above name."""
    monkeypatch.chdir(tmp_path)
    made = {name: tmp_path / name for name in ("empty", "boats", "file")}
    made["empty"].mkdir()
    boats = made["boats"] / "sloepregister/sloependata.csv"
    boats.parent.mkdir(parents=True)
    shutil.copy(built.archive / "sloepregister/sloependata.csv", boats)
    for name, text in (("file", ""), ("cmp.py", ""), ("taken.toml", ""), ("wrong.toml", WRONG)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    return {"archive": built.archive, "data": built.data} | made | {"tmp": tmp_path}


@pytest.mark.parametrize("language", LANGUAGES)
def test_what_cannot_be_done_ends_with_its_status_and_the_way_out(
    herijk, folders, snapshot, language
):
    shown = []
    for status, calls in REFUSED.items():
        for call in calls.split("\n        ")[1:]:
            words = [word.format(**folders) for word in call.split()]
            ended, out, err = herijk("--lang", language, *words)
            assert (ended, out) == (status, ""), call
            shown.append(f"$ herijk {call.strip()}\n{err}")
    text = "\n".join(shown)
    for name, folder in folders.items():
        text = text.replace(str(folder), f"{{{name}}}")
    snapshot(f"refused-{language}", text)
    assert not (folders["tmp"] / "data" / "warehouse.duckdb").exists()


def test_check_says_what_is_sound_and_what_is_not(herijk, built, tmp_path):
    status, out, _ = herijk("check", built.archive, "--data", built.data)
    assert status == 0
    assert "40 tows in 2 seasons" in out
    (tmp_path / "beheer.toml").write_text("nightly = 3\n", encoding="utf-8")
    (tmp_path / "methods").mkdir()
    (tmp_path / "methods" / "ours.toml").write_text('name = "theirs"\n', encoding="utf-8")
    status, out, _ = herijk("check", "--data", tmp_path)
    assert status == 1
    wrong = [line.split(":")[0].split() for line in out.splitlines() if line.startswith("WRONG")]
    assert wrong == [["WRONG", "settings"], ["WRONG", "method", "ours"], ["WRONG", "tables"]]
