"""What editions say to members, in Dutch and English: codes in words, numbers and days as written.

The texts themselves are the templates beside this module. The words of the site may change; these
may not without need, as the verification codes of published lines are made over the statuses.
"""

import datetime as dt
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, TypeAlias

from pipeline.messages import DECIMALS, LANGUAGES

Words: TypeAlias = Mapping[str, tuple[str, str]]
"""Codes in Dutch and English."""

CAUSES: Final[Words] = {
    "tow": ("andere proef telt", "another tow counts"),
    "input": ("gegevens van de sleep gewijzigd", "data of the tow changed"),
    "other_input": ("gegevens van andere sleepproeven gewijzigd", "data of other tows changed"),
    "code": ("programma gewijzigd", "the code changed"),
    "input_and_code": (
        "gegevens en programma gewijzigd, niet te scheiden",
        "data and code changed, not to be separated",
    ),
    "code_or_other_input": (
        "programma of gegevens van andere sleepproeven gewijzigd",
        "the code or data of other tows changed",
    ),
    "method": ("methode", "method"),
    "printed": (
        "gedrukt register: methode niet vastgelegd",
        "printed register: its method is not recorded",
    ),
    "printed_and_tow": (
        "gedrukt register met een andere proef: methode niet vastgelegd",
        "printed register with another tow: its method is not recorded",
    ),
    "closed_form": (
        "gedrukte A en B omgerekend met de logfactor",
        "printed A and B re-based with the log factor",
    ),
    "unseparated": (
        "methode met gegevens of programma, niet te scheiden",
        "method with data or code, not to be separated",
    ),
    "unexplained": ("onverklaard", "unexplained"),
}
STEPS: Final[Words] = {
    "speed": ("snelheidscorrectie", "speed correction"),
    "window": ("knippen", "steady window"),
    "runs": ("runs die tellen", "runs that count"),
    "calibration": ("ijking", "calibration"),
    "run_point": ("gemiddelde per run", "run point"),
    "wind": ("wind", "wind"),
    "temperature": ("watertemperatuur", "water temperature"),
    "unrecorded": ("wat niemand noteerde", "what nobody recorded"),
    "curve": ("kromme", "curve"),
}
STATUSES: Final[Words] = {
    "valid": ("geldig", "valid"),
    "expired": ("verlopen", "expired"),
    "rejected": ("geen kromme", "no curve"),
    "doubted": ("eerst nakijken", "to be looked at first"),
    "excluded": ("uitgesloten", "excluded"),
    "never_towed": ("niet gesleept", "never towed"),
    "no_valid_curve": ("geen geldige kromme", "no valid curve"),
}
CHANGES: Final[Words] = {
    "added": ("nieuw", "new"),
    "removed": ("vervallen", "gone"),
    "changed": ("gewijzigd", "changed"),
    "same": ("gelijk", "the same"),
}
CREWS: Final[Words] = {"H": ("heren", "men"), "D": ("dames", "women")}


@dataclass(frozen=True)
class Language:
    """A language: its words for codes, and how it writes numbers and days.

    Attributes:
        code: `nl` or `en`.
    """

    code: str

    def one_of(self, texts: tuple[str, str]) -> str:
        """The text of this language, of one in Dutch and one in English."""
        return texts[LANGUAGES.index(self.code)]

    def word(self, words: Words, code: str) -> str:
        """A code in words; one without words stands for itself."""
        return self.one_of(words.get(code, (code, code)))

    def cause(self, cause: str, step: str | None) -> str:
        """A cause, with the step of the method where there is one."""
        words = self.word(CAUSES, cause)
        return f"{words}: {self.word(STEPS, step)}" if step else words

    def number(self, value: float | None, decimals: int = 2) -> str:
        """A number; a dash where it is not known."""
        return "-" if value is None else self._decimal(f"{value:.{decimals}f}")

    def per_cent(self, ratio: float | None) -> str:
        """A ratio as a change in per cent."""
        if ratio is None:
            return "-"
        change = round(100 * (ratio - 1), 2) + 0.0  # never -0.00
        return self._decimal(f"{change:+.2f} %")

    def _decimal(self, text: str) -> str:
        return text.replace(".", DECIMALS[self.code])

    def seconds(self, value: float | None) -> str:
        """Seconds with their sign."""
        return "-" if value is None else f"{value:+.0f} s"

    def day(self, day: dt.date) -> str:
        """A day in full."""
        from babel.dates import format_date  # noqa: PLC0415 - needed where texts are written

        return format_date(day, "d MMMM y", locale=self.code)

    def count(self, lines: int) -> str:
        """A number of lines."""
        return f"{lines} {self.one_of(('regel', 'line') if lines == 1 else ('regels', 'lines'))}"


DUTCH: Final = Language("nl")
ENGLISH: Final = Language("en")


def table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    """A table in Markdown."""
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(_cell(c) for c in line) + " |" for line in lines)


def _cell(text: str) -> str:
    return text.replace("|", r"\|").replace("\n", " ")
