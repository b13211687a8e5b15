"""Which tows: all, the newest of each boat and crew, or those of some seasons."""

import re
from collections.abc import Iterable
from typing import Final

import numpy as np

from pipeline.consistency.eras import season_ranges
from pipeline.consistency.observed import Observed, newest
from pipeline.errors import MissingKnowledgeError

ALL, NEWEST = "all", "newest"

STATED: Final = (ALL, NEWEST)
"""Choices that are no seasons."""


def chosen(observed: Observed, tows: str) -> Observed:
    """The tows of a choice: `newest`, `all`, a season `2014` or a range `2012:2015`.

    Raises:
        MissingKnowledgeError: there is no such choice.
    """
    if tows in STATED:
        return newest(observed) if tows == NEWEST else observed
    match = re.fullmatch(r"(\d{4})(?::(\d{4}))?", tows)
    if match is None:
        raise MissingKnowledgeError(
            "there are no tows {!r}; write all, newest, a season 2014 or a range 2012:2015", tows
        )
    own = observed.table["season"].is_between(int(match[1]), int(match[2] or match[1]))
    return observed.take(np.flatnonzero(own.to_numpy()))


def choices_of(seasons: Iterable[int]) -> list[str]:
    """Every choice that tables and pages hold, of tows of these seasons."""
    known = sorted(set(seasons))
    return [*STATED, *season_ranges(known), *map(str, known)]


def spoken_range(tows: str) -> str:
    """A season or range of seasons as people write it."""
    return tows.replace(":", "\u2013")
