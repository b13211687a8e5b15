"""A guard on season factors that needs no model: what a factor must not contradict.

Whatever the joint estimate believes, no log was off by more than 10 %, and boats that were not
altered come out alike beside dGPS. Belongs here: which factors are refused. Does not: why.
"""

import math
from typing import Final

import numpy as np

from pipeline.arrays import BoolArray, FloatArray
from pipeline.quantiles import MAD_TO_SD
from pipeline.season_log.likelihood import LEVEL
from pipeline.season_log.posterior import Posterior

FARTHEST: Final = 0.10
"""Of a factor from 1: the worst log was 6 % off."""
FARTHEST_SD: Final = 4.0
"""Of a factor from what the repeat tows of its season alone say."""
FEWEST_BOATS: Final = 5
"""Fewer have no robust spread (inferred)."""
OF_MEDIAN: Final = math.sqrt(math.pi / 2.0)
"""Standard deviation of a median of n normal numbers, times sqrt(n), in theirs."""


def refused(posterior: Posterior, ln_factor: FloatArray, ln_sd: FloatArray) -> BoolArray:
    """Which groups have a factor that is not to be used, (groups,).

    Args:
        ln_factor, ln_sd: of the groups, as estimated.
    """
    gap, gap_sd = _by_repeats_alone(posterior, len(ln_factor))
    far = np.abs(np.expm1(ln_factor)) > FARTHEST
    return np.asarray(far | (np.abs(gap) > FARTHEST_SD * np.hypot(gap_sd, ln_sd)))


def _by_repeats_alone(posterior: Posterior, groups: int) -> tuple[FloatArray, FloatArray]:
    """What repeat tows add to each ln factor, and its standard deviation; 0 where they are few.

    Of every boat that was also towed beside dGPS the difference in ln Cw, less what all boats
    changed meanwhile, as a ln factor of the log; of these the median. A fault of the load cell is
    not taken off: it is what a wrong factor hides behind.
    """
    network = posterior.problem.network
    tangent = posterior.fit.slopes
    of_boats = np.where(posterior.of_boats, posterior.design[:, LEVEL], 0.0) @ posterior.mean
    level = network.numbers("ln_cw") - tangent.predicted[:, LEVEL] - of_boats
    kappa = tangent.ways["speed"][:, LEVEL]
    gap, gap_sd = np.zeros(groups), np.zeros(groups)
    beside_gps = _mean_of_boats(posterior, level, network.group < 0)
    for group in range(groups):
        mine = network.group == group
        difference = _mean_of_boats(posterior, level, mine) - beside_gps
        by_log = difference / _mean_of_boats(posterior, kappa, mine)
        known = by_log[np.isfinite(by_log)]
        if len(known) >= FEWEST_BOATS:
            gap[group] = np.median(known)
            spread = np.median(np.abs(known - gap[group]))
            gap_sd[group] = OF_MEDIAN * MAD_TO_SD * spread / np.sqrt(len(known))
    return gap, gap_sd


def _mean_of_boats(posterior: Posterior, values: FloatArray, chosen: BoolArray) -> FloatArray:
    """Mean over the chosen tows of each boat as it was between alterations; NaN without any."""
    boat = posterior.problem.network.boat
    boats = int(boat.max(initial=-1)) + 1
    count = np.bincount(boat[chosen], minlength=boats)
    total = np.bincount(boat[chosen], values[chosen], boats)
    return np.asarray(np.where(count > 0, total, np.nan) / np.maximum(count, 1))
