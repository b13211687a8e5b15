"""Numbers and texts as people of one language write them."""

import datetime as dt
from collections.abc import Callable, Sequence
from typing import Final, TypeAlias

from markupsafe import Markup, escape

from dashboards import labels
from pipeline.messages import DECIMALS, speaker, spoken

MINUS: Final = "\u2212"


class Speech:
    """Texts, and numbers with the decimal mark of a language and a true minus sign."""

    def __init__(self, language: str) -> None:
        self.language = language
        self.say = speaker(language)
        self.decimal = DECIMALS[language]
        self._marks = str.maketrans({".": self.decimal, "-": MINUS})

    def words(self, what: "Text") -> str:
        """A sentence or a statement in this language; any other text is data, and stays."""
        if isinstance(what, dt.date):
            return self.day(what)
        return what(self) if callable(what) else str(spoken(what, self.language))

    def text(self, text: "str | Headline") -> Markup:
        """A text or a statement, escaped."""
        return escape(text(self) if callable(text) else self.say(text))

    def number(self, value: float, digits: int, sign: str = "") -> str:
        """A number with so many decimals; `sign` is "+" where a plus is to be shown."""
        return f"{value:{sign}z.{digits}f}".translate(self._marks)

    def numbers(self, values: Sequence[float], digits: int) -> list[str]:
        """Numbers with so many decimals; those that are unknown (nan) as nothing."""
        text = "\n".join([f"{{:z.{digits}f}}"] * len(values)).format(*values)
        return text.translate(self._marks).replace("nan", "").split("\n") if values else []

    def per_cent(self, ratio: float) -> str:
        """A ratio as a change in per cent, with its sign."""
        return f"{self.number(100 * (ratio - 1), 1, '+')}\u00a0%"

    def day(self, day: dt.date) -> str:
        """A day as prose has it: 4 June 2018."""
        from babel.dates import format_date  # noqa: PLC0415 - many commands say no day

        return format_date(day, "d\u00a0MMMM\u00a0y", locale=self.language)

    def edition(self, edition: str) -> str:
        """An edition as people call it: a draft by its method."""
        if not edition.startswith("concept-"):
            return edition
        return f"{self.say('draft')}: {self.say(labels.method(edition.removeprefix('concept-')))}"


def duration(seconds: float) -> str:
    """A time rowed as people say it: 1:55:11."""
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes // 60}:{minutes % 60:02d}:{rest:02d}"


Headline: TypeAlias = Callable[[Speech], str]
"""What a section shows in one sentence, in the language of a page."""
Text: TypeAlias = Headline | str | int | dt.date
"""A sentence or a statement; or a text, count or day that is data."""
