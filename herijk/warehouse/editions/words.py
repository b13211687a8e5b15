"""What editions say to members, in Dutch and English: codes in words, numbers and days as written.

The texts themselves are the templates beside this module.
"""

import datetime as dt
from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class Language:
    """A language: its words for codes, and how it writes numbers and days.

    Attributes:
        code: `nl` or `en`.
        causes, steps, statuses, changes: codes in words.
        line, lines: a line of the register, and more of them.
        crews: words for H and D.
        months: January first.
        decimal: mark before decimals.
    """

    code: str
    causes: dict[str, str]
    steps: dict[str, str]
    statuses: dict[str, str]
    changes: dict[str, str]
    line: str
    lines: str
    crews: dict[str, str]
    months: tuple[str, ...]
    decimal: str

    def cause(self, cause: str, step: str | None) -> str:
        """A cause, with the step of the method where there is one."""
        words = self.causes.get(cause, cause)
        return f"{words}: {self.steps.get(step, step)}" if step else words

    def number(self, value: float | None, decimals: int = 2) -> str:
        """A number; a dash where it is not known."""
        return "-" if value is None else f"{value:.{decimals}f}".replace(".", self.decimal)

    def per_cent(self, ratio: float | None) -> str:
        """A ratio as a change in per cent."""
        if ratio is None:
            return "-"
        change = round(100 * (ratio - 1), 2) + 0.0  # never -0.00
        return f"{change:+.2f} %".replace(".", self.decimal)

    def seconds(self, value: float | None) -> str:
        """Seconds with their sign."""
        return "-" if value is None else f"{value:+.0f} s"

    def day(self, day: dt.date) -> str:
        """A day in full."""
        return f"{day.day} {self.months[day.month - 1]} {day.year}"

    def count(self, lines: int) -> str:
        """A number of lines."""
        return f"{lines} {self.line if lines == 1 else self.lines}"


DUTCH: Final = Language(
    code="nl",
    causes={
        "tow": "andere proef telt",
        "input": "gegevens van de sleep gewijzigd",
        "other_input": "gegevens van andere sleepproeven gewijzigd",
        "code": "programma gewijzigd",
        "input_and_code": "gegevens en programma gewijzigd, niet te scheiden",
        "code_or_other_input": "programma of gegevens van andere sleepproeven gewijzigd",
        "method": "methode",
        "printed": "gedrukt register: methode niet vastgelegd",
        "printed_and_tow": "gedrukt register met een andere proef: methode niet vastgelegd",
        "closed_form": "gedrukte A en B omgerekend met de logfactor",
        "unseparated": "methode met gegevens of programma, niet te scheiden",
        "unexplained": "onverklaard",
    },
    steps={
        "speed": "snelheidscorrectie",
        "window": "knippen",
        "runs": "runs die tellen",
        "calibration": "ijking",
        "run_point": "gemiddelde per run",
        "wind": "wind",
        "temperature": "watertemperatuur",
        "curve": "kromme",
    },
    statuses={
        "valid": "geldig",
        "expired": "verlopen",
        "rejected": "geen kromme",
        "doubted": "eerst nakijken",
        "excluded": "uitgesloten",
        "never_towed": "niet gesleept",
        "no_valid_curve": "geen geldige kromme",
    },
    changes={
        "added": "nieuw",
        "removed": "vervallen",
        "changed": "gewijzigd",
        "same": "gelijk",
    },
    line="regel",
    lines="regels",
    crews={"H": "heren", "D": "dames"},
    months=(
        *("januari", "februari", "maart", "april", "mei", "juni", "juli", "augustus"),
        *("september", "oktober", "november", "december"),
    ),
    decimal=",",
)

ENGLISH: Final = Language(
    code="en",
    causes={
        "tow": "another tow counts",
        "input": "data of the tow changed",
        "other_input": "data of other tows changed",
        "code": "the code changed",
        "input_and_code": "data and code changed, not to be separated",
        "code_or_other_input": "the code or data of other tows changed",
        "method": "method",
        "printed": "printed register: its method is not recorded",
        "printed_and_tow": "printed register with another tow: its method is not recorded",
        "closed_form": "printed A and B re-based with the log factor",
        "unseparated": "method with data or code, not to be separated",
        "unexplained": "unexplained",
    },
    steps={
        "speed": "speed correction",
        "window": "steady window",
        "runs": "runs that count",
        "calibration": "calibration",
        "run_point": "run point",
        "wind": "wind",
        "temperature": "water temperature",
        "curve": "curve",
    },
    statuses={
        "valid": "valid",
        "expired": "expired",
        "rejected": "no curve",
        "doubted": "to be looked at first",
        "excluded": "excluded",
        "never_towed": "never towed",
        "no_valid_curve": "no valid curve",
    },
    changes={"added": "new", "removed": "gone", "changed": "changed", "same": "the same"},
    line="line",
    lines="lines",
    crews={"H": "men", "D": "women"},
    months=(
        *("January", "February", "March", "April", "May", "June", "July", "August"),
        *("September", "October", "November", "December"),
    ),
    decimal=".",
)

LANGUAGES: Final = {"nl": DUTCH, "en": ENGLISH}


def table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    """A table in Markdown."""
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(_cell(c) for c in line) + " |" for line in lines)


def _cell(text: str) -> str:
    return text.replace("|", r"\|").replace("\n", " ")
