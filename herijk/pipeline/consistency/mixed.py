"""Linear mixed model with known measuring errors, fitted by restricted maximum likelihood.

    y = X beta + boat + other + cell + error

The boat's effect has one value for all rows of a boat, `other` (a season, a type) one for all rows
of that; a cell is the single row. The error's variance is known per row, the other three are
estimated. With a single row per boat this is the random-effects model of meta-analysis. The
likelihood and its maximum are in `reml`; what y and X are, and what a result means, is decided
elsewhere.
"""

from dataclasses import dataclass
from functools import cache, cached_property
from typing import Final, NamedTuple

import numpy as np
import scipy

from herijk.pipeline.arrays import FloatArray, IntArray
from herijk.pipeline.consistency.reml import Problem, Whitened, search
from herijk.pipeline.quantiles import t_quantile

BOAT, OTHER, CELL = "boat", "other", "cell"
COMPONENTS: Final = (BOAT, OTHER, CELL)

PROFILE_DROP: Final = 3.841458820694124
"""Deviance above its minimum at the ends of a 95 % profile interval (chi-squared, 1 dof)."""

PROFILE_PRECISION: Final = 1e-12
"""Precision of the ends of a profile interval, as a share of the spread."""

NO_GAIN: Final = 1e-4
"""A component that lowers the deviance by no more than this is 0."""


class Coefficients(NamedTuple):
    """Fixed effects, each of shape (p,)."""

    value: FloatArray
    lo: FloatArray
    hi: FloatArray


class LeftOut(NamedTuple):
    """Error of predicting a row from the rows of the other boats, and its variance; (n,)."""

    error: FloatArray
    variance: FloatArray


@dataclass(frozen=True)
class Fit:
    """A fitted mixed model.

    Attributes:
        problem: what was fitted.
        free: components that were estimated; the others are 0.
        sd: standard deviations of boat, other and cell.
    """

    problem: Problem
    free: tuple[str, ...]
    sd: tuple[float, float, float]

    @property
    def dof(self) -> int:
        """Degrees of freedom of the boats: rows of one boat do not count twice."""
        return self.problem.boats - int(self.problem.x.shape[1])

    @cached_property
    def _white(self) -> Whitened:
        return Whitened.of(self.problem, np.square(self.sd))

    @cached_property
    def _root(self) -> FloatArray:
        """R with (R'R)^-1 the covariance of the fixed effects, (p, p); upper triangular."""
        first = len(self._white.of_others)
        return self._white.r[first:, first:]

    @property
    def misfit(self) -> float:
        """Y' P Y: the weighted sum of squares about the fixed effects."""
        return self._white.misfit

    @property
    def total_misfit(self) -> float:
        """The same without the last column of X, at the same variances."""
        last = self._root[-1, -1] * self.beta[-1]
        return self.misfit + float(last) ** 2

    @property
    def scale(self) -> float:
        """Misfit per row beyond the fixed effects, at least 1: below, it is only rounding."""
        rows = len(self.problem.y) - self.problem.x.shape[1]
        return max(1.0, self.misfit / rows) if rows > 0 else 1.0

    @cached_property
    def beta(self) -> FloatArray:
        """Fixed effects, shape (p,)."""
        known = self._white.along[len(self._white.of_others) :, 0]
        plain = np.linalg.lstsq(self.problem.x, self.problem.y)[0]
        return np.asarray(plain + np.linalg.solve(self._root, known))

    def coefficients(self) -> Coefficients:
        """Fixed effects with 95 % intervals; needs `dof` of at least 1.

        The variance is scaled with the misfit per degree of freedom (Hartung & Knapp 2001): with
        equal errors the interval is that of ordinary least squares, whatever was estimated.
        """
        return self.line_at(np.eye(self.problem.x.shape[1]))

    def line_at(self, x: FloatArray) -> Coefficients:
        """The fixed effects' mean at rows of X, with 95 % intervals as in `coefficients`.

        Args:
            x: rows of fixed effects, shape (places, p).
        """
        rows = len(self.problem.y) - self.problem.x.shape[1]
        spread = (np.linalg.solve(self._root.T, x.T) ** 2).sum(axis=0)
        sd = np.sqrt(spread * self.misfit / rows)
        half = float(t_quantile(self.dof)) * sd
        mean = x @ self.beta
        return Coefficients(mean, mean - half, mean + half)

    def leave_boats_out(self) -> LeftOut:
        """Prediction of each row from all other boats, at the estimated variances.

        For rows g the error is (P_gg)^-1 (P y)_g with variance (P_gg)^-1: no fit is repeated.
        Where the others do not determine the prediction, the variance is infinite.
        """
        white, boat = self._white, self.problem.boat
        weighed = white.weigh(np.hstack([white.q, white.rest]))[0]
        known, py = weighed[:, :-1], weighed[:, -1]
        shared = white.boat / white.inflation
        error, variance = np.zeros(len(py)), np.full(len(py), np.inf)
        order = np.argsort(boat, kind="stable")
        for rows in np.split(order, np.flatnonzero(np.diff(boat[order])) + 1):
            weight = white.weight[rows]
            inverse = np.diag(weight) - shared[boat[rows[0]]] * np.outer(weight, weight)
            block = inverse - known[rows] @ known[rows].T
            if np.linalg.eigvalsh(block)[0] > 1e-9 * np.diag(inverse).max():
                found = np.linalg.inv(block)
                error[rows], variance[rows] = found @ py[rows], np.diag(found)
        return LeftOut(error, variance)

    def interval(self, component: str) -> tuple[float, float | None]:
        """95 % profile-likelihood interval of a component's sd; None without an upper bound."""
        index = COMPONENTS.index(component)
        least = self.problem.deviance(self.sd)
        rest = _places(tuple(c for c in self.free if c != component))
        nearest = np.square(self.sd)

        @cache
        def excess(sd: float) -> float:
            nonlocal nearest
            nearest = nearest.copy()
            nearest[index] = sd * sd
            nearest, deviance = search(self.problem, rest, nearest)
            # The root of a deviance is nearly straight, which a search for its zero likes.
            return float(np.sqrt(max(deviance - least, 0.0)) - np.sqrt(PROFILE_DROP))

        sd, scale = self.sd[index], self.problem.spread
        lo = (
            scipy.optimize.brentq(excess, 0.0, sd, xtol=PROFILE_PRECISION * scale)
            if excess(0.0) > 0
            else 0.0
        )
        outside = max(2.0 * sd, 0.1 * scale)
        for _ in range(8):
            if excess(outside) > 0:
                return float(lo), float(
                    scipy.optimize.brentq(excess, sd, outside, xtol=PROFILE_PRECISION * scale)
                )
            outside *= 2.0
        return float(lo), None


def fit(problem: Problem, free: tuple[str, ...]) -> Fit:
    """Restricted maximum likelihood of the components named in `free`."""
    places = _places(free)
    # What the errors leave of the spread, in equal parts.
    left = problem.spread**2 - float(problem.variance.mean())
    least = 0.1 * max(problem.spread**2, float(problem.variance.min()))
    start = np.zeros(3)
    start[places] = max(left, least) / max(len(places), 1)
    found, least = search(problem, places, start)
    for place in places:
        without = found.copy()
        without[place] = 0.0
        if found[place] > 0.0 and problem.likelihood(without).deviance <= least + NO_GAIN:
            places = places[places != place]
            found, least = search(problem, places, without)
    boat, other, cell = np.sqrt(found).tolist()
    return Fit(problem, free, (boat, other, cell))


def _places(components: tuple[str, ...]) -> IntArray:
    return np.array([COMPONENTS.index(c) for c in components], dtype=np.int64)
