"""How people of one language write texts, numbers, days and the values of columns."""

import datetime as dt
import json
import re
from collections.abc import Callable, Mapping
from functools import cache
from string import Formatter
from typing import Any, Final

from markupsafe import Markup, escape

from dashboards import words
from pipeline.messages import (
    DECIMALS,
    LANGUAGES,
    Sentence,
    format_probability,
    make_translator,
    say,
    write_in_language,
)
from pipeline.method.definition import LAST_SEASON
from pipeline.tables.display import Kind, get_column

NBSP: Final = "\u00a0"
MINUS: Final = "\u2212"


@cache
def _list_field_names(text: str) -> list[str]:
    """Return the names in braces of a text."""
    return [name for _, name, _, _ in Formatter().parse(text) if name]


def get_other_language(tag: str) -> str:
    """Return the tag of the language that a page has beside its own."""
    (other,) = set(LANGUAGES) - {tag}
    return other


class Language:
    """One language; templates and charts write everything through it.

    Args:
        tag: `nl` or `en`.
        about: facts about the database: what its own classes of crews are called.
    """

    def __init__(self, tag: str, about: Mapping[str, str] | None = None) -> None:
        self.tag = tag
        self._own_crews: dict[str, str] = json.loads((about or {}).get("crew_names", "{}"))
        self._say = make_translator(tag)
        self._marks = str.maketrans({".": DECIMALS[tag], "-": MINUS})

    # -- Texts ------------------------------------------------------------------------------------

    def say(self, text: Sentence | str) -> str:
        """Return a text without values."""
        return str(write_in_language(text, self.tag))

    def fill_in(self, text: str, row: Mapping[str, Any] | None = None, /, **values: Any) -> Markup:
        """Return a text with values filled in, escaped.

        Args:
            text: English, with the names of values in braces.
            row: values by column; each is written as its column is everywhere.
            values: go before those of the row.
        """
        template = escape(self._say(text))
        if row is None and not values:
            return template
        known = {**(row or {}), **values}
        names = _list_field_names(str(template))
        return template.format(**{name: self.write_in_text(name, known[name]) for name in names})

    # -- Values -----------------------------------------------------------------------------------

    def write_in_text(self, name: str, value: Any) -> str:
        """Return a value of a column as prose has it: days in full, words of data as they are."""
        if isinstance(value, Markup):
            return value
        if isinstance(value, dt.date):
            return self.write_day(value)
        kind = get_column(name).kind
        if isinstance(value, str) and kind is Kind.PLAIN:
            return self.say(value)
        if isinstance(value, list | tuple) and kind in (Kind.CODE, Kind.CANDIDATES):
            return "; ".join(self.write(name, one) for one in value)
        return self.write(name, value)

    def write(self, name: str, value: Any) -> str:
        """Return a value of a column as a table has it; None is nothing."""
        if value is None:
            return ""
        if isinstance(value, bool):
            return self.say(words.YES if value else words.NO)
        kind = get_column(name).kind
        if isinstance(value, float):
            return self._write_float(kind, name, value)
        if kind is not Kind.PLAIN:
            return self._write_words(kind, value)
        if isinstance(value, list | tuple):
            return ", ".join(map(str, value))
        return self.say(value) if isinstance(value, str) else str(value)

    def _write_words(self, kind: Kind, value: Any) -> str:
        """Return a code or name of a column in words."""
        if kind is Kind.CAUSE:
            return self.say(words.name_change_cause(value))
        if kind is Kind.CAUSES:
            return self._write_causes(json.loads(value) if isinstance(value, str) else value)
        if kind in (Kind.CODE, Kind.CANDIDATES):
            return self._write_codes(kind, value)
        if kind in _NAMES:
            return self.say(_NAMES[kind](value))
        return str(value)

    def _write_float(self, kind: Kind, name: str, value: float) -> str:
        if kind is Kind.DURATION:
            return write_duration(value)
        if kind is Kind.CHANGE:
            return self.write_change(value)
        if kind is Kind.SHARE:
            return f"{self.write_percent(value)}{NBSP}%"
        if kind is Kind.CHANCE:
            return format_probability(value)
        return self.write_number(value, get_column(name).decimals)

    def _write_codes(self, kind: Kind, value: Any) -> str:
        codes = value if isinstance(value, list | tuple) else re.split(", ?", str(value))
        name_it = words.name_candidate if kind is Kind.CANDIDATES else words.name_code
        return ", ".join(self._write_code(name_it, code) for code in codes if code)

    def _write_code(self, name_it: Callable[[str], Sentence], code: str) -> str:
        """Return a code in words; one of a season, `log_scale 2010`, with its year."""
        kind, blank, year = code.rpartition(" ")
        if year.isdigit():
            return f"{self.say(name_it(kind))}{blank}{year}"
        return self.say(name_it(code))

    def _write_causes(self, causes: list[dict[str, Any]]) -> str:
        """Return the causes of a change, each with its factor in per cent."""
        return "; ".join(
            f"{self.say(words.name_change_cause(one))} {self.write_change(one['factor'])}"
            for one in causes
        )

    def write_number(self, value: float, decimals: int = 2, sign: str = "") -> str:
        """Return a number with a true minus; `sign` is "+" where a plus is shown."""
        return f"{value:{sign}z.{decimals}f}".translate(self._marks)

    def write_plain(self, value: float) -> str:
        """Return a number with the digits that it has."""
        return f"{value:.10g}".translate(self._marks)

    def write_percent(self, ratio: float, decimals: int = 1) -> str:
        """Return a part of a whole in per cent, without the sign."""
        return self.write_number(100 * ratio, decimals)

    def write_change(self, ratio: float) -> str:
        """Return new over old as a change in per cent: +2.6 %."""
        return f"{self.write_number(100 * (ratio - 1), 1, '+')}{NBSP}%"

    def write_day(self, day: dt.date) -> str:
        """Return a day as prose has it: 4 June 2018."""
        from babel.dates import format_date  # noqa: PLC0415 - many commands say no day

        return format_date(day, f"d{NBSP}MMMM{NBSP}y", locale=self.tag)

    # -- Names ------------------------------------------------------------------------------------

    def name_code(self, code: str) -> str:
        """Return a code of the tables in words."""
        return self.say(words.name_code(code))

    def name_method(self, method: str) -> str:
        """Return a method as people call it."""
        return self.say(words.name_method(method))

    def name_crew(self, crew_class: str) -> str:
        """Return the people of a class."""
        return self._own_crews.get(crew_class) or self.say(words.name_crew(crew_class))

    @property
    def is_other_federation(self) -> bool:
        """Whether the archive has its own classes of crews: it is not the Dutch federation's."""
        return bool(self._own_crews)

    def list_crews(self) -> list[tuple[str, str]]:
        """Return every class by its code, with its people."""
        return [(code, self.name_crew(code)) for code in self._own_crews or words.CREWS]

    def name_edition(self, edition: str) -> str:
        """Return an edition, or a draft by its method, as people call it."""
        return self.say(words.name_edition(edition))

    def name_option(self, key: str) -> str:
        """Return an option of a method, or one of its values, in words."""
        return self.say(words.name_option(key))

    def name_choice(self, value: str) -> str:
        """Return in words a value that an option of a method can have."""
        return self.say(words.name_choice(value))

    def write_seasons(self, first: int, last: int) -> str:
        """Return seasons from one to another; those of the last range go on."""
        if last >= LAST_SEASON:
            return self.say(say("{} and later", first))
        return str(first) if first == last else f"{first}\u2013{last}"

    def get_unit(self, name: str) -> str:
        """Return the unit of a column or option; empty where it has none."""
        return get_column(name).unit

    def get_title(self, name: str) -> str:
        """Return the title of a column, without the places where it may be broken."""
        return self.say(get_column(name).title).replace("\u00ad", "").replace("\u200b", "")


_NAMES: Final[Mapping[Kind, Callable[[Any], Sentence]]] = {
    Kind.METHOD: words.name_method,
    Kind.EDITION: words.name_edition,
    Kind.DIRECTION: words.name_direction,
}


def write_duration(seconds: float) -> str:
    """Return a time rowed as people say it: 1:55:11."""
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes // 60}:{minutes % 60:02d}:{rest:02d}"
