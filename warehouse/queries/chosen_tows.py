"""Which tows: all, or the newest of each boat and crew."""

from typing import Final

from pipeline.consistency.observed import Observed, newest

ALL, NEWEST = "all", "newest"
CHOICES: Final = (ALL, NEWEST)


def chosen(observed: Observed, tows: str) -> Observed:
    """The tows of a choice."""
    return observed if tows == ALL else newest(observed)
