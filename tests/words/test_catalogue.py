"""Every text of faults and of the command line exists in Dutch, with the same values in it."""

import ast
from functools import cache
from string import Formatter

import pytest
from typer.main import get_command

from herijk.cli.main import app, main
from herijk.cli.overview import SECTIONS, USAGE, language_of
from herijk.cli.text import table
from pipeline import errors
from pipeline.toml_text import PROBLEMS
from pipeline.words import LANGUAGE, dutch, say, spoken, tell
from tests.architecture.repository import ROOT, modules

DUTCH = dutch()
SPEAKERS = {"say", "tell", "wrong", "fault", "MethodFileError"} | {
    n for n in dir(errors) if n.endswith("Error")
}
OF_LIBRARY = {
    *("Arguments", "Options", "Commands", "default", "required", "env var"),
    *("Show this message and exit.", *USAGE),
}
"""What the library of the command line says itself."""

SAME = {
    *("A", "B", "Cw", "W", "kg", "m", "n", "p", "run", "s", "v"),
    *("factor", "hash", "interval", "log", "per", "podium", "register", "status", "type", "wind"),
}
"""Words that are no others in Dutch."""


@cache
def sources():
    """Module and room of each file outside the catalogue."""
    places = [(file, file.relative_to(ROOT).parts) for file in modules()]
    return [
        (ast.parse(file.read_text("utf-8")), parts[parts[0] == "herijk"])
        for file, parts in places
        if parts[:2] != ("pipeline", "words")
    ]


def texts(node):
    """The texts that an expression can be, as far as they are written in it."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    for inner in (getattr(node, name, None) for name in ("body", "orelse", "value")):
        if isinstance(inner, ast.AST):
            yield from texts(inner)
    for element in getattr(node, "elts", ()):
        yield from texts(element)


def name_of(node):
    """The last part of a name: `table` of `text.table`."""
    return getattr(node, "attr", None) or getattr(node, "id", "")


def head_of_table(node):
    """The head of a table where it is written in place."""
    if isinstance(node, ast.Assign) and name_of(node.targets[0]) in ("head", "columns"):
        return node.value
    is_table = isinstance(node, ast.Call) and name_of(node.func) == "table" and node.args
    return node.args[0] if is_table else None


def said_in_code():
    for tree, room in sources():
        for node in ast.walk(tree):
            name = name_of(node.func) if isinstance(node, ast.Call) and node.args else ""
            if name in SPEAKERS - {"DefectiveInputError"} and (name, room) != ("say", "dashboards"):
                yield from texts(node.args[0])
            if room == "cli":
                yield from texts(head_of_table(node))


def said_in_help(command):
    yield " ".join(command.help.split())
    for parameter in command.params:
        yield " ".join((parameter.help or "").split())
    for inner in getattr(command, "commands", {}).values():
        yield from said_in_help(inner)


def has_words(text):
    literals = "".join(literal for literal, *_ in Formatter().parse(text))
    return any(word.isalpha() and word not in SAME for word in literals.split())


def test_every_text_exists_in_dutch():
    said = {*said_in_code(), *said_in_help(get_command(app)), *SECTIONS, *OF_LIBRARY}
    said |= {*PROBLEMS.values()}
    assert {text for text in said if has_words(text)} - DUTCH.keys() == set()


def test_every_dutch_text_is_of_something_that_is_said():
    written = {text for tree, _ in sources() for node in ast.walk(tree) for text in texts(node)}
    assert DUTCH.keys() - written - OF_LIBRARY - set(said_in_help(get_command(app))) == set()


def values(text):
    return sorted(
        f"{name}{form}" for _, name, form, _ in Formatter().parse(text) if name is not None
    )


def test_dutch_has_the_same_values():
    assert [english for english, dutch in DUTCH.items() if values(english) != values(dutch)] == []


def test_numbers_have_the_decimal_mark_of_the_language():
    english = "{}, n {} pairs"
    said = say(english, 0.25, 3)
    assert said == "0.25, n 3 pairs"
    assert said.spoken("nl") == "0,25, n 3 paren"
    before = LANGUAGE.set("nl")
    assert tell(english, 0.25, 3) == "0,25, n 3 paren"
    LANGUAGE.reset(before)


def test_an_error_within_a_sentence_is_said_in_its_language():
    inner = errors.MissingKnowledgeError("there is no file {}", "a.csv")
    outer = errors.HerijkError("{}: {}", "b.toml", inner)
    assert str(outer) == "b.toml: there is no file a.csv"
    assert spoken(outer, "nl") == "b.toml: er is geen bestand a.csv"


def test_data_is_never_translated():
    """A boat may be called as a text is: `Look`, a heading of the help, is `Bekijken`."""
    assert DUTCH["Look"] == "Bekijken"
    assert spoken("Look", "nl") == "Look"
    assert say("{}, n {} pairs", "Look", 3).spoken("nl") == "Look, n 3 paren"
    before = LANGUAGE.set("nl")
    assert tell("{}, n {} pairs", "Look", 3) == "Look, n 3 paren"
    assert table(["boat"], [["Look"]]) == "  sloep\n  Look"
    LANGUAGE.reset(before)


def commands(command):
    yield command
    for inner in getattr(command, "commands", {}).values():
        yield from commands(inner)


def test_every_command_takes_a_language_once():
    for command in commands(get_command(app)):
        options = [option for parameter in command.params for option in parameter.opts]
        assert options.count("--lang") == 1, command.name


@pytest.mark.parametrize(
    ("arguments", "environment", "language"),
    [
        ([], {}, "en"), ([], {"LANG": "nl_NL.UTF-8"}, "nl"), ([], {"LANG": "de_DE"}, "en"),
        ([], {"LC_ALL": "C", "LANG": "nl_NL"}, "en"), (["--lang", "nl", "due"], {}, "nl"),
        (["due", "--lang=en"], {"LANG": "nl_BE"}, "en"), (["due", "--lang", "fr"], {}, "en"),
    ],
)  # fmt: skip
def test_the_language_is_that_asked_for_or_that_of_the_system(arguments, environment, language):
    assert language_of(arguments, environment) == language


def test_wrong_arguments_are_told_in_dutch(monkeypatch, capsys):
    for arguments, said in (
        (["rebuild"], "Optie '--archive' (omgevingsvariabele: 'HERIJK_ARCHIVE') ontbreekt."),
        (["due", "--as-of", "gisteren"], "schrijf een dag als 2026-05-08"),
        (["frob"], "Er is geen opdracht 'frob'."),
        (["rebuildd"], "Er is geen opdracht 'rebuildd'. Bedoelt u 'rebuild'?"),
        (["due", "--frob"], "Er is geen optie --frob"),
        (["diff", "a", "b", "--fatigue", "x"], "'--fatigue': 'x' is niet een van 'none', 'known'"),
        (["slides", *("--type", "a") * 3], "Ongeldige waarde: geef een of twee types"),
    ):
        monkeypatch.setattr("sys.argv", ["herijk", "--lang", "nl", *arguments])
        with pytest.raises(SystemExit) as stopped:
            main()
        assert stopped.value.code == 2
        assert said in capsys.readouterr().err
    LANGUAGE.set("en")
