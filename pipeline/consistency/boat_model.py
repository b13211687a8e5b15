"""A linear model of boats of one type: explained part, boat, and known measuring error.

    y = X beta + boat + error,    boat ~ N(0, sd^2),    error ~ N(0, covariance)

`y` is a number of each tow (ln Cw, for example), `X` what may explain it, `boat` what makes a boat
differ from its like and is shared by all its tows. The covariance of the errors is known
(`pipeline.consistency.noise`): tows of one season share a part. This is the random-effects model of
meta-analysis (Higgins & Thompson 2002); the spread between boats is estimated after Paule & Mandel
(1982), its interval is the profile of a generalised Q (Viechtbauer 2007; Jackson 2013), and the
intervals of beta are those of Hartung & Knapp (2001), never narrower than the known errors (Roever,
Knapp & Friede 2015).

A type has tens of tows, so plain dense matrices do.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray

MAX_BOAT_SD: Final = 1.0
"""Upper end of the search for the spread between boats; y is a logarithm or a ratio."""

MIN_EIGENVALUE_RATIO: Final = 1e-12
"""Eigenvalues below this share of the largest one are 0 but for rounding."""


class Interval(NamedTuple):
    """A value with the two ends of its interval."""

    value: float
    lo: float
    hi: float


class LeftOut(NamedTuple):
    """What the other boats of the type predict for the tows of one boat; n tows.

    Attributes:
        rows: (n,) places of its tows.
        expected: (n,) their y as predicted.
        deviation_sd: (n,) y less expected, in standard deviations of that prediction.
        sd: (n,) that standard deviation.
        dof: degrees of freedom of those standard deviations.
    """

    rows: IntArray
    expected: FloatArray
    deviation_sd: FloatArray
    sd: FloatArray
    dof: int


@dataclass(frozen=True)
class BoatModel:
    """The model of one quantity of one type; n tows, p columns.

    Attributes:
        y: (n,) the quantity.
        covariance: (n, n) covariance of the measuring errors, positive definite.
        x: (n, p) explaining columns, of full column rank.
        boat: (n,) number of the boat of each tow.
        error_dof: degrees of freedom of the noise that `covariance` was scaled by; infinite where
            it is known.
        aimed_sd: spread between boats that matters: contrasts in which it would not show have
            little weight.
    """

    y: FloatArray
    covariance: FloatArray
    x: FloatArray
    boat: IntArray
    error_dof: float = np.inf
    aimed_sd: float = np.inf

    @property
    def dof(self) -> int:
        """Boats beyond the columns: tows of one boat do not count twice."""
        return len(np.unique(self.boat)) - int(self.x.shape[1])

    @property
    def _shares_boat(self) -> FloatArray:
        """1 where two tows are of one boat, else 0; (n, n)."""
        return np.asarray(self.boat[:, None] == self.boat, dtype=np.float64)

    @cached_property
    def _canonical(self) -> tuple[FloatArray, FloatArray]:
        """Independent contrasts between boats, with variances 1 + sd^2 eigenvalue; the eigenvalues.

        The tows are brought to independent errors of 1 and projected on what the columns leave
        free; there the covariance of the boats is brought to its axes. So the search for the
        spread between boats is one in plain sums. What only compares tows of one boat, such as its
        men's and its women's crew, has an eigenvalue of 0 and is left out.
        """
        whiten = np.linalg.inv(np.linalg.cholesky(self.covariance))
        free = scipy.linalg.null_space((whiten @ self.x).T)
        shares_boat = whiten @ self._shares_boat @ whiten.T
        eigenvalues, axes = np.linalg.eigh(free.T @ shares_boat @ free)
        rounding = MIN_EIGENVALUE_RATIO * eigenvalues.max(initial=1.0)
        is_between = eigenvalues > rounding
        contrasts = axes.T @ free.T @ whiten @ self.y
        return contrasts[is_between], eigenvalues[is_between]

    @property
    def _weights(self) -> FloatArray:
        """Share of each contrast's variance that comes from boats at a spread of `aimed_sd`."""
        eigenvalues = self._canonical[1]
        return 1.0 / (1.0 + 1.0 / (self.aimed_sd**2 * eigenvalues))

    def misfit(self, boat_sd: float) -> float:
        """Return the weighted sum of squares about the columns, if boats spread by `boat_sd`.

        A generalised Q of the contrasts between boats. At the true spread it is a sum of squares of
        standard normal numbers with these weights, and it falls as the spread rises.
        """
        contrasts, eigenvalues = self._canonical
        return float((self._weights * contrasts**2 / (1.0 + boat_sd**2 * eigenvalues)).sum())

    def _find_sd(self, squares: FloatArray, misfit: float) -> float:
        """Return the spread at which squared contrasts give a misfit: 0 if it is less without."""
        eigenvalues = self._canonical[1]
        weighted = self._weights * squares

        def excess(boat_sd: float) -> float:
            return float((weighted / (1.0 + boat_sd**2 * eigenvalues)).sum()) - misfit

        if excess(0.0) <= 0.0:
            return 0.0
        if excess(MAX_BOAT_SD) >= 0.0:
            return np.inf
        return float(scipy.optimize.brentq(excess, 0.0, MAX_BOAT_SD))

    @cached_property
    def boat_sd(self) -> float:
        """Estimated true spread between boats: the misfit is then what is expected of it."""
        return min(self._find_sd(self._canonical[0] ** 2, self._weights.sum()), MAX_BOAT_SD)

    def _misfit_quantile(self, chance: float) -> float:
        """Return the quantile of the misfit at the true spread.

        A weighted sum of chi-squared numbers is nearly a multiple of one (Satterthwaite 1946).
        """
        weights = self._weights
        dof = weights.sum() ** 2 / (weights**2).sum()
        if np.isfinite(self.error_dof):
            return float(weights.sum() * scipy.special.fdtri(dof, self.error_dof, chance))
        return float(weights.sum() / dof * scipy.special.chdtri(dof, 1.0 - chance))

    def lower_bound(self, chance: float = 0.05) -> float:
        """Return the upper limit of the true spread between boats at a probability."""
        return self._find_sd(self._canonical[0] ** 2, self._misfit_quantile(1.0 - chance))

    def upper_bound(self, chance: float = 0.05) -> float:
        """Return the lower limit of the true spread between boats at a probability.

        It is at least the bound that truly equal boats give with their usual misfit: boats that
        agree by chance, or errors that are overstated, prove no more than these tows can tell
        (power-constrained limit, Cowan et al. 2011).
        """
        misfit = self._misfit_quantile(chance)
        squares = self._canonical[0] ** 2
        usual = np.ones_like(squares)
        return max(self._find_sd(squares, misfit), self._find_sd(usual, misfit))

    @cached_property
    def _covariance_of_beta(self) -> tuple[FloatArray, FloatArray]:
        """Precision of the tows (n, n), and covariance of beta (p, p) at a scale of 1."""
        precision = np.linalg.inv(self.covariance + self.boat_sd**2 * self._shares_boat)
        covariance = np.linalg.inv(self.x.T @ precision @ self.x)
        return np.asarray(precision), np.asarray(covariance, dtype=np.float64)

    @cached_property
    def beta(self) -> FloatArray:
        """Coefficients of the columns by generalised least squares, (p,)."""
        precision, covariance = self._covariance_of_beta
        return covariance @ (self.x.T @ precision @ self.y)

    @property
    def _scale(self) -> float:
        """Misfit per degree of freedom, at least 1: the errors that are known are there."""
        return max(self.misfit(self.boat_sd) / float(self._weights.sum()), 1.0)

    def predict(self, x: FloatArray, chance: float = 0.05) -> list[Interval]:
        """Return X beta at rows of x with the interval that a chance leaves out.

        Args:
            x: (k, p) rows; a unit row gives a coefficient.
            chance: 0.05 for a 95 % interval.
        """
        covariance = self._covariance_of_beta[1]
        sd = np.sqrt(self._scale * ((x @ covariance) * x).sum(axis=1))
        half = float(scipy.special.stdtrit(max(self.dof, 1), 1.0 - 0.5 * chance)) * sd
        mean = x @ self.beta
        ends = np.stack([mean, mean - half, mean + half], axis=1)
        return [Interval(value, lo, hi) for value, lo, hi in ends.tolist()]

    def leave_boats_out(self) -> Iterator[LeftOut]:
        """Compare the tows of each boat with a model that is fitted to all other boats.

        What a season's tows share is in the prediction. A boat that alone determines a column, such
        as the only women's crew, is left out.
        """
        for boat in np.unique(self.boat):
            is_other = self.boat != boat
            others = self._take(is_other)
            if others.dof < 1 or np.linalg.matrix_rank(others.x) < self.x.shape[1]:
                continue
            rows = np.flatnonzero(~is_other)
            precision, covariance_of_beta = others._covariance_of_beta
            shared = self.covariance[np.ix_(rows, np.flatnonzero(is_other))]
            by_others = shared @ precision
            free_x = self.x[rows] - by_others @ others.x
            expected = self.x[rows] @ others.beta + by_others @ (others.y - others.x @ others.beta)
            own = np.diag(self.covariance)[rows] + others.boat_sd**2
            known = (by_others * shared).sum(axis=1)
            of_beta = ((free_x @ covariance_of_beta) * free_x).sum(axis=1)
            sd = np.sqrt(others._scale * (own - known + of_beta))
            yield LeftOut(rows, expected, (self.y[rows] - expected) / sd, sd, others.dof)

    def _take(self, rows: BoolArray) -> "BoatModel":
        """Return the model of some of the tows."""
        return BoatModel(
            y=self.y[rows],
            covariance=self.covariance[np.ix_(rows, rows)],
            x=self.x[rows],
            boat=self.boat[rows],
            error_dof=self.error_dof,
            aimed_sd=self.aimed_sd,
        )
