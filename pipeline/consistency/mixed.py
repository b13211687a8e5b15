"""Linear mixed model with known measuring errors, fitted by restricted maximum likelihood.

    y = X beta + boat + other + cell + error

The boat's effect has one value for all rows of a boat, `other` (a season, a type) one for all rows
of that; a cell is the single row. The error's variance is known per row, the other three are
estimated. With a single row per boat this is the random-effects model of meta-analysis. What y and
X are, and what a result means, is decided elsewhere.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple, Self

import numpy as np
import scipy
from numpy.typing import ArrayLike

from pipeline.arrays import FloatArray, IntArray

BOAT, OTHER, CELL = "boat", "other", "cell"
COMPONENTS: Final = (BOAT, OTHER, CELL)

LEVEL: Final = 0.95
PROFILE_DROP: Final = 3.841458820694124
"""Deviance above its minimum at the ends of a 95 % profile interval (chi-squared, 1 dof)."""

PROFILE_PRECISION: Final = 3e-3
"""Precision of the ends of a profile interval: of the deviance, and of the sd as a share."""

SMALLEST_SHARE: Final = 1e-4
"""Least measuring error, as a share of the size of y.

Points that happen to lie exactly on a curve seem to have no error. Sherman-Morrison subtracts
numbers as large as (boat's sd / error)^2, so that below 1e-8 no digit is left; 1e-4 leaves eight.
"""


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
class Problem:
    """Data of a mixed model.

    Attributes:
        y: (n,) observations.
        x: (n, p) fixed effects, of full column rank.
        variance: (n,) known variance of each observation.
        boat: (n,) which boat, 0 and up, without gaps.
        other: (n,) which other group, 0 and up; None without.
    """

    y: FloatArray
    x: FloatArray
    variance: FloatArray
    boat: IntArray
    other: IntArray | None

    @classmethod
    def of(
        cls,
        y: ArrayLike,
        x: ArrayLike,
        variance: ArrayLike,
        boat: ArrayLike,
        other: ArrayLike | None = None,
    ) -> Self:
        """A problem from anything array-like; groups may be named by text or number."""
        values = np.asarray(y, dtype=np.float64)
        floor = (SMALLEST_SHARE * (np.ptp(values) + abs(values.mean()))) ** 2
        return cls(
            values,
            np.asarray(x, dtype=np.float64).reshape(len(values), -1),
            np.maximum(np.asarray(variance, dtype=np.float64), max(floor, 1e-300)),
            np.unique(np.asarray(boat), return_inverse=True)[1],
            None if other is None else np.unique(np.asarray(other), return_inverse=True)[1],
        )

    @property
    def boats(self) -> int:
        """Number of boats."""
        return int(self.boat.max()) + 1

    @cached_property
    def _others(self) -> FloatArray:
        n = len(self.y)
        return (
            np.zeros((n, 0))
            if self.other is None
            else np.eye(int(self.other.max()) + 1)[self.other]
        )

    @cached_property
    def _columns(self) -> FloatArray:
        return np.hstack([self._others, self.x, self.y[:, None]])

    @cached_property
    def _by_boat(self) -> "scipy.sparse.csr_array":
        n = len(self.y)
        return scipy.sparse.csr_array(
            (np.ones(n), (self.boat, np.arange(n))), shape=(self.boats, n)
        )

    @cached_property
    def spread(self) -> float:
        """Standard deviation of y about the plain least-squares fit, the scale of a search."""
        beta = np.linalg.lstsq(self.x, self.y)[0]
        dof = max(len(self.y) - self.x.shape[1], 1)
        return float(np.sqrt(((self.y - self.x @ beta) ** 2).sum() / dof))

    def deviance(self, sd: Sequence[float] | FloatArray) -> float:
        """-2 log of the restricted likelihood but for a constant, at sds of boat, other, cell.

        The boats' effects are integrated out in closed form (Sherman-Morrison within a boat), then
        the few others (Woodbury), then beta. So the cost is linear in the rows.
        """
        boat, other, cell = (s * s for s in sd)
        total = self.variance + cell
        weighted = self._columns / total[:, None]
        precision = self._by_boat @ (1.0 / total)
        sums = self._by_boat @ weighted
        shrink = boat / (1.0 + boat * precision)
        cross = self._columns.T @ weighted - sums.T @ (sums * shrink[:, None])
        determinant = np.log(total).sum() + np.log1p(boat * precision).sum()
        k, p = self._others.shape[1], self.x.shape[1]
        if k:
            inner = np.eye(k) + other * cross[:k, :k]
            determinant += np.linalg.slogdet(inner)[1]
            cross = cross[k:, k:] - other * cross[k:, :k] @ np.linalg.solve(inner, cross[:k, k:])
        determinant += np.linalg.slogdet(cross[:p, :p])[1]
        explained = cross[:p, p] @ np.linalg.solve(cross[:p, :p], cross[:p, p])
        return float(determinant + cross[p, p] - explained)


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
    def _inverse(self) -> FloatArray:
        p = self.problem
        boat, other, cell = (s * s for s in self.sd)
        v = np.diag(p.variance + cell) + boat * (p.boat[:, None] == p.boat)
        if p.other is not None:
            v += other * (p.other[:, None] == p.other)
        return np.asarray(np.linalg.inv(v))

    @cached_property
    def _covariance(self) -> FloatArray:
        return np.asarray(np.linalg.inv(self.problem.x.T @ self._inverse @ self.problem.x))

    @cached_property
    def _projection(self) -> FloatArray:
        """P = V^-1 - V^-1 X (X' V^-1 X)^-1 X' V^-1, shape (n, n)."""
        vx = self._inverse @ self.problem.x
        return self._inverse - vx @ self._covariance @ vx.T

    @property
    def misfit(self) -> float:
        """Y' P Y: the weighted sum of squares about the fixed effects."""
        return float(self.problem.y @ self._projection @ self.problem.y)

    @property
    def total_misfit(self) -> float:
        """The same without the last column of X, at the same variances."""
        rest = self.problem.x[:, :-1]
        v = self._inverse
        residual = self.problem.y - rest @ np.linalg.solve(
            rest.T @ v @ rest, rest.T @ v @ self.problem.y
        )
        return float(residual @ v @ residual)

    @property
    def scale(self) -> float:
        """Misfit per row beyond the fixed effects, at least 1: below, it is only rounding."""
        rows = len(self.problem.y) - self.problem.x.shape[1]
        return max(1.0, self.misfit / rows) if rows > 0 else 1.0

    @property
    def beta(self) -> FloatArray:
        """Fixed effects, shape (p,)."""
        return np.asarray(self._covariance @ (self.problem.x.T @ self._inverse @ self.problem.y))

    def coefficients(self) -> Coefficients:
        """Fixed effects with 95 % intervals; needs `dof` of at least 1.

        The variance is scaled with the misfit per degree of freedom (Hartung & Knapp 2001): with
        equal errors the interval is that of ordinary least squares, whatever was estimated.
        """
        rows = len(self.problem.y) - self.problem.x.shape[1]
        sd = np.sqrt(np.diag(self._covariance) * max(self.misfit, 0.0) / rows)
        half = float(scipy.special.stdtrit(self.dof, 0.5 + LEVEL / 2)) * sd
        beta = self.beta
        return Coefficients(beta, beta - half, beta + half)

    def leave_boats_out(self) -> LeftOut:
        """Prediction of each row from all other boats, at the estimated variances.

        For rows g the error is (P_gg)^-1 (P y)_g with variance (P_gg)^-1: no fit is repeated.
        Where the others do not determine the prediction, the variance is infinite.
        """
        p, py = self._projection, self._projection @ self.problem.y
        error, variance = np.zeros(len(py)), np.full(len(py), np.inf)
        order = np.argsort(self.problem.boat, kind="stable")
        for rows in np.split(order, np.flatnonzero(np.diff(self.problem.boat[order])) + 1):
            block = p[np.ix_(rows, rows)]
            if np.linalg.eigvalsh(block)[0] > 1e-9 * np.diag(self._inverse)[rows].max():
                inverse = np.linalg.inv(block)
                error[rows], variance[rows] = inverse @ py[rows], np.diag(inverse)
        return LeftOut(error, variance)

    def interval(self, component: str) -> tuple[float, float | None]:
        """95 % profile-likelihood interval of a component's sd; None without an upper bound."""
        index = COMPONENTS.index(component)
        least = self.problem.deviance(self.sd)
        rest = tuple(c for c in self.free if c != component)

        def excess(sd: float) -> float:
            held = list(self.sd)
            held[index] = sd
            nearest = _search(self.problem, rest, (held[0], held[1], held[2]), PROFILE_PRECISION)
            return nearest[1] - least - PROFILE_DROP

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
    scale = problem.spread
    boat, other, cell = (0.5 * scale * (component in free) for component in COMPONENTS)
    best = _search(problem, free, (boat, other, cell))[0]
    return Fit(problem, free, best)


_Sds = tuple[float, float, float]


def _search(
    problem: Problem, free: tuple[str, ...], start: _Sds, precision: float = 1e-5
) -> tuple[_Sds, float]:
    """Least deviance over the free sds from `start` on, the others held; a negligible sd is 0."""
    places = [COMPONENTS.index(component) for component in free]
    sd = np.array(start)
    scale = max(problem.spread, float(np.sqrt(problem.variance.min())))

    def deviance(values: ArrayLike) -> float:
        sd[places] = np.abs(values) * scale
        return problem.deviance(sd)

    if len(places) == 1:
        alone = scipy.optimize.minimize_scalar(
            deviance, bounds=(0.0, 3.0), method="bounded", options={"xatol": 1e-5}
        )
        best = np.array([alone.x])
    elif places:
        first = sd[places] / scale
        simplex = np.vstack([first, first + np.diag(0.3 * np.maximum(first, 0.1))])
        found = scipy.optimize.minimize(
            deviance,
            first,
            method="Nelder-Mead",
            options={"xatol": precision, "fatol": precision, "initial_simplex": simplex},
        )
        best = np.abs(found.x)
    else:
        best = np.zeros(0)
    least = deviance(best)
    for i in range(len(best)):
        zeroed = np.where(np.arange(len(best)) == i, 0.0, best)
        if deviance(zeroed) <= least + 1e-4:
            best, least = zeroed, deviance(zeroed)
    deviance(best)
    return (float(sd[0]), float(sd[1]), float(sd[2])), least
