"""What the tows of a boat say together: their joint normal density, unreported changes summed.

Each tow gives three numbers: ln Cw and the bend q of its own curve, and ln(GPS / log). The boat's
level and bend are random and integrated out. The level drifts in a way of the boat's own, as paint,
wear and fouling differ: a random walk over the seasons. A boat may have been altered between two
tows without a report, and any tow of the years before steering was aided may have been pulled
askew. At most one of these per boat: each, and that there is none, is a component of a normal
mixture.

Belongs here: the patterns and the covariance of a boat's numbers, as `pipeline.model` takes them.
Does not: what moves the numbers of a tow (`effects`), the search for the unknowns (`fit`).
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.model import Boats
from pipeline.season_log.assumed import Settings

LEVEL, BEND, GPS = range(3)
"""The numbers of a tow."""

LEVEL_SD: Final = 1.0
"""Spread of ln Cw between boats: so wide that no boat's level is drawn to that of others."""


@dataclass(frozen=True)
class Patterns:
    """Patterns of changes of b boats with the same number of tows, as many of them early.

    Attributes:
        tow: (b, tows) place of each tow.
        altered: (patterns,) whether the boat was altered between two tows.
        askew: (patterns, tows) whether a tow was pulled askew.
        level, bend: (patterns, tows, tows) prior covariance of the boat's level and bend.
        years: (b, tows, tows) years that the drift of two tows has in common.
        excess: (patterns, tows) mean of what being pulled askew adds to ln Cw.
        excess_variance: of that.
    """

    tow: IntArray
    altered: BoolArray
    askew: BoolArray
    level: FloatArray
    bend: FloatArray
    years: FloatArray
    excess: FloatArray
    excess_variance: float

    @property
    def changes(self) -> FloatArray:
        """Which patterns are an alteration, and which a tow pulled askew, (patterns, 2)."""
        return np.stack([self.altered, self.askew.any(axis=1)], axis=1).astype(np.float64)

    def drift(self, state: FloatArray, variance: float) -> FloatArray:
        """Part of the covariance of the numbers that is the boats' drift, (b, n, n).

        Args:
            state: (all tows, 3, 2) slope of the numbers by the boat's level and bend.
            variance: of the drift of a boat's level, per year.
        """
        by_level = state[self.tow][..., 0].reshape(len(self.tow), -1)
        return by_level[:, :, None] * by_level[:, None] * _per_number(variance * self.years)

    def covariance(self, own: FloatArray, state: FloatArray, drift: FloatArray) -> FloatArray:
        """Covariance of the numbers of each boat under each pattern, (b, patterns, n, n).

        Args:
            own: (all tows, 3, 3) of what is a tow's own.
            state, drift: as `drift` takes and gives them.
        """
        boats, tows = self.tow.shape
        z = state[self.tow].reshape(boats, 3 * tows, 2)
        by_level, by_bend = (z[:, :, None, i] * z[:, None, :, i] for i in range(2))
        full = by_level[:, None] * _per_number(self.level)
        full += by_bend[:, None] * _per_number(self.bend)
        full += drift[:, None]
        of_pairs = full.reshape(boats, -1, tows, 3, tows, 3)
        each = np.arange(tows)
        # Indexing twice with one array puts that axis first.
        of_pairs[:, :, each, :, each, :] += own[self.tow].swapaxes(0, 1)[:, :, None]
        of_pairs[:, :, each, LEVEL, each, LEVEL] += self.excess_variance * self.askew
        return full

    def boats(
        self,
        residual: FloatArray,
        covariance: FloatArray,
        design: FloatArray,
        shares: FloatArray | None,
    ) -> Boats:
        """What these boats say; 3 numbers per tow.

        Args:
            residual: (all tows, 3) observed less predicted, level centred per boat.
            covariance: as `covariance` gives it.
            design: (all tows, 3, unknowns).
            shares: of gaps between tows in which a boat was altered without a report, and of early
                tows that were pulled askew; None where nothing changed.
        """
        boats, tows = self.tow.shape
        own = np.repeat(residual[self.tow][:, None], len(self.askew), axis=1)
        own[..., LEVEL] -= self.excess
        odds = np.full(2, -np.inf) if shares is None else scipy.special.logit(shares)
        return Boats.of(
            (3 * self.tow[..., None] + np.arange(3)).reshape(boats, 3 * tows),
            design[self.tow].reshape(boats, 3 * tows, -1),
            own.reshape(boats, -1, 3 * tows),
            covariance,
            np.where(self.changes > 0, odds, 0.0).sum(axis=1),
        )


def patterns_of(
    boat: IntArray, season: FloatArray, early: BoolArray, settings: Settings
) -> list[Patterns]:
    """Boats by their number of tows and of early ones, with every pattern of at most one change.

    Args:
        boat: place of the boat as it was until a reported alteration, (tows,), sorted by time.
        season: year of each tow, (tows,).
        early: whether a tow is from before steering straight was aided, (tows,).
    """
    order = np.argsort(boat, kind="stable")
    first, count = np.unique(boat[order], return_index=True, return_counts=True)[1:]
    kinds = np.stack([count, np.bincount(boat, early).astype(np.int64)], axis=1)
    return [
        _patterns(order[first[mine][:, None] + np.arange(kind[0])], season, int(kind[1]), settings)
        for kind in np.unique(kinds, axis=0)
        for mine in [(kinds == kind).all(axis=1)]
    ]


def _patterns(tow: IntArray, season: FloatArray, early: int, settings: Settings) -> Patterns:
    tows = tow.shape[1]
    since_first = season[tow] - season[tow[:, :1]]
    gaps = tows - 1
    there = np.eye(1 + gaps + early, 1 + gaps + tows, dtype=bool)[:, 1:]
    altered, askew = there[:, :gaps], there[:, gaps:]
    after = np.tri(tows, gaps, -1)
    step = np.einsum("pg,kg,lg->pkl", altered, after, after)
    return Patterns(
        tow,
        np.asarray(altered.any(axis=1)),
        askew,
        LEVEL_SD**2 + settings.changed_sd**2 * step,
        settings.bend_sd**2 + settings.changed_bend_sd**2 * step,
        np.minimum(since_first[:, :, None], since_first[:, None, :]),
        settings.askew_excess.mean * askew,
        settings.askew_excess.sd**2,
    )


def _per_number(of_tows: FloatArray) -> FloatArray:
    """What each pair of tows has, (..., tows, tows), for each pair of their numbers."""
    return np.repeat(np.repeat(of_tows, 3, axis=-1), 3, axis=-2)
