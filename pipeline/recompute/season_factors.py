"""Season factors: what the joint estimate is given, and what it gives to the tows.

Every tow is first computed without any factor for the seasons whose factor is estimated; from
those curves the factors follow, twice: at the speeds as read, then at true speed. They are applied
after. The statistics are in `pipeline.season_log`.
"""

import math
from collections.abc import Mapping
from typing import Final

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray
from pipeline.channels import BACK, OUT
from pipeline.recompute.budget import (
    FORCE_SD,
    estimate_files_log_sd,
    estimate_pure_error,
    estimate_scatter,
)
from pipeline.recompute.computed import Computed
from pipeline.recompute.plan import Plan
from pipeline.season_log import SeasonFactors, estimate_roughly, estimate_season_factors
from pipeline.season_log.archive import LOG, UNOBSERVED_SD, sort_tows
from pipeline.steps.calibration import gps_factor
from pipeline.tables.frames import get_dtypes
from pipeline.tables.keys import LINE
from pipeline.tables.season_log import TowInstruments

MIN_TOWS_OF_TYPE: Final = 5
"""Fewest anchored tows of a type, or calibrated tows, from which its own value is taken."""

MIN_BEND_VARIANCE: Final = 1e-6
"""Variance of the bend between boats of a type: none at all would leave nothing to divide by."""

USUAL_LOG_SCATTER: Final = 0.005
"""Standard deviation of ln y from tow to tow where too few are calibrated to show it (inferred)."""

MEDIAN_SQUARE: Final = 0.455
"""Median of the square of a standard normal number."""

INSTRUMENTS: Final = get_dtypes(TowInstruments, without=["method"])
"""What is estimated of a tow's instruments."""


def find_season_factors(c: Computed) -> SeasonFactors:
    """Estimate the log factors of all seasons, from tows computed without them.

    Tows of a line are compared at one true speed: its median declared speed. A first estimate, from
    the speeds as read, says what the logs read there. At those speeds themselves a log that is 6 %
    low would be compared at the edge of what was towed, and all would hang on the bend.

    Args:
        c: all tows under `leave_out_factor`.
    """
    first, ln_factor = estimate_roughly(make_observations(c, {}))
    return estimate_season_factors(make_observations(c, ln_factor), first)


def get_instruments(plan: Plan, rows: pl.DataFrame | None) -> pl.DataFrame:
    """Return what was estimated of each tow, as far as its steps ask for it.

    Args:
        rows: `SeasonFactors.tows` or rows of the table `tow_instruments`; None where nothing
            was estimated.

    Returns:
        A row per tow with the columns of `INSTRUMENTS`, null where nothing is known; such a
        load cell has the factor 1 and the zero 0.
    """
    own = plan.tows.frame.select("tow_id", "season", "log1_part")
    known = pl.DataFrame(schema=INSTRUMENTS) if rows is None else rows
    estimated = known.select(INSTRUMENTS.keys())
    joined = own.join(estimated, on="tow_id", how="left", maintain_order="left")
    # A tow that takes no part in the estimate had the instruments of its season all the same.
    of_season = pl.col("factor", "force_factor", "force_zero_n", "ln_sd")
    filled = joined.with_columns(of_season.fill_null(of_season.mean().over("season", "log1_part")))
    asked = pl.Series(plan.options.speed.correction == "estimated")
    return filled.with_columns(
        pl.when(asked).then("factor").alias("factor"),
        pl.col("force_factor").fill_null(1.0),
        pl.col("force_zero_n").fill_null(0.0),
    )


def make_observations(c: Computed, ln_factor: Mapping[str, float]) -> pl.DataFrame:
    """Return the rows that `estimate_season_factors` takes, of tows with a sound curve.

    Args:
        c: all tows under `leave_out_factor`.
        ln_factor: what is known of the ln factor of each tow's log.
    """
    tows = c.tows
    declared = tows.get_of_tows("declared_speed_m_s")
    line_speed = tows.frame.select(pl.col("declared_speed_m_s").median().over(LINE))
    true_speed = line_speed.to_series().to_numpy()
    reference_ln = np.array([ln_factor.get(name, 0.0) for name in tows.frame["tow_id"]])
    log_speed = true_speed * np.exp(-reference_ln)

    # Of the water alone: still air does not scale with the log's error.
    water = tows.group_by_tow(c.cw_kg_m - c.still_air_kg_m)
    points = curve.Points(c.points.speed_m_s, water, c.points.used & (water > 0))
    curves = curve.fit(points)
    errors = curve.covariance(points, curves, estimate_pure_error(c), log_speed)
    with_misfit = curve.covariance(points, curves, estimate_scatter(c, pooled=True), log_speed)
    cw_as_read = curves.cw_at(log_speed)
    is_sound = curves.converged & np.isfinite(cw_as_read) & (cw_as_read > 0)
    cw = np.where(is_sound, cw_as_read, 1.0)
    r = np.where(is_sound, curves.s_s2_m2 * log_speed**2, 0.0)
    q = r / (1.0 - r)

    # Random errors: scatter of the points; in combined tows, logs that differ; unmeasured wind. The
    # misfit of the hull is no error of its level, but one of its bend: at the speeds that another
    # log reads, the same hull has another.
    has_errors = is_sound & np.isfinite(errors.c0_variance_kg2_m2)
    log_sd = estimate_files_log_sd(c)
    ln_cw_by_log = 2.0 + 2.0 * q
    q_by_log = 2.0 * q * (1.0 + q)
    still_air = tows.mean(c.still_air_kg_m, c.used)
    wind_sd = np.where(tows.has_channel("wind"), 0.0, still_air * c.air.unrecorded_sd) / cw
    point_variance = np.where(has_errors, errors.c0_variance_kg2_m2 / cw**2, 1.0)
    ln_cw_sd = np.sqrt(point_variance + (ln_cw_by_log * log_sd) ** 2 + wind_sd**2)
    q_variance = np.maximum(errors.q_variance, with_misfit.q_variance)
    q_sd = np.hypot(np.where(has_errors, np.sqrt(q_variance), 1.0), q_by_log * log_sd)
    covariance = np.where(has_errors, errors.c0_q_covariance_kg_m / cw, 0.0)
    covariance = covariance + ln_cw_by_log * q_by_log * log_sd**2

    # A doubted tow says nothing of boats and logs; the others say what its Cw should have been.
    is_trusted = tows.trusted
    is_calibrated = c.speed.is_calibrated & is_trusted
    is_anchored = c.options.speed.is_calibrated
    gps_ln_ratio, gps_sd, has_gps = _estimate_gps_ratio(c)
    is_plain_gps = has_gps & ~is_anchored & is_trusted
    y = np.where(c.speed.is_calibrated, c.calibration_factor, 1.0)
    numbers = {
        "ln_cw": np.where(is_sound, np.log(cw), np.nan),
        "ln_cw_sd": np.where(is_trusted, ln_cw_sd, UNOBSERVED_SD),
        "q": q,
        "q_sd": np.where(is_trusted, q_sd, UNOBSERVED_SD),
        "ln_cw_q_cov": np.where(is_trusted, covariance, 0.0),
        "own_calibration_ln": np.where(is_calibrated, np.log(c.speed.log_factor * y), np.nan),
        "gps_ln_ratio": np.where(is_plain_gps, gps_ln_ratio, np.nan),
        "gps_sd": np.where(is_plain_gps, np.hypot(gps_sd, log_sd), np.nan),
        "reference_ratio": declared / true_speed,
        "reference_ln": reference_ln,
    }
    rows = tows.frame.select(
        "tow_id",
        pl.col(LINE),
        "boat_type",
        "season",
        "altered",
        "declared_speed_m_s",
        pl.col("weight_kg", "waterline_length_m").cast(pl.Float64),
        pl.col("tow_date").dt.ordinal_day().cast(pl.Float64).alias("day"),
        pl.col("log1_part").alias("part"),
        pl.Series("anchored", is_anchored),
        pl.Series("temperature_known", c.temperature.is_known),
        pl.Series("water_off_c", c.water_off_c),
        FORCE_SD.alias("force_sd"),
    ).with_columns(pl.DataFrame(numbers).fill_nan(None).get_columns())
    # A boat of which every tow is doubted stays as measured.
    is_observed = pl.col("ln_cw_sd") < UNOBSERVED_SD
    is_boat_observed = is_observed.any().over(LINE + ("state",))
    rows = sort_tows(rows.drop_nulls("ln_cw")).filter(is_boat_observed)
    return _add_calibrations(_add_kappa(rows.drop("state")))


def _estimate_gps_ratio(c: Computed) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Return ln(GPS / log) of each tow with runs both ways, its random part, and where known.

    The random part is the scatter of run ratios about their direction's mean, pooled over
    the tows with the same steps: one tow's six runs are too few.
    """
    tows, steps = c.tows, c.plan.which
    gps, log = c.means.gps_m_s, c.means.speed_m_s
    is_used = c.used & np.isfinite(gps)
    y, has_both_ways = gps_factor(gps, log, tows.direction, tows.tow, is_used, tows.size)
    ratio = np.where(is_used, gps, 1.0) / np.where(is_used, log, 1.0)
    square = np.zeros(len(c.plan.steps))
    dof = np.zeros(len(c.plan.steps))
    for way in (OUT, BACK):
        is_way = is_used & (tows.direction == way)
        deviation = np.where(is_way, ratio - tows.mean(ratio, is_way)[tows.tow], 0.0)
        square += np.bincount(steps[tows.tow], deviation**2, len(square))
        dof += np.bincount(steps, np.maximum(tows.count(is_way) - 1, 0), len(dof))
    run_sd = np.where(dof > 0, np.sqrt(square / np.maximum(dof, 1)), 1.0)
    sd = run_sd[steps] / np.sqrt(np.maximum(tows.count(is_used), 1))
    return np.log(np.where(has_both_ways, y, 1.0)), sd, has_both_ways


def _add_calibrations(rows: pl.DataFrame) -> pl.DataFrame:
    """Add what dGPS says of a log in its other tows: `others_calibration_ln` and its `_sd`.

    The mean of ln y over the tows of a season that are calibrated, and its standard deviation by
    the scatter within all such seasons; null where there are none.
    """
    ln_y = pl.col("own_calibration_ln")
    calibrated = rows.drop_nulls("own_calibration_ln")
    dof = calibrated.height - calibrated.select(LOG).n_unique()
    scatter = USUAL_LOG_SCATTER
    if dof >= MIN_TOWS_OF_TYPE:
        square = calibrated.select(((ln_y - ln_y.mean().over(LOG)) ** 2).sum()).item()
        scatter = math.sqrt(square / dof)
    count = ln_y.count().over(LOG)
    return rows.with_columns(
        ln_y.mean().over(LOG).alias("others_calibration_ln"),
        pl.when(count > 0).then(scatter / count.sqrt()).alias("others_calibration_sd"),
    )


def _add_kappa(rows: pl.DataFrame) -> pl.DataFrame:
    """Add `kappa`, the elasticity of the line's true curve, from the bend of its anchored tows.

    One tow's bend is uncertain, and boats of a type differ. So the mean of a line's own anchored
    tows is drawn towards its type (the fleet, where that has few) as far as its uncertainty is
    large against the spread between boats. Without this the difference between boats, times a log
    error of 5 %, passes for scatter of the log between tows.
    """
    q, deviation = pl.col("q"), pl.col("q") - pl.col("type_q")
    anchored = rows.filter("anchored", pl.col("q_sd") < UNOBSERVED_SD)
    source = anchored if anchored.height else rows
    types = (
        source.group_by("boat_type", maintain_order=True)
        .agg(q.median().alias("type_q"), pl.len())
        .filter(pl.col("len") >= MIN_TOWS_OF_TYPE)
        .drop("len")
    )
    fleet_q = pl.lit(source["q"].median(), pl.Float64)
    rows = rows.join(
        types, on="boat_type", how="left", nulls_equal=True, maintain_order="left"
    ).with_columns(pl.col("type_q").fill_null(fleet_q))

    anchored = rows.filter("anchored", pl.col("q_sd") < UNOBSERVED_SD)
    total = anchored.select((deviation**2).median() / MEDIAN_SQUARE).item()
    noise = anchored.select((pl.col("q_sd") ** 2).median()).item()
    between = MIN_BEND_VARIANCE if total is None else max(total - noise, MIN_BEND_VARIANCE)
    precision = pl.col("q_sd") ** -2.0
    lines = anchored.group_by(LINE, maintain_order=True).agg(
        shift=(deviation * precision).sum() / (precision.sum() + 1.0 / between)
    )
    return (
        rows.join(lines, on=LINE, how="left", maintain_order="left")
        .with_columns(kappa=2.0 + 2.0 * (pl.col("type_q") + pl.col("shift").fill_null(0.0)))
        .drop("type_q", "shift")
    )
