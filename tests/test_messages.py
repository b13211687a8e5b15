"""Every text has its Dutch with the same values, and data are never translated."""

from string import Formatter

import pytest
from babel.messages.pofile import read_po
from typer.main import get_command

from herijk.cli.main import app, main
from herijk.cli.overview import language_of
from herijk.cli.text import table
from pipeline import errors
from pipeline.messages import LANGUAGE, headings, ngettext, pgettext, say, speaker, spoken
from tests.texts import PO, WHAT_TO_DO, as_file, catalogue, in_python

NL = speaker("nl")


def values(text):
    return sorted(
        f"{name}{form}" for _, name, form, _ in Formatter().parse(text) if name is not None
    )


def forms(text):
    """A text, or one about one and one about several."""
    return (text,) if isinstance(text, str) else text


def test_the_catalogue_holds_what_is_said():
    assert as_file(catalogue()) == PO.read_bytes(), f"The texts have changed. {WHAT_TO_DO}"


def test_every_text_has_its_dutch_with_the_same_values():
    with PO.open("rb") as file:
        texts = [m for m in read_po(file, locale="nl") if m.id]
    assert [m.id for m in texts if not m.string or not all(m.string)] == [], WHAT_TO_DO
    pairs = [pair for m in texts for pair in zip(forms(m.id), forms(m.string), strict=True)]
    assert [english for english, dutch in pairs if values(english) != values(dutch)] == []


def test_texts_are_found_where_they_are_marked():
    source = """
say("a"), x.tell("b" if y else "c", 1), headings("d", "e"), print("f"), say(f"g{y}")
pgettext("context", "h"), ngettext("i", "j", n), MissingKnowledgeError("k" "l")
"""
    single = [(text, None) for text in ("a", "b", "c", "d", "e", "kl")]
    found = [*single, ("h", "context"), (("i", "j"), None)]
    assert sorted(in_python(source), key=str) == sorted(found, key=str)


def test_numbers_have_the_decimal_mark_of_the_language():
    english = "{}, n {} pairs"
    said = say(english, 0.25, 3)
    assert said == "0.25, n 3 pairs"
    assert said.spoken("nl") == "0,25, n 3 paren"
    assert NL(english, 0.25, 3) == "0,25, n 3 paren"


def test_one_and_several_are_said_apart():
    assert [NL(ngettext("1 boat", "{n} boats", n)) for n in (0, 1, 2)] == [
        "0 sloepen", "1 sloep", "2 sloepen",
    ]  # fmt: skip
    assert ngettext("1 boat", "{n} boats", 2) == "2 boats"


def test_equal_english_may_be_other_dutch():
    assert NL("altered") == "gewijzigd"
    assert NL(pgettext("boat", "altered")) == "verbouwd"


def test_an_error_within_a_sentence_is_said_in_its_language():
    inner = errors.MissingKnowledgeError("there is no file {}", "a.csv")
    outer = errors.HerijkError("{}: {}", "b.toml", inner)
    assert str(outer) == "b.toml: there is no file a.csv"
    assert spoken(outer, "nl") == "b.toml: er is geen bestand a.csv"


def test_data_is_never_translated():
    """A boat may be called as a text is: `Look`, a heading of the help, is `Bekijken`."""
    assert NL("Look") == "Bekijken"
    assert spoken("Look", "nl") == "Look"
    assert say("{}, n {} pairs", "Look", 3).spoken("nl") == "Look, n 3 paren"
    assert NL("{}, n {} pairs", "Look", 3) == "Look, n 3 paren"
    before = LANGUAGE.set("nl")
    assert table(headings("boat"), [["Look"]]) == "  sloep\n  Look"
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
