"""Whether the factor of a log can be used.

A guard needs no insight: whatever the joint estimate believes, no log was off by more than 10 %,
and boats that were not altered come out alike beside dGPS.
"""

import math
from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import BoolArray, FloatArray
from pipeline.quantiles import MAD_TO_SD
from pipeline.season_log.boats import LEVEL
from pipeline.season_log.fit import Fit, level_of_boats

FARTHEST: Final = 0.10
"""Of a factor from 1: the worst log was 6 % off."""
FARTHEST_SD: Final = 4.0
"""Of a factor from what the repeat tows of its season alone say."""
FEWEST_BOATS: Final = 5
"""Fewer have no robust spread (inferred)."""
OF_MEDIAN: Final = math.sqrt(math.pi / 2.0)
"""Standard deviation of a median of n normal numbers, times sqrt(n), in theirs."""


def refused(fitted: Fit) -> BoolArray:
    """Logs whose factor contradicts what needs no model, (logs,)."""
    along = means(fitted)
    ln_factor = along @ fitted.value
    variance = ((along @ fitted.covariance) * along).sum(axis=1)
    gap, gap_variance = _by_repeats_alone(fitted)
    far = np.abs(np.expm1(ln_factor)) > FARTHEST
    far |= np.abs(gap) > FARTHEST_SD * np.sqrt(gap_variance + variance)
    return np.asarray(far & (fitted.problem.tows.logs["component"].to_numpy() == 0))


def _by_repeats_alone(fitted: Fit) -> tuple[FloatArray, FloatArray]:
    """What repeat tows add to each ln factor, and its variance; 0 where they are few.

    Of every boat that was also towed beside dGPS the difference in ln Cw, less what all boats
    changed meanwhile, as a ln factor of the log; of these the median. A fault of the load cell is
    not taken off: it is what a wrong factor hides behind.
    """
    tows = fitted.problem.tows
    level = tows.numbers("ln_cw") - fitted.slopes.predicted[:, LEVEL] - level_of_boats(fitted)
    values = tows.frame.select(
        "boat", "log_place", level=pl.Series(level), kappa=fitted.slopes.ways["speed"][:, LEVEL]
    )
    of_boats = values.group_by("boat", "log_place", maintain_order=True).mean()
    beside_gps = of_boats.filter(pl.col("log_place") < 0).select("boat", beside="level")
    difference = (pl.col("level") - pl.col("beside")) / pl.col("kappa")
    known = of_boats.filter(pl.col("log_place") >= 0).join(
        beside_gps, on="boat", maintain_order="left"
    )
    spread = MAD_TO_SD * (pl.col("gap") - pl.col("gap").median()).abs().median()
    gaps = (
        known.select("log_place", gap=difference)
        .group_by("log_place", maintain_order=True)
        .agg(pl.col("gap").median().alias("middle"), sd=OF_MEDIAN * spread, boats=pl.len())
        .filter(pl.col("boats") >= FEWEST_BOATS)
    )
    gap, variance = np.zeros((2, tows.logs.height))
    gap[gaps["log_place"]] = gaps["middle"]
    variance[gaps["log_place"]] = gaps["sd"] ** 2 / gaps["boats"]
    return gap, variance


def means(fitted: Fit) -> FloatArray:
    """Mean ln factor over the tows of each log as a sum of effects, (logs, k)."""
    log = fitted.problem.tows.log + 1  # 0, anchored, is left out
    total = np.zeros((log.max() + 1, len(fitted.active)))
    np.add.at(total, log, fitted.share * fitted.of_log)
    return np.asarray((total / np.bincount(log)[:, None].clip(1))[1:])
