"""Mean-shift outliers: groups of observations that all the others rule out.

Observations are Gaussian with known variances: independent noise and random effects. The shift of a
group in a given direction g is estimated from all the rest. With P the inverse of the covariance of
y, it is g'Py / g'Pg, with variance 1 / g'Pg (Cook & Weisberg 1982, Residuals and Influence in
Regression, 2.2.2). The clearest shift is taken out, which makes it a fixed effect, and the rest is
judged again. What is observed and what may shift is said elsewhere.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
import scipy

from herijk.pipeline.arrays import BoolArray, FloatArray
from herijk.pipeline.choice import first_largest

NARROWEST: Final = 0.5
"""An archive may scatter less than is assumed; a limit shrinks to half at most."""

SAME_DIRECTION: Final = 1e-6
"""What is left of a direction of which so little is, was taken out with another."""

FEWEST_FOR_SCALE: Final = 10
MOSTLY: Final = 1.645
"""Standard deviations below its mean that a Gaussian number reaches in 19 of 20 cases."""

NORMAL_MAD: Final = 0.6745


@dataclass(frozen=True)
class Observations:
    """What is seen, and how it scatters beforehand.

    Attributes:
        values: deviations from the expected mean, shape (n,).
        variance: of their independent noise, shape (n,).
        effects: which random effects each one has, sparse, shape (n, effects).
        effect_variance: shape (effects,).
    """

    values: FloatArray
    variance: FloatArray
    effects: "scipy.sparse.csr_array"
    effect_variance: FloatArray


@dataclass(frozen=True)
class Candidates:
    """What may have shifted.

    Attributes:
        directions: one a column, sparse, shape (n, candidates).
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
        clear: it is beyond the limit from which chance is ruled out.
    """

    place: int
    size: float
    sd: float
    clear: bool


@dataclass(frozen=True)
class Shifted:
    """What shifted, and what else would have been seen.

    Attributes:
        shifts: the shifts, the clearest first.
        seen_from: size from which a shift of each candidate is beyond its last limit in 19 of 20
            cases, shape (candidates,); NaN of one that was taken out, or is one with such a one.
    """

    shifts: list[Found]
    seen_from: FloatArray


def find_shifts(seen: Observations, may: Candidates, limit: float, look: float) -> Shifted:
    """Shifts beyond so many standard deviations, the clearest first.

    Where tows scatter more or less than is assumed, the limits move with them. Shifts too large to
    be scatter come out before that is measured: a few of these make all others look scattered.

    Args:
        seen: what is seen.
        may: what may have shifted.
        limit: from which chance is ruled out.
        look: from which a single tow is unusual, judged when all clear shifts are taken out.
    """
    left = _Left(seen, may)
    gross = left.take_out(np.full(len(may.least), limit), np.maximum(may.least, may.gross))
    scales = left.scales()
    clear = left.take_out(limit * scales, may.least)
    limits = np.where(may.single, look * scales, np.inf)
    unusual = left.take_out(limits, may.least)
    _, sd = left.sizes()
    seen_from = np.maximum(sd * (limits + MOSTLY * scales), may.least)
    shifts = [Found(*one, clear=True) for one in gross + clear]
    shifts += [Found(*one, clear=False) for one in unusual]
    return Shifted(shifts, np.where(left.told, seen_from, np.nan))


class _Left:
    """What the candidates show beside all that was taken out before."""

    def __init__(self, seen: Observations, may: Candidates) -> None:
        self._may = may
        self._precision = _Precision.of(seen)
        self._score = np.asarray(may.directions.T @ self._precision.times(seen.values))
        self._at_first = self._precision.weights(may.directions)
        self._weight = self._at_first.copy()

    @property
    def told(self) -> BoolArray:
        """Which candidates are not taken out already, nor the same as one that is."""
        return np.asarray(self._weight > SAME_DIRECTION * self._at_first)

    def sizes(self) -> tuple[FloatArray, FloatArray]:
        """Size of each shift and its standard deviation; of no use where it cannot be told."""
        sd = 1.0 / np.sqrt(np.where(self.told, self._weight, 1.0))
        return self._score * sd**2, sd

    def scales(self) -> FloatArray:
        """How much wider or narrower tows scatter than is assumed; groups never narrower."""
        single = self._may.single & self.told
        if single.sum() < FEWEST_FOR_SCALE:
            return np.ones(len(single))
        z = self._score[single] / np.sqrt(self._weight[single])
        scatter = float(np.median(np.abs(z))) / NORMAL_MAD
        return np.where(self._may.single, max(scatter, NARROWEST), max(scatter, 1.0))

    def take_out(self, limits: FloatArray, least: FloatArray) -> list[tuple[int, float, float]]:
        """Takes out what is beyond its limit in standard deviations: place, size and sd of each."""
        taken: list[tuple[int, float, float]] = []
        while True:
            size, sd = self.sizes()
            beyond = np.abs(size) / (sd * limits)
            beyond[~self.told | (np.abs(size) < least)] = 0.0
            best = int(first_largest(beyond))
            if beyond[best] < 1.0:
                return taken
            taken.append((best, float(size[best]), float(sd[best])))
            moved = self._precision.take_out(self._may.directions[:, [best]].toarray()[:, 0])
            share = np.asarray(self._may.directions.T @ moved)
            self._score = self._score - share * size[best]
            self._weight = self._weight - share**2 * sd[best] ** 2


class _Precision:
    """The inverse of the covariance of what is seen, less what was taken out (Woodbury)."""

    def __init__(self, seen: Observations, root: FloatArray) -> None:
        self._seen, self._root = seen, root
        self._taken: list[tuple[FloatArray, float]] = []

    @classmethod
    def of(cls, seen: Observations) -> "_Precision":
        scaled = seen.effects.multiply(1.0 / seen.variance[:, None])
        within = (seen.effects.T @ scaled).toarray() + np.diag(1.0 / seen.effect_variance)
        return cls(seen, np.linalg.cholesky(within))

    def times(self, values: FloatArray) -> FloatArray:
        """The product with a vector, before anything is taken out."""
        scaled = values / self._seen.variance
        effects = scipy.linalg.cho_solve((self._root, True), self._seen.effects.T @ scaled)
        return np.asarray(scaled - (self._seen.effects @ effects) / self._seen.variance)

    def take_out(self, direction: FloatArray) -> FloatArray:
        """The product with a direction, which is a fixed effect from then on."""
        product = self.times(direction)
        for before, inverse in self._taken:
            product -= before * (before @ direction) * inverse
        self._taken.append((product, 1.0 / float(product @ direction)))
        return product

    def weights(self, directions: "scipy.sparse.csc_array") -> FloatArray:
        """Gives g'Pg of each direction, before anything is taken out."""
        scaled = directions.multiply(1.0 / self._seen.variance[:, None]).tocsc()
        own = np.asarray(directions.multiply(scaled).sum(axis=0)).ravel()
        shared = scipy.linalg.solve_triangular(
            self._root, (self._seen.effects.T @ scaled).toarray(), lower=True
        )
        return np.asarray(own - (shared**2).sum(axis=0))
