"""Facts of the history of the tow test that several parts need, each said once with its source."""

from typing import Final, NamedTuple

from pipeline.messages import Sentence, say

STEERED_STRAIGHT_FROM: Final = 2014
"""First season in which steering straight was aided, so that a tow pulled askew would have been
seen (presentation R. Pot, 24 January 2015)."""

UNKNOWN_LOG_SD: Final = 0.06
"""Spread of the ln factor of a log about which nothing is known: the worst was 6 % off
(presentation 2015, "Meten van de sleepsnelheid")."""


class Era(NamedTuple):
    """Seasons with like instruments.

    Attributes:
        name: as it is in tables.
        first, last: seasons, both included.
        measured: what was peculiar to how they were measured, in a few words.
    """

    name: str
    first: int
    last: int
    measured: Sentence


ERAS: Final = (
    Era("2009-2011", 2009, 2011, say("worn logs")),
    Era("2012-2013", 2012, 2013, say("Doppler logs")),
    Era("2014-", 2014, 9999, say("dGPS, runs cut")),
)
"""Worn logs, Doppler logs, dGPS and trimming (Sleepproef, R. Pot 2017)."""
