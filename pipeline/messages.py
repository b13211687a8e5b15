"""Texts that people read: English in the source, Dutch in `locale/nl/LC_MESSAGES/herijk.po`.

A text is marked where it stands, by `say`, `pgettext`, `ngettext` or `tell`, and looked up by
gettext when it is shown. What `say` gives is a text like any other, in English, and can be said
again in Dutch: tables keep it in English, and what shows it chooses the language. Any other text is
data (the name of a boat, a method or an edition) and is never translated.
"""

from collections.abc import Mapping
from contextvars import ContextVar
from functools import cache, partial
from gettext import NullTranslations, translation
from numbers import Real
from string import Formatter
from types import MappingProxyType
from typing import Any, Final, Protocol, Self

LANGUAGES: Final = ("nl", "en")
DECIMALS: Final = {"nl": ",", "en": "."}

LANGUAGE: Final = ContextVar("LANGUAGE", default="en")
"""The language in which this command speaks: `nl` or `en`."""

DOMAIN: Final = "herijk"
CATALOGUES: Final = f"{__file__.removesuffix('messages.py')}locale"
"""Where catalogues lie, by language, as gettext looks for them."""


class Say(Protocol):
    """Gives a text in one language, with values filled in."""

    def __call__(self, text: str, *in_order: object, **named: object) -> str:
        """Return the marked text with the values filled in."""


@cache
def _catalogue(language: str) -> NullTranslations:
    if language == "en":
        return NullTranslations()
    try:
        return translation(DOMAIN, CATALOGUES, [language])
    except FileNotFoundError as error:
        raise RuntimeError("texts are not compiled yet: run `make env`") from error


class _WithComma:
    """A number that is written with a decimal comma, whatever the format."""

    __slots__ = ("_value",)

    def __init__(self, value: Real) -> None:
        self._value = value

    def __format__(self, form: str) -> str:
        return format(self._value, form).replace(".", ",")

    def __repr__(self) -> str:
        return format(self)


class Sentence(str):
    """A text in English that can be given in another language.

    It is a `str`, so messages and tables take it as it is. Beside its English it keeps what it was
    made from: a template, and the values that are filled in.

    Attributes:
        template: the English text, with braces for the values.
        in_order: values of braces without a name.
        values: values of braces with a name; may be sentences themselves.
        context: tells two equal English texts apart whose Dutch differs.
        plural: the template for any number but 1; empty if there is one template only.
        number: chooses between `template` and `plural`.
    """

    __slots__ = ("context", "in_order", "number", "plural", "template", "values")

    template: str
    in_order: tuple[object, ...]
    values: Mapping[str, Any]
    context: str
    plural: str
    number: int

    def __new__(
        cls,
        template: str,
        in_order: tuple[object, ...] = (),
        values: Mapping[str, object] = MappingProxyType({}),
        context: str = "",
        plural: str = "",
        number: int = 1,
    ) -> Self:
        """Fill the values in, in English."""
        english = plural if plural and number != 1 else template
        sentence = super().__new__(cls, _fill_in(english, "en", in_order, values))
        sentence.template = str(template)
        sentence.in_order = in_order
        sentence.values = values
        sentence.context = context
        sentence.plural = plural
        sentence.number = number
        return sentence

    def write_in(self, language: str) -> str:
        """Return the sentence in `en` or `nl`; in English where there is no Dutch."""
        if language == "en":
            return str(self)
        text = _look_up(language, self.template, self.context, self.plural, self.number)
        return _fill_in(text, language, self.in_order, self.values)


def _look_up(
    language: str, template: str, context: str = "", plural: str = "", number: int = 1
) -> str:
    """Return the text for a template in the catalogue of a language."""
    catalogue = _catalogue(language)
    if plural:
        return catalogue.ngettext(template, plural, number)
    if context:
        return catalogue.pgettext(context, template)
    return catalogue.gettext(template) if template else ""  # the header goes by no text


def _fill_in(
    text: str, language: str, in_order: tuple[object, ...], values: Mapping[str, object]
) -> str:
    """Return a text with its values filled in, as a language writes them."""
    if not in_order and not values:
        return text
    shown = [_translate_value(value, language) for value in in_order]
    named = {name: _translate_value(value, language) for name, value in values.items()}
    return text.format(*shown, **named)


def _translate_value(value: object, language: str) -> object:
    """Return a value in a language: text translated, a number with its decimal mark."""
    if isinstance(value, str | Exception):
        return write_in_language(value, language)
    return _WithComma(value) if DECIMALS[language] == "," and isinstance(value, Real) else value


def say(template: str, *in_order: object, **named: object) -> Sentence:
    """Return the sentence that a template gives with the values filled in.

    What comes from files and libraries is made printable: it goes to terminals and tables.
    """
    shown = tuple(_printable(value) for value in in_order)
    by_name = {name: _printable(value) for name, value in named.items()}
    return Sentence(template, shown, by_name, context=getattr(template, "context", ""))


def headings(*texts: str) -> tuple[Sentence, ...]:
    """Return the head of a table, each a text of its own."""
    return tuple(map(say, texts))


def pgettext(context: str, template: str) -> Sentence:
    """Return a text whose English has another Dutch elsewhere; the context tells them apart."""
    return Sentence(template, context=context)


def ngettext(one: str, many: str, number: int) -> Sentence:
    """Return a text about one or about several; `{n}` is how many."""
    return Sentence(one, values={"n": number}, plural=many, number=number)


def make_translator(language: str) -> Say:
    """Return a function that gives texts in one language."""
    return partial(_say_in, language)


def _say_in(language: str, text: str, *in_order: object, **named: object) -> str:
    if isinstance(text, Sentence) and not in_order and not named:
        return text.write_in(language)
    known = _look_up(language, text, getattr(text, "context", ""))
    return _fill_in(known, language, in_order, named)


def tell(template: str, *in_order: object, **named: object) -> str:
    """Return a text in the language of this command, values and sentences in it filled in."""
    return _say_in(LANGUAGE.get(), template, *in_order, **named)


def number(value: float, form: str) -> str:
    """Return a number as the language of this command writes it; `form` as in `format`."""
    return format(value, form).replace(".", DECIMALS[LANGUAGE.get()])


def format_probability(probability: float) -> str:
    """Return a probability that was counted in draws, which never make it certain."""
    if probability < 0.01:
        return "<\u00a01\u00a0%"
    return ">\u00a099\u00a0%" if probability > 0.99 else f"{100 * probability:.0f}\u00a0%"


def _printable(value: object) -> object:
    """Return texts and errors as one line without control characters, other values as they are."""
    if isinstance(value, Exception) and value.args and isinstance(value.args[0], Sentence):
        return value.args[0]
    if isinstance(value, Sentence) or not isinstance(value, str | Exception):
        return value
    line = " ".join(str(value).split())
    return line if line.isprintable() else "".join(c if c.isprintable() else "?" for c in line)


def write_in_language(text: Any, language: str) -> Any:
    """Return a sentence or an error in a language; any other text is data, and stays."""
    if isinstance(text, Exception):
        text = text.args[0] if text.args and isinstance(text.args[0], Sentence) else str(text)
    return text.write_in(language) if isinstance(text, Sentence) else text


def find_innermost(text: str) -> str:
    """Return the sentence about a line: the one within `Line 3: ...`."""
    while isinstance(text, Sentence) and isinstance(text.values.get("what"), Sentence):
        text = text.values["what"]
    return text


def find_cause(text: str) -> str:
    """Return the part that sentences of one cause share: the same words about the same column.

    What differs from fault to fault is left open: `column 'klasse' is '…'; H or D is expected.`
    """
    what = find_innermost(text)
    if not isinstance(what, Sentence):
        return what
    shared = {name: what.values[name] for name in _SHARED if name in what.values}
    return "".join(
        literal + ("" if name is None else str(shared.get(name, "…")))
        for literal, name in _parts(what.template)
    )


@cache
def _parts(template: str) -> tuple[tuple[str, str | None], ...]:
    """Return the literals of a template, each with the name of the value that follows it."""
    return tuple((literal, name) for literal, name, _, _ in Formatter().parse(template))


_SHARED: Final = ("column", "names", "unit", "found")
"""Values that faults of one cause have in common."""
