"""Every text has its Dutch with the same values, and data are never translated."""

from pathlib import Path
from string import Formatter

import click
import pytest
from babel.messages.pofile import read_po

from dashboards.document import Document
from dashboards.language import Language
from dashboards.terminal import to_text
from herijk.cli.speaking import find_language
from pipeline import errors
from pipeline.messages import make_translator, ngettext, pgettext, say, write_in_language
from tests.texts import (
    OF_CLICK,
    PO,
    WHAT_TO_DO,
    as_file,
    catalogue,
    in_python,
    list_untranslated,
)

NL = make_translator("nl")


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
    assert list_untranslated(texts) == [], WHAT_TO_DO
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
    english = "{} tows in {} seasons"
    said = say(english, 0.25, 3)
    assert said == "0.25 tows in 3 seasons"
    assert said.write_in("nl") == "0,25 proeven in 3 seizoenen"
    assert NL(english, 0.25, 3) == "0,25 proeven in 3 seizoenen"


def test_one_and_several_are_said_apart():
    assert [NL(ngettext("1 run", "{n} runs", n)) for n in (0, 1, 2)] == [
        "0 runs", "1 run", "2 runs",
    ]  # fmt: skip
    several = ngettext("{n} thing is wrong.", "{n} things are wrong.", 2)
    assert several == "2 things are wrong."
    assert NL(several) != NL(ngettext("{n} thing is wrong.", "{n} things are wrong.", 1))


def test_equal_english_may_be_other_dutch():
    assert NL("altered") == "gewijzigd"
    assert NL(pgettext("boat", "altered")) == "verbouwd"


def test_an_error_within_a_sentence_is_said_in_its_language():
    inner = errors.MissingKnowledgeError("{} is the name of another method; choose another", "a")
    outer = errors.HerijkError("{}: {}", "b.toml", inner)
    assert str(outer) == "b.toml: a is the name of another method; choose another"
    assert (
        write_in_language(outer, "nl")
        == "b.toml: a is de naam van een andere methode; kies een andere naam"
    )


def test_data_is_never_translated():
    """A boat may be called as a text is: `Look`, a heading of the help, is `Bekijken`."""
    assert NL("Look") == "Bekijken"
    assert write_in_language("Look", "nl") == "Look"
    assert say("{} tows in {} seasons", "Look", 3).write_in("nl") == "Look proeven in 3 seizoenen"
    assert NL("{} tows in {} seasons", "Look", 3) == "Look proeven in 3 seizoenen"
    made = Document(Language("nl")).table([{"name": "Look"}], "name", heads={"name": say("boat")})
    assert to_text(made) == "  sloep\n  Look"


def test_click_still_says_what_is_translated():
    source = "".join(f.read_text("utf-8") for f in Path(click.__file__).parent.glob("*.py"))
    said = [text for texts in OF_CLICK for text in forms(texts)]
    assert [text for text in said if f'"{text}"' not in source] == []


@pytest.mark.parametrize(
    ("arguments", "environment", "language"),
    [
        ([], {}, "en"), ([], {"LANG": "nl_NL.UTF-8"}, "nl"), ([], {"LANG": "de_DE"}, "en"),
        ([], {"LC_ALL": "C", "LANG": "nl_NL"}, "en"), (["--lang", "nl", "audit"], {}, "nl"),
        (["audit", "--lang=en"], {"LANG": "nl_BE"}, "en"), (["audit", "--lang", "fr"], {}, "en"),
    ],
)  # fmt: skip
def test_the_language_is_that_asked_for_or_that_of_the_system(arguments, environment, language):
    assert find_language(arguments, environment) == language
