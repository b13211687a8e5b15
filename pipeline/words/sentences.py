"""Sentences that are said where they arise: their English text, with the Dutch beside it.

A sentence is made by `say` from its English text with braces for what is filled in; the catalogue
has the Dutch text to each, as in gettext. It is a text like any other, in English, and can be said
again in Dutch: tables keep it in English, and whoever shows it chooses. `tell` is for texts that
are shown at once, in the language of this command.
"""

from collections.abc import Mapping
from contextvars import ContextVar
from functools import cache
from numbers import Real
from string import Formatter
from typing import Any, Final

LANGUAGES: Final = ("nl", "en")
DECIMALS: Final = {"nl": ",", "en": "."}

LANGUAGE: Final = ContextVar("LANGUAGE", default="en")
"""The language in which this command speaks: `nl` or `en`."""


@cache
def dutch() -> Mapping[str, str]:
    """Every such sentence in Dutch, by its English text; read when it is needed."""
    from pipeline.words.archive import ARCHIVE  # noqa: PLC0415
    from pipeline.words.command import COMMAND  # noqa: PLC0415
    from pipeline.words.errors import ERRORS  # noqa: PLC0415

    return ARCHIVE | ERRORS | COMMAND


class _InWords(Formatter):
    """Fills in values, numbers with the decimal mark of a language."""

    def __init__(self, language: str) -> None:
        self._decimal = DECIMALS[language]

    def format_field(self, value: object, format_spec: str) -> str:
        text = str(super().format_field(value, format_spec))
        return text.replace(".", self._decimal) if isinstance(value, Real) else text


def _filled(
    template: str, language: str, values: tuple[object, ...], named: Mapping[str, object]
) -> str:
    text = dutch().get(template, template) if language == "nl" else template
    return _InWords(language).vformat(text, values, named) if values or named else text


class Sentence(str):
    """A sentence in English that knows its template and what is filled in.

    Attributes:
        template: the English text with braces.
        in_order: what is in the place of braces without a name.
        values: what is in the place of names; may be sentences themselves.
    """

    __slots__ = ("in_order", "template", "values")

    template: str
    in_order: tuple[object, ...]
    values: Mapping[str, Any]

    def spoken(self, language: str) -> str:
        """The sentence in `en` or `nl`; in English where there is no Dutch."""
        in_order = tuple(spoken(value, language) for value in self.in_order)
        named = {name: spoken(value, language) for name, value in self.values.items()}
        return _filled(self.template, language, in_order, named)


def say(template: str, *in_order: object, **named: object) -> Sentence:
    """The sentence that a template gives with the values filled in.

    What comes from files and libraries is made printable: it goes to terminals and tables.
    """
    shown = tuple(_printable(value) for value in in_order)
    by_name = {name: _printable(value) for name, value in named.items()}
    sentence = Sentence(_filled(template, "en", shown, by_name))
    sentence.template, sentence.in_order, sentence.values = template, shown, by_name
    return sentence


def tell(template: str, *in_order: object, **named: object) -> str:
    """A text in the language of this command, with the values filled in, sentences in it too."""
    language = LANGUAGE.get()
    by_name = {name: spoken(value, language) for name, value in named.items()}
    return _filled(template, language, tuple(spoken(v, language) for v in in_order), by_name)


def number(value: float, form: str) -> str:
    """A number as the language of this command writes it; `form` as in `format`."""
    return format(value, form).replace(".", DECIMALS[LANGUAGE.get()])


def in_per_cent(probability: float) -> str:
    """A probability that was counted in draws, which never make it certain."""
    if probability < 0.01:
        return "<\u00a01\u00a0%"
    return ">\u00a099\u00a0%" if probability > 0.99 else f"{100 * probability:.0f}\u00a0%"


def _printable(value: object) -> object:
    """Text or an error as one line without control characters; other values as they are."""
    if isinstance(value, Exception) and value.args and isinstance(value.args[0], Sentence):
        return value.args[0]
    if isinstance(value, Sentence) or not isinstance(value, str | Exception):
        return value
    line = " ".join(str(value).split())
    return "".join(letter if letter.isprintable() else "?" for letter in line)


def spoken(text: Any, language: str) -> Any:
    """A sentence or an error in the language asked for; any other text is data, and stays."""
    if isinstance(text, Exception):
        text = text.args[0] if text.args and isinstance(text.args[0], Sentence) else str(text)
    return text.spoken(language) if isinstance(text, Sentence) else text


def innermost(text: str) -> str:
    """What a sentence says of its line: the sentence within `Line 3: ...`."""
    while isinstance(text, Sentence) and isinstance(text.values.get("what"), Sentence):
        text = text.values["what"]
    return text


def cause_of(text: str) -> str:
    """What sentences of one cause share: the same words about the same column.

    What differs from fault to fault is left open: `column 'klasse' is '…'; H or D is expected.`
    """
    what = innermost(text)
    if not isinstance(what, Sentence):
        return what
    shared = {name: what.values[name] for name in _SHARED if name in what.values}
    return "".join(
        literal + ("" if name is None else str(shared.get(name, "…")))
        for literal, name, _, _ in Formatter().parse(what.template)
    )


_SHARED: Final = ("column", "names", "unit", "found")
"""Values that faults of one cause have in common."""
