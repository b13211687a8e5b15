"""Restricted likelihood of a linear mixed model with known measuring errors, and its maximum.

    y = X beta + boat + other + cell + error

Here the data, the likelihood with its slope, and the search for the variances of boat, other and
cell. What a fitted model says about anything is in `mixed`.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, NamedTuple, Self

import numpy as np
import scipy
from numpy.typing import ArrayLike

from herijk.pipeline.arrays import FloatArray, IntArray

SMALLEST_SHARE: Final = 1e-4
"""Least measuring error, as a share of the size of y.

Points that happen to lie exactly on a curve seem to have no error, and would have all the weight.
The inverse of the covariance holds numbers as large as (boat's sd / error)^2 and loses as many
digits: below 1e-8 none is left; 1e-4 leaves eight.
"""

MAX_ITERATIONS: Final = 100
MAX_HALVINGS: Final = 40
TOLERANCE: Final = 1e-11
"""A search is done when a step changes no variance by more than this share of its size."""

NEGLIGIBLE: Final = 1e-3
"""Share of the spread's variance below which a variance need not be known as a share of itself."""

ROUNDING: Final = 1e-11
"""Share of a deviance, or 1 if that is larger, that is lost in its sums."""


UNFELT: Final = 1e-10
"""Information, in units of the spread, below which it is rounding: boats of one type have none of
what differs between types."""


class Likelihood(NamedTuple):
    """The restricted likelihood at some variances.

    Attributes:
        deviance: -2 log of it but for a constant.
        gradient: (3,) slope of the deviance along the variances of boat, other and cell.
        information: (3, 3) average of observed and expected second derivative of the deviance.
    """

    deviance: float
    gradient: FloatArray
    information: FloatArray


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
    def residual(self) -> FloatArray:
        """Y less the plain least-squares fit: the likelihood sees nothing else of y."""
        return np.asarray(self.y - self.x @ np.linalg.lstsq(self.x, self.y)[0])

    @cached_property
    def spread(self) -> float:
        """Standard deviation of y about the plain least-squares fit, the scale of a search."""
        dof = max(len(self.y) - self.x.shape[1], 1)
        return float(np.sqrt((self.residual**2).sum() / dof))

    @cached_property
    def others(self) -> FloatArray:
        """Which other group each row is of, as columns of 0 and 1; (n, groups)."""
        n = len(self.y)
        return (
            np.zeros((n, 0))
            if self.other is None
            else np.eye(int(self.other.max()) + 1)[self.other]
        )

    @cached_property
    def columns(self) -> FloatArray:
        """Others, fixed effects and what y is beyond the plain fit, side by side."""
        return np.hstack([self.others, self.x, self.residual[:, None]])

    @cached_property
    def by_boat(self) -> "scipy.sparse.csr_array":
        """Adds up the rows of each boat; (boats, n)."""
        n = len(self.y)
        return scipy.sparse.csr_array(
            (np.ones(n), (self.boat, np.arange(n))), shape=(self.boats, n)
        )

    def likelihood(self, variances: ArrayLike) -> Likelihood:
        """The restricted likelihood at variances of boat, other and cell, none of them negative.

        Slope and average information are those of Gilmour, Thompson and Cullis (1995), tr(P V_k) -
        y'P V_k P y and y'P V_k P V_l P y: V_k is the part of one variance in the covariance V, P
        its inverse without the fixed effects.
        """
        at = Whitened.of(self, variances)
        own, of_boats = at.weigh(np.hstack([at.q, at.rest]))
        p_y, boats_p_y = own[:, -1:], of_boats[:, -1:]
        if at.other > 0.0:
            others_p_y = at.of_others @ at.along / np.sqrt(at.other)
            trace_of_others = (len(at.of_others) - (at.of_others**2).sum()) / at.other
        else:
            others = at.without_boats(at.root * self.others)
            others_p_y = others.T @ at.rest
            trace_of_others = (others**2).sum() - ((others.T @ at.q) ** 2).sum()
        alone = at.weight * (1.0 + at.boat * (at.precision[self.boat] - at.weight))
        traces = np.array(
            [
                (at.precision / at.inflation).sum() - (of_boats[:, :-1] ** 2).sum(),
                trace_of_others,
                (alone / at.inflation[self.boat]).sum() - (own[:, :-1] ** 2).sum(),
            ]
        )
        squares = np.array([(part**2).sum() for part in (boats_p_y, others_p_y, p_y)])
        parts = np.hstack([boats_p_y[self.boat], self.others @ others_p_y, p_y])
        parts = at.without_boats(at.root * parts)
        along = at.q.T @ parts
        determinant = np.log(at.inflation).sum() - np.log(at.weight).sum()
        determinant += 2.0 * np.log(np.abs(np.diag(at.r))).sum()
        return Likelihood(
            float(determinant + at.misfit),
            traces - squares,
            np.asarray(parts.T @ parts - along.T @ along),
        )

    def deviance(self, sd: ArrayLike) -> float:
        """-2 log of the restricted likelihood but for a constant, at sds of boat, other, cell."""
        return self.likelihood(np.square(sd)).deviance


@dataclass(frozen=True)
class Whitened:
    """A problem at some variances: rows of unit covariance, known columns taken out.

    Rows are whitened for error, cell and boat. Others (as further data: Woodbury) and fixed effects
    are then taken out by one orthogonal decomposition: no large numbers cancel, however small the
    errors are, and all is linear in the rows. All matrices are narrow: a product of two that have
    as many columns as rows comes out otherwise on another number of threads.

    Attributes:
        problem: the problem.
        boat, other: the variances.
        weight: (n,) 1 / variance of error and cell; root: (n, 1) its root.
        precision: (boats,) sum of the weights; inflation: 1 + boat's variance times that.
        q: (n, k + p) orthogonal columns, with `of_others`, (k, k + p), below.
        r: (k + p, k + p) triangular.
        along: (k + p, 1) whitened y along the columns.
        rest: (n, 1) what is left of it.
    """

    problem: Problem
    boat: float
    other: float
    weight: FloatArray
    precision: FloatArray
    inflation: FloatArray
    q: FloatArray
    of_others: FloatArray
    r: FloatArray
    along: FloatArray
    rest: FloatArray

    @classmethod
    def of(cls, problem: Problem, variances: ArrayLike) -> Self:
        """A problem at its variances of boat, other and cell."""
        boat, other, cell = np.asarray(variances, dtype=np.float64)
        weight = 1.0 / (problem.variance + cell)
        precision = problem.by_boat @ weight
        none = np.zeros((0, 0))
        bare = cls(problem, boat, other, weight, precision, 1.0 + boat * precision, *(none,) * 5)
        k, n = problem.others.shape[1], len(problem.y)
        white = bare.without_boats(bare.root * problem.columns)
        known, y = white[:, :-1], white[:, -1:]
        known[:, :k] *= np.sqrt(other)
        q, r = np.linalg.qr(np.vstack([known, np.eye(k, known.shape[1])]))
        along = q[:n].T @ y
        return replace(bare, q=q[:n], of_others=q[n:], r=r, along=along, rest=y - q[:n] @ along)

    @cached_property
    def root(self) -> FloatArray:
        """Root of the weights, (n, 1)."""
        return np.sqrt(self.weight)[:, None]

    def without_boats(self, rows: FloatArray) -> FloatArray:
        """What is left of rows, in units of their errors, in units of boats and errors."""
        return self._shrunk(rows, self.problem.by_boat @ (self.root * rows))

    def weigh(self, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Whitened rows as they weigh on the rows of the problem, and the sum of that by boat."""
        total = self.problem.by_boat @ (self.root * rows)
        of_boats = total / np.sqrt(self.inflation)[:, None]
        return self.root * self._shrunk(rows, total), np.asarray(of_boats)

    def _shrunk(self, rows: FloatArray, total: FloatArray) -> FloatArray:
        """Rows with each boat's mean made smaller; `total` is the weighted sum by boat."""
        shrink = (1.0 / np.sqrt(self.inflation) - 1.0) / self.precision
        return np.asarray(rows + self.root * (shrink[:, None] * total)[self.problem.boat])

    @property
    def misfit(self) -> float:
        """Y' P Y: the weighted sum of squares about the fixed effects."""
        return float((self.rest**2).sum() + ((self.of_others @ self.along) ** 2).sum())


def search(problem: Problem, free: IntArray, start: FloatArray) -> tuple[FloatArray, float]:
    """Least deviance over some of the variances, the others held.

    Newton's method with the average information, on variances that are not negative: one that is 0
    and would fall is left at exactly 0. The slope, not the deviance, says when it is done: the
    least of a smooth function is flat over the root of its rounding, its slope crosses 0 there.

    Args:
        problem: the data.
        free: places of the free variances among boat, other and cell.
        start: (3,) variances to begin with; the others of the result are as here.

    Returns:
        The variances, and the deviance there.
    """
    unit = max(problem.spread**2, float(problem.variance.min()))
    at, now = start, problem.likelihood(start)
    for _ in range(MAX_ITERATIONS):
        loose = free[(at[free] > 0.0) | (now.gradient[free] < 0.0)]
        if not len(loose):
            break
        step = np.zeros(3)
        step[loose] = _newton(now, loose, unit)
        last = at
        at, now = _descend(problem, at, now, step)
        if (np.abs(at - last) <= TOLERANCE * np.maximum(at, NEGLIGIBLE * unit)).all():
            break
    return at, now.deviance


def _newton(now: Likelihood, loose: IntArray, unit: float) -> FloatArray:
    """Step of the loose variances; one that the data do not feel goes nowhere, as do its like."""
    felt = np.diag(now.information)[loose] > UNFELT / unit**2
    size = np.sqrt(np.where(felt, np.diag(now.information)[loose], 1.0))
    scaled = np.where(np.outer(felt, felt), now.information[np.ix_(loose, loose)], 0.0)
    slope = np.where(felt, now.gradient[loose], 0.0) / size
    scaled = scaled / np.outer(size, size)
    return np.asarray(-np.linalg.lstsq(scaled, slope, rcond=UNFELT)[0] / size)


def _descend(
    problem: Problem, at: FloatArray, now: Likelihood, step: FloatArray
) -> tuple[FloatArray, Likelihood]:
    """The step, cut off at 0, halved until the deviance does not rise by more than rounding."""
    limit = now.deviance + ROUNDING * max(1.0, abs(now.deviance))
    for _ in range(MAX_HALVINGS):
        trial = np.maximum(at + step, 0.0)
        there = problem.likelihood(trial)
        if there.deviance <= limit:
            return trial, there
        step = 0.5 * step
    return at, now
