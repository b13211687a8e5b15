"""A line through tows of boats: a linear mixed model with known measuring errors, fitted by REML.

    y = X beta + boat + other + cell + error

The boat's effect has one value for all rows of a boat, `other` (a season, a type) one for all rows
of that; a cell is the single row. The error's variance is known per row, the other three are
estimated by restricted maximum likelihood (Patterson & Thompson 1971) with the search of
`pipeline.model`. With a single row per boat this is the random-effects model of meta-analysis. What
y and X are is decided elsewhere.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.model import Likelihood, most_likely
from pipeline.quantiles import NORMAL, t_quantile

BOAT, OTHER, CELL = "boat", "other", "cell"
COMPONENTS: Final = (BOAT, OTHER, CELL)

SMALLEST_SHARE: Final = 1e-4
"""Least measuring error, as a share of the size of y.

Points that happen to lie exactly on a curve seem to have no error, and would have all the weight.
Beside the spread of boats as many digits are lost as (boat's sd / error)^2 has: 1e-4 leaves eight.
"""

PROFILE_PRECISION: Final = 1e-7
"""The last step towards an end of a profile interval is less than this share of the spread."""

PROFILE_TOLERANCE: Final = 1e-5
"""When the search for the other variances is done: their error counts squared in the deviance."""

MAX_DOUBLINGS: Final = 7
"""The upper end of an interval is sought up to 2 to this power times its expected place."""

MAX_STEPS: Final = 60
"""Steps towards an end of an interval."""

LEAST_MISFIT: Final = 0.05
"""Least misfit of the other boats' rows, also where they agree by chance."""

FEW_UNKNOWNS: Final = 6
"""Up to here products of many problems are taken at once, beyond it of one after the other."""

NO_GAIN: Final = 1e-4
"""A component that lowers the deviance by no more than this is 0."""


class NotSettledError(ArithmeticError):
    """A search reached its limit of steps before it came to rest: there is no answer."""


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
        others: (n, k) which other group each row is of, as columns of 0 and 1.
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
        group = np.asarray([] if other is None else other)
        others = (group[:, None] == np.unique(group)).astype(np.float64)
        self.others = others.reshape(len(self.y), -1)
        self.plain = np.asarray(np.linalg.lstsq(self.x, self.y)[0], dtype=np.float64)
        self.residual = self.y - self.x @ self.plain
        self.rows_beyond = len(self.y) - int(self.x.shape[1])
        self.spread = float(np.sqrt((self.residual**2).sum() / max(self.rows_beyond, 1)))
        self.unit = max(self.spread**2, float(self.variance.min()))


class _At(NamedTuple):
    """Problems at some variances.

    Attributes:
        likelihood: as `most_likely` takes it.
        unknowns: effects of the others and fixed effects where they are most likely, (m, k).
        covariance: of them, (m, k, k).
        misfit: y' P y, (m,): the weighted sum of squares about the fixed effects.
    """

    likelihood: Likelihood
    unknowns: FloatArray
    covariance: FloatArray
    misfit: FloatArray


@dataclass(frozen=True)
class _SideBySide:
    """Problems side by side, as small arrays cost their calls and not their numbers.

    All have as many unknowns as the largest needs, first the others, then the fixed effects.
    Columns that a problem does not have are empty, with a prior of 1, which adds nothing.

    Attributes:
        residual, variance: (n,) of all rows; those of a problem, and in it of a boat, together.
        design: (n, k) slope of the rows by the unknowns.
        random: (m, k) which unknowns have a prior.
        n_others: how many of them are others.
        problem, boat: (n,) which each row is of.
    """

    residual: FloatArray
    variance: FloatArray
    design: FloatArray
    random: BoolArray
    n_others: int
    problem: IntArray
    boat: IntArray

    @classmethod
    def of(cls, problems: Sequence[Problem]) -> Self:
        n_others = max(one.others.shape[1] for one in problems)
        size = n_others + max(one.x.shape[1] for one in problems)
        random = np.ones((len(problems), size), bool)
        parts, boats = [], 0
        for number, one in enumerate(problems):
            order = np.argsort(one.boat, kind="stable")
            design = np.zeros((len(order), size))
            design[:, : one.others.shape[1]] = one.others
            fixed = slice(n_others, n_others + one.x.shape[1])
            design[:, fixed], random[number, fixed] = one.x, False
            rows = (one.residual, one.variance, design, np.full(len(order), number))
            parts.append((*(part[order] for part in rows), boats + one.boat[order]))
            boats += int(one.boat.max()) + 1
        joined = [np.concatenate(part) for part in zip(*parts, strict=True)]
        residual, variance, stacked, problem, boat = joined
        return cls(residual, variance, stacked, random, n_others, problem, boat)

    def take(self, chosen: IntArray) -> "_SideBySide":
        """Some of the problems, in their order."""
        place = np.full(len(self.random), -1)
        place[chosen] = np.arange(len(chosen))
        mine = place[self.problem] >= 0
        return _SideBySide(
            self.residual[mine],
            self.variance[mine],
            self.design[mine],
            self.random[chosen],
            self.n_others,
            place[self.problem[mine]],
            self.boat[mine],
        )

    def likelihood(self, chosen: IntArray, variances: FloatArray) -> Likelihood:
        """The restricted likelihood of some of the problems, as `most_likely` takes it."""
        of = self if len(chosen) == len(self.random) else self.take(chosen)
        return of.at(variances).likelihood

    def at(self, variances: FloatArray) -> _At:
        """The problems at variances of boat, other and cell, (m, 3).

        The covariance of a boat's rows is diagonal but for the effect of the boat, so that what it
        takes to invert it are sums over the boat (Sherman & Morrison 1950). With P the precision
        of all rows less what the unknowns take up, the slope of the deviance by a variance that
        adds K to the covariance is tr(P K) - y' P K P y.
        """
        problem, design, q = self.problem, self.design, self.n_others
        row_of_boat = np.flatnonzero(np.diff(self.boat, prepend=-1))
        boat_of_row = np.cumsum(np.diff(self.boat, prepend=self.boat[0]) != 0)
        problem_of_boat = problem[row_of_boat]
        boat_of_problem = np.flatnonzero(np.diff(problem_of_boat, prepend=-1))
        row_of_problem = row_of_boat[boat_of_problem]

        def over(values: FloatArray, begins: IntArray) -> FloatArray:
            return np.asarray(np.add.reduceat(values, begins, axis=0))

        def outer(left: FloatArray, right: FloatArray) -> FloatArray:
            """Products of all columns, summed over the rows of each problem."""
            if design.shape[1] <= FEW_UNKNOWNS:
                return over(left[:, :, None] * right[:, None], row_of_problem)
            parts = (np.split(rows, row_of_problem[1:]) for rows in (left, right))
            return np.stack([one.T @ other for one, other in zip(*parts, strict=True)])

        def squares(rows: FloatArray, begins: IntArray, whose: IntArray) -> FloatArray:
            """Variance that the unknowns give each row, of as many unknowns."""
            if design.shape[1] <= FEW_UNKNOWNS:
                return np.asarray(np.einsum("ij,ijk,ik->i", rows, covariance[whose], rows))
            parts = zip(np.split(rows, begins[1:]), covariance, strict=True)
            return np.concatenate([((one @ own) * one).sum(axis=1) for one, own in parts])

        between, _, cell = variances.T
        weight = 1.0 / (self.variance + cell[problem])
        boat_weight = over(weight, row_of_boat)
        stretch = 1.0 + between[problem_of_boat] * boat_weight
        shrink = between[problem_of_boat] / stretch

        def solve(values: FloatArray) -> FloatArray:
            """The precision of the rows, were the unknowns known, times values (n, any)."""
            of_boats = over(weight[:, None] * values, row_of_boat)
            left = values - (shrink[:, None] * of_boats)[boat_of_row]
            return np.asarray(weight[:, None] * left)

        weighed = solve(design)
        products = outer(design, weighed)
        prior = np.where(np.arange(design.shape[1]) < q, variances[:, 1:2], 1.0)
        known = self.random[:, None] * np.eye(design.shape[1]) + prior[:, :, None] * products
        covariance = np.linalg.inv(known).astype(np.float64) * prior[:, None]
        score = over(weighed * self.residual[:, None], row_of_problem)
        unknowns = (covariance @ score[..., None])[..., 0]
        left = self.residual - (design * unknowns[problem]).sum(axis=1)
        pull = solve(left[:, None])[:, 0]
        of_boats = over(weight * left, row_of_boat) / stretch
        of_others = over(design[:, :q] * pull[:, None], row_of_problem)
        pulls = [
            over(of_boats**2, boat_of_problem),
            (of_others**2).sum(axis=1),
            over(pull**2, row_of_problem),
        ]
        misfit = over(pull**2 / weight, row_of_problem)
        misfit += variances[:, 0] * pulls[0] + variances[:, 1] * pulls[1]
        determinant = over(np.log(stretch), boat_of_problem) - over(np.log(weight), row_of_problem)
        deviance = determinant + np.linalg.slogdet(known)[1] + misfit

        taken_of_boats = squares(over(weighed, row_of_boat), boat_of_problem, problem_of_boat)
        taken = squares(weighed, row_of_problem, problem)
        of_known = products[:, :q] @ covariance @ np.swapaxes(products[:, :q], 1, 2)
        traces = [
            over(boat_weight / stretch - taken_of_boats, boat_of_problem),
            np.trace(products[:, :q, :q] - of_known, axis1=1, axis2=2),
            over(weight - weight**2 * shrink[boat_of_row] - taken, row_of_problem),
        ]
        # K P y of each variance: what boats, others and cells have of the pull in common.
        common = (design[:, :q] * of_others[problem]).sum(axis=1)
        felt = np.stack([of_boats[boat_of_row], common, pull], axis=1)
        across = outer(weighed, felt)
        information = outer(felt, solve(felt)) - np.swapaxes(across, 1, 2) @ covariance @ across
        gradient = np.stack(traces, axis=1) - np.stack(pulls, axis=1)
        return _At(Likelihood(deviance, gradient, information), unknowns, covariance, misfit)


@dataclass(frozen=True)
class Fit:
    """A fitted mixed model.

    Attributes:
        problem: what was fitted.
        free: components that were estimated; the others are 0.
        sd: standard deviations of boat, other and cell.
        beta: fixed effects, (p,); covariance: of them, (p, p), at a scale of 1.
        misfit: y' P y: the weighted sum of squares about the fixed effects.
    """

    problem: Problem
    free: tuple[str, ...]
    sd: tuple[float, float, float]
    beta: FloatArray
    covariance: FloatArray
    misfit: float

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
        boat, other, cell = np.square(self.sd)
        covariance = boat * (problem.boat[:, None] == problem.boat)
        covariance += other * problem.others @ problem.others.T
        covariance[range(n), range(n)] += problem.variance + cell
        precision: FloatArray = np.linalg.inv(covariance).astype(np.float64)
        along = precision @ problem.x
        block_of, pull = precision - along @ self.covariance @ along.T, precision @ problem.residual
        pull -= along @ (self.beta - problem.plain)
        error, variance, scale = np.zeros(n), np.full(n, np.inf), np.ones(n)
        for one in range(int(problem.boat.max()) + 1):
            rows = np.flatnonzero(problem.boat == one)
            own = np.ix_(rows, rows)
            block = block_of[own]
            if np.linalg.eigvalsh(block)[0] <= 1e-9 / covariance[rows, rows].min():
                continue
            inverse = np.linalg.inv(block)
            error[rows], variance[rows] = inverse @ pull[rows], np.diagonal(inverse)
            others = self.scale * problem.rows_beyond - error[rows] @ pull[rows]
            beyond = max(problem.rows_beyond - len(rows), 1)
            scale[rows] = max(float(others), LEAST_MISFIT) / beyond
        return error, variance, scale

    def intervals(self) -> dict[str, tuple[float, float | None]]:
        """95 % profile-likelihood intervals of the components' sds; None without an upper bound.

        Raises:
            NotSettledError: the search for an end did not come to rest.
        """
        profile, sd, upper = _Profile(self), np.tile(self.sd, 2), np.arange(6) >= 3
        outside = np.where(upper, np.maximum(2.0 * sd, 0.1 * self.problem.spread), 0.0)
        bounded = profile.excess(outside, np.arange(6))[0] > 0.0
        for _ in range(MAX_DOUBLINGS):  # far out the deviance loses its digits
            short = np.flatnonzero(upper & ~bounded)
            outside[short] *= 2.0
            if len(short):
                bounded[short] = profile.excess(outside[short], short)[0] > 0.0
        found = profile.ends(outside.copy(), sd, outside, np.flatnonzero(bounded))
        low, high = np.where(bounded, found, np.where(upper, np.nan, 0.0)).reshape(2, 3).tolist()
        return {
            name: (lo, None if np.isnan(hi) else hi)
            for name, lo, hi in zip(COMPONENTS, low, high, strict=True)
        }


class _Profile:
    """How much worse a fit is where one of its sds is something else, the others at their best.

    Six places side by side: at the lower ends of the three intervals, then at the upper ends.
    """

    def __init__(self, fit: Fit) -> None:
        self._component = np.tile(np.arange(3), 2)
        self._free = np.isin(COMPONENTS, fit.free) & (np.arange(3) != self._component[:, None])
        self._together = _SideBySide.of([fit.problem] * 6)
        self._unit, self._nearest = np.full(6, fit.problem.unit), np.square([fit.sd] * 6)
        self._least = self._together.at(self._nearest).likelihood.deviance
        self._precision = PROFILE_PRECISION * fit.problem.spread

    def excess(self, sd: FloatArray, ends: IntArray) -> tuple[FloatArray, FloatArray]:
        """Root of what the deviance gains at sds of some ends, less its value there; its slope.

        The root of a deviance is nearly straight, which a search for its zero likes. The other
        variances at their best do not count in the slope (envelope theorem).
        """
        start, at = self._nearest[ends], (np.arange(len(ends)), self._component[ends])
        start[at] = sd**2
        self._nearest[ends], there, settled = most_likely(
            self._together.take(ends).likelihood,
            self._free[ends],
            start,
            self._unit[ends],
            PROFILE_TOLERANCE,
        )
        if not settled.all():
            raise NotSettledError
        root = np.sqrt(np.maximum(there.deviance - self._least[ends], 0.0))
        return root - NORMAL, there.gradient[at] * sd / np.maximum(root, 1e-9)

    def ends(
        self, found: FloatArray, inside: FloatArray, outside: FloatArray, busy: IntArray
    ) -> FloatArray:
        """Where the excess of some ends is 0, between sds inside and outside of the intervals.

        By Newton's method; where that leads out of the bracket, the bracket is halved.
        """
        for _ in range(MAX_STEPS):
            if not len(busy):
                return found
            excess, slope = self.excess(found[busy], busy)
            is_outside = excess > 0.0
            inside[busy[~is_outside]] = found[busy[~is_outside]]
            outside[busy[is_outside]] = found[busy[is_outside]]
            low, high = np.sort([inside[busy], outside[busy]], axis=0)
            newton = found[busy] - excess / np.where(slope == 0.0, 1e-300, slope)
            is_within = (newton >= low) & (newton <= high)
            now = np.where(is_within, newton, 0.5 * (low + high))
            moved = np.abs(now - found[busy])
            found[busy] = now
            busy = busy[moved > self._precision]
        raise NotSettledError


def fit_all(problems: Sequence[Problem], free: tuple[str, ...]) -> list[Fit | None]:
    """Restricted maximum likelihood of the components named in `free`, of each problem.

    Returns:
        None where the search did not come to rest.
    """
    if not problems:
        return []
    together = _SideBySide.of(problems)
    variances, settled = _most_likely(problems, together, np.isin(COMPONENTS, free))
    at, first = together.at(variances), together.n_others
    fits: list[Fit | None] = []
    for i, problem in enumerate(problems):
        mine = slice(first, first + problem.x.shape[1])
        beta, covariance = problem.plain + at.unknowns[i, mine], at.covariance[i, mine, mine]
        boat, other, cell = np.sqrt(variances[i]).tolist()
        fitted = Fit(problem, free, (boat, other, cell), beta, covariance, float(at.misfit[i]))
        fits.append(fitted if settled[i] else None)
    return fits


def _most_likely(
    problems: Sequence[Problem], together: _SideBySide, free: BoolArray
) -> tuple[FloatArray, BoolArray]:
    """Variances of boat, other and cell of each problem, (problems, 3); whether they settled."""
    unit, loose = np.array([one.unit for one in problems]), np.tile(free, (len(problems), 1))
    # What the errors leave of the spread, in equal parts.
    left = [max(p.spread**2 - p.variance.mean(), 0.1 * p.unit) for p in problems]
    start = loose * np.array(left)[:, None] / max(free.sum(), 1)
    variances, there, settled = most_likely(together.likelihood, loose, start, unit)
    least = there.deviance
    for place in np.flatnonzero(free):
        without = variances.copy()
        without[:, place] = 0.0
        loss = together.at(without).likelihood.deviance - least
        idle = (variances[:, place] > 0.0) & (loss <= NO_GAIN)
        loose[idle, place] = False
        if idle.any():
            of_idle = together.take(np.flatnonzero(idle)).likelihood
            variances[idle], there, still = most_likely(
                of_idle, loose[idle], without[idle], unit[idle]
            )
            settled[idle] &= still
            least[idle] = there.deviance
    return variances, settled
