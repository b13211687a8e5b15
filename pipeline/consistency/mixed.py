"""A line through tows of boats: a linear mixed model with known measuring errors, fitted by REML.

    y = X beta + boat + other + cell + error

The boat's effect has one value for all rows of a boat, `other` (a season, a type) one for all rows
of that; a cell is the single row. The error's variance is known per row, the other three are
estimated by restricted maximum likelihood (Patterson & Thompson 1971) with the search of
`pipeline.model`. With a single row per boat this is the random-effects model of meta-analysis. What
y and X are is decided elsewhere.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple, Self

import numpy as np
import scipy
from numpy.typing import ArrayLike

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.model import Likelihood, most_likely
from pipeline.quantiles import LEVEL, t_quantile

BOAT, OTHER, CELL = "boat", "other", "cell"
COMPONENTS: Final = (BOAT, OTHER, CELL)

SMALLEST_SHARE: Final = 1e-4
"""Least measuring error, as a share of the size of y.

Points that happen to lie exactly on a curve seem to have no error, and would have all the weight.
Beside the spread of boats as many digits are lost as (boat's sd / error)^2 has: 1e-4 leaves eight.
"""

LEAST_MISFIT: Final = 0.05
"""Least misfit of the other boats' rows, also where they agree by chance."""

NO_GAIN: Final = 1e-4
"""A component that lowers the deviance by no more than this is 0."""

MOST_NUMBERS: Final = 1_000_000
"""In one array of problems that are fitted side by side."""


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
        alike: (3, n, n) pairs of rows that share a boat, another group, a cell: what a component
            adds to the covariance of the rows.
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
        other = np.arange(len(self.y)) if other is None else np.asarray(other)
        groups = (self.boat, other, np.arange(len(self.y)))
        self.alike = np.stack([one[:, None] == one for one in groups])
        self.plain = np.asarray(np.linalg.lstsq(self.x, self.y)[0], dtype=np.float64)
        self.residual = self.y - self.x @ self.plain
        self.rows_beyond = len(self.y) - int(self.x.shape[1])
        self.spread = float(np.sqrt((self.residual**2).sum() / max(self.rows_beyond, 1)))
        self.unit = max(self.spread**2, float(self.variance.min()))


class _At(NamedTuple):
    """Problems at some variances; m problems of n rows with p fixed effects.

    Attributes:
        likelihood: as `most_likely` takes it.
        effects: fixed effects, less those by plain least squares, (m, p).
        covariance: of them, (m, p, p).
        precision: P, that of the rows less what the fixed effects take up, (m, n, n).
        pull: P y, (m, n); misfit: y' P y, (m,): the weighted sum of squares about the line.
    """

    likelihood: Likelihood
    effects: FloatArray
    covariance: FloatArray
    precision: FloatArray
    pull: FloatArray
    misfit: FloatArray


@dataclass(frozen=True)
class _SideBySide:
    """Problems side by side, as small arrays cost their calls and not their numbers.

    All have as many rows and fixed effects as the largest needs. Rows that a problem does not have
    are 0 with a variance of 1; of columns it does not have the information is 1.

    Attributes:
        residual, variance: (m, n) of the rows.
        x: (m, n, p) fixed effects; absent: (m, p, p) 1 for each that a problem does not have.
        alike: (m, 3, n, n) as in `Problem`.
    """

    residual: FloatArray
    variance: FloatArray
    x: FloatArray
    absent: FloatArray
    alike: FloatArray

    @classmethod
    def of(cls, problems: Sequence[Problem]) -> Self:
        m, n = len(problems), max(len(one.y) for one in problems)
        p = max(one.x.shape[1] for one in problems)
        residual, variance, x = np.zeros((m, n)), np.ones((m, n)), np.zeros((m, n, p))
        absent, alike = np.zeros((m, p, p)), np.zeros((m, len(COMPONENTS), n, n))
        for i, one in enumerate(problems):
            rows, effects = one.x.shape
            residual[i, :rows], variance[i, :rows] = one.residual, one.variance
            x[i, :rows, :effects], alike[i, :, :rows, :rows] = one.x, one.alike
            absent[i] = np.diag(np.arange(p) >= effects)
        return cls(residual, variance, x, absent, alike)

    def likelihood(self, chosen: IntArray, variances: FloatArray) -> Likelihood:
        """The restricted likelihood of some of the problems, as `most_likely` takes it."""
        some = (values[chosen] for values in vars(self).values())
        of = self if len(chosen) == len(self.x) else _SideBySide(*some)
        return of.at(variances).likelihood

    def at(self, variances: FloatArray) -> _At:
        """The problems at variances of boat, other and cell, (m, 3).

        The slope of the deviance by a variance that adds K to the covariance is
        tr(P K) - y' P K P y, its average information y' P K P K P y.
        """
        count, size = self.variance.shape
        flat = self.alike.reshape(count, len(COMPONENTS), -1)
        rows = (variances[:, None] @ flat).reshape(count, size, size)
        rows += self.variance[:, :, None] * np.eye(size)
        inverse = np.linalg.inv(rows)
        weighed = inverse @ self.x
        known = np.swapaxes(self.x, 1, 2) @ weighed + self.absent
        covariance: FloatArray = np.linalg.inv(known).astype(np.float64)
        effects = covariance @ (np.swapaxes(weighed, 1, 2) @ self.residual[:, :, None])
        precision = inverse - weighed @ covariance @ np.swapaxes(weighed, 1, 2)
        pull = precision @ self.residual[:, :, None]
        misfit = (self.residual * pull[:, :, 0]).sum(axis=1)

        felt = (self.alike @ pull[:, None])[..., 0]
        gradient = (flat @ precision.reshape(count, -1, 1) - felt @ pull)[:, :, 0]
        information = felt @ precision @ np.swapaxes(felt, 1, 2)
        deviance = np.linalg.slogdet(rows)[1] + np.linalg.slogdet(known)[1] + misfit
        likelihood = Likelihood(deviance, gradient, information)
        return _At(likelihood, effects[:, :, 0], covariance, precision, pull[:, :, 0], misfit)


@dataclass(frozen=True)
class Fit:
    """A fitted mixed model.

    Attributes:
        problem: what was fitted.
        sd: standard deviations of boat, other and cell; 0 where none was estimated.
        beta: fixed effects, (p,); covariance: of them, (p, p), at a scale of 1.
        precision: P, of the rows less what the unknowns take up, (n, n); pull: P y, (n,).
        misfit: y' P y: the weighted sum of squares about the fixed effects.
        information: (3, 3) second derivative of the deviance by the variances.
    """

    problem: Problem
    sd: tuple[float, float, float]
    beta: FloatArray
    covariance: FloatArray
    precision: FloatArray
    pull: FloatArray
    misfit: float
    information: FloatArray

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
        smallest = 1.0 / (np.square(self.sd).sum() + problem.variance)
        error, variance, scale = np.zeros(n), np.full(n, np.inf), np.ones(n)
        for one in range(int(problem.boat.max()) + 1):
            rows = np.flatnonzero(problem.boat == one)
            block = self.precision[np.ix_(rows, rows)]
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
        variance = np.square(self.sd)
        there = variance > 0.0
        uncertain = np.full(len(variance), np.inf)
        inverse = np.linalg.inv(self.information[np.ix_(there, there)])
        uncertain[there] = np.diagonal(inverse)
        dof = variance**2 / uncertain
        return {
            name: _chi_interval(sd, float(own)) if own >= 1.0 else (0.0, None)
            for name, sd, own in zip(COMPONENTS, self.sd, dof, strict=True)
        }


def _chi_interval(sd: float, dof: float) -> tuple[float, float | None]:
    high, low = (scipy.special.chdtri(dof, 0.5 * (1.0 + end * LEVEL)) for end in (1, -1))
    return sd * float(np.sqrt(dof / low)), sd * float(np.sqrt(dof / high))


def fit_all(problems: Sequence[Problem], free: tuple[str, ...]) -> list[Fit | None]:
    """Restricted maximum likelihood of the components named in `free`, of each problem.

    Returns:
        None where the search did not come to rest.
    """
    fits: list[Fit | None] = [None] * len(problems)
    for places in _batches([len(one.y) for one in problems]):
        batch = [problems[place] for place in places]
        for place, fit in zip(places, _fitted(batch, np.isin(COMPONENTS, free)), strict=True):
            fits[place] = fit
    return fits


def _batches(rows: Sequence[int]) -> Iterator[list[int]]:
    """Problems that are fitted side by side, by their places: of about equal size."""
    batch: list[int] = []
    for place in sorted(range(len(rows)), key=lambda one: rows[one]):
        if batch and (len(batch) + 1) * rows[place] ** 2 > MOST_NUMBERS:
            yield batch
            batch = []
        batch.append(place)
    if batch:
        yield batch


def _fitted(problems: Sequence[Problem], free: BoolArray) -> Iterator[Fit | None]:
    together = _SideBySide.of(problems)
    variances, settled = _most_likely(problems, together, free)
    at = together.at(variances)
    for i, problem in enumerate(problems):
        mine = slice(problem.x.shape[1])
        boat, other, cell = np.sqrt(variances[i]).tolist()
        n = len(problem.y)
        fit = Fit(
            problem,
            (boat, other, cell),
            problem.plain + at.effects[i, mine],
            at.covariance[i, mine, mine],
            at.precision[i, :n, :n],
            at.pull[i, :n],
            float(at.misfit[i]),
            at.likelihood.information[i],
        )
        yield fit if settled[i] else None


def _most_likely(
    problems: Sequence[Problem], together: _SideBySide, free: BoolArray
) -> tuple[FloatArray, BoolArray]:
    """Variances of boat, other and cell of each problem, (problems, 3); whether they settled."""
    unit, loose = np.array([one.unit for one in problems]), np.tile(free, (len(problems), 1))
    # What the errors leave of the spread, in equal parts.
    left = [max(p.spread**2 - p.variance.mean(), 0.1 * p.unit) for p in problems]
    start = loose * np.array(left)[:, None] / max(free.sum(), 1)
    variances, there, settled = most_likely(together.likelihood, loose, start, unit)
    for place in np.flatnonzero(free):
        without = variances.copy()
        without[:, place] = 0.0
        loss = together.at(without).likelihood.deviance - there.deviance
        idle = ((variances[:, place] > 0.0) & (loss <= NO_GAIN))[:, None]
        if not idle.any():
            continue
        loose &= ~idle | (np.arange(len(free)) != place)
        start = np.where(idle, without, variances)
        variances, there, still = most_likely(together.likelihood, loose & idle, start, unit)
        settled &= still
    return variances, settled
