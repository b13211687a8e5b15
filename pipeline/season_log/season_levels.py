"""The common level of a season against what its boats show in other seasons.

Mass on board, depth of the water, waves or a load cell that is not linear move all tows of a season
alike, and no instrument of the model does. A level g is added to the fit as one more effect of that
season, with a prior as wide as that of a boat's level. One step from the fit gives it: with score
s, information i given all other effects, and prior variance w,

    g = s / (i + 1/w),    variance 1 / (i + 1/w)

(score test: Rao 1948). A scale fault of the load cell in that season is the same column: it is kept
at its size, so that g is what its correction leaves. Without GPS only the bend of the curves tells
the level of a season from its log, so that its variance is large.
"""

from dataclasses import dataclass

import numpy as np

from pipeline.arrays import BoolArray, FloatArray
from pipeline.season_log.archive import LEVEL
from pipeline.season_log.fit import Fit
from pipeline.season_log.observation_model import FORCE


@dataclass(frozen=True)
class SeasonLevel:
    """What the tows of a season have in common, against the other tows of their boats.

    Attributes:
        ln_ratio: change of ln Cw, with instruments corrected for what was found of them.
        sd: its standard deviation.
    """

    ln_ratio: float
    sd: float


def compare_season_levels(fit: Fit) -> dict[int, SeasonLevel]:
    """Return the level of every season, by year."""
    archive = fit.model.archive
    prior_precision = fit.model.priors.level_sd**-2.0
    information_of_effects: FloatArray = np.linalg.inv(fit.covariance).astype(np.float64)
    season = np.array([fit.model.effects.listed[place].season for place in fit.active])
    is_scale_fault = fit.is_fault & (fit.name == FORCE)
    levels = {}
    for year in np.unique(archive.season).astype(int).tolist():
        others = np.flatnonzero(~(is_scale_fault & (season == year)))
        cross, own, score = _measure_level(fit, archive.season == year)
        covariance = np.linalg.inv(information_of_effects[np.ix_(others, others)])
        information = max(own - float(cross[others] @ covariance @ cross[others]), 0.0)
        precision = information + prior_precision
        levels[year] = SeasonLevel(ln_ratio=score / precision, sd=precision**-0.5)
    return levels


def _measure_level(fit: Fit, is_own: BoolArray) -> tuple[FloatArray, float, float]:
    """Return the information of a level with all effects, (k,), with itself, and its score.

    Args:
        is_own: (n,) tows that have the level.
    """
    numbers = np.zeros((len(is_own), 3))
    numbers[is_own, LEVEL] = 1.0
    column = numbers.ravel()
    cross = np.zeros(len(fit.value))
    own = score = 0.0
    for b in fit.boats:
        of_boat = column[b.group.numbers]  # (b, 3 T)
        weighted = (b.observed_precision @ of_boat[:, :, None])[:, :, 0]
        cross += np.tensordot(b.design, weighted, axes=([0, 1], [0, 1]))
        own += float((of_boat * weighted).sum())
        score += float((of_boat * b.mean_residual).sum())
    return cross, own, score
