"""The factor of each log: its interval, what the interval consists of, and whether it is refused.

A guard that needs no model: no log was off by more than 10 %, and boats that were not altered come
out alike beside dGPS, whatever the joint estimate believes.
"""

from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import BoolArray, FloatArray
from pipeline.quantiles import NORMAL
from pipeline.season_log.archive import ANCHORED, GPS, LEVEL
from pipeline.season_log.fit import Fit
from pipeline.season_log.observation_model import GPS_SCALE

ESTIMATED: Final = "estimated"
BY_GPS: Final = "gps"
NOT_DETERMINED: Final = "not determined"
NOT_SETTLED: Final = "not settled"

MAX_LOG_ERROR: Final = 0.10
"""Largest distance of a factor from 1 that is believed: the worst log was 6 % off."""
MAX_CONTRADICTION: Final = 0.05
"""Largest distance in ln factor from what the season's repeat tows say alone (inferred). A fault of
the load cell, which is not taken off there, is up to 10 % of force: 3.6 % of speed."""
MIN_BOATS: Final = 5
"""Fewer boats have no median to rely on (inferred)."""


def make_factor_table(
    fit: Fit, is_determined: BoolArray, is_refused: BoolArray
) -> tuple[pl.DataFrame, FloatArray]:
    """Return rows of `SeasonFactors.factors`, and the covariance of the determined ln factors.

    A factor is the mean over the tows of its log. The scatter of these tows is in that mean as well
    as in what they tell of the log, so it is part of the error only as far as the prior draws the
    estimate. With the posterior covariance C of the effects, C = C (priors + data) C: what each
    number and each prior contributes to a variance adds up.

    Args:
        is_determined: (logs,) logs whose factor is given.
        is_refused: (logs,) logs whose factor is not believed.
    """
    archive = fit.model.archive
    mean_design = fit.mean_log_design[is_determined]
    ln_factor = mean_design @ fit.value
    scatter = fit.mean_log_scatter[is_determined]
    drawn = scatter / fit.model.priors.log_sd**2
    covariance = mean_design @ fit.covariance @ mean_design.T
    covariance = covariance * (1.0 + drawn + drawn[:, None]) - np.diag(scatter)
    variance = np.diag(covariance)

    weight = mean_design @ fit.covariance
    from_prior = weight**2 / fit.prior_variance
    is_gps_scale = fit.name == GPS_SCALE
    gps_variance = _compute_variance_from_gps(fit, weight) + from_prior[:, is_gps_scale].sum(axis=1)
    assumed_variance = from_prior[:, ~is_gps_scale].sum(axis=1)
    repeat_variance = np.maximum(variance - gps_variance - assumed_variance, 0.0)

    half_width = NORMAL * np.sqrt(variance)
    numbers = {
        "factor": np.exp(ln_factor),
        "lo": np.exp(ln_factor - half_width),
        "hi": np.exp(ln_factor + half_width),
        "ln_sd": np.sqrt(variance),
        "repeat_tows_sd": np.sqrt(repeat_variance),
        "gps_sd": np.sqrt(gps_variance),
        "assumed_sd": np.sqrt(assumed_variance),
    }
    columns = []
    for name, values in numbers.items():
        of_log = np.full(len(is_determined), np.nan)
        of_log[is_determined] = values
        columns.append(pl.Series(name, of_log).fill_nan(None))

    by_gps_alone = (pl.col("n_links") == 0) & (pl.col("has_gps") | pl.col("calibrated"))
    source = (
        pl.when(pl.col("component") > 0)
        .then(pl.lit(NOT_DETERMINED))
        .when(pl.Series(is_refused) | pl.lit(not fit.has_converged))
        .then(pl.lit(NOT_SETTLED))
        .when(by_gps_alone)
        .then(pl.lit(BY_GPS))
        .otherwise(pl.lit(ESTIMATED))
    )
    factors = archive.logs.with_columns(source=source).with_columns(columns)
    return factors.drop("prior_ln", "prior_sd", "has_gps", "calibrated"), covariance


def _compute_variance_from_gps(fit: Fit, weight: FloatArray) -> FloatArray:
    """Return the part of the variance of ln factors that is the scatter of plain GPS, (logs,).

    Args:
        weight: (logs, k) combination of effects times their covariance.
    """
    known = fit.model.archive.y_covariance[:, GPS, GPS]
    gps_variance = known + np.exp(fit.ln_variance[GPS])
    total = np.zeros(len(weight))
    for b in fit.boats:
        of_number = b.precision_design[:, GPS::3] @ weight.T  # (b, T, logs)
        total += (of_number**2 * gps_variance[b.group.tow][..., None]).sum(axis=(0, 1))
    return total


def find_refused(fit: Fit) -> BoolArray:
    """Return whether the factor of a log contradicts what needs no model, (logs,)."""
    is_far = np.abs(np.expm1(fit.mean_log_design @ fit.value)) > MAX_LOG_ERROR
    is_contradicted = np.abs(_compare_repeat_tows(fit)) > MAX_CONTRADICTION
    return np.asarray((is_far | is_contradicted) & fit.model.archive.is_connected)


def find_determined(fit: Fit) -> BoolArray:
    """Return whether a log is connected with the anchor and its factor not refused, (logs,)."""
    return np.asarray(fit.model.archive.is_connected & ~find_refused(fit))


def _compare_repeat_tows(fit: Fit) -> FloatArray:
    """Return what repeat tows alone would add to the ln factor of each log, (logs,).

    The median over the boats that were also towed beside dGPS of their difference in ln Cw, less
    what all boats changed meanwhile, as a ln factor; 0 where these are fewer than `MIN_BOATS`. A
    fault of the load cell is not taken off: it is what a wrong factor hides behind.
    """
    archive = fit.model.archive
    level = archive.column("ln_cw") - fit.linear.predicted[:, LEVEL] - fit.boat_design @ fit.value
    tows = pl.DataFrame(
        {
            "boat": archive.boat,
            "log": archive.log,
            "level": level,
            "kappa": fit.linear.by_channel["log"][:, LEVEL],
        }
    )
    boats = tows.group_by("boat", "log", maintain_order=True).mean()
    anchored = boats.filter(log=ANCHORED).select("boat", anchored_level="level")
    gaps = (
        boats.filter(pl.col("log") != ANCHORED)
        .join(anchored, on="boat", maintain_order="left")
        .group_by("log", maintain_order=True)
        .agg(
            boats=pl.len(),
            median=((pl.col("level") - pl.col("anchored_level")) / pl.col("kappa")).median(),
        )
        .filter(pl.col("boats") >= MIN_BOATS)
    )
    added = np.zeros(archive.logs.height)
    added[gaps["log"]] = gaps["median"]
    return added
