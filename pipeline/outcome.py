"""The outcome of a method as tables: `run_points`, `curves`, `log_factors`, `assessments`.

Arrays in, frames out; a number that is not known becomes null here, never NaN. What is computed
stands in `pipeline.recompute`; `pipeline.assessment` makes the tables' last, `assessments`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import polars as pl
from numpy.typing import ArrayLike

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray
from pipeline.assessment import assess, with_status
from pipeline.batch import Batch
from pipeline.method import Method, Steps
from pipeline.race import power_per_rower_w
from pipeline.speed import prescribed_factor
from pipeline.steady import Windows
from pipeline.wind import mean_wind_angle_deg


@dataclass(frozen=True)
class Recomputed:
    """The tables of one method, named as in the warehouse."""

    run_points: pl.DataFrame
    curves: pl.DataFrame
    log_factors: pl.DataFrame
    assessments: pl.DataFrame


@dataclass(frozen=True)
class Outcome:
    """A batch with all that a method found out about it.

    Arrays are of shape (runs,), but for `known_factor`, `calibration_factor`,
    `temperature_known` and the curves, which are of shape (tows,).
    """

    batch: Batch
    steps: Steps
    windows: Windows
    reasons: np.ndarray[tuple[int, ...], np.dtype[np.str_]]
    known_factor: FloatArray
    calibration_factor: FloatArray
    speed_m_s: FloatArray
    speed_factor: FloatArray
    gross_kg_m: FloatArray
    sd_kg_m: FloatArray
    inertia_kg_m: FloatArray
    air_kg_m: FloatArray
    still_air_kg_m: FloatArray
    temperature_kg_m: FloatArray
    temperature_known: BoolArray
    ahead: FloatArray
    behind: FloatArray
    cw_kg_m: FloatArray
    points: curve.Points
    free: curve.Curves
    curves: curve.Curves

    @property
    def used(self) -> BoolArray:
        """Runs that count."""
        return np.asarray(self.reasons == "")


def as_tables(method: Method, tows: pl.DataFrame, outcomes: Sequence[Outcome]) -> Recomputed:
    """The tables of a method from its batches; tows are assessed when all curves are there."""
    name = pl.lit(method.name).alias("method")

    def together(frames: list[pl.DataFrame]) -> pl.DataFrame:
        return pl.concat(frames).select(name, pl.all())

    run_points = together([_run_points(o) for o in outcomes])
    curves = together([_curves(o) for o in outcomes])
    assessments = assess(curves, run_points, tows)
    rejecting = [
        (season, check)
        for season in tows["season"].unique().sort()
        for check in method.for_season(season).assessment.reject
    ]
    return Recomputed(
        run_points=run_points,
        curves=with_status(curves, assessments, rejecting),
        log_factors=together([_log_factors(o) for o in outcomes]),
        assessments=assessments,
    )


def _run_points(o: Outcome) -> pl.DataFrame:
    blocks, mask, found = o.batch.blocks, o.windows.mask, o.windows.found
    tow = o.batch.tow
    on_curve = curve.cw(o.curves.a_kg_m[tow], o.curves.s_s2_m2[tow], o.speed_m_s)
    log1 = np.where(found, blocks.mean("log1_v", mask), 1.0)
    gps_samples = blocks.total("gps_n", mask)
    gps = blocks.total("gps", mask) / np.maximum(gps_samples, 1.0)
    numbers = {
        "window_start_s": o.windows.start_s,
        "window_end_s": o.windows.end_s,
        "speed_factor": o.speed_factor,
        "speed_m_s": o.speed_m_s,
        "gross_cw_kg_m": o.gross_kg_m,
        "inertia_cw_kg_m": o.inertia_kg_m,
        "air_cw_kg_m": o.air_kg_m,
        "still_air_cw_kg_m": o.still_air_kg_m,
        "temperature_cw_kg_m": o.temperature_kg_m,
        "wind_coefficient_ahead": o.ahead,
        "wind_coefficient_behind": o.behind,
        "cw_kg_m": o.cw_kg_m,
        "cw_sd": o.sd_kg_m,
        "wind_m_s": blocks.mean("wind_v", mask),
        "wind_angle_deg": mean_wind_angle_deg(blocks, mask),
        "log2_ratio": blocks.mean("log2_v", mask) / log1,
    }
    return blocks.runs.select("tow_id", "run", "direction", "target_speed_ratio").with_columns(
        *(_column(name, values, found) for name, values in numbers.items()),
        _column("gps_ratio", gps / log1, found & (gps_samples > 0)),
        _column("fitted_cw_kg_m", on_curve, found & o.curves.converged[tow]),
        pl.Series("cut_reason", o.windows.reasons, pl.String),
        pl.Series("used", o.used),
        pl.Series("reason", o.reasons, pl.String),
    )


def _curves(o: Outcome) -> pl.DataFrame:
    tows = o.batch.tows
    declared = o.batch.of_tow("declared_speed_m_s")
    cw = o.curves.cw_at(declared)
    sound = o.curves.converged & np.isfinite(cw)
    scatter = curve.own_scatter(o.free)
    errors = curve.covariance(o.points, o.free, scatter, declared)
    cw_interval = curve.cw_interval(o.curves, errors, scatter.dof, declared)
    b_interval = curve.b_interval(o.points, o.free, scatter)
    safe_cw = np.where(sound, cw, 1.0)
    residual = np.sqrt(o.curves.rss_kg2_m2 / np.maximum(o.curves.n_points - 2, 1)) / safe_cw
    numbers = {
        "a_kg_m": o.curves.a_kg_m,
        "cw_kg_m": cw,
        "cw_lo_kg_m": cw_interval.lo,
        "cw_hi_kg_m": cw_interval.hi,
        "b_lo_m_s": b_interval.lo,
        "b_hi_m_s": b_interval.hi,
        "power_w": power_per_rower_w(safe_cw, declared, o.batch.of_tow("rowers")),
        "residual_sd_ratio": residual,
    }
    return tows.select(
        "tow_id", "fsn_no", "season", "rowers", "crew_class", "declared_speed_m_s"
    ).with_columns(
        *(_column(name, values, sound) for name, values in numbers.items()),
        _column("b_m_s", o.curves.b_m_s, sound & o.curves.b_determined),
        _column("calibration_factor", o.calibration_factor, _calibrated(o)),
        pl.Series("b_capped", o.curves.b_capped),
        pl.Series("runs_used", o.batch.count(o.used), pl.Int8),
    )


def _calibrated(o: Outcome) -> BoolArray:
    return np.full(o.batch.size, o.steps.calibration.rule != "none")


def _log_factors(o: Outcome) -> pl.DataFrame:
    """The season's factor; a tow's own percentage stands in `run_points.speed_factor`."""
    seasons = o.batch.tows["season"].unique().sort()
    none = pl.Series([None] * len(seasons), dtype=pl.Float64)
    return pl.DataFrame(
        {
            "season": seasons,
            "factor": prescribed_factor(o.steps.speed, np.full(len(seasons), np.nan)),
            "lo": none,
            "hi": none,
            "source": [o.steps.speed.correction] * len(seasons),
        }
    )


def _column(name: str, values: ArrayLike, known: BoolArray) -> pl.Series:
    """A column of numbers, null where nothing is known or the number is infinite."""
    numbers = np.asarray(values, dtype=np.float64)
    sound = known & np.isfinite(numbers)
    column = pl.Series(name, np.where(sound, numbers, 0.0))
    return pl.select(pl.when(pl.Series(sound)).then(column).alias(name)).to_series()
