"""The scale of each season's anemometer, by the wind out and back.

The wind that a boat feels is the true wind less its own velocity. Out and back the true wind turns
about the boat and cancels; the boat's own speed is left. So mean apparent wind over boat speed is
what the anemometer reads of the wind, and needs no resistance and no other boat. A vane that points
askew turns the mean vector and leaves its length. What wind does to resistance is in
`pipeline.steps.wind`.
"""

from dataclasses import replace
from typing import Final

import numpy as np
import polars as pl
import scipy

from pipeline.arrays import FloatArray
from pipeline.history import UNKNOWN_LOG_SD
from pipeline.quantiles import NORMAL
from pipeline.recompute.computed import Computed
from pipeline.season_log.diagnosis import (
    ALARM,
    ALARM_SD,
    DIAGNOSIS_SCHEMA,
    MIN_INFORMED_SHARE,
    SOUND,
)

ANEMOMETER: Final = "anemometer_scale"
"""Its name among the instruments of `season_diagnosis`."""

SCALE_SD: Final = 0.05
"""Spread of ln scale of an anemometer about which nothing is known."""
TOW_SD: Final = 0.06
"""Spread of a tow's ratio where no season has two tows: wind changes between out and back."""
ARCHIVE_SD: Final = 0.15
"""Spread of ln scale of one anemometer used in all seasons (inferred)."""
BETWEEN_SEASONS_GRID: Final = np.geomspace(0.001, 0.5, 60)
"""Standard deviations of ln scale between seasons over which is summed."""
BETWEEN_SEASONS_SCALE: Final = 0.02
"""Scale of their half-Cauchy prior (Gelman 2006): small as a rule, large if something broke."""
MIN_RATIO: Final = 1e-3
UNKNOWN_VARIANCE: Final = 1e6


def correct_anemometers(c: Computed) -> Computed:
    """Return the tows with their wind as it was, where their steps ask to estimate its scale."""
    is_asked = c.options.wind.estimates_anemometer
    if not is_asked.any():
        return c
    scales = estimate_scales(_measure_wind_ratios(c).filter(is_asked))
    tows = c.tows.frame.select("season").join(
        scales, on="season", how="left", maintain_order="left"
    )
    ln_scale = np.where(is_asked, tows["ln_scale"].to_numpy(), 0.0)
    sd = np.where(is_asked, tows["sd"].to_numpy(), np.nan)
    means = c.means.scale_wind(np.exp(ln_scale)[c.tows.tow])
    air = replace(c.air, anemometer_ln_scale=ln_scale, anemometer_ln_sd=sd)
    return replace(c, means=means, air=air)


def _measure_wind_ratios(c: Computed) -> pl.DataFrame:
    """Return the apparent wind of each tow over boat speed, mean of out and back.

    Returns:
        A row per tow: `season`; `ahead` and `abeam`, the two parts of the mean vector, NaN where
        wind or speed is not known; `shared_sd` of ln boat speed, the part that a season's tows
        share. Boat speed is that by GPS, or by the log as corrected so far where there is none.
    """
    tows, wind = c.tows, c.means.wind_m_s
    is_windy = c.used & (wind > 0) & (c.speed_m_s > 0)
    is_windy &= (tows.has_channel("wind") & tows.trusted)[tows.tow]
    by_gps = tows.count(is_windy & np.isfinite(c.means.gps_m_s)) == tows.count(is_windy)
    speed = np.where(by_gps[tows.tow], c.means.gps_m_s, c.speed_m_s)
    mean_speed = tows.mean_of_ways(np.where(is_windy, speed, 1.0), is_windy)
    angle = np.radians(c.means.wind_angle_deg)
    log_sd = np.nan_to_num(c.get_estimated("ln_sd"), nan=UNKNOWN_LOG_SD)
    return tows.frame.select(
        "season",
        ahead=pl.Series(tows.mean_of_ways(wind * np.cos(angle), is_windy) / mean_speed),
        abeam=pl.Series(tows.mean_of_ways(wind * np.sin(angle), is_windy) / mean_speed),
        shared_sd=pl.Series(np.where(by_gps, 0.0, log_sd)),
    )


def estimate_scales(ratios: pl.DataFrame) -> pl.DataFrame:
    """Estimate what the anemometer of every season reads of the wind.

    The observed ln scale of a season is the length of the mean vector of its tows; its variance is
    the scatter of the tows along that vector, pooled over seasons. Scales of seasons are normal
    about that of the archive (`shrink_to_archive`).

    Args:
        ratios: per tow `season, ahead, abeam, shared_sd`.

    Returns:
        Per season, sorted, `ln_scale`, ln(reading / wind), and its `sd`.
    """
    ahead, abeam = pl.col("mean_ahead"), pl.col("mean_abeam")
    length = (ahead**2 + abeam**2).sqrt()
    known = ratios.filter(pl.col("ahead").is_finite() & pl.col("abeam").is_finite())
    means = known.group_by("season", maintain_order=True).agg(
        mean_ahead=pl.col("ahead").mean(),
        mean_abeam=pl.col("abeam").mean(),
        shared_sd=pl.col("shared_sd").mean(),
        tows=pl.len(),
    )
    tow_variance = TOW_SD**2
    dof = known.height - means.height
    if dof:
        along = (pl.col("ahead") * ahead + pl.col("abeam") * abeam) / length**2
        tows = known.join(means, on="season", maintain_order="left")
        tow_variance = tows.select(((along - 1.0) ** 2).sum()).item() / dof
    variance = tow_variance / pl.col("tows") + pl.col("shared_sd") ** 2
    seasons = (
        ratios.select(pl.col("season").unique().sort())
        .join(means, on="season", how="left", maintain_order="left")
        .select(
            "season",
            observed=length.clip(MIN_RATIO).log().fill_null(0.0),
            variance=variance.fill_null(UNKNOWN_VARIANCE),
        )
    )
    ln_scale, sd = shrink_to_archive(seasons["observed"].to_numpy(), seasons["variance"].to_numpy())
    return seasons.select("season", ln_scale=pl.Series(ln_scale), sd=pl.Series(sd))


def shrink_to_archive(observed: FloatArray, variance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return posterior mean and sd of normal numbers about a common mean, (n,) each.

    The random-effects model of meta-analysis, observed_i ~ N(theta_i, variance_i), theta_i ~
    N(mu, tau^2), mu ~ N(0, ARCHIVE_SD^2). The posterior is summed over a grid of tau, so that one
    anemometer of many years is known from all of them, and one odd season moves no other.
    """
    tau2 = BETWEEN_SEASONS_GRID[:, None] ** 2
    weight = 1.0 / (variance + tau2)  # (grid, n)
    precision = weight.sum(axis=1) + ARCHIVE_SD**-2.0
    mu = (weight * observed).sum(axis=1) / precision
    ln_likelihood = 0.5 * (np.log(weight).sum(axis=1) - np.log(precision))
    ln_likelihood -= 0.5 * ((weight * observed**2).sum(axis=1) - precision * mu**2)
    # Half-Cauchy prior; the grid is even in ln tau, so its measure is tau itself.
    ln_prior = np.log(BETWEEN_SEASONS_GRID)
    ln_prior -= np.log1p((BETWEEN_SEASONS_GRID / BETWEEN_SEASONS_SCALE) ** 2)
    probability = scipy.special.softmax(ln_likelihood + ln_prior)[:, None]

    shrinkage = tau2 * weight
    theta = mu[:, None] + shrinkage * (observed - mu[:, None])
    theta_variance = shrinkage * variance + (1.0 - shrinkage) ** 2 / precision[:, None]
    mean = (probability * theta).sum(axis=0)
    total_variance = (probability * (theta_variance + (theta - mean) ** 2)).sum(axis=0)
    return np.asarray(mean), np.sqrt(total_variance)


def diagnose_anemometers(c: Computed) -> pl.DataFrame:
    """Return rows of `season_diagnosis`: the anemometer of every season that was estimated."""
    estimate, sd = pl.col("estimate"), pl.col("sd")
    shown = (SCALE_SD**2 - sd**2).clip(MIN_INFORMED_SHARE * SCALE_SD**2).sqrt()
    distance = estimate / shown
    is_alarm = distance.abs() >= ALARM_SD
    return (
        c.tows.frame.select(
            "season",
            estimate=pl.Series(c.air.anemometer_ln_scale),
            sd=pl.Series(c.air.anemometer_ln_sd),
        )
        .filter(sd.is_finite())
        .group_by("season", maintain_order=True)
        .agg(estimate.first(), sd.first(), tows=pl.len())
        .sort("season")
        .select(
            "season",
            "estimate",
            part=pl.lit(0),
            instrument=pl.lit(ANEMOMETER),
            unit=pl.lit("1"),
            lo=estimate - NORMAL * sd,
            hi=estimate + NORMAL * sd,
            p_fault=pl.lit(None),
            distance_sd=distance,
            verdict=pl.when(is_alarm).then(pl.lit(ALARM)).otherwise(pl.lit(SOUND)),
            alarm=is_alarm,
            first_tow=pl.lit(None),
            rests_on=pl.format("wind out and back of {} tows", "tows"),
            shown_by=pl.lit(None),
            confused_with=pl.lit(None),
        )
        .select(DIAGNOSIS_SCHEMA.keys())
        .cast(pl.Schema(DIAGNOSIS_SCHEMA))
    )
