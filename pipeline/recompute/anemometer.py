"""The anemometer of each season as all tows show it: estimated, applied to the wind, diagnosed.

The formulas are in `pipeline.steps.anemometer`.
"""

from collections.abc import Sequence
from dataclasses import fields, replace
from typing import Final

import numpy as np
import polars as pl

from pipeline.quantiles import NORMAL
from pipeline.recompute.outcome import Outcome, Prepared
from pipeline.season_log.diagnosis import ALARM, ALARM_SD, DIAGNOSIS_SCHEMA, SOUND
from pipeline.steps.anemometer import Anemometer, WindRatio, anemometer_of_seasons

ANEMOMETER: Final = "anemometer_scale"
"""Its name among the instruments of `season_diagnosis`."""

USUAL_SD: Final = 0.05
"""Spread of ln scale of an anemometer about which nothing is known."""


def with_anemometer(prepared: Sequence[Prepared]) -> list[Prepared]:
    """The batches with their wind as it was, where their method asks to estimate the anemometer.

    Args:
        prepared: all batches; the scale of a season is drawn towards that of the archive.
    """
    asking = [p for p in prepared if _asks(p)]
    if not asking:
        return list(prepared)
    anemometer = _estimated(asking)
    return [_corrected(p, anemometer) if _asks(p) else p for p in prepared]


def _asks(prepared: Prepared) -> bool:
    return prepared.steps.wind.anemometer == "estimated"


def _estimated(prepared: Sequence[Prepared]) -> Anemometer:
    each = [
        WindRatio.of(
            p.batch, p.windows.mask, p.used, p.means.gps_m_s, p.speed_m_s, p.estimated.ln_sd
        )
        for p in prepared
    ]
    names = [field.name for field in fields(WindRatio)]
    return anemometer_of_seasons(
        WindRatio(**{name: np.concatenate([getattr(r, name) for r in each]) for name in names})
    )


def _corrected(prepared: Prepared, anemometer: Anemometer) -> Prepared:
    ln_scale, sd = anemometer.of_tows(prepared.batch.of_tow("season"))
    means = prepared.means.with_wind(np.exp(ln_scale)[prepared.batch.tow])
    return replace(prepared, means=means, wind_ln_scale=ln_scale, wind_ln_sd=sd)


def anemometer_diagnosis(outcomes: Sequence[Outcome]) -> pl.DataFrame:
    """Rows of `season_diagnosis`: the anemometer of every season where it was estimated."""
    tows = pl.concat(
        [
            o.batch.tows.select(
                "season", estimate=o.prepared.wind_ln_scale, sd=o.prepared.wind_ln_sd
            )
            for o in outcomes
        ]
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
