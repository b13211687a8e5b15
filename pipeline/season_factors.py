"""Season factors: what the joint estimate is given, and what it gives to the tows.

Every tow is first computed without any factor for the seasons whose factor is estimated; from
those curves the factors follow, once, and are applied after (never tuned in a loop). The statistics
stand in `pipeline.season_log`.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.arrays import FloatArray
from pipeline.batch import Batch
from pipeline.calibration import gps_factor
from pipeline.method import Steps
from pipeline.outcome import Outcome, TowFactor
from pipeline.season_log import LINE, SeasonFactors, estimate_season_factors
from pipeline.sureness import random_ratio

WHOLE_SEASON: Final = 0
"""Part of a season; an archive does not yet say when a log was replaced within one."""

FEWEST_OF_TYPE: Final = 5
"""A type's own bend is taken from so many anchored tows on."""

GPS: Final = "gps_per_tow"
FACTOR_KEY: Final = ("season", "log")


def is_estimated(steps: Steps) -> bool:
    """Whether these steps ask for an estimated log factor."""
    return steps.speed.correction == "estimated"


def without_factor(steps: Steps) -> Steps:
    """The steps with the log as it reads where its factor is to be estimated."""
    if not is_estimated(steps):
        return steps
    speed = steps.speed.model_copy(update={"correction": "none"})
    return steps.model_copy(update={"speed": speed})


def find_season_factors(outcomes: Sequence[Outcome]) -> SeasonFactors:
    """The log factors of all seasons, from tows computed without them.

    Args:
        outcomes: all batches under `without_factor`.
    """
    rows = pl.concat([_rows(outcome) for outcome in outcomes])
    return estimate_season_factors(_at_reference_speed(rows.drop_nulls("a_kg_m")))


def factor_of_tows(batch: Batch, steps: Steps, found: SeasonFactors | None) -> TowFactor:
    """The estimated factor of each tow's season and log."""
    if found is None or not is_estimated(steps):
        nothing = np.full(batch.size, np.nan)
        return TowFactor(nothing, nothing, nothing)
    held = batch.tows.select("season", pl.lit(_log(steps)).alias("log")).join(
        found.factors.select(*FACTOR_KEY, "factor", "ln_sd", "dof"),
        on=FACTOR_KEY,
        how="left",
        maintain_order="left",
    )
    columns = (held[name].cast(pl.Float64).to_numpy() for name in ("factor", "ln_sd", "dof"))
    return TowFactor(*columns)


def _log(steps: Steps) -> str:
    return steps.speed.source


def _rows(o: Outcome) -> pl.DataFrame:
    """One row a tow: its curve, how sure it is, and its GPS ratio."""
    batch, steps = o.batch, o.steps
    water = _water_curves(o)
    sound = water.converged & np.isfinite(water.cw_at(batch.of_tow("declared_speed_m_s")))
    calibrated = steps.calibration.rule == GPS
    gps, gps_sd, has_gps = _gps_ratio(o)
    numbers = {
        "a_kg_m": np.where(sound, water.a_kg_m, np.nan),
        "s_s2_m2": water.s_s2_m2,
        "ln_cw_sd": random_ratio(o)[0],
        "gps_ln_ratio": np.where(has_gps & (not calibrated), gps, np.nan),
        "gps_sd": np.where(has_gps & (not calibrated), gps_sd, np.nan),
    }
    names = ("tow_id", "season", *LINE, "altered", "declared_speed_m_s")
    return batch.tows.select(
        *names,
        pl.col("weight_kg", "waterline_length_m").cast(pl.Float64),
        _boat_type(batch.tows),
        pl.lit(WHOLE_SEASON).alias("part"),
        pl.lit(_log(steps)).alias("log"),
        pl.lit(calibrated).alias("anchored"),
        *(pl.Series(name, values).fill_nan(None) for name, values in numbers.items()),
    )


def _water_curves(o: Outcome) -> curve.Curves:
    """Curves of the water alone: the still-air part does not scale with the log's error."""
    water = o.batch.by_tow(o.cw_kg_m - o.still_air_kg_m)
    return curve.fit(curve.Points(o.points.speed_m_s, water, o.points.used & (water > 0)))


def _boat_type(tows: pl.DataFrame) -> pl.Expr:
    known = "boat_type" in tows.columns
    return pl.col("boat_type") if known else pl.lit(None, dtype=pl.String).alias("boat_type")


def _gps_ratio(o: Outcome) -> tuple[FloatArray, FloatArray, np.ndarray]:
    """Gives ln(GPS / log) of each tow with runs both ways, its random part, and where known.

    The random part is the scatter of run ratios about their direction's mean, pooled over the
    batch: one tow's six runs are too few.
    """
    batch, mask = o.batch, o.windows.mask
    samples = batch.blocks.total("gps_n", mask)
    gps = batch.blocks.total("gps", mask) / np.maximum(samples, 1.0)
    used = o.used & (samples > 0)
    log = o.speed_m_s / o.speed_factor
    y, both = gps_factor(gps, log, batch.direction, batch.tow, used, batch.size)
    ratio = np.where(used, gps / np.where(used, log, 1.0), 1.0)
    spread, count = 0.0, 0.0
    for way in (1, -1):
        mine = used & (batch.direction == way)
        deviation = np.where(mine, ratio - batch.mean(ratio, mine)[batch.tow], 0.0)
        spread += float((deviation**2).sum())
        count += float(np.maximum(batch.count(mine) - 1, 0).sum())
    run_sd = np.sqrt(spread / count) if count else 1.0
    runs = np.maximum(batch.count(used), 1)
    return np.log(np.where(both, y, 1.0)), run_sd / np.sqrt(runs), both


def _at_reference_speed(rows: pl.DataFrame) -> pl.DataFrame:
    """Adds `ln_cw` at one speed per line, and `kappa` there.

    The bend of one tow is badly determined: kappa comes from the median bend of the anchored tows
    of the boat's type, of the fleet where those are few. A tenth in kappa costs nothing (research,
    method.md 8.1).
    """
    speed = pl.col("declared_speed_m_s").median().over(LINE)
    r = pl.col("s_s2_m2") * speed**2
    placed = rows.with_columns(r.alias("r")).filter(pl.col("r") < 1.0)
    placed = placed.with_columns(
        (pl.col("a_kg_m") / (1.0 - pl.col("r"))).log().alias("ln_cw"),
        (pl.col("r") / (1.0 - pl.col("r"))).alias("q"),
    )
    anchored = placed.filter("anchored")
    trusted = anchored if anchored.height else placed
    by_type = trusted.group_by("boat_type").agg(pl.col("q").median().alias("q_type"), pl.len())
    usual = by_type.filter(pl.col("len") >= FEWEST_OF_TYPE).select("boat_type", "q_type")
    return placed.join(
        usual, on="boat_type", how="left", nulls_equal=True, maintain_order="left"
    ).with_columns((2.0 + 2.0 * pl.col("q_type").fill_null(trusted["q"].median())).alias("kappa"))
