"""Mean-shift outliers: groups of observations that all the others rule out.

Observations are Gaussian with known variances: independent noise and random effects. The shift of a
group in a given direction g is estimated from all the rest. With P the inverse of the covariance of
y, it is g'Py / g'Pg, with variance 1 / g'Pg (Cook & Weisberg 1982, Residuals and Influence in
Regression, 2.2.2). The clearest shift is taken out, which makes it a fixed effect, and the rest is
judged again. What is observed and what may shift is decided by the caller.
"""

from dataclasses import dataclass
from typing import Final

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


@dataclass(frozen=True)
class Effects:
    """Random effects.

    Attributes:
        of: which each observation has, sparse, shape (n, effects).
        variance: shape (effects,).
    """

    of: "scipy.sparse.csr_array"
    variance: FloatArray


@dataclass(frozen=True)
class Observations:
    """What is observed, and its prior scatter.

    Attributes:
        values: deviations from the expected mean, shape (n,).
        variance: of their independent noise, shape (n,).
        own: random effects of which each observation has at most one: those of its boat.
        shared: the other random effects.
    """

    values: FloatArray
    variance: FloatArray
    own: Effects
    shared: Effects


@dataclass(frozen=True)
class Candidates:
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


@dataclass(frozen=True)
class Found:
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
    """What the candidates show given all that was taken out before."""

    def __init__(self, seen: Observations, may: Candidates) -> None:
        self._may = may
        self._precision = _Precision(seen)
        self._score = np.asarray(may.directions.T @ self._precision.times(seen.values))
        self._at_first = self._precision.weights(may.directions)
        self._weight = self._at_first.copy()

    @property
    def open(self) -> BoolArray:
        """Which candidates are not taken out already, nor the same as one that is."""
        return np.asarray(self._weight > SAME_DIRECTION * self._at_first)

    def sizes(self) -> tuple[FloatArray, FloatArray]:
        """Size of each shift and its standard deviation; meaningless where `open` is false."""
        sd = 1.0 / np.sqrt(np.where(self.open, self._weight, 1.0))
        return self._score * sd**2, sd

    def scales(self) -> FloatArray:
        """How much wider or narrower tows scatter than is assumed; groups never narrower."""
        single = self._may.single & self.open
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
            size, sd = self.sizes()
            beyond = np.abs(size) / (sd * limits)
            beyond[~self.open | (np.abs(size) < least)] = 0.0
            best = int(first_largest(beyond))
            if beyond[best] < 1.0:
                return taken
            taken.append(Found(best, float(size[best]), float(sd[best]), clear))
            moved = self._precision.take_out(self._may.directions[:, [best]].toarray()[:, 0])
            share = np.asarray(self._may.directions.T @ moved)
            self._score = self._score - share * size[best]
            self._weight = self._weight - share**2 * sd[best] ** 2


class _Precision:
    """The inverse of the covariance of what is seen, less what was taken out (Woodbury).

    Own effects are dealt with first, in closed form: what is left to invert grows with days and
    seasons, and not with boats.
    """

    def __init__(self, seen: Observations) -> None:
        own, shared = seen.own.of, seen.shared
        noise = scipy.sparse.diags_array(1.0 / seen.variance)
        of_own = (own.T @ noise @ own).diagonal() + 1.0 / seen.own.variance
        by_own = noise @ own @ scipy.sparse.diags_array(1.0 / of_own)
        self._without_shared = (noise - by_own @ own.T @ noise).tocsr()
        self._shared = shared.of
        within = (shared.of.T @ self._without_shared @ shared.of).toarray()
        self._root = np.linalg.cholesky(within + np.diag(1.0 / shared.variance))
        self._taken: list[tuple[FloatArray, float]] = []

    def times(self, values: FloatArray) -> FloatArray:
        """The product with a vector, before anything is taken out."""
        scaled = self._without_shared @ values
        effects = scipy.linalg.cho_solve((self._root, True), self._shared.T @ scaled)
        return np.asarray(scaled - self._without_shared @ (self._shared @ effects))

    def take_out(self, direction: FloatArray) -> FloatArray:
        """The product with a direction, which is a fixed effect from then on."""
        product = self.times(direction)
        for before, inverse in self._taken:
            product -= before * (before @ direction) * inverse
        self._taken.append((product, 1.0 / float(product @ direction)))
        return product

    def weights(self, directions: "scipy.sparse.csc_array") -> FloatArray:
        """Gives g'Pg of each direction, before anything is taken out."""
        starts = range(0, directions.shape[1], AT_A_TIME)
        return np.concatenate([self._weights(directions[:, k : k + AT_A_TIME]) for k in starts])

    def _weights(self, directions: "scipy.sparse.csc_array") -> FloatArray:
        scaled = self._without_shared @ directions
        alone = np.asarray(directions.multiply(scaled).sum(axis=0)).ravel()
        shared = scipy.linalg.solve_triangular(
            self._root, (self._shared.T @ scaled).toarray(), lower=True
        )
        return np.asarray(alone - (shared**2).sum(axis=0))
