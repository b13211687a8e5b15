"""The results of a method as tables of the warehouse.

Arrays in, frames out; a number that is not known becomes null here, never NaN. What is computed
is in `pipeline.recompute.recompute`; its uncertainty, in `pipeline.recompute.budget`; what a
person should look at, in `pipeline.assessment.assess`.
"""

from dataclasses import dataclass

import numpy as np
import polars as pl
from numpy.typing import ArrayLike

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray
from pipeline.assessment.assess import add_status, assess
from pipeline.assessment.currents import estimate_currents
from pipeline.assessment.repeated_runs import choose_repeated_runs
from pipeline.method.definition import Method
from pipeline.method.options import Steps
from pipeline.quantiles import t_quantile
from pipeline.races.race import power_per_rower_w
from pipeline.recompute.anemometer import diagnose_anemometers
from pipeline.recompute.best import add_best_estimates
from pipeline.recompute.budget import (
    CURVE_SPEED_RATIOS,
    DECLARED,
    estimate_scatter,
    get_assumed,
    make_budget_inputs,
)
from pipeline.recompute.computed import Computed
from pipeline.season_log import SeasonFactors
from pipeline.season_log.diagnosis import DIAGNOSIS_SCHEMA
from pipeline.season_log.factors import NOT_SETTLED
from pipeline.tables.frames import get_dtypes
from pipeline.tables.season_log import (
    BestEstimateWeights,
    LogFactors,
    SeasonLinks,
    TowInstruments,
)
from pipeline.uncertainty.propagation import combine, make_budget


@dataclass(frozen=True)
class Recomputed:
    """The tables of one method, named as in the warehouse, and the season factors behind them.

    Attributes:
        factors: with their covariance, for the ensemble; None if the method estimates none.
    """

    run_points: pl.DataFrame
    curves: pl.DataFrame
    log_factors: pl.DataFrame
    assessments: pl.DataFrame
    uncertainty_budget: pl.DataFrame
    curve_points: pl.DataFrame
    tow_currents: pl.DataFrame
    season_links: pl.DataFrame
    season_diagnosis: pl.DataFrame
    tow_instruments: pl.DataFrame
    best_estimate_weights: pl.DataFrame
    factors: SeasonFactors | None


def build_tables(
    method: Method,
    c: Computed,
    estimated: SeasonFactors | None,
    with_bands: bool,
    crew_classes: pl.DataFrame,
) -> Recomputed:
    """Make the tables of a method; tows are assessed when all curves are there."""
    name = pl.lit(method.name).alias("method")

    def add_method(frame: pl.DataFrame) -> pl.DataFrame:
        return frame.select(name, pl.all())

    pooled = estimated is not None
    run_points = choose_repeated_runs(add_method(_make_run_points(c)))
    speed_ratios = CURVE_SPEED_RATIOS if with_bands else (DECLARED,)
    inputs = make_budget_inputs(c, estimated, speed_ratios).filter(pl.col("cw_kg_m").is_finite())
    declared_inputs = inputs.filter(speed_ratio=DECLARED)
    assumed = get_assumed(c, estimated)
    bounds = combine(inputs, assumed)
    at_v0 = make_budget(declared_inputs, assumed)
    curves = add_method(_make_curves(c, bounds.filter(speed_ratio=DECLARED), pooled))
    curves = add_best_estimates(curves, estimated, at_v0, declared_inputs)
    of_logs = pl.DataFrame(schema=DIAGNOSIS_SCHEMA) if estimated is None else estimated.diagnosis
    diagnosis = pl.concat([of_logs, diagnose_anemometers(c)]).sort("season", "part", "instrument")
    currents = estimate_currents(curves, run_points)
    assessments = assess(curves, run_points, c.tows.frame, diagnosis, currents, crew_classes)
    links, instruments, weights = _make_tables_of_all_tows(estimated)
    rejecting: list[tuple[int, str]] = []
    for season in c.tows.frame["season"].unique().sort():
        rejecting += [(season, check) for check in method.get_steps(season).assessment.reject]
    return Recomputed(
        run_points=run_points,
        curves=add_status(curves, assessments, rejecting),
        log_factors=add_method(_make_log_factors(c, estimated)),
        assessments=assessments,
        uncertainty_budget=at_v0.select(
            name,
            pl.exclude("speed_ratio", "dof"),
            pl.when(pl.col("dof").is_finite()).then("dof").alias("dof"),
        ),
        curve_points=add_method(_make_curve_points(inputs, bounds))
        if with_bands
        else pl.DataFrame(),
        tow_currents=currents,
        season_diagnosis=add_method(diagnosis),
        season_links=add_method(links),
        tow_instruments=add_method(instruments),
        best_estimate_weights=add_method(weights),
        factors=estimated,
    )


def _make_run_points(c: Computed) -> pl.DataFrame:
    means, windows, tow = c.means, c.windows, c.tows.tow
    has_window = windows["exists"]
    on_curve = curve.cw(c.curves.a_kg_m[tow], c.curves.s_s2_m2[tow], c.speed_m_s)
    log1 = np.where(has_window, means.speed_m_s, 1.0)
    has_limits = c.plan.run_options.run.is_trimmed
    has_wind, has_log2 = c.tows.has_channel("wind")[tow], c.tows.has_channel("log2")[tow]
    log2_ratio = means.log2_m_s / log1
    has_log2 &= log2_ratio != 1.0  # a run without its log 2 has log 1 in its place
    numbers = {
        "window_start_s": windows["start_s"],
        "window_end_s": windows["end_s"],
        "speed_factor": c.speed_factor,
        "speed_m_s": c.speed_m_s,
        "gross_cw_kg_m": c.refer_to_true_speed(means.gross_kg_m),
        "inertia_cw_kg_m": c.refer_to_true_speed(means.inertia_kg_m),
        "air_cw_kg_m": c.air_kg_m,
        "still_air_cw_kg_m": c.still_air_kg_m,
        "temperature_cw_kg_m": c.temperature.change_kg_m,
        "wind_coefficient_ahead": c.air.drag.ahead,
        "wind_coefficient_behind": c.air.drag.behind,
        "cw_kg_m": c.cw_kg_m,
        "cw_sd": c.refer_to_true_speed(means.sd_kg_m),
        "cw_seconds_sd_kg_m": c.refer_to_true_speed(means.seconds_sd_kg_m),
        "wind_m_s": np.where(has_wind, means.wind_m_s, np.nan),
        "wind_angle_deg": np.where(has_wind, means.wind_angle_deg, np.nan),
        "log2_ratio": np.where(has_log2, log2_ratio, np.nan),
        "ends_ratio": np.where(has_limits, windows["ends_ratio"], np.nan),
        "gps_ratio": means.gps_m_s / log1,
        "fitted_cw_kg_m": np.where(c.curves.converged[tow], on_curve, np.nan),
    }
    runs = c.tows.blocks.runs.select("tow_id", "run", "direction", "target_speed_ratio")
    return runs.with_columns(
        pl.Series("lost_s", c.tows.lost_s),
        pl.Series("cut_reason", windows["cut_reason"], pl.String),
        pl.Series("used", c.used),
        pl.Series("reason", c.reasons, pl.String),
    ).with_columns(_make_column(name, values, has_window) for name, values in numbers.items())


def _make_curves(c: Computed, bounds: pl.DataFrame, pooled: bool) -> pl.DataFrame:
    tows = c.tows.frame
    declared = c.tows.get_of_tows("declared_speed_m_s")
    cw = c.cw_at_declared
    sound = np.isfinite(cw)
    mine = tows.select("tow_id").join(bounds, on="tow_id", how="left", maintain_order="left")
    lo = mine["lo_ratio"].fill_null(np.nan).to_numpy()
    hi = mine["hi_ratio"].fill_null(np.nan).to_numpy()
    b_interval = curve.b_interval(c.points, c.free, estimate_scatter(c, pooled))
    safe_cw = np.where(sound, cw, 1.0)
    residual = np.sqrt(c.curves.rss_kg2_m2 / np.maximum(c.curves.n_points - 2, 1)) / safe_cw
    # A cap is the method's choice, and coefficients searched run by run leave no scatter.
    own_b = ~c.curves.b_capped & (c.options.wind.coefficients != "per_run")
    numbers = {
        "a_kg_m": c.curves.a_kg_m,
        "cw_kg_m": cw,
        "cw_lo_kg_m": cw * lo,
        "cw_hi_kg_m": cw * hi,
        "b_lo_m_s": np.where(own_b, b_interval.lo, np.nan),
        "b_hi_m_s": np.where(own_b, b_interval.hi, np.nan),
        "power_w": power_per_rower_w(safe_cw, declared, c.tows.get_of_tows("rowers")),
        "residual_sd_ratio": residual,
        "b_m_s": np.where(c.curves.b_determined, c.curves.b_m_s, np.nan),
    }
    facts = tows.select("tow_id", "fsn_no", "season", "rowers", "crew_class", "declared_speed_m_s")
    return facts.with_columns(
        _make_column(name, values, sound) for name, values in numbers.items()
    ).with_columns(
        _make_column("calibration_factor", c.calibration_factor, c.options.speed.is_calibrated),
        pl.Series("b_capped", c.curves.b_capped),
        pl.Series("runs_used", c.tows.count(c.used), pl.Int8),
    )


def _make_curve_points(inputs: pl.DataFrame, bounds: pl.DataFrame) -> pl.DataFrame:
    """Curves over the speeds at which they are valid, with the 95 % interval of Cw at each."""
    cw = pl.col("cw_kg_m")
    return inputs.join(bounds, on=["tow_id", "speed_ratio"], maintain_order="left").select(
        "tow_id",
        "speed_m_s",
        "cw_kg_m",
        cw_lo_kg_m=cw * pl.col("lo_ratio"),
        cw_hi_kg_m=cw * pl.col("hi_ratio"),
    )


def _make_log_factors(c: Computed, estimated: SeasonFactors | None) -> pl.DataFrame:
    """Return factor, interval and source of each season; of tows that have GPS, if any have.

    A tow's own factor is in `run_points.speed_factor`.
    """
    ln_factor = np.where(
        c.speed.is_calibrated, np.log(c.speed.log_factor * c.calibration_factor), np.nan
    )
    season, which = c.tows.get_of_tows("season"), c.plan.which
    rows = []
    for year in c.tows.frame["season"].unique().sort():
        first = which[season == year].min()
        if c.plan.steps[first].calibration.rule == "none":
            found = _find_season_factor(c.plan.steps[first], year, estimated)
        else:
            found = _average_factor(ln_factor[(season == year) & (which == first)])
        factor, lo, hi, source = found
        rows.append({"season": year, "factor": factor, "lo": lo, "hi": hi, "source": source})
    return pl.DataFrame(rows, get_dtypes(LogFactors, without=["method"]))


Factor = tuple[float, float | None, float | None, str]
"""A factor with its interval and source."""


def _find_season_factor(steps: Steps, season: int, estimated: SeasonFactors | None) -> Factor:
    """Return the factor where tows are not calibrated on GPS: estimated, prescribed or none."""
    is_asked = estimated is not None and steps.speed.correction == "estimated"
    if estimated is not None and is_asked and (known := estimated.get_season(season)) is not None:
        return known
    factor = steps.speed.prescribed
    if estimated is not None and estimated.is_refused(season):
        return factor, None, None, NOT_SETTLED
    return factor, None, None, "none" if factor == 1.0 else "prescribed"


def _average_factor(ln_factor: FloatArray) -> Factor:
    """Return the mean of tows that are calibrated on GPS, with a t interval; NaN are not."""
    known = ln_factor[np.isfinite(ln_factor)]
    if not (n := len(known)):
        return 1.0, None, None, "none"
    mean = float(known.mean())
    if n == 1:
        return float(np.exp(mean)), None, None, "gps"
    half = float(t_quantile(n - 1) * known.std(ddof=1) / np.sqrt(n))
    factor, lo, hi = np.exp([mean, mean - half, mean + half]).tolist()
    return factor, lo, hi, "gps"


def _make_tables_of_all_tows(
    estimated: SeasonFactors | None,
) -> tuple[pl.DataFrame, pl.DataFrame, pl.DataFrame]:
    """Return season links, instruments of tows and weights of best estimates.

    They are without rows where nothing was estimated.
    """
    links = pl.Schema(get_dtypes(SeasonLinks, without=["method"]))
    instruments = pl.Schema(get_dtypes(TowInstruments, without=["method"]))
    weights = pl.Schema(get_dtypes(BestEstimateWeights, without=["method"]))
    if estimated is None:
        return (
            pl.DataFrame(schema=links),
            pl.DataFrame(schema=instruments),
            pl.DataFrame(schema=weights),
        )
    return (
        estimated.factors.select(links.keys()).cast(links),
        estimated.tows.select(instruments.keys()).sort("tow_id"),
        estimated.weights,
    )


def _make_column(name: str, values: ArrayLike, known: BoolArray | bool) -> pl.Series:
    """Return a column of numbers, null where nothing is known or the number is infinite."""
    numbers = np.asarray(values, dtype=np.float64)
    sound = known & np.isfinite(numbers)
    column = pl.Series(name, np.where(sound, numbers, 0.0))
    return pl.select(pl.when(pl.Series(sound)).then(column).alias(name)).to_series()
