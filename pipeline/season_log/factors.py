"""The factor of each log with its interval, what that consists of, and whether it can be used.

A guard needs no insight: whatever the joint estimate believes, no log was off by more than 10 %,
and boats that were not altered come out alike beside dGPS.
"""

import math
from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import BoolArray, FloatArray
from pipeline.quantiles import MAD_TO_SD, t_quantile
from pipeline.season_log.boats import GPS as GPS_NUMBER
from pipeline.season_log.boats import LEVEL
from pipeline.season_log.effects import GPS_SCALE
from pipeline.season_log.fit import Fit, level_of_boats

ESTIMATED: Final = "estimated"
GPS: Final = "gps"
NOT_DETERMINED: Final = "not determined"
NOT_SETTLED: Final = "not settled"

FARTHEST: Final = 0.10
"""Of a factor from 1: the worst log was 6 % off."""
FARTHEST_SD: Final = 4.0
"""Of a factor from what the repeat tows of its season alone say."""
FEWEST_BOATS: Final = 5
"""Fewer have no robust spread (inferred)."""
OF_MEDIAN: Final = math.sqrt(math.pi / 2.0)
"""Standard deviation of a median of n normal numbers, times sqrt(n), in theirs."""


def means(fitted: Fit) -> FloatArray:
    """Mean ln factor over the tows of each log as a sum of effects, (logs, k)."""
    log = fitted.problem.tows.log + 1  # 0, anchored, is left out
    total = np.zeros((log.max() + 1, len(fitted.active)))
    np.add.at(total, log, fitted.share * fitted.of_log)
    return np.asarray((total / np.bincount(log)[:, None].clip(1))[1:])


def factors_of(
    fitted: Fit, known: BoolArray, contradicted: BoolArray
) -> tuple[pl.DataFrame, FloatArray]:
    """The factor of each log, and the covariance between those that are determined.

    Args:
        known: logs that are determined, (logs,).
        contradicted: those that are `refused`.

    Returns:
        Rows of `SeasonFactors.factors`, and (determined, determined) covariance of ln factor.
    """
    tows, along = fitted.problem.tows, means(fitted)[known]
    covariance = _of_means(fitted, along @ fitted.covariance @ along.T, known)
    by_gps, assumed = _beside_repeats(fitted, along)
    variance = np.diag(covariance)
    mean, dof = along @ fitted.value, fitted.dof(along)
    half = np.sqrt(variance) * t_quantile(np.maximum(dof, 1.0))
    found = (
        tows.logs.select("log_place")
        .filter(pl.Series(known))
        .with_columns(
            factor=np.exp(mean),
            lo=np.exp(mean - half),
            hi=np.exp(mean + half),
            ln_sd=np.sqrt(variance),
            dof=dof,
            repeat_tows_sd=np.sqrt(np.maximum(variance - by_gps - assumed, 0.0)),
            gps_sd=np.sqrt(by_gps),
            assumed_sd=np.sqrt(assumed),
        )
    )
    tied_by_gps = pl.col("has_gps") | pl.col("calibrated")
    by_gps_alone = (pl.col("n_links") == 0) & tied_by_gps
    usable = pl.when(by_gps_alone).then(pl.lit(GPS)).otherwise(pl.lit(ESTIMATED))
    source = (
        pl.when(pl.col("component") > 0)
        .then(pl.lit(NOT_DETERMINED))
        .when(pl.Series(contradicted) | pl.lit(not fitted.settled))
        .then(pl.lit(NOT_SETTLED))
        .otherwise(usable)
    )
    factors = tows.logs.with_columns(source=source).join(
        found, on="log_place", how="left", maintain_order="left"
    )
    return factors.drop("log_place", "prior_ln", "prior_sd", "has_gps", "calibrated"), covariance


def _of_means(fitted: Fit, covariance: FloatArray, known: BoolArray) -> FloatArray:
    """Covariance of the mean ln factors over tows, by that of what logs do in general.

    The scatter of the tows is in their mean as well as in what they tell of the log: it is in the
    difference only as far as the prior draws the estimate.
    """
    own = fitted.scatter_of_means[known]
    drawn = own / fitted.problem.settings.log_sd**2
    return np.asarray(covariance * (1.0 + drawn + drawn[:, None]) - np.diag(own))


def _beside_repeats(fitted: Fit, along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Parts of the variance of ln factors that are the GPS's, and of what is assumed.

    The covariance C of the effects is C (prior + data) C: what each number and each prior has in it
    adds up.
    """
    weight = along @ fitted.covariance
    gps = fitted.problem.given[:, GPS_NUMBER, GPS_NUMBER] + np.exp(fitted.ln_variance[GPS_NUMBER])
    by_gps = ((fitted.weighed[:, GPS_NUMBER] @ weight.T) ** 2 * gps[:, None]).sum(axis=0)
    by_prior = weight**2 / fitted.problem.effects.column("variance", fitted.active)
    of_gps = fitted.name == GPS_SCALE
    return by_gps + by_prior[:, of_gps].sum(axis=1), by_prior[:, ~of_gps].sum(axis=1)


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
