"""What the tows of one day share: a load cell zeroed that morning, waves, water.

Tows of a day are of different boats, so the joint density, which goes boat by boat, does not know
of it; between two tows of a boat it is part of how tows scatter. It does not average out over the
tows of a season as their own scatter does, so a season's load cell is less known by as much.
"""

import numpy as np

from pipeline.arrays import FloatArray, IntArray
from pipeline.season_log.likelihood import LEVEL, Told


def day_variance(told: list[Told], covariance: FloatArray, day: IntArray) -> float:
    """Variance of ln Cw that tows of one day share, by products of different tows (MINQUE).

    C. R. Rao (1971), Estimation of variance and covariance components, J. Multivariate Analysis 1.

    Args:
        told: the density of the boats at the mode.
        covariance: (unknowns, unknowns) there.
        day: (tows,) index of each tow's day.
    """
    if len(np.unique(day)) == len(day):
        return 0.0
    unknowns = len(covariance)
    pull, precision = np.zeros(len(day)), np.zeros(len(day))
    by_unknowns = np.zeros((len(day), unknowns))
    for t in told:
        tow, level = t.patterns.tow, np.s_[:, LEVEL::3]
        pull[tow] = t.mean_pull[level]
        precision[tow] = np.einsum("bkk->bk", t.mean_precision)[level]
        by_unknowns[tow] = (t.mean_precision @ t.slope)[level]
    # The residuals of tows are related already, as all share the unknowns.
    expected = _between(by_unknowns @ np.linalg.cholesky(covariance), day)
    products = _between(pull[:, None], day) + expected
    return max(products / _between(precision[:, None], day), 0.0)


def _between(values: FloatArray, day: IntArray) -> float:
    """Sum of the products of all pairs of different tows of a day; values (tows, columns)."""
    total = np.zeros((int(day.max(initial=-1)) + 1, values.shape[1]))
    np.add.at(total, day, values)
    return float((total**2).sum() - (values**2).sum())


def share_of_season(season: IntArray, day: IntArray) -> FloatArray:
    """Part of a day's variance that the mean of a season has, (seasons,)."""
    of_day = np.bincount(day)
    tows = np.bincount(season)
    return np.asarray(np.bincount(season, of_day[day].astype(np.float64)) / tows**2)
