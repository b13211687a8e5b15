"""Linear mixed model with known measuring errors, fitted by restricted maximum likelihood.

    y = X beta + boat + other + cell + error

The boat's effect has one value for all rows of a boat, `other` (a season, a type) one for all rows
of that; a cell is the single row. The error's variance is known per row, the other three are
estimated. With a single row per boat this is the random-effects model of meta-analysis. Here is its
design for `pipeline.model`, and what a fit says; what y and X are is decided elsewhere.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.model import Boats, Likelihood, LikelihoodOf, leave_boats_out, most_likely, total
from pipeline.quantiles import NORMAL, t_quantile

BOAT, OTHER, CELL = "boat", "other", "cell"
COMPONENTS: Final = (BOAT, OTHER, CELL)

SMALLEST_SHARE: Final = 1e-4
"""Least measuring error, as a share of the size of y.

Points that happen to lie exactly on a curve seem to have no error, and would have all the weight.
The inverse of the covariance holds numbers as large as (boat's sd / error)^2 and loses as many
digits: below 1e-8 none is left; 1e-4 leaves eight.
"""

PROFILE_PRECISION: Final = 1e-7
"""An end of a profile interval is known to this share of the spread."""

PROFILE_TOLERANCE: Final = 1e-5
"""When the search for the other variances is done: their error counts squared in the deviance."""

MAX_DOUBLINGS: Final = 7
"""The upper end of an interval is sought up to 2 to this power times its expected place."""

LEAST_MISFIT: Final = 0.05
"""Least misfit of the other boats' rows, also where they agree by chance."""

NO_GAIN: Final = 1e-4
"""A component that lowers the deviance by no more than this is 0."""


class NotSettledError(ArithmeticError):
    """A search reached its limit of steps before it came to rest: there is no answer."""


class Coefficients(NamedTuple):
    """Fixed effects, each of shape (p,)."""

    value: FloatArray
    lo: FloatArray
    hi: FloatArray


@dataclass(frozen=True)
class Problem:
    """Data of a mixed model; n rows, p fixed effects.

    Attributes:
        y: (n,) observations.
        variance: (n,) known variance of each.
        x: (n, p) fixed effects, of full column rank.
        boat: (n,) which boat, 0 and up, without gaps.
        others: (n, k) which other group each row is of, as columns of 0 and 1.
    """

    y: FloatArray
    variance: FloatArray
    x: FloatArray
    boat: IntArray
    others: FloatArray

    @classmethod
    def of(
        cls,
        y: ArrayLike,
        variance: ArrayLike,
        x: ArrayLike,
        boat: ArrayLike,
        other: ArrayLike | None = None,
    ) -> Self:
        """A problem from anything array-like; groups may be named by text or number."""
        values = np.asarray(y, dtype=np.float64)
        floor = (SMALLEST_SHARE * (np.ptp(values) + abs(values.mean()))) ** 2
        known = np.maximum(np.asarray(variance, dtype=np.float64), max(floor, 1e-300))
        group = np.asarray([] if other is None else other)
        return cls(
            values,
            known,
            np.asarray(x, dtype=np.float64).reshape(len(values), -1),
            np.unique(np.asarray(boat), return_inverse=True)[1],
            (group[:, None] == np.unique(group)).astype(np.float64).reshape(len(values), -1),
        )

    @cached_property
    def plain(self) -> FloatArray:
        """Fixed effects by plain least squares, (p,)."""
        return np.asarray(np.linalg.lstsq(self.x, self.y)[0])

    @cached_property
    def residual(self) -> FloatArray:
        """Y less the plain least-squares fit: the likelihood sees nothing else of y."""
        return self.y - self.x @ self.plain

    @property
    def rows_beyond(self) -> int:
        """Rows beyond the number of fixed effects."""
        return len(self.y) - int(self.x.shape[1])

    @cached_property
    def spread(self) -> float:
        """Standard deviation of y about the plain least-squares fit, the scale of a search."""
        return float(np.sqrt((self.residual**2).sum() / max(self.rows_beyond, 1)))

    @property
    def unit(self) -> float:
        """Size of a variance."""
        return max(self.spread**2, float(self.variance.min()))


class _Rows(NamedTuple):
    """Boats of n rows, of any problem: their rows, known variances, unknowns, residuals."""

    rows: IntArray
    variance: FloatArray
    design: FloatArray
    residual: FloatArray
    problem: IntArray

    def take(self, mine: BoolArray) -> "_Rows":
        """Some of the boats."""
        rows, variance, design, residual, problem = self
        return _Rows(rows[mine], variance[mine], design[mine], residual[mine], problem[mine])


class _At(NamedTuple):
    """Problems at some variances.

    Attributes:
        boats: what their boats say where the unknowns are most likely.
        others: which other groups each row is of, as columns of 0 and 1, (b, n, others) each.
        unknowns: those, others in units of their sd and fixed effects, (m, k).
        covariance: of them, (m, k, k).
        misfit: y' P y, (m,): the weighted sum of squares about the fixed effects.
        deviance: as in `Likelihood`.
    """

    boats: list[Boats]
    others: list[FloatArray]
    unknowns: FloatArray
    covariance: FloatArray
    misfit: FloatArray
    deviance: FloatArray


class _SideBySide:
    """Problems side by side: small matrices cost their calls, not their numbers.

    All have as many unknowns as the largest needs, first the others, then the fixed effects.
    Columns that a problem does not have are empty, with a prior of 1, which adds nothing.
    """

    def __init__(self, problems: Sequence[Problem]) -> None:
        self.unit = np.array([one.unit for one in problems])
        self._others = max(one.others.shape[1] for one in problems)
        size = self._others + max(one.x.shape[1] for one in problems)
        self._random = np.ones((len(problems), size), bool)
        parts: dict[int, list[_Rows]] = {}
        for number, one in enumerate(problems):
            design = np.zeros((len(one.y), size))
            design[:, : one.others.shape[1]] = one.others
            design[:, self.fixed(one)] = one.x
            self._random[number, self.fixed(one)] = False
            order = np.argsort(one.boat, kind="stable")
            first, count = np.unique(one.boat[order], return_index=True, return_counts=True)[1:]
            for n in np.unique(count).tolist():
                rows = order[first[count == n, None] + np.arange(n)]
                whose = np.full(len(rows), number)
                part = _Rows(rows, one.variance[rows], design[rows], one.residual[rows], whose)
                parts.setdefault(n, []).append(part)
        self._rows = [_Rows(*map(np.concatenate, zip(*p, strict=True))) for p in parts.values()]

    def fixed(self, problem: Problem) -> slice:
        """Where a problem's fixed effects are among the unknowns."""
        return slice(self._others, self._others + problem.x.shape[1])

    def at(self, chosen: IntArray, variances: FloatArray) -> _At:
        """Some of the problems at variances of boat, other and cell, (some, 3)."""
        m, size = len(chosen), self._random.shape[1]
        place = np.full(len(self._random), -1)
        place[chosen] = np.arange(m)
        scale = np.where(np.arange(size) < self._others, np.sqrt(variances[:, 1:2]), 1.0)
        boats, others = [], []
        for part in self._rows:
            mine = place[part.problem] >= 0
            if not mine.any():
                continue
            rows, variance, design, residual, problem = part if mine.all() else part.take(mine)
            whose, n = place[problem], rows.shape[1]
            boat, _, cell = variances[whose].T
            own = np.tile(boat[:, None, None], (1, n, n))
            own[:, range(n), range(n)] += variance + cell[:, None]
            others.append(design[..., : self._others])
            boats.append(Boats.alike(rows, design * scale[whose, None], residual, own, whose))
        random = self._random[chosen]
        known = total(boats, (some.complete_information for some in boats), m)
        known += random[:, None] * np.eye(size)
        covariance: FloatArray = np.linalg.inv(known).astype(np.float64)
        score = total(boats, (some.score for some in boats), m)
        unknowns = (covariance @ score[..., None])[..., 0]
        boats = [some.moved(unknowns) for some in boats]
        misfit = total(boats, (some.misfit[:, 0] for some in boats), m)
        misfit += np.where(random, unknowns**2, 0.0).sum(axis=1)
        determinant = total(boats, (some.ln_determinant[:, 0] for some in boats), m)
        deviance = determinant + np.linalg.slogdet(known)[1] + misfit
        return _At(boats, others, unknowns, covariance, misfit, deviance)

    def of(self, places: IntArray) -> LikelihoodOf:
        """The likelihood of some of the problems alone, in this order."""
        return lambda chosen, variances: self.likelihood(places[chosen], variances)

    def likelihood(self, chosen: IntArray, variances: FloatArray) -> Likelihood:
        """The restricted likelihood of some of the problems, as `most_likely` takes it."""
        at, m = self.at(chosen, variances), len(chosen)
        pairs = list(zip(at.boats, at.others, strict=True))
        of_others = total(at.boats, ((o.mT @ b.pull.mT)[..., 0] for b, o in pairs), m)
        trace = total(at.boats, ((o * (b.precision @ o)).sum(axis=(1, 2)) for b, o in pairs), m)
        across = total(at.boats, (o.mT @ b.weighed for b, o in pairs), m)
        trace -= (across @ at.covariance * across).sum(axis=(1, 2))
        excess = [some.excess(at.covariance) for some in at.boats]
        slopes = [
            -total(at.boats, (e.sum(axis=(1, 2)) for e in excess), m),
            trace - (of_others**2).sum(axis=1),
            -total(at.boats, (np.trace(e, axis1=1, axis2=2) for e in excess), m),
        ]
        felt = [_felt(some, other @ of_others[some.problem, :, None]) for some, other in pairs]
        parts = list(zip(at.boats, felt, strict=True))
        itself = total(at.boats, (f.mT @ b.precision @ f for b, f in parts), m)
        along = total(at.boats, (f.mT @ b.weighed for b, f in parts), m)
        information = itself - along @ at.covariance @ along.mT
        return Likelihood(at.deviance, np.stack(slopes, axis=1), information)


def _felt(boats: Boats, by_other: FloatArray) -> FloatArray:
    """P y as boats, others and cells of variance 1 have it in common, (b, n, 3)."""
    pull = boats.pull.mT
    by_boat = np.broadcast_to(pull.sum(axis=1, keepdims=True), pull.shape)
    return np.concatenate([by_boat, by_other, pull], axis=2)


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
        """The fixed effects' mean at rows of X, with 95 % intervals as in `coefficients`.

        Args:
            x: rows of fixed effects, shape (places, p).
        """
        spread = ((x @ self.covariance) * x).sum(axis=1)
        sd = np.sqrt(spread * self.misfit / self.problem.rows_beyond)
        half = float(t_quantile(self.dof)) * sd
        mean = x @ self.beta
        return Coefficients(mean, mean - half, mean + half)

    def leave_boats_out(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Each row as all other boats predict it, at the estimated variances.

        Returns:
            error: what the row has above its prediction, (n,).
            variance: of that, at a scale of 1; infinite where the others do not determine it.
            scale: misfit per row of the other boats, as in externally studentised residuals.
        """
        at = _SideBySide([self.problem]).at(np.zeros(1, np.int64), np.square([self.sd]))
        n, beyond = len(self.problem.y), self.problem.rows_beyond
        error, variance, own = leave_boats_out(at.boats, at.covariance[0], n)
        of_boat = np.bincount(self.problem.boat)[self.problem.boat]
        others = self.scale * beyond - own
        scale = np.maximum(others, LEAST_MISFIT) / np.maximum(beyond - of_boat, 1)
        return error, variance, np.where(np.isfinite(variance), scale, 1.0)

    def intervals(self) -> dict[str, tuple[float, float | None]]:
        """95 % profile-likelihood intervals of the components' sds; None without an upper bound.

        Raises:
            NotSettledError: the search for an end did not come to rest.
        """
        profile, sd = _Profile(self), np.tile(self.sd, 2)
        ends = np.arange(len(sd))
        lower, upper = np.split(ends, 2)
        lo, outside = np.zeros(len(sd)), np.maximum(2.0 * sd, 0.1 * self.problem.spread)
        above = profile.excess(lo[lower], lower) > 0.0
        beyond = profile.excess(outside[upper], upper) > 0.0
        for _ in range(MAX_DOUBLINGS):
            if beyond.all():
                break
            outside[upper[~beyond]] *= 2.0
            beyond[~beyond] = profile.excess(outside[upper[~beyond]], upper[~beyond]) > 0.0
        known = np.concatenate([lower[above], upper[beyond]])
        is_upper = known >= len(lower)
        inside = np.where(is_upper, sd[known], 0.0), np.where(is_upper, outside[known], sd[known])
        end = dict(zip(known.tolist(), profile.roots(*inside, known).tolist(), strict=True))
        return {
            name: (end.get(i, 0.0), end.get(len(COMPONENTS) + i))
            for i, name in enumerate(COMPONENTS)
        }


class _Profile:
    """How much worse a fit is where one of its sds is something else, the others at their best.

    Six searches side by side: for the lower ends of the three intervals, then for the upper ends.
    """

    def __init__(self, fit: Fit) -> None:
        self._component = np.tile(np.arange(len(COMPONENTS)), 2)
        ends = len(self._component)
        self._free = np.isin(COMPONENTS, fit.free) & (
            np.arange(len(COMPONENTS)) != self._component[:, None]
        )
        self._together = _SideBySide([fit.problem] * ends)
        self._nearest = np.square([fit.sd] * ends)
        self._least = self._together.at(np.arange(ends), self._nearest).deviance
        self._precision = PROFILE_PRECISION * fit.problem.spread

    def excess(self, sd: FloatArray, ends: IntArray) -> FloatArray:
        """Root of what the deviance gains at sds of some ends, less its value there.

        The root of a deviance is nearly straight, which a search for its zero likes.
        """
        start, unit = self._nearest[ends], self._together.unit[ends]
        start[np.arange(len(ends)), self._component[ends]] = sd**2
        self._nearest[ends], there, settled = most_likely(
            self._together.of(ends),
            self._free[ends],
            start,
            unit,
            PROFILE_TOLERANCE,
        )
        if not settled.all():
            raise NotSettledError
        return np.sqrt(np.maximum(there.deviance - self._least[ends], 0.0)) - NORMAL

    def roots(self, low: FloatArray, high: FloatArray, ends: IntArray) -> FloatArray:
        """Where the excess of some ends is 0, between these sds."""
        from scipy.optimize import elementwise  # noqa: PLC0415 - much, and seldom needed

        found = elementwise.find_root(
            self.excess, (low, high), args=(ends,), tolerances={"xatol": self._precision}
        )
        if not found.success.all():
            raise NotSettledError
        return np.asarray(found.x, dtype=np.float64)


def fit(problem: Problem, free: tuple[str, ...]) -> Fit:
    """Restricted maximum likelihood of the components named in `free`.

    Raises:
        NotSettledError: the search did not come to rest.
    """
    fitted = fit_all([problem], free)[0]
    if fitted is None:
        raise NotSettledError
    return fitted


def fit_all(problems: Sequence[Problem], free: tuple[str, ...]) -> list[Fit | None]:
    """The same of each of many problems, None where the search did not come to rest."""
    if not problems:
        return []
    together = _SideBySide(problems)
    variances, settled = _most_likely(problems, together, np.isin(COMPONENTS, free))
    at = together.at(np.arange(len(problems)), variances)
    fits: list[Fit | None] = []
    for i, problem in enumerate(problems):
        mine = together.fixed(problem)
        beta, covariance = problem.plain + at.unknowns[i, mine], at.covariance[i, mine, mine]
        boat, other, cell = np.sqrt(variances[i]).tolist()
        fitted = Fit(problem, free, (boat, other, cell), beta, covariance, float(at.misfit[i]))
        fits.append(fitted if settled[i] else None)
    return fits


def _most_likely(
    problems: Sequence[Problem], together: _SideBySide, free: BoolArray
) -> tuple[FloatArray, BoolArray]:
    """Variances of boat, other and cell of each problem, (problems, 3); whether they settled."""
    loose, every = np.tile(free, (len(problems), 1)), np.arange(len(problems))
    # What the errors leave of the spread, in equal parts.
    left = [max(p.spread**2 - p.variance.mean(), 0.1 * p.unit) for p in problems]
    start = loose * np.array(left)[:, None] / max(free.sum(), 1)
    variances, there, settled = most_likely(together.likelihood, loose, start, together.unit)
    least = there.deviance
    for place in np.flatnonzero(free):
        without = variances.copy()
        without[:, place] = 0.0
        idle = together.at(every, without).deviance <= least + NO_GAIN
        idle &= variances[:, place] > 0.0
        loose[idle, place] = False
        if idle.any():
            chosen = np.flatnonzero(idle)
            variances[idle], there, still = most_likely(
                together.of(chosen),
                loose[idle],
                without[idle],
                together.unit[idle],
            )
            settled[idle] &= still
            least[idle] = there.deviance
    return variances, settled
