"""Facts of the history of the tow test that several parts need, each said once with its source."""

from typing import Final

STEERED_STRAIGHT_FROM: Final = 2014
"""First season in which steering straight was aided, so that a tow pulled askew would have been
seen (presentation R. Pot, 24 January 2015)."""

UNKNOWN_LOG_SD: Final = 0.06
"""Spread of the ln factor of a log about which nothing is known: the worst was 6 % off
(presentation 2015, "Meten van de sleepsnelheid")."""

SLOW_POWER_W: Final = {"H": 60.0, "D": 34.0}
"""Power per rower under which a tow is too slow. Men: "minder dan 60-70 Watt" (Cw-kromme, R. Pot
2015). Women tow at 40-55 W instead of 70-90 W: the same share of their range (inferred)."""
