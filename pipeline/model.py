"""One linear Gaussian mixed model: what boats, seasons and tows say of unknowns and variances.

    y = A u + e

The numbers e of different boats are independent; those of one have any covariance, which may depend
on which of a few patterns the boat follows (a normal mixture). The unknowns u are fixed (a flat
prior) or random (a normal one). So no matrix is larger than a boat's numbers or than the unknowns,
however many tows there are (Woodbury). Where the boat's effect is the only covariance, as in
`consistency.mixed`, sums over a boat are enough.

Belongs here: the likelihood of boats, the posterior of the unknowns, the maximum of a restricted
likelihood over its variances, scores of candidates. Does not: what the numbers, unknowns and
variances mean (`consistency.mixed`, `season_log.fit`).

Sources: Patterson & Thompson 1971 (REML); Gilmour, Thompson & Cullis 1995 (average information);
Louis 1982 (information of mixtures).
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple, Self

import numpy as np

from pipeline.arrays import BoolArray, FloatArray, IntArray

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


@dataclass(frozen=True)
class Boats:
    """What boats with n numbers each say at given unknowns and variances; b boats, k unknowns.

    Attributes:
        rows: (b, n) places of their numbers.
        design: (b, n, k) slope of the numbers by the unknowns.
        pull: (b, patterns, n) precision of the numbers times their residual.
        weight: (b, patterns) posterior of each pattern.
        widest: (b, n, n) precision of the numbers of a boat to which no pattern adds anything.
        less: (b, patterns, n, d) what a pattern takes off: its precision is `widest` - less less'.
    """

    rows: IntArray
    design: FloatArray
    pull: FloatArray
    weight: FloatArray
    widest: FloatArray
    less: FloatArray

    @classmethod
    def of(
        cls,
        rows: IntArray,
        design: FloatArray,
        residual: FloatArray,
        covariance: FloatArray,
        added: FloatArray,
        ln_prior: FloatArray,
    ) -> Self:
        """What boats say, each of which follows one of a few patterns.

        Args:
            rows, design: as the attributes.
            residual: (b, patterns, n) of the numbers under each pattern.
            covariance: (b, n, n) of the numbers, without what patterns and unknowns add.
            added: (b, patterns, n, d) what a pattern adds to that: added added'.
            ln_prior: (b, patterns) of each pattern.
        """
        widest: FloatArray = np.linalg.inv(covariance).astype(np.float64)
        ln_determinant = np.linalg.slogdet(covariance)[1][:, None]
        less = widest[:, None] @ added
        for place in range(added.shape[3]):  # one rank after the other (Sherman & Morrison)
            direction, product = added[..., place], less[..., place]
            for before in range(place):
                earlier = less[..., before]
                product = product - earlier * (earlier * direction).sum(axis=2, keepdims=True)
            gain = 1.0 + (direction * product).sum(axis=2)
            less[..., place] = product / np.sqrt(gain)[..., None]
            ln_determinant = ln_determinant + np.log(gain)
        pull = residual @ widest
        pull -= (less @ (np.swapaxes(less, 2, 3) @ residual[..., None]))[..., 0]
        ln_density = -0.5 * ((pull * residual).sum(axis=2) + ln_determinant)
        return cls(rows, design, pull, shares(ln_density + ln_prior), widest, less)

    @cached_property
    def precision(self) -> FloatArray:
        """Precision of the numbers, averaged over patterns, (b, n, n)."""
        count, size = self.rows.shape
        less = np.swapaxes(self.less, 1, 2).reshape(count, size, -1)
        weight = np.repeat(self.weight, self.less.shape[3], axis=1)
        return np.asarray(self.widest - (weight[:, None] * less) @ np.swapaxes(less, 1, 2))

    @property
    def precision_of_patterns(self) -> FloatArray:
        """Precision of the numbers under each pattern, (b, patterns, n, n)."""
        return np.asarray(self.widest[:, None] - self.less @ np.swapaxes(self.less, 2, 3))

    @cached_property
    def mean_pull(self) -> FloatArray:
        """Pull, averaged over patterns, (b, n)."""
        return np.asarray((self.weight[..., None] * self.pull).sum(axis=1))

    @cached_property
    def weighed(self) -> FloatArray:
        """Precision of the numbers times the design, (b, n, k)."""
        return np.asarray(self.precision @ self.design)

    @cached_property
    def observed_precision(self) -> FloatArray:
        """Precision, less what the pattern being unknown takes off (Louis 1982), (b, n, n)."""
        if self.weight.shape[1] == 1:
            return self.precision
        off = self.pull - self.mean_pull[:, None]
        return self.precision - np.swapaxes(self.weight[..., None] * off, 1, 2) @ off

    @cached_property
    def observed(self) -> FloatArray:
        """Observed precision of the numbers times the design, (b, n, k)."""
        return np.asarray(self.observed_precision @ self.design)

    @property
    def information(self) -> FloatArray:
        """Observed information on the unknowns, per boat, (b, k, k)."""
        return np.asarray(np.swapaxes(self.design, 1, 2) @ self.observed)

    def total(self, weighed: FloatArray) -> FloatArray:
        """Information on the unknowns of all boats by a precision times the design, (k, k)."""
        return np.tensordot(self.design, weighed, axes=([0, 1], [0, 1]))

    @property
    def score(self) -> FloatArray:
        """Slope of the ln density by the unknowns, per boat, (b, k)."""
        return np.asarray((np.swapaxes(self.design, 1, 2) @ self.mean_pull[..., None])[..., 0])

    def by_variances(
        self, parts: FloatArray, covariance: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Slope of the restricted ln likelihood by ln variances, (v,), and information, (v, v).

        Args:
            parts: what each variance adds to the covariance of the numbers, (v, b, n, n).
            covariance: of the unknowns, (k, k).
        """
        squares = np.swapaxes(self.weight[..., None] * self.pull, 1, 2) @ self.pull
        known = self.weighed @ covariance @ np.swapaxes(self.weighed, 1, 2)
        excess = squares - self.precision + known
        along = self.precision @ parts
        turned = np.swapaxes(along, 2, 3).reshape(len(parts), -1)
        slope = np.tensordot(parts, excess, axes=3)
        return 0.5 * slope, 0.5 * along.reshape(len(parts), -1) @ turned.T

    def moved_by(self, parts: FloatArray) -> FloatArray:
        """Covariance of the scores that each of these parts is the cause of, (v, k, k)."""
        return np.asarray((np.swapaxes(self.weighed, 1, 2) @ parts @ self.weighed).sum(axis=1))


def shares(ln_weight: FloatArray) -> FloatArray:
    """Weights along the last axis, with a sum of 1, from their logarithms."""
    weight = np.exp(ln_weight - ln_weight.max(axis=-1, keepdims=True))
    return np.asarray(weight / weight.sum(axis=-1, keepdims=True))


class Scores(NamedTuple):
    """What candidates, each by itself, would add to a fitted model; c candidates.

    Attributes:
        across: (k, c) information of each with the unknowns of the model.
        itself: (c,) of each with itself, were those unknowns known.
        pull: (c,) slope of the ln density by each.
    """

    across: FloatArray
    itself: FloatArray
    pull: FloatArray

    @classmethod
    def of(cls, boats: Iterable[Boats], design: FloatArray) -> Self:
        """The scores of candidates in one problem.

        Args:
            design: slope of every number by each, (all numbers, c).
        """
        size = design.shape[1]
        parts = []
        for some in boats:
            by = design[some.rows]
            weighed = some.observed_precision @ by
            across = np.tensordot(some.design, weighed, axes=([0, 1], [0, 1]))
            pull = np.tensordot(some.mean_pull, by, axes=([0, 1], [0, 1]))
            parts.append((across, (by * weighed).sum(axis=(0, 1)), pull))
        k, at = len(parts[0][0]), zip(*parts, strict=True)
        across, itself, pull = (np.sum(part, axis=0) for part in at)
        return cls(across.reshape(k, size), itself, pull)

    def odds(
        self, covariance: FloatArray, prior: FloatArray, chance: FloatArray
    ) -> tuple[FloatArray, BoolArray]:
        """Ln odds of each candidate that is normal about 0, were it added by itself, (c,).

        Args:
            covariance: of the unknowns, (k, k).
            prior, chance: its variance, and the probability that there is one, (c,).

        Returns:
            The odds, and whether one of the size of its prior would be likelier than not.
        """
        of_unknowns = (self.across * (covariance @ self.across)).sum(axis=0)
        known = prior * np.maximum(self.itself - of_unknowns, 0.0)
        ln_prior = np.log(chance / (1.0 - chance)) - 0.5 * np.log1p(known)
        ln_odds = 0.5 * self.pull**2 * prior / (1.0 + known) + ln_prior
        return ln_odds, 0.5 * known**2 / (1.0 + known) + ln_prior > 0.0


class Likelihood(NamedTuple):
    """A restricted likelihood at some variances, v of them.

    Attributes:
        deviance: -2 ln of it but for a constant.
        gradient: (v,) slope of the deviance by each variance.
        information: (v, v) average of observed and expected second derivative of the deviance.
    """

    deviance: float
    gradient: FloatArray
    information: FloatArray


def most_likely(
    likelihood: Callable[[FloatArray], Likelihood],
    free: BoolArray,
    start: FloatArray,
    unit: float,
) -> tuple[FloatArray, float]:
    """Least deviance over some of its variances, the others fixed.

    Newton's method with the average information, on variances that are not negative: one that is 0
    and would fall stays 0. A step is halved until the deviance does not rise. The slope, not the
    deviance, says when it is done: the least of a smooth function is flat over the root of its
    rounding, its slope crosses 0 there.

    Args:
        likelihood: at given variances, (v,).
        free: (v,) which variances are searched.
        start: (v,) where to begin; those that are not free stay so.
        unit: size of a variance.

    Returns:
        The variances, (v,), and the deviance there; that is infinite where the search did not come
        to rest.
    """
    at, now = start, likelihood(start)
    for _ in range(MAX_ITERATIONS):
        loose = free & ((at > 0.0) | (now.gradient < 0.0))
        if not loose.any():
            return at, now.deviance
        step = _newton(now, loose, unit)
        highest = now.deviance + ROUNDING * max(1.0, abs(now.deviance))
        for _ in range(MAX_HALVINGS):
            there = np.maximum(at + step, 0.0)
            now = likelihood(there)
            if now.deviance <= highest:
                break
            step = 0.5 * step
        else:
            break
        moved, at = np.abs(there - at), there
        if (moved <= TOLERANCE * np.maximum(at, NEGLIGIBLE * unit)).all():
            return at, now.deviance
    return at, np.inf


def _newton(now: Likelihood, loose: BoolArray, unit: float) -> FloatArray:
    """Step of the loose variances, (v,); one that the data do not feel goes nowhere."""
    size = np.diagonal(now.information)
    felt = loose & (size > UNFELT / unit**2)
    size = np.sqrt(np.where(felt, size, 1.0))
    scaled = np.where(felt[:, None] & felt, now.information / np.outer(size, size), 0.0)
    slope = np.where(felt, now.gradient, 0.0) / size
    step = np.linalg.pinv(scaled, rcond=UNFELT, hermitian=True) @ slope
    return np.where(felt, -step / size, 0.0)
