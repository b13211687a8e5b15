"""A line through tows of boats: a linear mixed model with known measuring errors, fitted by REML.

    y = X beta + boat + other + cell + error

The boat's effect has one value for all rows of a boat, `other` (a season, a type) one for all rows
of that; a cell is the single row. The error's variance is known per row, the other three are
estimated by restricted maximum likelihood (Patterson & Thompson 1971) with the search of
`consistency.reml`. With a single row per boat this is the random-effects model of meta-analysis.
What y and X are is decided elsewhere.

Rows are split into the mean of each boat and the deviations from it, which are independent. The few
effects of `other` are unknowns beside beta, with a prior. So no matrix grows with the rows.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
import scipy
from numpy.typing import ArrayLike

from pipeline.arrays import FloatArray
from pipeline.consistency.reml import Likelihood, minimize_deviance
from pipeline.quantiles import LEVEL, t_quantile

BOAT, OTHER, CELL = "boat", "other", "cell"
COMPONENTS: Final = (BOAT, OTHER, CELL)

SMALLEST_SHARE: Final = 1e-4
"""Least measuring error, as a share of the size of y.

Points that happen to lie exactly on a curve seem to have no error, and would have all the weight.
"""

LEAST_MISFIT: Final = 0.05
"""Least misfit of the other boats' rows, also where they agree by chance."""

NO_GAIN: Final = 1e-4
"""A component that lowers the deviance by no more than this is 0."""


class Coefficients(NamedTuple):
    """Fixed effects, each of shape (p,)."""

    value: FloatArray
    lo: FloatArray
    hi: FloatArray


class Problem:
    """Data of a mixed model; n rows, p fixed effects.

    Args:
        y: observations.
        variance: known variance of each.
        x: fixed effects, of full column rank.
        boat, other: names of the boat and of the other group that each row is of.

    Attributes:
        y, variance: (n,); x: (n, p).
        boat: (n,) which boat, 0 and up, without gaps.
        other: (n, groups) 1 for the other group of each row; no columns without one.
        plain: (p,) fixed effects by plain least squares.
        residual: (n,) what those leave of y: the likelihood sees nothing else of it.
        rows_beyond: rows beyond the number of fixed effects.
        spread: standard deviation about plain least squares; unit: size of a variance.
    """

    def __init__(
        self,
        y: ArrayLike,
        variance: ArrayLike,
        x: ArrayLike,
        boat: ArrayLike,
        other: ArrayLike | None = None,
    ) -> None:
        self.y = np.asarray(y, dtype=np.float64)
        floor = (SMALLEST_SHARE * (np.ptp(self.y) + abs(self.y.mean()))) ** 2
        self.variance = np.maximum(np.asarray(variance, dtype=np.float64), max(floor, 1e-300))
        self.x = np.asarray(x, dtype=np.float64).reshape(len(self.y), -1)
        self.boat = np.unique(np.asarray(boat), return_inverse=True)[1]
        names = np.zeros((len(self.y), 0)) if other is None else np.asarray(other)[:, None]
        self.other = np.asarray(names == np.unique(names), dtype=np.float64)
        self.plain = np.asarray(np.linalg.lstsq(self.x, self.y)[0], dtype=np.float64)
        self.residual = self.y - self.x @ self.plain
        self.rows_beyond = len(self.y) - int(self.x.shape[1])
        self.spread = float(np.sqrt((self.residual**2).sum() / max(self.rows_beyond, 1)))
        self.unit = max(self.spread**2, float(self.variance.min()))
        self._order = np.argsort(self.boat, kind="stable")
        self._first = np.searchsorted(self.boat[self._order], np.arange(self.boat.max() + 1))

    def of_boats(self, values: FloatArray) -> FloatArray:
        """Sum over the rows of each boat, (boats, ...)."""
        return np.asarray(np.add.reduceat(values[self._order], self._first, axis=0))


@dataclass(frozen=True)
class Fit:
    """A mixed model at given variances of boat, other and cell, (3,); 0 where there is none.

    L y are n + boats independent numbers with a variance of 1: deviations from the means of boats,
    and those means. The fixed effects and those of `other` are unknowns.
    """

    problem: Problem
    variances: FloatArray

    @property
    def sd(self) -> tuple[float, float, float]:
        """Standard deviations of boat, other and cell."""
        boat, other, cell = np.sqrt(self.variances).tolist()
        return boat, other, cell

    @cached_property
    def _weight(self) -> FloatArray:
        """Precision of each row within its boat, (n, 1)."""
        return np.asarray(1.0 / (self.problem.variance + self.variances[2])[:, None])

    @cached_property
    def _total(self) -> FloatArray:
        """The same of the mean of each boat, (boats, 1)."""
        return self.problem.of_boats(self._weight)

    @cached_property
    def _of_mean(self) -> FloatArray:
        """Precision of a boat's mean with the spread of boats in it, (boats, 1)."""
        return np.asarray(self._total / (1.0 + self.variances[0] * self._total))

    def _independent(self, values: FloatArray) -> FloatArray:
        """L times rows, (n, k): independent numbers, (n + boats, k)."""
        mean = self.problem.of_boats(self._weight * values) / self._total
        within = np.sqrt(self._weight) * (values - mean[self.problem.boat])
        return np.concatenate([within, np.sqrt(self._of_mean) * mean])

    def _as_rows(self, independent: FloatArray) -> FloatArray:
        """The transpose of L times independent numbers, (n + boats, k): rows, (n, k)."""
        rows = len(self._weight)
        means = np.sqrt(self._of_mean) * independent[rows:] / self._total
        weighed = self._weight * means[self.problem.boat]
        return np.asarray(np.sqrt(self._weight) * independent[:rows] + weighed)

    @cached_property
    def _unknowns(self) -> FloatArray:
        """What moves with each unknown, those of `other` in their sd, (n + boats, k)."""
        others = np.sqrt(self.variances[1]) * self.problem.other
        return self._independent(np.column_stack([self.problem.x, others]))

    @cached_property
    def _information(self) -> FloatArray:
        """On the unknowns, with the prior of those of `other`, (k, k)."""
        fixed, k = self.problem.x.shape[1], self._unknowns.shape[1]
        return np.asarray(self._unknowns.T @ self._unknowns + np.diag(np.arange(k) >= fixed))

    @cached_property
    def _covariance(self) -> FloatArray:
        """Of the unknowns, (k, k)."""
        return np.linalg.inv(self._information).astype(np.float64)

    def _rest(self, values: FloatArray) -> FloatArray:
        """What the unknowns leave of L times rows, (n, k), (n + boats, k)."""
        independent = self._independent(values)
        taken = self._covariance @ (self._unknowns.T @ independent)
        return np.asarray(independent - self._unknowns @ taken)

    @cached_property
    def pull(self) -> FloatArray:
        """P y, with P the precision of the rows less what the unknowns take up, (n,)."""
        return self._as_rows(self._rest(self.problem.residual[:, None]))[:, 0]

    @cached_property
    def misfit(self) -> float:
        """Weighted sum of squares about the fixed effects, y' P y."""
        return float(self.problem.residual @ self.pull)

    @cached_property
    def beta(self) -> FloatArray:
        """Fixed effects, (p,)."""
        seen = self._unknowns.T @ self._independent(self.problem.residual[:, None])
        return self.problem.plain + (self._covariance @ seen)[: len(self.problem.plain), 0]

    @property
    def covariance(self) -> FloatArray:
        """Of the fixed effects, at a scale of 1, (p, p)."""
        fixed = len(self.problem.plain)
        return self._covariance[:fixed, :fixed]

    @cached_property
    def likelihood(self) -> Likelihood:
        """The restricted likelihood as `minimize_deviance` takes it.

        The slope of the deviance by a variance that adds K to the covariance is
        tr(P K) - y' P K P y, its average information y' P K P K P y.
        """
        problem, boat, other = self.problem, self.problem.boat, self.problem.other
        taken = self._unknowns @ np.linalg.cholesky(self._covariance)  # P = L' (1 - taken taken') L
        share = self._weight / self._total[boat]
        own = self._weight * (1.0 - share) + share**2 * self._of_mean[boat]
        taken_of_means = (taken[len(boat) :] ** 2).sum(axis=1, keepdims=True)
        of_boat = (self._of_mean * (1.0 - taken_of_means)).sum()
        of_other = (self._rest(other) * self._independent(other)).sum()
        of_cell = own.sum() - (self._as_rows(taken) ** 2).sum()
        pull = self.pull[:, None]
        felt = np.column_stack([problem.of_boats(pull)[boat], other @ (other.T @ pull), pull])
        ln_determinants = (
            np.log1p(self.variances[0] * self._total).sum()
            - np.log(self._weight).sum()
            + np.linalg.slogdet(self._information)[1]
        )
        return Likelihood(
            float(ln_determinants) + self.misfit,
            np.array([of_boat, of_other, of_cell]) - (felt * pull).sum(axis=0),
            felt.T @ self._as_rows(self._rest(felt)),
        )

    @property
    def dof(self) -> int:
        """Degrees of freedom of the boats: rows of one boat do not count twice."""
        return int(self.problem.boat.max()) + 1 - int(self.problem.x.shape[1])

    @property
    def scale(self) -> float:
        """Misfit per row beyond the fixed effects, at least 1: below, it is only rounding."""
        rows = self.problem.rows_beyond
        return max(1.0, self.misfit / rows) if rows > 0 else 1.0

    def coefficients(self) -> Coefficients:
        """Fixed effects with 95 % intervals; needs `dof` of at least 1.

        The variance is scaled with the misfit per degree of freedom (Hartung & Knapp 2001): with
        equal errors the interval is that of ordinary least squares, whatever was estimated.
        """
        return self.line_at(np.eye(len(self.beta)))

    def line_at(self, x: FloatArray) -> Coefficients:
        """The fixed effects' mean at rows of X, (places, p), with intervals as `coefficients`."""
        spread = ((x @ self.covariance) * x).sum(axis=1)
        sd = np.sqrt(spread * self.misfit / self.problem.rows_beyond)
        half = float(t_quantile(self.dof)) * sd
        mean = x @ self.beta
        return Coefficients(mean, mean - half, mean + half)

    def leave_boats_out(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Each row as all other boats predict it, at the estimated variances.

        With P as in the fit, the errors of the rows of a boat are (P_bb)^-1 (P y)_b, their variance
        (P_bb)^-1.

        Returns:
            error: what the row has above its prediction, (n,).
            variance: of that, at a scale of 1; infinite where the others do not determine it.
            scale: misfit per row of the other boats, as in externally studentised residuals.
        """
        problem, n = self.problem, len(self.problem.y)
        smallest = 1.0 / (self.variances.sum() + problem.variance)
        taken = self._as_rows(self._unknowns)
        error, variance, scale = np.zeros(n), np.full(n, np.inf), np.ones(n)
        for one in range(int(problem.boat.max()) + 1):
            rows = np.flatnonzero(problem.boat == one)
            weight, total = self._weight[rows], self._total[one]
            by_mean = (self._of_mean[one] / total - 1.0) / total
            block = np.diag(weight[:, 0]) + weight @ weight.T * by_mean
            block -= taken[rows] @ self._covariance @ taken[rows].T
            if np.linalg.eigvalsh(block)[0] <= 1e-9 * smallest[rows].max():
                continue
            inverse = np.linalg.inv(block)
            error[rows], variance[rows] = inverse @ self.pull[rows], np.diagonal(inverse)
            others = self.scale * problem.rows_beyond - error[rows] @ self.pull[rows]
            beyond = max(problem.rows_beyond - len(rows), 1)
            scale[rows] = max(float(others), LEAST_MISFIT) / beyond
        return error, variance, scale

    def intervals(self) -> dict[str, tuple[float, float | None]]:
        """95 % intervals of the components' sds; None without an upper bound.

        A variance is taken as chi-squared with as many degrees of freedom as its information says
        (Satterthwaite 1946). One that is 0, or has less than one degree of freedom, has no bound.
        """
        there = self.variances > 0.0
        uncertain = np.full(len(there), np.inf)
        inverse = np.linalg.inv(self.likelihood.information[np.ix_(there, there)])
        uncertain[there] = np.diagonal(inverse)
        dof = self.variances**2 / uncertain
        return {
            name: _chi_interval(sd, float(own)) if own >= 1.0 else (0.0, None)
            for name, sd, own in zip(COMPONENTS, self.sd, dof, strict=True)
        }


def _chi_interval(sd: float, dof: float) -> tuple[float, float | None]:
    high, low = (scipy.special.chdtri(dof, 0.5 * (1.0 + end * LEVEL)) for end in (1, -1))
    return sd * float(np.sqrt(dof / low)), sd * float(np.sqrt(dof / high))


def fit(problem: Problem, *components: str) -> Fit | None:
    """Restricted maximum likelihood of some components; None where the search does not settle."""
    free, spread = np.isin(COMPONENTS, components), problem.spread**2

    def likelihood(variances: FloatArray) -> Likelihood:
        return Fit(problem, variances).likelihood

    # What the errors leave of the spread, in equal parts.
    left = max(spread - problem.variance.mean(), 0.1 * problem.unit)
    start = free * left / max(free.sum(), 1)
    variances, deviance = minimize_deviance(likelihood, free, start, problem.unit)
    for place in np.flatnonzero(free):
        without = np.where(np.arange(len(free)) == place, 0.0, variances)
        gain = likelihood(without).deviance - deviance
        if variances[place] > 0.0 and np.isfinite(deviance) and gain <= NO_GAIN:
            free[place] = False
            variances, deviance = minimize_deviance(likelihood, free, without, problem.unit)
    return Fit(problem, variances) if np.isfinite(deviance) else None
