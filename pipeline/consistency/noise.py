"""How far the tows of one boat differ by chance: what repeat tows say of the measuring errors.

The runs of a tow and its interval give a variance of its error. Whether that is all, only a boat
that is towed again can tell: a load cell whose zero moves from tow to tow, or a log that is not
quite proportional to speed, hits all runs of a tow alike. So the differences between consecutive
tows of unaltered boats are described as

    difference = season - season before + error - error before,
    season ~ N(0, season_sd^2),
    error_i ~ N(0, variance_ratio variance_i + (zero_sd_n effect_i)^2)

for every method and quantity. Where tows agree better than their variances say, `variance_ratio` is
below 1; the variances count as `PRIOR_DOF` observations that agree with them, so that a few pairs
do not overrule them. Where tows agree less well, each has an error of its own, with the effect
[1/N] of a zero error of the load cell: the smaller the force, the larger. Spreads are estimated
after Paule & Mandel (1982).
"""

from typing import Final, NamedTuple

import numpy as np
import polars as pl
import scipy

from pipeline.arrays import BoolArray, FloatArray

PRIOR_DOF: Final = 10
"""Degrees of freedom of the assumed errors: they may be a fifth too small or too large."""

OUTLYING_SD: Final = 3.0
"""A pair that differs more, such as one with a tow pulled askew, is no ordinary noise."""

MAX_ROUNDS: Final = 20
MAX_SPREAD: Final = 1.0
MAX_ZERO_SD_N: Final = 1000.0
"""Upper ends of the searches; the quantities are logarithms or ratios."""

MIN_SINGULAR_RATIO: Final = 1e-9
"""Contrasts below this share of the largest are 0 but for rounding."""


class Noise(NamedTuple):
    """The measuring errors of a quantity under a method.

    Attributes:
        variance_ratio: variance of a tow's error / what its runs and its interval say; at most 1.
        zero_sd_n: standard deviation of what is added to each tow, as a zero error of the load
            cell [N].
        season_sd: standard deviation of what all tows of a season share.
        dof: degrees of freedom of these.
        n_pairs: number of pairs of repeat tows that they rest on.
    """

    variance_ratio: float = 1.0
    zero_sd_n: float = 0.0
    season_sd: float = 0.0
    dof: float = PRIOR_DOF
    n_pairs: int = 0

    def covariance(
        self, variance: FloatArray, zero_effect: FloatArray, season: FloatArray
    ) -> FloatArray:
        """Return the covariance of the errors of tows, (n, n).

        Args:
            variance: (n,) as their runs and intervals say.
            zero_effect: (n,) of a zero error of the load cell [1/N].
            season: (n,) season of each tow.
        """
        shares_season = season[:, None] == season
        of_tow = np.diag(self.variance_ratio * variance + (self.zero_sd_n * zero_effect) ** 2)
        return np.asarray(of_tow + self.season_sd**2 * shares_season, dtype=np.float64)


class PairErrors(NamedTuple):
    """Differences between consecutive tows: k pairs of t tows in s seasons.

    Attributes:
        difference: (k,) the quantity of the tow less that of the tow before.
        variance: (t,) of each tow, as its runs and its interval say.
        zero_effect: (t,) of a zero error of the load cell on each tow [1/N].
        tows: (k, t) 1 at the tow, -1 at the tow before; pairs that share a tow are correlated.
        seasons: (k, s) 1 in the season of the tow, -1 in that before; 0 if both are one season.
    """

    difference: FloatArray
    variance: FloatArray
    zero_effect: FloatArray
    tows: FloatArray
    seasons: FloatArray

    def take(self, chosen: BoolArray) -> "PairErrors":
        """Return some of the pairs."""
        return PairErrors(
            difference=self.difference[chosen],
            variance=self.variance,
            zero_effect=self.zero_effect,
            tows=self.tows[chosen],
            seasons=self.seasons[chosen],
        )

    def covariance(self, variance_ratio: float, zero_sd_n: float) -> FloatArray:
        """Return the covariance of the differences without the seasons, (k, k)."""
        variance = variance_ratio * self.variance + (zero_sd_n * self.zero_effect) ** 2
        return np.asarray((self.tows * variance) @ self.tows.T, dtype=np.float64)


def stack_pairs(pairs: pl.DataFrame) -> PairErrors:
    """Return the differences of pairs.

    Args:
        pairs: `difference`, and of the tow and, with `_before`, of that before: `tow_id`, `season`,
            `variance`, `zero_effect`; a row per pair.
    """
    tows = np.unique(np.r_[pairs["tow_id"], pairs["tow_id_before"]])
    seasons = np.unique(np.r_[pairs["season"], pairs["season_before"]])
    rows = np.arange(pairs.height)
    new = np.searchsorted(tows, pairs["tow_id"].to_numpy())
    old = np.searchsorted(tows, pairs["tow_id_before"].to_numpy())
    variance, zero_effect = np.zeros(len(tows)), np.zeros(len(tows))
    for place, ending in ((new, ""), (old, "_before")):
        variance[place] = pairs[f"variance{ending}"].to_numpy()
        zero_effect[place] = pairs[f"zero_effect{ending}"].to_numpy()
    of_tows = np.zeros((pairs.height, len(tows)))
    of_tows[rows, new] = 1.0
    of_tows[rows, old] = -1.0
    of_seasons = np.zeros((pairs.height, len(seasons)))
    of_seasons[rows, np.searchsorted(seasons, pairs["season"].to_numpy())] += 1.0
    of_seasons[rows, np.searchsorted(seasons, pairs["season_before"].to_numpy())] -= 1.0
    return PairErrors(
        difference=pairs["difference"].to_numpy().astype(np.float64),
        variance=variance,
        zero_effect=zero_effect,
        tows=of_tows,
        seasons=of_seasons,
    )


def estimate_noise(pairs: pl.DataFrame) -> Noise:
    """Estimate the measuring errors from repeat tows.

    Pairs that differ by more than `OUTLYING_SD` are left out, until no other pair does.

    Args:
        pairs: rows as `stack_pairs` takes them, of one quantity under one method.
    """
    if pairs.is_empty():
        return Noise()
    every = stack_pairs(pairs)
    is_ordinary = np.ones(pairs.height, bool)
    for _ in range(MAX_ROUNDS):
        chosen = every.take(is_ordinary)
        ratio, zero_sd_n, dof = _estimate_tow_errors(chosen)
        covariance = chosen.covariance(ratio, zero_sd_n)
        whiten = np.linalg.inv(np.linalg.cholesky(covariance))
        axes, strength, right = decompose(whiten @ chosen.seasons)
        by_season = axes.T @ whiten @ chosen.difference
        seasons = right.T @ (by_season / strength)
        rest = every.difference - every.seasons @ seasons
        sd = np.sqrt(np.diag(every.covariance(ratio, zero_sd_n)))
        is_within = np.abs(rest) <= OUTLYING_SD * sd
        if (is_within == is_ordinary).all() or not is_within.any():
            break
        is_ordinary = is_within
    return Noise(
        variance_ratio=ratio,
        zero_sd_n=zero_sd_n,
        season_sd=find_spread(by_season, strength),
        dof=dof,
        n_pairs=int(is_ordinary.sum()),
    )


def _estimate_tow_errors(pairs: PairErrors) -> tuple[float, float, float]:
    """Return `variance_ratio`, `zero_sd_n` and their degrees of freedom.

    Whatever the seasons are, they are taken out: only what they leave free is looked at.
    """
    whiten = np.linalg.inv(np.linalg.cholesky(pairs.covariance(1.0, 0.0)))
    axes, _, _ = decompose(whiten @ pairs.seasons)
    free = scipy.linalg.null_space(axes.T) if axes.shape[1] else np.eye(len(whiten))
    axes, strength, _ = decompose(free.T @ whiten @ (pairs.tows * pairs.zero_effect))
    contrasts = axes.T @ free.T @ whiten @ pairs.difference
    squares = float(contrasts @ contrasts)
    if squares <= len(contrasts):
        dof = PRIOR_DOF + len(contrasts)
        return (PRIOR_DOF + squares) / dof, 0.0, dof
    return 1.0, find_spread(contrasts, strength, MAX_ZERO_SD_N), max(len(contrasts), PRIOR_DOF)


def decompose(columns: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the singular value decomposition without what is 0 but for rounding."""
    axes, strength, right = np.linalg.svd(columns, full_matrices=False)
    is_contrast = strength > MIN_SINGULAR_RATIO * strength.max(initial=1.0)
    return axes[:, is_contrast], strength[is_contrast], right[is_contrast]


def find_spread(contrasts: FloatArray, strength: FloatArray, highest: float = MAX_SPREAD) -> float:
    """Return the spread of a random effect at which its contrasts are as large as expected.

    Args:
        contrasts: (r,) independent, with variances 1 + spread^2 strength^2.
        strength: (r,) how much of the effect is in each.
        highest: upper end of the search.
    """

    def excess(spread: float) -> float:
        return float((contrasts**2 / (1.0 + (spread * strength) ** 2)).sum()) - len(contrasts)

    if not len(contrasts) or excess(0.0) <= 0.0:
        return 0.0
    if excess(highest) >= 0.0:
        return highest
    return float(scipy.optimize.brentq(excess, 0.0, highest))
