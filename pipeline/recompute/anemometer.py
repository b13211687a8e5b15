"""The scale of each season's anemometer, by the wind out and back.

The wind that a boat feels is the true wind less its own velocity. Out and back the true wind turns
about the boat and cancels; the boat's own speed is left. So mean apparent wind over boat speed is
what the anemometer reads of the wind, and needs no resistance and no other boat. A vane that points
askew turns the mean vector and leaves its length. Here: that ratio per tow, the scale of each
season with what the other seasons say of it, and its diagnosis. Not here: what wind does to
resistance (`pipeline.steps.wind`).
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

USUAL_SD: Final = 0.05
"""Spread of ln scale of an anemometer about which nothing is known."""

USUAL_TOW_SD: Final = 0.06
"""Spread of a tow's ratio where no season has two tows: wind changes between out and back."""

ARCHIVE_SD: Final = 0.15
"""Spread of ln scale of one anemometer used in all seasons (inferred)."""

BETWEEN_SEASONS: Final = np.geomspace(0.001, 0.5, 60)
"""Standard deviations of ln scale between seasons that are tried."""

USUAL_BETWEEN: Final = 0.02
"""Scale of their half-Cauchy prior (Gelman 2006): small as a rule, large if something broke."""


def with_anemometer(c: Computed) -> Computed:
    """The tows with their wind as it was, where their steps ask to estimate the anemometer.

    The scale of a season is drawn towards that of the archive.
    """
    asked = c.plan.option("wind.anemometer") == "estimated"
    if not asked.any():
        return c
    scale = scale_of_seasons(_wind_ratios(c).filter(asked))
    of_tows = c.tows.frame.select("season").join(
        scale, on="season", how="left", maintain_order="left"
    )
    ln_scale, sd = (of_tows[name].to_numpy() for name in ("ln_scale", "sd"))
    ln_scale, sd = np.where(asked, ln_scale, 0.0), np.where(asked, sd, np.nan)
    means = c.means.with_wind(np.exp(ln_scale)[c.tows.tow])
    return replace(c, means=means, wind_ln_scale=ln_scale, wind_ln_sd=sd)


def _wind_ratios(c: Computed) -> pl.DataFrame:
    """Apparent wind of each tow over boat speed, mean of out and back.

    Returns:
        A row per tow: `season`; `ahead` and `abeam`, the two parts of the mean vector, NaN where
        wind or speed is not known; `shared_sd` of ln boat speed, the part that a season's tows
        share. Boat speed is that by GPS, or by the log as corrected so far where there is none.
    """
    tows, means = c.tows, c.means
    blows = c.used & (means.wind_m_s > 0) & (c.speed_m_s > 0)
    blows &= (tows.measured("wind") & tows.trusted)[tows.tow]
    by_gps = tows.count(blows & np.isfinite(means.gps_m_s)) == tows.count(blows)
    boat = np.where(by_gps[tows.tow], means.gps_m_s, c.speed_m_s)
    mean = tows.mean_of_ways(np.where(blows, boat, 1.0), blows)
    angle, wind = np.radians(means.wind_angle_deg), means.wind_m_s
    log_sd = np.nan_to_num(c.estimated("ln_sd"), nan=UNKNOWN_LOG_SD)
    return tows.frame.select(
        "season",
        ahead=pl.Series(tows.mean_of_ways(wind * np.cos(angle), blows) / mean),
        abeam=pl.Series(tows.mean_of_ways(wind * np.sin(angle), blows) / mean),
        shared_sd=pl.Series(np.where(by_gps, 0.0, log_sd)),
    )


def scale_of_seasons(ratios: pl.DataFrame) -> pl.DataFrame:
    """What the anemometer of every season reads of the wind.

    Normal about that of the archive. Seasons without a tow that tells have what the others let
    expect. Between seasons the standard deviation is summed over a grid (Rue, Martino & Chopin
    2009), so that one anemometer of many years is known from all of them, and one odd season does
    not move the others.

    Args:
        ratios: per tow `season, ahead, abeam, shared_sd`.

    Returns:
        Per season, sorted, `ln_scale`, ln(reading / wind), and its `sd`.
    """
    parts = pl.col("ahead", "abeam")
    known = ratios.filter(pl.all_horizontal(parts.is_finite()))
    means = known.group_by("season", maintain_order=True).agg(
        parts.mean().name.suffix("_mean"), pl.col("shared_sd").mean(), tows=pl.len()
    )
    ahead, abeam = pl.col("ahead_mean"), pl.col("abeam_mean")
    square = ahead**2 + abeam**2
    along = (pl.col("ahead") * ahead + pl.col("abeam") * abeam) / square
    beside = known.join(means, on="season", maintain_order="left")
    spare = known.height - means.height
    off = beside.select(((along - 1.0) ** 2).sum()).item()
    tow_variance = off / spare if spare else USUAL_TOW_SD**2
    seasons = (
        ratios.select(pl.col("season").unique().sort())
        .join(means, on="season", how="left", maintain_order="left")
        .select(
            "season",
            seen=square.sqrt().clip(1e-3).log().fill_null(0.0),
            noise=(tow_variance / pl.col("tows") + pl.col("shared_sd") ** 2).fill_null(1e6),
        )
    )
    ln_scale, sd = _shrunk(*(seasons[name].to_numpy() for name in ("seen", "noise")))
    return seasons.select("season", ln_scale=pl.Series(ln_scale), sd=pl.Series(sd))


def _shrunk(seen: FloatArray, variance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Mean and sd of normal numbers about a common mean, whose spread is summed over a grid."""
    between = BETWEEN_SEASONS[:, None] ** 2
    weight = 1.0 / (variance + between)
    precision = weight.sum(axis=1) + ARCHIVE_SD**-2.0
    mean = (weight * seen).sum(axis=1) / precision
    ln_density = 0.5 * (np.log(weight).sum(axis=1) - np.log(precision))
    ln_density -= 0.5 * ((weight * seen**2).sum(axis=1) - precision * mean**2)
    # The grid is even in the logarithm: its measure is the standard deviation itself.
    ln_density += np.log(BETWEEN_SEASONS) - np.log1p((BETWEEN_SEASONS / USUAL_BETWEEN) ** 2)
    chance = scipy.special.softmax(ln_density)[:, None]
    pull = between * weight
    value = mean[:, None] + pull * (seen - mean[:, None])
    own = pull * variance + (1.0 - pull) ** 2 / precision[:, None]
    average = (chance * value).sum(axis=0)
    spread = (chance * (own + (value - average) ** 2)).sum(axis=0)
    return np.asarray(average), np.sqrt(spread)


def anemometer_diagnosis(c: Computed) -> pl.DataFrame:
    """Rows of `season_diagnosis`: the anemometer of every season where it was estimated."""
    tows = c.tows.frame.select(
        "season", estimate=pl.Series(c.wind_ln_scale), sd=pl.Series(c.wind_ln_sd)
    )
    seasons = (
        tows.filter(pl.col("sd").is_finite())
        .group_by("season", maintain_order=True)
        .agg(pl.col("estimate", "sd").first(), pl.len().alias("tows"))
    )
    half = NORMAL * pl.col("sd")
    shown = (USUAL_SD**2 - pl.col("sd") ** 2).clip(MIN_INFORMED_SHARE * USUAL_SD**2).sqrt()
    distance = pl.col("estimate") / shown
    alarm = distance.abs() >= ALARM_SD
    return (
        seasons.sort("season")
        .select(
            "season",
            pl.lit(0).alias("part"),
            pl.lit(ANEMOMETER).alias("instrument"),
            pl.lit("1").alias("unit"),
            "estimate",
            (pl.col("estimate") - half).alias("lo"),
            (pl.col("estimate") + half).alias("hi"),
            pl.lit(None).alias("p_fault"),
            distance.alias("distance_sd"),
            pl.when(alarm).then(pl.lit(ALARM)).otherwise(pl.lit(SOUND)).alias("verdict"),
            alarm.alias("alarm"),
            pl.lit(None).alias("first_tow"),
            pl.format("wind out and back of {} tows", "tows").alias("rests_on"),
            pl.lit(None).alias("shown_by"),
            pl.lit(None).alias("confused_with"),
        )
        .cast(pl.Schema(DIAGNOSIS_SCHEMA))
    )
