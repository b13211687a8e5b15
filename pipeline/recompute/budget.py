"""What the uncertainty budget of a tow needs, taken from what was computed.

A method with estimated season factors knows the whole archive: the scatter of its points is pooled
over a season. Any other method is taken at its word, tow by tow: its interval rests on the tow's
own points and holds if its log factors are right.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray
from pipeline.recompute.computed import Computed
from pipeline.season_log import SeasonFactors
from pipeline.tables.keys import LINE
from pipeline.uncertainty.misfit import fit_parabolas, shrink_to_lines
from pipeline.uncertainty.propagation import CURVE_PARAMETERS, Assumed, pool_scatter

DECLARED: Final = 1.0
"""The declared speed among speed ratios."""

CURVE_SPEED_RATIOS: Final = tuple(thousandths / 1000 for thousandths in range(850, 1151, 25))
"""Speeds of the points of a curve / declared speed: the range in which a curve is valid."""

MAX_R: Final = 0.9
"""r = (v/B)^2 beyond which a curve tells nothing."""

PARABOLA_PARAMETERS: Final = 3
"""Height, slope and bow of the residuals of a tow."""

USUAL_BEND: Final = 0.4
"""q where the archive is not asked for it (inferred: r of 0.3)."""

_LOAD_CELL_ERROR: Final = pl.col("load_cell_ratio") - 1.0
FORCE_SD: Final = (_LOAD_CELL_ERROR**2 + pl.col("load_cell_sd") ** 2).sqrt()
"""Standard uncertainty of a tow's force by the record of its load cell; null without one. The force
is not corrected by the record, so its error is part of the uncertainty (GUM F.2.4.5)."""


def get_assumed(c: Computed, factors: SeasonFactors | None) -> Assumed:
    """Return what remains assumed beside what the archive shows."""
    if factors is None:
        return Assumed()
    assumed = replace(Assumed(), wind_coefficient=estimate_wind_coefficient_sd(c))
    return assumed.replace_by_repeats(factors.tow_sd, factors.tow_zero_n, factors.calibration_sd)


def estimate_wind_coefficient_sd(c: Computed) -> float:
    """Return the uncertainty of the drag coefficient in air, as runs out and back show it.

    Where the coefficient is off by d, runs out and back of a tow differ by d (felt out - felt back)
    / Cw. d follows by least squares over all tows, its variance by the sandwich over tows (Huber
    1967), and both are drawn to the prior 0 ± `Assumed.wind_coefficient`. Nothing is corrected, so
    that d itself is part of the uncertainty (GUM, F.2.4.5).
    """
    residual, is_used, on_curve = _compute_residuals(c)
    tows = c.tows
    is_usable = is_used & (tows.trusted & tows.has_channel("wind"))[:, None]
    direction = tows.group_by_tow(tows.direction.astype(np.float64))
    is_out, is_back = is_usable & (direction > 0), is_usable & (direction < 0)
    felt_per_unit = tows.group_by_tow(c.refer_to_true_speed(c.means.air.ahead + c.means.air.behind))
    felt_ratio = felt_per_unit / np.where(is_used, on_curve, 1.0)
    has_both_ways = is_out.any(axis=1) & is_back.any(axis=1)
    difference = np.where(has_both_ways, _contrast(residual, is_out, is_back), 0.0)
    slope = np.where(has_both_ways, _contrast(felt_ratio, is_out, is_back), 0.0)

    prior_variance = Assumed().wind_coefficient ** 2
    information = (slope**2).sum()
    if information == 0.0:
        return Assumed().wind_coefficient
    error = (slope * difference).sum() / information
    variance = ((slope * (difference - slope * error)) ** 2).sum() / information**2
    shrinkage = prior_variance / (prior_variance + variance)
    return float(np.hypot(shrinkage * error, np.sqrt(shrinkage * variance)))


def _contrast(values: FloatArray, is_out: BoolArray, is_back: BoolArray) -> FloatArray:
    """Return the mean of (tows, points) values out less that of those back, (tows,)."""
    out = np.where(is_out, values, 0.0).sum(axis=1) / np.maximum(is_out.sum(axis=1), 1)
    back = np.where(is_back, values, 0.0).sum(axis=1) / np.maximum(is_back.sum(axis=1), 1)
    return np.asarray(out - back)


def estimate_scatter(c: Computed, pooled: bool) -> curve.Scatter:
    """Return the scatter of single run points: pooled over a season, or of each tow alone.

    Without a curve of its own a tow has no height to scale the scatter with: unknown, not 0. A
    doubted tow says nothing of the scatter of others.
    """
    if not pooled:
        return curve.own_scatter(c.free)
    residual, is_used, on_curve = _compute_residuals(c)
    return _pool_residuals(c, residual, is_used, on_curve, CURVE_PARAMETERS)


def estimate_pure_error(c: Computed) -> curve.Scatter:
    """Return the scatter of single run points that is no shape of the hull, pooled over a season.

    A hull lies off its hyperbola in all of its tows. That is the misfit of the budget and no
    scatter: what a parabola in speed takes out of the residuals of a tow is left out here (pure
    error: Draper & Smith 1998, ch. 2).
    """
    residual, is_used, on_curve = _compute_residuals(c)
    x = c.points.speed_m_s / c.tows.get_of_tows("declared_speed_m_s")[:, None] - 1.0
    design = np.where(is_used[..., None], np.stack([np.ones_like(x), x, x**2], axis=2), 0.0)
    parabola = (design @ (np.linalg.pinv(design) @ residual[..., None]))[..., 0]
    return _pool_residuals(c, residual - parabola, is_used, on_curve, PARABOLA_PARAMETERS)


def _pool_residuals(
    c: Computed, residual: FloatArray, is_used: BoolArray, on_curve: FloatArray, parameters: int
) -> curve.Scatter:
    """Return the scatter of residuals pooled over seasons, as a variance of Cw of each tow."""
    is_trusted = is_used & c.tows.trusted[:, None]
    sd_ratio, dof = pool_scatter(residual, is_trusted, c.season_group, parameters)
    is_known = np.isfinite(sd_ratio) & is_used.any(axis=1)
    mean_cw = np.where(is_used, on_curve, 0.0).sum(axis=1) / np.maximum(is_used.sum(axis=1), 1)
    variance = (np.where(is_known, sd_ratio, 0.0) * mean_cw) ** 2
    return curve.Scatter(variance, np.where(is_known, dof, 0.0))


def _compute_residuals(c: Computed) -> tuple[FloatArray, BoolArray, FloatArray]:
    """Return (point - curve) / curve, which points count, and the curve; (tows, points) each."""
    speed = np.where(c.points.used, c.points.speed_m_s, 0.0)
    on_curve = curve.cw(c.free.a_kg_m[:, None], c.free.s_s2_m2[:, None], speed)
    is_used = c.points.used & np.isfinite(on_curve) & c.free.converged[:, None]
    ratio = c.points.cw_kg_m / np.where(is_used, on_curve, 1.0) - 1.0
    return np.where(is_used, ratio, 0.0), is_used, on_curve


def estimate_files_log_sd(c: Computed) -> FloatArray:
    """Return the sd of a combined tow's mean ln log factor by how its files differ, (tows,).

    Each file has a log of its own. What two of them differ by says how far their mean may be off:
    half as far. Pooled over the season's combined tows; 0 for others, and where each is calibrated.
    """
    residual, is_used, _ = _compute_residuals(c)
    is_second = c.tows.group_by_tow(c.tows.is_in_second_file.astype(np.float64)) > 0
    in_first, in_second = is_used & ~is_second, is_used & is_second
    is_combined = in_first.any(axis=1) & in_second.any(axis=1) & ~c.speed.is_calibrated
    first_mean = (residual * in_first).sum(axis=1) / np.maximum(in_first.sum(axis=1), 1)
    second_mean = (residual * in_second).sum(axis=1) / np.maximum(in_second.sum(axis=1), 1)
    r = np.clip(c.free.s_s2_m2 * c.tows.get_of_tows("declared_speed_m_s") ** 2, -1.0, MAX_R)
    kappa = 2.0 / (1.0 - r)
    ln_log_difference = np.where(is_combined, (second_mean - first_mean) / kappa, 0.0)
    combined_tows = np.maximum(np.bincount(c.season_group, is_combined), 1)
    mean_square = np.bincount(c.season_group, ln_log_difference**2) / combined_tows
    return np.where(is_combined, 0.5 * np.sqrt(mean_square[c.season_group]), 0.0)


def make_budget_inputs(
    c: Computed, factors: SeasonFactors | None, speed_ratios: Sequence[float]
) -> pl.DataFrame:
    """Return what the budget of every tow needs, at some speeds.

    Away from the declared speed the random part grows, and a speed error acts through the
    elasticity there.

    Args:
        c: all tows under a method.
        factors: its season factors, if it has estimated ones.
        speed_ratios: those speeds / declared speed.

    Returns:
        A row per tow and speed with the columns of `propagation.make_budget`; `speed_m_s`,
        `cw_kg_m`, NaN from B on; `misfit`, hull over curve less 1 by all tows of the boat, and
        `misfit_variance`, 0 where no season factors are estimated.
    """
    scatter = estimate_scatter(c, pooled=False) if factors is None else estimate_pure_error(c)
    tows = _make_inputs_at_any_speed(c, factors, scatter)
    misfit, misfit_variance = _estimate_boat_misfit(c, np.array(speed_ratios))
    if factors is None:
        misfit, misfit_variance = np.zeros_like(misfit), np.zeros_like(misfit_variance)
    at_speeds = [
        tows.with_columns(
            speed_ratio=pl.lit(speed_ratio),
            cw_kg_m=pl.Series(c.cw_at(speed_ratio)),
            random_ratio=pl.Series(_compute_random_ratio(c, scatter, speed_ratio)),
            misfit=pl.Series(misfit[:, place]),
            misfit_variance=pl.Series(misfit_variance[:, place]),
        )
        for place, speed_ratio in enumerate(speed_ratios)
    ]
    cw, bend, ratio = pl.col("cw_kg_m"), pl.col("bend"), pl.col("speed_ratio")
    r = (bend / (1.0 + bend) * ratio**2).clip(-1.0, MAX_R)
    return pl.concat(at_speeds).with_columns(
        speed_m_s=ratio * pl.col("declared_speed_m_s"),
        force_n=cw * (ratio * pl.col("declared_speed_m_s")) ** 2,
        kappa=2.0 / (1.0 - r),
        misfit_ratio=(pl.col("misfit") ** 2 + pl.col("misfit_variance")).sqrt(),
        air_ratio=pl.col("net_air_kg_m") / cw,
        air_per_coefficient=pl.col("air_per_coefficient_kg_m") / cw,
        still_air_ratio=pl.col("still_air_kg_m") / cw,
        water_change_ratio=pl.col("water_change_kg_m") / cw,
    )


def _estimate_boat_misfit(c: Computed, speed_ratios: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return misfit of each tow's hull and its variance, (tows, speeds) each."""
    residual, is_used, _ = _compute_residuals(c)
    tows = c.tows
    by_tow = fit_parabolas(
        residual,
        is_used & tows.trusted[:, None],
        c.points.speed_m_s / tows.get_of_tows("declared_speed_m_s")[:, None],
        tows.group_by_tow(tows.direction.astype(np.float64)),
        tows.group_by_tow(tows.target_speed_ratio),
        speed_ratios,
        c.plan.which,
    )
    line = tows.frame.select(pl.struct(LINE).rank("dense") - 1).to_series()
    return shrink_to_lines(by_tow, line.to_numpy().astype(np.int64))


def _compute_random_ratio(c: Computed, scatter: curve.Scatter, speed_ratio: float) -> FloatArray:
    """Return the relative random uncertainty of Cw at a speed / declared speed, (tows,)."""
    speed = speed_ratio * c.tows.get_of_tows("declared_speed_m_s")
    variance = curve.covariance(c.points, c.free, scatter, speed).c0_variance_kg2_m2
    cw = c.free.cw_at(speed)
    is_known = np.isfinite(cw) & np.isfinite(variance)
    sd = np.sqrt(np.where(is_known, variance, 1.0))
    return np.where(is_known, sd / np.where(is_known, cw, 1.0), 1.0)


def _make_inputs_at_any_speed(
    c: Computed, factors: SeasonFactors | None, scatter: curve.Scatter
) -> pl.DataFrame:
    """Return what the budget needs of each tow as far as it is the same at any speed."""
    tows = c.tows
    has_log = np.isfinite(c.get_estimated("ln_sd"))
    usual_bend = np.full(tows.size, USUAL_BEND)
    tow_log_sd = np.zeros(tows.size)
    if factors is not None:
        usual_bend = _find_median_bends(c)
        log_sd = np.hypot(
            factors.get_tow_log_sd(tows.get_of_tows("season")), estimate_files_log_sd(c)
        )
        tow_log_sd = np.where(c.speed.is_calibrated, 0.0, log_sd)
    bend = np.where(np.isfinite(c.get_estimated("bend")), c.get_estimated("bend"), usual_bend)

    net_air = c.air_kg_m - c.still_air_kg_m
    # A larger coefficient takes more off as felt and puts more back for still air.
    still_per_unit = c.still_air_kg_m / np.maximum(c.air.drag.still, 1e-9)
    felt_per_unit = c.refer_to_true_speed(c.means.air.ahead + c.means.air.behind)
    return tows.frame.select(
        "tow_id",
        "season",
        "declared_speed_m_s",
        part="log1_part",
        random_dof=pl.Series(scatter.dof),
        bend=pl.Series(bend),
        calibrated=pl.Series(c.speed.is_calibrated),
        askew_ratio=pl.Series(c.get_estimated("askew_ratio")).fill_nan(None),
        log_sd=pl.Series(np.where(has_log, c.get_estimated("ln_sd"), 0.0)),
        tow_log_sd=pl.Series(tow_log_sd),
        net_air_kg_m=pl.Series(tows.mean(net_air, c.used)),
        air_per_coefficient_kg_m=pl.Series(tows.mean(still_per_unit - felt_per_unit, c.used)),
        still_air_kg_m=pl.Series(tows.mean(c.still_air_kg_m, c.used)),
        wind_ln_sd=pl.Series(c.air.anemometer_ln_sd).fill_nan(None),
        wind_measured=pl.Series(tows.has_channel("wind")),
        unmeasured_wind=pl.Series(c.air.unrecorded_sd),
        temperature_known=pl.Series(c.temperature.is_known),
        water_off_c=pl.Series(c.water_off_c),
        mass_ln_sd=pl.col("mass_ln_sd").fill_null(0.0),
        water_change_kg_m=pl.Series(tows.mean(c.temperature.change_kg_m, c.used)),
        force_sd=FORCE_SD,
    )


def _find_median_bends(c: Computed) -> FloatArray:
    """Return the median of q at the declared speed over the tows with the same steps, (tows,)."""
    r = c.free.s_s2_m2 * c.tows.get_of_tows("declared_speed_m_s") ** 2
    is_known = c.free.converged & (r > 0.0) & (r < 1.0)
    q = pl.Series(np.where(is_known, r / np.where(is_known, 1.0 - r, 1.0), np.nan)).fill_nan(None)
    bends = pl.DataFrame({"steps": c.plan.which, "q": q})
    median = bends.select(pl.col("q").median().over("steps").fill_null(USUAL_BEND))
    return median.to_series().to_numpy()
