"""Mean-shift outliers: groups of observations that all the others rule out.

Observations are Gaussian with known variances: independent noise and random effects. The shift of a
group in a given direction g is estimated from all the rest. With P the inverse of the covariance of
y, it is g'Py / g'Pg, with variance 1 / g'Pg (Cook & Weisberg 1982, Residuals and Influence in
Regression, 2.2.2). The clearest shift is taken out, which makes it a fixed effect, and the rest is
judged again. What is observed and what may shift is decided by the caller.
"""

from collections.abc import Sequence
from typing import Final, NamedTuple, Self

import numpy as np
import scipy

from pipeline.arrays import BoolArray, FloatArray
from pipeline.choice import first_largest
from pipeline.quantiles import MAD_TO_SD

NARROWEST: Final = 0.5
"""An archive may scatter less than is assumed; a limit shrinks to half at most."""

SAME_DIRECTION: Final = 1e-6
"""What is left of a direction of which so little is, was taken out with another."""

FEWEST_FOR_SCALE: Final = 10
AT_A_TIME: Final = 2048
"""Candidates that are weighed together: those of ten thousand tows would take gigabytes."""


class Observations(NamedTuple):
    """What is observed, and its prior scatter.

    Attributes:
        values: deviations from the expected mean, shape (n,).
        variance: of their independent noise, shape (n,).
        shared: which random effects each observation has, sparse, shape (n, effects).
        shared_variance: of these, shape (effects,).
    """

    values: FloatArray
    variance: FloatArray
    shared: "scipy.sparse.csr_array"
    shared_variance: FloatArray

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """Observations of several kinds, which share nothing."""
        values, variance, shared, shared_variance = zip(*parts, strict=True)
        return cls(
            np.concatenate(values),
            np.concatenate(variance),
            scipy.sparse.block_diag(shared, format="csr"),
            np.concatenate(shared_variance),
        )


class Candidates(NamedTuple):
    """What may have shifted.

    Attributes:
        directions: one per column, sparse, shape (n, candidates).
        single: whether a column is of one tow, whose scatter the archive itself shows.
        least: smallest size that matters, shape (candidates,).
        gross: size that no scatter explains, however wide, shape (candidates,).
    """

    directions: "scipy.sparse.csc_array"
    single: BoolArray
    least: FloatArray
    gross: FloatArray


class Found(NamedTuple):
    """A shift: place of the candidate, its size, and the standard deviation of that.

    Attributes:
        clear: whether it is beyond the limit from which chance is ruled out.
    """

    place: int
    size: float
    sd: float
    clear: bool


def find_shifts(seen: Observations, may: Candidates, limit: float, look: float) -> list[Found]:
    """Shifts beyond so many standard deviations, the clearest first.

    Where tows scatter more or less than is assumed, the limits move with them. Shifts too large to
    be scatter come out before that is measured: a few of these make all others look scattered.

    Args:
        seen: what is seen.
        may: what may have shifted.
        limit: from which chance is ruled out.
        look: from which a single tow is unusual, judged when all clear shifts are taken out.
    """
    state = _MeanShifts(seen, may)
    shifts = state.take_out(limit, np.maximum(may.least, may.gross), clear=True)
    scales = state.scales()
    shifts += state.take_out(limit * scales, may.least, clear=True)
    limits = np.where(may.single, look * scales, np.inf)
    return shifts + state.take_out(limits, may.least, clear=False)


class _MeanShifts:
    """What the candidates show given all that was taken out before.

    The inverse of the covariance is by Woodbury's identity. What is factorised has a row per random
    effect, and is sparse: boats have tows in few seasons.
    """

    def __init__(self, seen: Observations, may: Candidates) -> None:
        self._may, self._effects = may, seen.shared
        self._noise = scipy.sparse.diags_array(1.0 / seen.variance)
        within = self._effects.T @ self._noise @ self._effects
        prior = scipy.sparse.diags_array(1.0 / seen.shared_variance)
        self._within = scipy.sparse.linalg.splu(
            (within + prior).tocsc(), permc_spec="MMD_AT_PLUS_A"
        )
        self._taken: list[tuple[FloatArray, float]] = []
        self._score = np.asarray(may.directions.T @ self._precision_times(seen.values))
        starts = range(0, may.directions.shape[1], AT_A_TIME)
        parts = [self._weights(may.directions[:, k : k + AT_A_TIME]) for k in starts]
        self._at_first = np.concatenate(parts)
        self._weight = self._at_first.copy()

    def _precision_times(self, values: FloatArray) -> FloatArray:
        scaled = np.asarray(self._noise @ values)
        effects = self._within.solve(np.asarray(self._effects.T @ scaled))
        return np.asarray(scaled - self._noise @ (self._effects @ effects))

    def _weights(self, directions: "scipy.sparse.csc_array") -> FloatArray:
        """Gives g'Pg of each direction, before anything is taken out."""
        scaled = self._noise @ directions
        alone = np.asarray(directions.multiply(scaled).sum(axis=0)).ravel()
        across = (self._effects.T @ scaled).toarray()
        return np.asarray(alone - (across * self._within.solve(across)).sum(axis=0))

    @property
    def _open(self) -> BoolArray:
        """Which candidates are not taken out already, nor the same as one that is."""
        return np.asarray(self._weight > SAME_DIRECTION * self._at_first)

    def scales(self) -> FloatArray:
        """How much wider or narrower tows scatter than is assumed; groups never narrower."""
        single = self._may.single & self._open
        if single.sum() < FEWEST_FOR_SCALE:
            return np.ones(len(single))
        z = self._score[single] / np.sqrt(self._weight[single])
        scatter = MAD_TO_SD * float(np.median(np.abs(z)))
        return np.where(self._may.single, max(scatter, NARROWEST), max(scatter, 1.0))

    def take_out(
        self, limits: FloatArray | float, least: FloatArray, *, clear: bool
    ) -> list[Found]:
        """Takes out what is beyond its limit in standard deviations, the clearest first."""
        taken: list[Found] = []
        while True:
            sd = 1.0 / np.sqrt(np.where(self._open, self._weight, 1.0))
            size = self._score * sd**2
            beyond = np.abs(size) / (sd * limits)
            beyond[~self._open | (np.abs(size) < least)] = 0.0
            best = int(first_largest(beyond))
            if beyond[best] < 1.0:
                return taken
            taken.append(Found(best, float(size[best]), float(sd[best]), clear))
            direction = self._may.directions[:, [best]].toarray()[:, 0]
            moved = self._precision_times(direction)
            for before, inverse in self._taken:
                moved -= before * (before @ direction) * inverse
            self._taken.append((moved, 1.0 / float(moved @ direction)))
            share = np.asarray(self._may.directions.T @ moved)
            self._score = self._score - share * size[best]
            self._weight = self._weight - share**2 * sd[best] ** 2
