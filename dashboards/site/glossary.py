"""The glossary: its page, and its words where pages use them, each opening its own line."""

import re
from typing import Final

from markupsafe import Markup, escape

from dashboards.site.parts import Page, Section
from dashboards.speech import Speech
from pipeline.messages import pgettext, say

TERMS: Final = {
    "tow": (
        pgettext("glossary", "Tow"),
        say("Measuring resistance by towing the boat: six runs, three out and three back."),
    ),
    "cw": (
        say("Cw"),
        say(
            "Resistance coefficient in kg/m: tow force divided by speed squared. The "
            "lower, the easier the boat runs. It is not the dimensionless wave-making "
            "coefficient that naval architects call Cw."
        ),
    ),
    "a": (say("A"), say("Cw at very low speed, in kg/m.")),
    "b": (
        say("B"),
        say(
            "The speed in m/s at which the curve's resistance becomes infinite: the lower, "
            "the faster Cw rises with speed. Cw = A / (1 - (v/B)²)."
        ),
    ),
    "declared": (
        say("Declared speed"),
        say("The speed that the crew says it rows; the curve holds from 85 to 115 % of it."),
    ),
    "interval": (
        say("95 % interval"),
        say("Where the value lies with 95 % confidence, with all causes of uncertainty included."),
    ),
    "as_measured": (
        say("As measured"),
        say("From the tow itself, with the corrections of its day."),
    ),
    "best_estimate": (
        say("Best estimate"),
        say("From all tows of the archive, the boat's own and those of others."),
    ),
    "log_factor": (
        say("Log factor"),
        say("True speed divided by the speed of the log, in a season."),
    ),
    "method": (
        say("Method"),
        say(
            "The agreed way of computing, from measurement to A and B. Every number names its own."
        ),
    ),
    "edition": (
        say("Edition"),
        say("A register as decided, which never changes. A draft is not decided."),
    ),
    "flag": (say("Flag"), say("Something to look at; it changes no number.")),
    "set_aside": (say("Set aside"), say("Not used, with the reason.")),
    "e_n": (
        say("E_n"),
        say(
            "Difference of two tows divided by both 95 % intervals together; beyond 1 they "
            "disagree."
        ),
    ),
    "power": (
        say("Power per rower"),
        say("What each rower gives on average, in watts; the crew that gives most wins."),
    ),
    "type": (
        say("Standard speed"),
        say("The median declared speed of a type, at which boats can be compared."),
    ),
    "crew_class": (pgettext("glossary", "Class"), say("H: men, D: women.")),
    "verification_code": (
        pgettext("glossary", "Verification code"),
        say(
            "Computed from everything behind a line of an edition: if any of that changes, "
            "so does the code."
        ),
    ),
}
"""Words with what they mean."""

MARKED: Final = (
    *("cw", "declared", "interval", "as_measured", "best_estimate", "log_factor", "e_n", "flag"),
    *("power", "type", "verification_code"),
)
"""Terms that open where they are used; others are plain words, or a single letter."""

_WORD: Final = '<button type="button" class="term" popovertarget="term-{}">{}</button>'


class Glossed:
    """Marks on a page the first use of each word of the glossary.

    Attributes:
        used: name, word and meaning of those that the page has used so far.
    """

    def __init__(self, speech: Speech) -> None:
        self.used: list[tuple[str, str, str]] = []
        self._known = {
            speech.say(term).casefold(): (name, speech.say(term), speech.say(meaning))
            for name, (term, meaning) in TERMS.items()
            if name in MARKED
        }
        words = sorted(self._known, key=len, reverse=True)
        spaced = "|".join(word.replace(" ", r"\s") for word in words)
        self._word = re.compile(rf"\b({spaced})\b", re.IGNORECASE)

    def __call__(self, text: str) -> Markup:
        """A text, escaped, its words of the glossary as buttons that open their lines."""
        return Markup(self._word.sub(self._mark, escape(text)))  # noqa: S704 - escaped

    def _mark(self, found: re.Match[str]) -> str:
        line = self._known[found[0].casefold().replace("\u00a0", " ")]
        if line in self.used:
            return found[0]
        self.used.append(line)
        return _WORD.format(line[0], found[0])


def words_page() -> Page:
    """What the words mean, and how to read a page."""
    return Page(
        "words.html",
        say("Glossary"),
        [
            Section(
                "words_list",
                say("What the words mean"),
                say(
                    "A 95 % interval contains the true value in 19 of 20 cases if it includes all "
                    "causes; where it does not, the page says so."
                ),
                terms=list(TERMS.values()),
            )
        ],
    )
