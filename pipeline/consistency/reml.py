"""Restricted likelihood of a linear mixed model with known measuring errors, and its maximum.

    y = X beta + boat + other + cell + error

Here the data, the likelihood with its slope, and the search for the variances of boat, other and
cell. What a fitted model says about anything is in `mixed`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from pipeline.arrays import BoolArray, FloatArray, IntArray

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

LARGE: Final = 1024
"""Rows from which on empty ones cost more than calls."""

UNFELT: Final = 1e-10
"""Information, in units of the spread, below which it is rounding: boats of one type have none of
what differs between types."""


class Likelihood(NamedTuple):
    """The restricted likelihood of each problem of a stack at some variances.

    Attributes:
        deviance: (m,) -2 log of it but for a constant.
        gradient: (m, 3) slope of the deviance along the variances of boat, other and cell.
        information: (m, 3, 3) average of observed and expected second derivative of the deviance.
    """

    deviance: FloatArray
    gradient: FloatArray
    information: FloatArray

    def put(self, rows: IntArray, there: "Likelihood", which: BoolArray) -> None:
        """Sets some rows to those of another."""
        for mine, other in zip(self, there, strict=True):
            mine[rows] = other[which]


@dataclass(frozen=True)
class Design:
    """What is known of the rows of a model before anything is measured; problems may share one.

    Attributes:
        x: (n, p) fixed effects, of full column rank.
        boat: (n,) which boat, 0 and up, without gaps.
        other: (n,) which other group, 0 and up; None without.
    """

    x: FloatArray
    boat: IntArray
    other: IntArray | None

    @classmethod
    def of(cls, x: ArrayLike, boat: ArrayLike, other: ArrayLike | None = None) -> Self:
        """A design from anything array-like; groups may be named by text or number."""
        number = np.unique(np.asarray(boat), return_inverse=True)[1]
        return cls(
            np.asarray(x, dtype=np.float64).reshape(len(number), -1),
            number,
            None if other is None else np.unique(np.asarray(other), return_inverse=True)[1],
        )

    @cached_property
    def boats(self) -> int:
        """Number of boats."""
        return int(self.boat.max()) + 1

    @cached_property
    def others(self) -> FloatArray:
        """Which other group each row is of, as columns of 0 and 1; (n, groups)."""
        n = len(self.boat)
        return (
            np.zeros((n, 0))
            if self.other is None
            else np.eye(int(self.other.max()) + 1)[self.other]
        )

    @cached_property
    def by_boat(self) -> IntArray:
        """The rows boat by boat."""
        return np.argsort(self.boat, kind="stable")

    @cached_property
    def solver(self) -> FloatArray:
        """Y times this are its fixed effects by plain least squares, (n, p)."""
        q, r = np.linalg.qr(self.x)
        return np.asarray(q @ np.linalg.inv(r).T)

    @cached_property
    def size(self) -> tuple[int, int, int, int]:
        """Rows and boats, each rounded up, other groups and fixed effects.

        Problems of one size can be searched together.
        """
        rows, boats = (_rounded_up(n) for n in (len(self.boat), self.boats))
        return rows, boats, self.others.shape[1], self.x.shape[1]


def _rounded_up(number: int) -> int:
    """The next power of two, and of large numbers the next multiple of `LARGE`."""
    return 1 << (number - 1).bit_length() if number < LARGE else -(-number // LARGE) * LARGE


@dataclass(frozen=True)
class Problem:
    """Data of a mixed model.

    Attributes:
        design: what is known of the rows before anything is measured.
        y: (n,) observations.
        variance: (n,) known variance of each observation.
    """

    design: Design
    y: FloatArray
    variance: FloatArray

    @classmethod
    def of(cls, design: Design, y: ArrayLike, variance: ArrayLike) -> Self:
        """A problem from anything array-like."""
        values = np.asarray(y, dtype=np.float64)
        floor = (SMALLEST_SHARE * (np.ptp(values) + abs(values.mean()))) ** 2
        known = np.asarray(variance, dtype=np.float64)
        return cls(design, values, np.maximum(known, max(floor, 1e-300)))

    @cached_property
    def plain(self) -> FloatArray:
        """Fixed effects by plain least squares, (p,)."""
        return self.y @ self.design.solver

    @cached_property
    def residual(self) -> FloatArray:
        """Y less the plain least-squares fit: the likelihood sees nothing else of y."""
        return self.y - self.design.x @ self.plain

    @property
    def rows_beyond(self) -> int:
        """Rows beyond the number of fixed effects."""
        return len(self.y) - int(self.design.x.shape[1])

    @cached_property
    def spread(self) -> float:
        """Standard deviation of y about the plain least-squares fit, the scale of a search."""
        return float(np.sqrt((self.residual**2).sum() / max(self.rows_beyond, 1)))


@dataclass(frozen=True)
class Stack:
    """Problems of one size side by side: small matrices cost their calls, not their numbers.

    The rows of each problem go boat by boat. Below them come empty rows without any weight, as many
    as the size asks for; they count for the last boat.

    Attributes:
        columns: (m, n, k + p + 1) others, fixed effects and what y is beyond the plain fit.
        variance: (m, n) known variance of each observation; infinite in empty rows.
        boat: (m, n) which boat.
        size: rows, boats, other groups and fixed effects.
        spread: (m,) standard deviation about the plain fit.
        unit: (m,) size of a variance.
    """

    columns: FloatArray
    variance: FloatArray
    boat: IntArray
    size: tuple[int, int, int, int]
    spread: FloatArray
    unit: FloatArray

    @classmethod
    def of(cls, problems: Sequence[Problem]) -> Self:
        """A stack of problems of one size."""
        size = problems[0].design.size
        n, _, k, p = size
        columns = np.zeros((len(problems), n, k + p + 1))
        variance = np.full(columns.shape[:2], np.inf)
        boat = np.empty(columns.shape[:2], np.int64)
        for i, one in enumerate(problems):
            design, rows = one.design, len(one.y)
            order = design.by_boat
            columns[i, :rows, :k], columns[i, :rows, k:-1] = design.others[order], design.x[order]
            columns[i, :rows, -1] = one.residual[order]
            variance[i, :rows] = one.variance[order]
            boat[i, :rows], boat[i, rows:] = design.boat[order], design.boats - 1
        spread = np.array([p.spread for p in problems])
        unit = np.maximum(spread**2, variance.min(axis=1))
        return cls(columns, variance, boat, size, spread, unit)

    def take(self, rows: IntArray | BoolArray) -> Self:
        """Some of the problems, by their places or by a mask."""
        every = np.arange(len(self.unit))
        if np.array_equal(every[rows], every):
            return self
        names = ("columns", "variance", "boat", "spread", "unit")
        return replace(self, **{name: getattr(self, name)[rows] for name in names})

    @property
    def others(self) -> FloatArray:
        """Which other group each row is of, as columns of 0 and 1; (m, n, k)."""
        return self.columns[..., : self.size[2]]

    @cached_property
    def _place(self) -> IntArray:
        """The boat of each row among those of all problems, (m, n)."""
        return self.boat + self.size[1] * np.arange(len(self.boat))[:, None]

    @cached_property
    def _begins(self) -> IntArray:
        """Where each boat that has rows begins among the rows of all problems."""
        return np.flatnonzero(np.diff(self._place.ravel(), prepend=-1))

    def by_boat(self, rows: FloatArray) -> FloatArray:
        """Adds up the rows of each boat: (m, n, c) to (m, boats, c)."""
        (m, n, c), boats = rows.shape, self.size[1]
        added = np.add.reduceat(rows.reshape(m * n, c), self._begins)
        total = np.zeros((m * boats, c))
        total[self._place.ravel()[self._begins]] = added
        return total.reshape(m, boats, c)

    def of_rows(self, boats: FloatArray) -> FloatArray:
        """What a boat has, for each of its rows: (m, boats, ...) to (m, n, ...)."""
        m, each, *rest = boats.shape
        return np.asarray(boats.reshape(m * each, *rest)[self._place])

    def likelihood(self, variances: FloatArray) -> Likelihood:
        """The restricted likelihood at variances of boat, other and cell, none of them negative.

        Slope and average information are those of Gilmour, Thompson and Cullis (1995), tr(P V_k) -
        y'P V_k P y and y'P V_k P V_l P y: V_k is the part of one variance in the covariance V, P
        its inverse without the fixed effects.

        Args:
            variances: of boat, other and cell, (m, 3).
        """
        at = Whitened(self, variances)
        own, of_boats = at.weigh(np.concatenate([at.q, at.rest], axis=-1))
        p_y, boats_p_y = own[..., -1:], of_boats[..., -1:]
        others_p_y, trace_of_others = at.felt_by_others()
        precision, inflation = self.of_rows(at.precision), self.of_rows(at.inflation)
        alone = at.weight * (1.0 + at.boat[:, None] * (precision - at.weight))
        traces = [
            (at.precision / at.inflation).sum(axis=-1) - _squares(of_boats[..., :-1]),
            trace_of_others,
            (alone / inflation).sum(axis=-1) - _squares(own[..., :-1]),
        ]
        squares = [_squares(part) for part in (boats_p_y, others_p_y, p_y)]
        parts = [self.of_rows(boats_p_y), self.others @ others_p_y, p_y]
        felt = at.without_boats(at.root * np.concatenate(parts, axis=-1))
        along = at.q.mT @ felt
        weight = np.where(at.weight > 0.0, at.weight, 1.0)
        determinant = np.log(at.inflation).sum(axis=-1) - np.log(weight).sum(axis=-1)
        diagonal = np.diagonal(at.r, axis1=-2, axis2=-1)
        determinant += 2.0 * np.log(np.abs(diagonal)).sum(axis=-1)
        return Likelihood(
            determinant + at.misfit,
            np.stack(traces, axis=-1) - np.stack(squares, axis=-1),
            felt.mT @ felt - along.mT @ along,
        )


def _squares(rows: FloatArray) -> FloatArray:
    """Sum of the squares of each matrix of a stack."""
    return np.asarray((rows**2).sum(axis=(-2, -1)))


class Whitened:
    """A stack at some variances: rows of unit covariance, known columns taken out.

    Rows are whitened for error, cell and boat. Others (as further data: Woodbury) and fixed effects
    are then taken out by one orthogonal decomposition: no large numbers cancel, however small the
    errors are, and all is linear in the rows. All matrices are narrow: a product of two that have
    as many columns as rows comes out otherwise on another number of threads.

    Attributes:
        stack: the problems.
        variances: those of boat, other and cell, (m, 3); boat, other: each, (m,).
        weight: (m, n) 1 / variance of error and cell; root: (m, n, 1) its root.
        precision: (m, boats) sum of the weights; inflation: 1 + boat's variance times that.
        others: (m, n, k) the other groups, whitened.
        q: (m, n, k + p) orthogonal columns, with `of_others`, (m, k, k + p), below.
        r: (m, k + p, k + p) triangular.
        along: (m, k + p, 1) whitened y along the columns.
        rest: (m, n, 1) what is left of it.
    """

    def __init__(self, stack: Stack, variances: FloatArray) -> None:
        self.stack, self.variances = stack, variances
        self.boat, self.other, cell = variances.T
        self.weight: FloatArray = 1.0 / (stack.variance + cell[:, None])
        self.root: FloatArray = np.sqrt(self.weight)[..., None]
        self.precision = stack.by_boat(self.weight[..., None])[..., 0]
        self.inflation: FloatArray = 1.0 + self.boat[:, None] * self.precision
        n, _, k, p = stack.size
        white = self.without_boats(self.root * stack.columns)
        self.others, y = white[..., :k], white[..., -1:]
        known = np.zeros((len(white), n + k, k + p))
        known[:, :n, :k] = self.others * np.sqrt(self.other)[:, None, None]
        known[:, :n, k:] = white[..., k:-1]
        known[:, n:, :k] = np.eye(k)
        q, self.r = np.linalg.qr(known)
        self.q, self.of_others = q[:, :n], q[:, n:]
        self.along = self.q.mT @ y
        self.rest = y - self.q @ self.along

    def of_one(self, place: int) -> Self:
        """One problem of the stack, as a stack of one."""
        return type(self)(self.stack.take(np.array([place])), self.variances[[place]])

    def felt_by_others(self) -> tuple[FloatArray, FloatArray]:
        """Y as it weighs on the other groups, (m, k, 1), and the trace of P times their part."""
        weighs = self.others.mT @ self.rest
        trace = _squares(self.others) - _squares(self.others.mT @ self.q)
        # Where they vary they are taken out with the columns, which loses no digits.
        taken = self.other > 0.0
        variance = self.other[taken]
        along = self.of_others[taken] @ self.along[taken]
        weighs[taken] = along / np.sqrt(variance)[:, None, None]
        trace[taken] = (self.of_others.shape[1] - _squares(self.of_others[taken])) / variance
        return weighs, trace

    def without_boats(self, rows: FloatArray) -> FloatArray:
        """What is left of rows, in units of their errors, in units of boats and errors."""
        return self._shrunk(rows, self.stack.by_boat(self.root * rows))

    def weigh(self, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Whitened rows as they weigh on the rows of the problem, and the sum of that by boat."""
        total = self.stack.by_boat(self.root * rows)
        of_boats = total / np.sqrt(self.inflation)[..., None]
        return self.root * self._shrunk(rows, total), of_boats

    def _shrunk(self, rows: FloatArray, total: FloatArray) -> FloatArray:
        """Rows with each boat's mean made smaller; `total` is the weighted sum by boat."""
        shrink = (1.0 / np.sqrt(self.inflation) - 1.0) / np.maximum(self.precision, 1e-300)
        return rows + self.root * self.stack.of_rows(shrink[..., None] * total)

    @cached_property
    def inverse(self) -> FloatArray:
        """Inverse of the triangular matrix of the fixed effects, (m, p, p)."""
        k = self.stack.size[2]
        return np.asarray(np.linalg.inv(self.r[:, k:, k:]))

    @cached_property
    def misfit(self) -> FloatArray:
        """Y' P Y: the weighted sum of squares about the fixed effects, (m,)."""
        return _squares(self.rest) + _squares(self.of_others @ self.along)


def search(
    stack: Stack, free: BoolArray, start: FloatArray, tolerance: float = TOLERANCE
) -> tuple[FloatArray, Likelihood, BoolArray]:
    """Least deviance of each problem over some of the variances, the others fixed.

    Newton's method with the average information, on variances that are not negative: one that is 0
    and would fall is left at exactly 0. The slope, not the deviance, says when it is done: the
    least of a smooth function is flat over the root of its rounding, its slope crosses 0 there.

    Args:
        stack: the problems.
        free: (m, 3) which of the variances of boat, other and cell are free.
        start: (m, 3) variances to begin with; those that are not free stay so.
        tolerance: share of its size by which a step at the end may change a variance.

    Returns:
        The variances, (m, 3), the likelihood there, and whether each search came to rest, (m,).
    """
    at, now = start.copy(), stack.likelihood(start)
    busy, settled = np.arange(len(at)), np.ones(len(at), bool)
    for _ in range(MAX_ITERATIONS):
        loose = free & ((at > 0.0) | (now.gradient < 0.0))
        busy = busy[loose[busy].any(axis=1)]
        if not len(busy):
            break
        last = at[busy]
        step = _newton(now.gradient[busy], now.information[busy], loose[busy], stack.unit[busy])
        settled[_descend(stack, busy, step, at, now)] = False
        size = np.maximum(at[busy], NEGLIGIBLE * stack.unit[busy, None])
        busy = busy[(np.abs(at[busy] - last) > tolerance * size).any(axis=1)]
    settled[busy] = False
    return at, now, settled


def _newton(
    gradient: FloatArray, information: FloatArray, loose: BoolArray, unit: FloatArray
) -> FloatArray:
    """Steps of the loose variances, (m, 3); one that the data do not feel goes nowhere."""
    size = np.diagonal(information, axis1=-2, axis2=-1)
    felt = loose & (size > UNFELT / unit[:, None] ** 2)
    size = np.sqrt(np.where(felt, size, 1.0))
    both = felt[:, :, None] & felt[:, None, :]
    scaled = np.where(both, information / (size[:, :, None] * size[:, None, :]), 0.0)
    slope = np.where(felt, gradient, 0.0) / size
    value, vector = np.linalg.eigh(scaled)
    told = np.abs(value) > UNFELT * np.abs(value).max(axis=-1, keepdims=True)
    along = (vector.mT @ slope[..., None])[..., 0] * told / np.where(told, value, 1.0)
    step = -(vector @ along[..., None])[..., 0] / size
    return np.where(felt, step, 0.0)  # rounding lets the others move a little


def _descend(
    stack: Stack, rows: IntArray, step: FloatArray, at: FloatArray, now: Likelihood
) -> IntArray:
    """Steps some rows of `at`, cut off at 0; each is halved until the deviance does not rise.

    A rise by no more than rounding counts as none.

    Returns:
        The rows that stay where they were, as it rises however short the step is.
    """
    limit = now.deviance[rows] + ROUNDING * np.maximum(1.0, np.abs(now.deviance[rows]))
    for _ in range(MAX_HALVINGS):
        trial = np.maximum(at[rows] + step, 0.0)
        there = stack.take(rows).likelihood(trial)
        lower = there.deviance <= limit
        at[rows[lower]] = trial[lower]
        now.put(rows[lower], there, lower)
        rows, step, limit = rows[~lower], 0.5 * step[~lower], limit[~lower]
        if not len(rows):
            break
    return rows
