"""The anemometer of each season as all tows show it: estimated, applied to the wind, diagnosed.

The formulas are in `pipeline.steps.anemometer`.
"""

from collections.abc import Sequence
from dataclasses import fields, replace
from typing import Final

import numpy as np
import polars as pl

from pipeline.quantiles import NORMAL
from pipeline.recompute.computed import Computed
from pipeline.season_log.diagnosis import ALARM, ALARM_SD, DIAGNOSIS_SCHEMA, SOUND
from pipeline.steps.anemometer import Anemometer, WindRatio, anemometer_of_seasons

ANEMOMETER: Final = "anemometer_scale"
"""Its name among the instruments of `season_diagnosis`."""

USUAL_SD: Final = 0.05
"""Spread of ln scale of an anemometer about which nothing is known."""


def with_anemometer(computed: list[Computed]) -> list[Computed]:
    """The batches with their wind as it was, where their method asks to estimate the anemometer.

    Args:
        computed: all batches; the scale of a season is drawn towards that of the archive.
    """
    asking = [c for c in computed if c.steps.wind.anemometer == "estimated"]
    if not asking:
        return computed
    each = [
        WindRatio.of(
            c.batch, c.windows.mask, c.used, c.means.gps_m_s, c.speed_m_s, c.estimated("ln_sd")
        )
        for c in asking
    ]
    names = [field.name for field in fields(WindRatio)]
    scale = anemometer_of_seasons(
        WindRatio(**{name: np.concatenate([getattr(r, name) for r in each]) for name in names})
    )
    return [_corrected(c, scale) if c.steps.wind.anemometer == "estimated" else c for c in computed]


def _corrected(computed: Computed, anemometer: Anemometer) -> Computed:
    ln_scale, sd = anemometer.of_tows(computed.batch.of_tow("season"))
    means = computed.means.with_wind(np.exp(ln_scale)[computed.batch.tow])
    return replace(computed, means=means, wind_ln_scale=ln_scale, wind_ln_sd=sd)


def anemometer_diagnosis(computed: Sequence[Computed]) -> pl.DataFrame:
    """Rows of `season_diagnosis`: the anemometer of every season where it was estimated."""
    tows = pl.concat(
        [c.batch.tows.select("season", estimate=c.wind_ln_scale, sd=c.wind_ln_sd) for c in computed]
    )
    seasons = (
        tows.filter(pl.col("sd").is_finite())
        .group_by("season", maintain_order=True)
        .agg(pl.col("estimate", "sd").first(), pl.len().alias("tows"))
    )
    half = NORMAL * pl.col("sd")
    shown = (USUAL_SD**2 - pl.col("sd") ** 2).clip(1e-6 * USUAL_SD**2).sqrt()
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
            pl.lit(None).alias("confused_with"),
        )
        .cast(pl.Schema(DIAGNOSIS_SCHEMA))
    )
