"""Linear mixed model with known measuring errors, fitted by restricted maximum likelihood.

    y = X beta + boat + other + cell + error

The boat's effect has one value for all rows of a boat, `other` (a season, a type) one for all rows
of that; a cell is the single row. The error's variance is known per row, the other three are
estimated. With a single row per boat this is the random-effects model of meta-analysis. The
likelihood and its maximum are in `reml`; what y and X are, and what a result means, is decided
elsewhere.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.consistency.reml import Problem, Stack, Whitened, search
from pipeline.quantiles import NORMAL, t_quantile

BOAT, OTHER, CELL = "boat", "other", "cell"
COMPONENTS: Final = (BOAT, OTHER, CELL)

PROFILE_PRECISION: Final = 1e-7
"""The search for an end of a profile interval stops when a step is less, as a share of the spread:
Newton's method then leaves the square of that."""

PROFILE_TOLERANCE: Final = 1e-5
"""When the search for the other variances is done: their error counts squared in the deviance."""

ROUGHLY: Final = 1e-2
"""The same where only the sign is needed."""

MAX_STEPS: Final = 60
MAX_DOUBLINGS: Final = 7
"""The upper end of an interval is sought up to 2 to this power times its expected place."""

NUMBERS_AT_ONCE: Final = 1 << 16
"""Numbers of a stack: enough to make calls cheap, few enough for the nearer cache."""

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


class LeftOut(NamedTuple):
    """Predictions of the rows from those of the other boats, each of shape (n,).

    Attributes:
        error: what the row has above its prediction.
        variance: of that, at a scale of 1.
        scale: that of the other boats' rows, as `Fit.scale` is of all.
    """

    error: FloatArray
    variance: FloatArray
    scale: FloatArray


@dataclass(frozen=True)
class Fit:
    """A fitted mixed model.

    Attributes:
        problem: what was fitted.
        free: components that were estimated; the others are 0.
        sd: standard deviations of boat, other and cell.
        white: problems at these, the own one among them; place: which it is.
    """

    problem: Problem
    free: tuple[str, ...]
    sd: tuple[float, float, float]
    white: Whitened
    place: int

    @property
    def dof(self) -> int:
        """Degrees of freedom of the boats: rows of one boat do not count twice."""
        design = self.problem.design
        return design.boats - int(design.x.shape[1])

    @property
    def _inverse(self) -> FloatArray:
        """R with R R' the covariance of the fixed effects, (p, p); upper triangular."""
        return np.asarray(self.white.inverse[self.place])

    @property
    def misfit(self) -> float:
        """Y' P Y: the weighted sum of squares about the fixed effects."""
        return float(self.white.misfit[self.place])

    @property
    def scale(self) -> float:
        """Misfit per row beyond the fixed effects, at least 1: below, it is only rounding."""
        rows = self.problem.rows_beyond
        return max(1.0, self.misfit / rows) if rows > 0 else 1.0

    @cached_property
    def beta(self) -> FloatArray:
        """Fixed effects, shape (p,)."""
        known = self.white.along[self.place, self.problem.design.others.shape[1] :, 0]
        return self.problem.plain + self._inverse @ known

    def coefficients(self) -> Coefficients:
        """Fixed effects with 95 % intervals; needs `dof` of at least 1.

        The variance is scaled with the misfit per degree of freedom (Hartung & Knapp 2001): with
        equal errors the interval is that of ordinary least squares, whatever was estimated.
        """
        return self.line_at(np.eye(self.problem.design.x.shape[1]))

    def line_at(self, x: FloatArray) -> Coefficients:
        """The fixed effects' mean at rows of X, with 95 % intervals as in `coefficients`.

        Args:
            x: rows of fixed effects, shape (places, p).
        """
        spread = ((x @ self._inverse) ** 2).sum(axis=1)
        sd = np.sqrt(spread * self.misfit / self.problem.rows_beyond)
        half = float(t_quantile(self.dof)) * sd
        mean = x @ self.beta
        return Coefficients(mean, mean - half, mean + half)

    def leave_boats_out(self) -> LeftOut:
        """Prediction of each row from all other boats, at the estimated variances.

        For rows g the error is (P_gg)^-1 (P y)_g with variance (P_gg)^-1: no fit is repeated.
        Where the others do not determine the prediction, the variance is infinite. The boat's own
        misfit (P y)_g' (P_gg)^-1 (P y)_g is taken out of the scale, as in externally studentised
        residuals (Cook & Weisberg 1982, 2.2.1).
        """
        white, order = self.white.of_one(self.place), self.problem.design.by_boat
        n, boat = len(order), self.problem.design.boat[order]
        weighed = white.weigh(np.concatenate([white.q, white.rest], axis=-1))[0][0, :n]
        known, py = weighed[:, :-1], weighed[:, -1]
        weights, shared = white.weight[0, :n], white.boat[0] / white.inflation[0]
        error, variance, scale = np.zeros(n), np.full(n, np.inf), np.ones(n)
        misfit, beyond = self.scale * self.problem.rows_beyond, self.problem.rows_beyond
        first, each = np.unique(boat, return_index=True, return_counts=True)[1:]
        for size in np.unique(each):  # boats of as many rows side by side
            rows = first[each == size, None] + np.arange(size)
            weight = weights[rows][..., None]
            inverse = weight * np.eye(size) - shared[boat[rows], None] * weight * weight.mT
            block = inverse - known[rows] @ known[rows].mT
            largest = np.diagonal(inverse, axis1=-2, axis2=-1).max(axis=-1)
            told = np.linalg.eigvalsh(block)[:, 0] > 1e-9 * largest
            covariance, rows = np.linalg.inv(block[told]), rows[told]
            missed = (covariance @ py[rows][..., None])[..., 0]
            own = (missed * py[rows]).sum(axis=1, keepdims=True)
            error[order[rows]] = missed
            variance[order[rows]] = np.diagonal(covariance, axis1=-2, axis2=-1)
            scale[order[rows]] = np.maximum(misfit - own, LEAST_MISFIT) / max(beyond - size, 1)
        return LeftOut(error, variance, scale)

    def intervals(self) -> dict[str, tuple[float, float | None]]:
        """95 % profile-likelihood intervals of the components' sds; None without an upper bound.

        Raises:
            NotSettledError: the search for an end did not come to rest.
        """
        profile = _Profile(self)
        sd, places = np.asarray(self.sd), np.arange(len(COMPONENTS))
        lo, nothing = np.zeros(len(sd)), np.zeros(len(sd))
        at_nothing, _ = profile.excess(nothing, places, ROUGHLY)
        above = at_nothing > 0.0
        lo[above] = profile.ends(sd[above], nothing[above], at_nothing[above], places[above])
        outside = np.maximum(2.0 * sd, 0.1 * self.problem.spread)
        at_outside, _ = profile.excess(outside, places, ROUGHLY)
        for _ in range(MAX_DOUBLINGS):
            within = at_outside <= 0.0
            if not within.any():
                break
            outside[within] *= 2.0
            at_outside[within], _ = profile.excess(outside[within], places[within], ROUGHLY)
        beyond = at_outside > 0.0
        hi = profile.ends(sd[beyond], outside[beyond], at_outside[beyond], places[beyond])
        upper = dict(zip(places[beyond].tolist(), hi.tolist(), strict=True))
        return {name: (float(lo[i]), upper.get(i)) for i, name in enumerate(COMPONENTS)}


class _Profile:
    """How much worse a fit is where one of its sds is something else, the others at their best.

    Attributes:
        stack: the problem once per component.
        free: (3, 3) what is estimated, besides the component itself.
        nearest: (3, 3) the last variances, from which the next search starts.
        least: the deviance of the fit.
    """

    def __init__(self, fit: Fit) -> None:
        self.stack = Stack.of([fit.problem] * len(COMPONENTS))
        self.free = np.isin(COMPONENTS, fit.free) & ~np.eye(len(COMPONENTS), dtype=bool)
        self.nearest = np.square([fit.sd] * len(COMPONENTS))
        self.least = float(self.stack.likelihood(self.nearest).deviance[0])

    def excess(
        self, sd: FloatArray, place: IntArray, tolerance: float = PROFILE_TOLERANCE
    ) -> tuple[FloatArray, FloatArray]:
        """Root of the deviance at sds of some components, less its value at the ends; its slope.

        The root of a deviance is nearly straight, which a search for its zero likes.
        """
        each = np.arange(len(place))
        start = self.nearest[place]
        start[each, place] = sd**2
        self.nearest[place], there, settled = search(
            self.stack.take(place), self.free[place], start, tolerance
        )
        if not settled.all():
            raise NotSettledError
        root = np.sqrt(np.maximum(there.deviance - self.least, 0.0))
        # Along the profile the other variances are at their best, so they add nothing.
        slope = 2.0 * sd * there.gradient[each, place]
        return root - NORMAL, slope / np.maximum(2.0 * root, 1e-300)

    def ends(
        self, inside: FloatArray, outside: FloatArray, excess: FloatArray, place: IntArray
    ) -> FloatArray:
        """Sds between these at which the deviance is that of a 95 % interval's end.

        Newton's method from the straight line between the two; a step that leaves what is known to
        hold the end is replaced by half of that.

        Args:
            inside: where the deviance is least, (ends,).
            outside: where it is too large, (ends,).
            excess: by how much its root is, (ends,).
            place: of which component, (ends,).
        """
        inside, outside = inside.copy(), outside.copy()
        least = NORMAL
        at: FloatArray = inside + (outside - inside) * least / (least + excess)
        busy = np.arange(len(at))
        for _ in range(MAX_STEPS):
            if not len(busy):
                return at
            excess, slope = self.excess(at[busy], place[busy])
            too_far = excess > 0.0
            outside[busy[too_far]], inside[busy[~too_far]] = at[busy[too_far]], at[busy[~too_far]]
            with np.errstate(divide="ignore", invalid="ignore"):
                to = at[busy] - excess / slope
            ends = np.sort([inside[busy], outside[busy]], axis=0)
            between = (ends[0] < to) & (to < ends[1])
            to = np.where(between, to, ends.mean(axis=0))
            moved, at[busy] = np.abs(to - at[busy]), to
            busy = busy[moved > PROFILE_PRECISION * self.stack.spread[0]]
        raise NotSettledError


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
    """The same of each of many problems, None where the search did not come to rest.

    Those of one size are searched side by side.
    """
    sizes: dict[tuple[int, ...], list[int]] = {}
    for i, problem in enumerate(problems):
        sizes.setdefault(problem.design.size, []).append(i)
    fits: dict[int, Fit | None] = {}
    for (rows, _, others, effects), numbers in sizes.items():
        at_once = max(1, NUMBERS_AT_ONCE // (rows * (others + effects + 1)))
        for some in (numbers[i : i + at_once] for i in range(0, len(numbers), at_once)):
            stack = Stack.of([problems[i] for i in some])
            variances, settled = _most_likely(stack, free)
            white = Whitened(stack, variances)
            for place, (i, sd) in enumerate(zip(some, np.sqrt(variances).tolist(), strict=True)):
                at_rest = settled[place]
                fits[i] = Fit(problems[i], free, tuple(sd), white, place) if at_rest else None
    return [fits[i] for i in range(len(problems))]


def _most_likely(stack: Stack, free: tuple[str, ...]) -> tuple[FloatArray, BoolArray]:
    """Variances of boat, other and cell of each problem, (problems, 3); whether they settled."""
    loose = np.tile(np.isin(COMPONENTS, free), (len(stack.unit), 1))
    # What the errors leave of the spread, in equal parts.
    known = stack.variance.mean(axis=1, where=np.isfinite(stack.variance))
    left = stack.spread**2 - known
    start = loose * (np.maximum(left, 0.1 * stack.unit) / max(len(free), 1))[:, None]
    variances, there, settled = search(stack, loose, start)
    least = there.deviance
    for place in np.flatnonzero(loose[0]):
        without = variances.copy()
        without[:, place] = 0.0
        idle = stack.likelihood(without).deviance <= least + NO_GAIN
        idle &= variances[:, place] > 0.0
        loose[idle, place] = False
        if idle.any():
            variances[idle], there, still = search(stack.take(idle), loose[idle], without[idle])
            settled[idle] &= still
            least[idle] = there.deviance
    return variances, settled
