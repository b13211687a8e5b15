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
from typing import Final, Self

import numpy as np
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.model import Boats
from pipeline.season_log.assumed import Settings
from pipeline.season_log.effects import Slopes

LEVEL, BEND, GPS = range(3)
"""The numbers of a tow."""

LEVEL_SD: Final = 1.0
"""Spread of ln Cw between boats: so wide that no boat's level is drawn to that of others."""


@dataclass(frozen=True)
class Patterns:
    """Patterns of changes of b boats with the same number of tows.

    Attributes:
        tow: (b, tows) place of each tow.
        after: (patterns, tows) whether a tow is from after an alteration.
        askew: (patterns, tows) whether a tow was pulled askew.
        possible: (b, patterns) whether there may be such a pattern; askew are early tows only.
        years: (b, tows, tows) years that the drift of two tows has in common.
        settings: the priors.
    """

    tow: IntArray
    after: BoolArray
    askew: BoolArray
    possible: BoolArray
    years: FloatArray
    settings: Settings

    @classmethod
    def of(cls, tow: IntArray, season: FloatArray, early: BoolArray, settings: Settings) -> Self:
        """Every pattern of at most one change: none, an alteration in each gap, each tow askew."""
        tows = tow.shape[1]
        which = np.eye(2 * tows, dtype=bool)[:, 1:]
        since_first = season[tow] - season[tow[:, :1]]
        return cls(
            tow,
            which[:, : tows - 1] @ np.tri(tows, tows - 1, -1, dtype=bool).T,
            which[:, tows - 1 :],
            np.concatenate([np.ones(tow.shape, dtype=bool), early[tow]], axis=1),
            np.minimum(since_first[:, :, None], since_first[:, None, :]),
            settings,
        )

    @property
    def changes(self) -> FloatArray:
        """Which patterns are an alteration, and which a tow pulled askew, (patterns, 2)."""
        changes = np.stack([self.after.any(axis=1), self.askew.any(axis=1)], axis=1)
        return changes.astype(np.float64)

    @property
    def excess(self) -> FloatArray:
        """Mean of what being pulled askew adds to ln Cw, (patterns, tows)."""
        return np.asarray(self.settings.askew_excess.mean * self.askew)

    @property
    def level(self) -> FloatArray:
        """Prior covariance of the boat's level at its tows, (patterns, tows, tows)."""
        step = self.after[:, :, None] & self.after[:, None]
        return np.asarray(LEVEL_SD**2 + self.settings.changed_sd**2 * step)

    def parts(self, own: FloatArray, state: FloatArray, drift_variance: float) -> FloatArray:
        """What each variance adds to the covariance of the numbers, (variances, b, n, n).

        Args:
            own: (all tows, variances but the last, 3, 3) to that of a tow.
            state: (all tows, 3, 2) slope of the numbers by the boat's level and bend.
            drift_variance: the last: of the drift of a boat's level, per year.
        """
        count, tows = self.tow.shape
        by_level = state[self.tow][..., 0].reshape(count, 3 * tows)
        years = np.repeat(np.repeat(drift_variance * self.years, 3, axis=1), 3, axis=2)
        parts = np.zeros((own.shape[1] + 1, count, 3 * tows, 3 * tows))
        parts[:-1] = np.moveaxis(self._of_tows(np.moveaxis(own, 1, 0)), 1, 0)
        parts[-1] = by_level[:, :, None] * by_level[:, None] * years
        return parts

    def covariance(self, given: FloatArray, state: FloatArray, parts: FloatArray) -> FloatArray:
        """Covariance of the numbers of each boat that nothing changed, (b, n, n).

        Args:
            given: (all tows, 3, 3) random covariance of a tow.
            state, parts: as `parts` takes and gives them.
        """
        z = state[self.tow].reshape(len(self.tow), -1, 2)
        prior = (z * [LEVEL_SD**2, self.settings.bend_sd**2]) @ np.swapaxes(z, 1, 2)
        return np.asarray(prior + parts.sum(axis=0) + self._of_tows(given[None])[:, 0])

    def _of_tows(self, own: FloatArray) -> FloatArray:
        """Covariances of all tows, (some, tows, 3, 3), as those of boats, (b, some, n, n)."""
        (count, tows), some = self.tow.shape, len(own)
        whole = np.zeros((count, some, tows, 3, tows, 3))
        for place in range(tows):
            whole[:, :, place, :, place] = np.moveaxis(own[:, self.tow[:, place]], 1, 0)
        return whole.reshape(count, some, 3 * tows, 3 * tows)

    def added(self, state: FloatArray) -> FloatArray:
        """What each pattern adds to the covariance, as its root, (b, patterns, n, 2)."""
        s, (boats, tows) = self.settings, self.tow.shape
        z = state[self.tow][:, None] * [s.changed_sd, s.changed_bend_sd]
        by = z * self.after[..., None, None]
        by[..., LEVEL, 0] += s.askew_excess.sd * self.askew
        return np.asarray(by.reshape(boats, -1, 3 * tows, 2))

    def boats(
        self,
        residual: FloatArray,
        covariance: FloatArray,
        slopes: Slopes,
        design: FloatArray,
        shares: FloatArray | None,
    ) -> Boats:
        """What these boats say; 3 numbers per tow.

        Args:
            residual: (all tows, 3) observed less predicted, level centred per boat.
            covariance: as `covariance` gives it.
            slopes: of the numbers.
            design: (all tows, 3, unknowns).
            shares: of gaps between tows in which a boat was altered without a report, and of early
                tows that were pulled askew; None where nothing changed.
        """
        boats, tows = self.tow.shape
        own = np.repeat(residual[self.tow][:, None], len(self.askew), axis=1)
        own[..., LEVEL] -= self.excess
        odds = np.full(2, -np.inf) if shares is None else scipy.special.logit(shares)
        ln_prior = np.where(self.changes > 0, odds, 0.0).sum(axis=1)
        return Boats.of(
            (3 * self.tow[..., None] + np.arange(3)).reshape(boats, 3 * tows),
            design[self.tow].reshape(boats, 3 * tows, -1),
            own.reshape(boats, -1, 3 * tows),
            covariance,
            self.added(slopes.state),
            np.where(self.possible, ln_prior, -np.inf),
        )


def patterns_of(
    boat: IntArray, season: FloatArray, early: BoolArray, settings: Settings
) -> list[Patterns]:
    """Boats by their number of tows, with every pattern of at most one change.

    Args:
        boat: place of the boat as it was until a reported alteration, (tows,), sorted by time.
        season: year of each tow, (tows,).
        early: whether a tow is from before steering straight was aided, (tows,).
    """
    order = np.argsort(boat, kind="stable")
    first, count = np.unique(boat[order], return_index=True, return_counts=True)[1:]
    return [
        Patterns.of(order[first[count == n][:, None] + np.arange(n)], season, early, settings)
        for n in np.unique(count)
    ]
