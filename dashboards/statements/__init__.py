"""Statements: what there is to say of the results, each computed and worded once.

A statement is made from tables by the module of its subject, and says the same on the site, in the
terminal, in documents, in mail and in `--json`.
"""

import datetime as dt
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from string import Formatter
from types import MappingProxyType
from typing import Any, Final, TypeAlias

from dashboards.columns import digits_of, ends_of, unit_of
from dashboards.speech import Headline, Speech
from pipeline.messages import Sentence


@dataclass(frozen=True)
class Number:
    """A number as it is shown, with its 95 % interval where that is known.

    Attributes:
        value: in `unit`.
        digits: decimals that are shown.
        sign: "+" where a plus is to be shown.
    """

    value: float
    digits: int = 2
    unit: str = "kg/m"
    low: float | None = None
    high: float | None = None
    sign: str = ""

    def __call__(self, speech: Speech) -> str:
        """The number without its unit, which is in the wording."""
        return speech.number(self.value, self.digits, self.sign)


@dataclass(frozen=True)
class Change:
    """A change from old to new, as a ratio; it is shown in per cent."""

    ratio: float

    def __call__(self, speech: Speech) -> str:
        """The change in per cent, with its sign."""
        return speech.per_cent(self.ratio)


FIGURES: Final = (Number, Change, int, dt.date)
"""What a program is given as it is."""


@dataclass(frozen=True)
class EditionName:
    """An edition, or a draft by its method."""

    name: str

    def __call__(self, speech: Speech) -> str:
        """The edition as people call it."""
        return speech.edition(self.name)


@dataclass(frozen=True)
class Statement:
    """Something that tables say.

    Attributes:
        kind: its code.
        wording: the sentence, with the names of its values in braces.
        values: numbers, names, days, and other statements.
        verdict: code of a judgement in it, such as `beyond`.
        rests_on: the tables it was computed from.
    """

    kind: str
    wording: Sentence
    values: Mapping[str, "Value"] = field(default_factory=dict)
    verdict: str = ""
    rests_on: Sequence[str] = ()

    def __call__(self, speech: Speech) -> str:
        """The sentence in the language of a page."""
        values = {name: _spoken(value, speech) for name, value in self.values.items()}
        return speech.say(self.wording, **values)

    def said(self, speech: Speech, about: str) -> "Said":
        """The statement as `--json` prints it."""
        values = {
            name: value if isinstance(value, FIGURES) else _spoken(value, speech)
            for name, value in self.values.items()
        }
        return Said(about, self.kind, self(speech), self.verdict, values, list(self.rests_on))


@dataclass(frozen=True)
class Said:
    """A statement as a program is given it.

    Attributes:
        about: the boat and crew, type, edition, draft or method.
        kind: its code.
        text: in the language of the command.
        verdict: code of a judgement in it.
        values: numbers with unit, interval and decimals, changes as a ratio, and words.
        rests_on: tables.
    """

    about: str
    kind: str
    text: str
    verdict: str
    values: dict[str, Any]
    rests_on: list[str]


Value: TypeAlias = Headline | Sentence | str | int | dt.date | Sequence["Value"]
"""A number or statement is a headline, too: it speaks by itself."""


def _spoken(value: Value, speech: Speech) -> object:
    if isinstance(value, list):
        return "; ".join(str(_spoken(one, speech)) for one in value)
    if isinstance(value, dt.date):
        return speech.day(value)
    if isinstance(value, Sentence):
        return speech.say(value)
    return value(speech) if callable(value) else value


NO_ROW: Final[Mapping[str, Any]] = MappingProxyType({})


def told(
    kind: str,
    wording: Sentence,
    row: Mapping[str, Any] = NO_ROW,
    *rests_on: str,
    verdict: str = "",
    **values: Value,
) -> Statement:
    """A statement about a row: what its wording names is given, or else a value of the row."""
    names = [name for _, name, _, _ in Formatter().parse(wording.template) if name]
    said = {name: values[name] if name in values else _value(row, name) for name in names}
    return Statement(kind, wording, said, verdict, rests_on)


def _value(row: Mapping[str, Any], column: str) -> Value:
    value: Value = row[column]
    return number(row, column) if isinstance(value, float) else value


def number(
    row: Mapping[str, Any], column: str, digits: int | None = None, sign: str = ""
) -> Number:
    """The number of a column, as its name says: with its unit, its decimals and its interval."""
    low, high = (row.get(end) for end in ends_of(column))
    shown = digits_of(column) if digits is None else digits
    return Number(row[column], shown, unit_of(column), low, high, sign)


def together(statements: Sequence[Statement], between: str = "") -> Headline:
    """Statements as one paragraph; those that go on a sentence begin with their own mark."""
    return lambda speech: between.join(statement(speech) for statement in statements)
