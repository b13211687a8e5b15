"""The uncertainty of a curve: the random part from its points, and the budget of every component.

Here what was computed is given to the formulas of `pipeline.uncertainty.propagation`. A method
with estimated season factors knows the whole archive: its scatter is pooled over a season. Any
other method is taken at its word, tow by tow: its interval rests on the tow's own points and holds
if its log factors are right.
"""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Final

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray
from pipeline.recompute.computed import Computed
from pipeline.season_log import SeasonFactors
from pipeline.uncertainty.misfit import Departure, departure_of_boats
from pipeline.uncertainty.propagation import Assumed, residual_scatter

DECLARED: Final = 1.0
"""The declared speed among speed ratios."""

CURVE_SPEED_RATIOS: Final = tuple(thousandths / 1000 for thousandths in range(850, 1151, 25))
"""Speeds of the points of a curve / declared speed: the range in which a curve is valid, with
`DECLARED` in the middle."""

MOST_BENT: Final = 0.9
"""r beyond which a curve tells nothing."""

USUAL_BEND: Final = 0.4
"""q where the archive is not asked for it (inferred: r of 0.3)."""

_OFF: Final = pl.col("load_cell_ratio") - 1.0
FORCE_SD: Final = (_OFF**2 + pl.col("load_cell_sd") ** 2).sqrt()
"""Standard uncertainty of a tow's force by the record of its load cell; null without one.

The force is not corrected by the record, so what the cell was off is part of it (GUM F.2.4.5)."""


def scatter_of(c: Computed, pooled: bool) -> curve.Scatter:
    """Scatter of single run points: pooled over the tows of a season, or of each tow alone.

    Without a curve of its own a tow has no height to scale the scatter with: unknown, not 0.
    """
    if not pooled:
        return curve.own_scatter(c.free)
    residual, used, on_curve = _residuals(c)
    ratio, dof = residual_scatter(residual, used, c.of_season)
    known = np.isfinite(ratio) & used.any(axis=1)
    height = np.where(used, on_curve, 0.0).sum(axis=1) / np.maximum(used.sum(axis=1), 1)
    return curve.Scatter((np.where(known, ratio, 0.0) * height) ** 2, np.where(known, dof, 0.0))


def _residuals(c: Computed) -> tuple[FloatArray, BoolArray, FloatArray]:
    """(point - curve) / curve, which points count, and the curve there, (tows, points) each."""
    on_curve = curve.cw(
        c.free.a_kg_m[:, None],
        c.free.s_s2_m2[:, None],
        np.where(c.points.used, c.points.speed_m_s, 0.0),
    )
    used = c.points.used & np.isfinite(on_curve) & c.free.converged[:, None]
    ratio = np.where(used, c.points.cw_kg_m / np.where(used, on_curve, 1.0) - 1.0, 0.0)
    return ratio, used, on_curve


def files_log_sd(c: Computed) -> FloatArray:
    """Standard deviation of a combined tow's mean ln log factor, by how its files differ; (tows,).

    Each file has a log of its own. What two of them differ by says how far their mean may be off:
    half as far. Pooled over the season's combined tows; 0 for others, and where each is calibrated.
    """
    ratio, used, _ = _residuals(c)
    second = c.tows.by_tow(c.tows.in_second_file.astype(np.float64)) > 0
    files = [used & ~second, used & second]
    combined = files[0].any(axis=1) & files[1].any(axis=1) & ~c.calibrated
    of_first, of_second = (
        np.where(mine, ratio, 0.0).sum(axis=1) / np.maximum(mine.sum(axis=1), 1) for mine in files
    )
    r = np.clip(c.free.s_s2_m2 * c.tows.of_tow("declared_speed_m_s") ** 2, -1.0, MOST_BENT)
    apart = np.where(combined, of_second - of_first, 0.0) * (1.0 - r) / 2.0
    count = np.maximum(np.bincount(c.of_season, combined), 1)
    square = np.bincount(c.of_season, apart**2) / count
    return np.where(combined, 0.5 * np.sqrt(square[c.of_season]), 0.0)


def facts_of(
    c: Computed, estimated: SeasonFactors | None, speed_ratios: Sequence[float]
) -> pl.DataFrame:
    """What the budget of every tow asks, at some speeds.

    Away from the declared speed the random part grows, and a speed error acts through the
    elasticity there.

    Args:
        c: all tows under a method.
        estimated: its season factors, if it has estimated ones.
        speed_ratios: those speeds / declared speed.

    Returns:
        A row per tow and speed with the columns of `propagation.budget`; `speed_m_s`, `cw_kg_m`,
        NaN from B on; `misfit`, hull over curve less 1 by all tows of the boat, and
        `misfit_variance`, 0 where no season factors are estimated: such a method is taken at its
        word.
    """
    scatter = scatter_of(c, pooled=estimated is not None)
    tows = _terms_of_tows(c, estimated, scatter)
    boat = tows["fsn_no"].rank("dense").to_numpy().astype(np.int64) - 1
    asked = 0.0 if estimated is None else 1.0
    departures = departure_of_boats(_departure(c, np.array(speed_ratios)), boat)
    misfit, variance = (asked * part for part in departures)
    cw, bend, ratio = pl.col("cw_kg_m"), pl.col("bend"), pl.col("speed_ratio")
    r = (bend / (1.0 + bend) * ratio**2).clip(-1.0, MOST_BENT)
    return pl.concat(
        tows.with_columns(
            speed_ratio=pl.lit(speed),
            cw_kg_m=pl.Series(c.cw_at(speed)),
            random_ratio=pl.Series(_random_ratio(c, scatter, speed)),
            misfit=pl.Series(misfit[:, place]),
            misfit_variance=pl.Series(variance[:, place]),
        )
        for place, speed in enumerate(speed_ratios)
    ).with_columns(
        speed_m_s=ratio * pl.col("declared_speed_m_s"),
        kappa=2.0 / (1.0 - r),
        misfit_ratio=(pl.col("misfit") ** 2 + pl.col("misfit_variance")).sqrt(),
        air_ratio=pl.col("net_air_kg_m") / cw,
        air_per_coefficient=pl.col("air_per_coefficient_kg_m") / cw,
        still_air_ratio=pl.col("still_air_kg_m") / cw,
        water_change_ratio=pl.col("water_change_kg_m") / cw,
    )


def _departure(c: Computed, speed_ratios: FloatArray) -> Departure:
    """How far the points of each tow lie from its curve."""
    tows, (ratio, used, _) = c.tows, _residuals(c)
    towed = c.points.speed_m_s / tows.of_tow("declared_speed_m_s")[:, None]
    way = tows.by_tow(tows.direction.astype(np.float64))
    counts, target = used & tows.trusted[:, None], tows.by_tow(tows.target_speed_ratio)
    return Departure.of(ratio, counts, towed, way, target, speed_ratios, c.plan.which)


def _random_ratio(c: Computed, scatter: curve.Scatter, speed_ratio: float) -> FloatArray:
    """Relative random uncertainty of Cw at a speed / declared speed, shape (tows,)."""
    speed = speed_ratio * c.tows.of_tow("declared_speed_m_s")
    errors = curve.covariance(c.points, c.free, scatter, speed)
    cw = c.free.cw_at(speed)
    known = np.isfinite(cw) & np.isfinite(errors.c0_variance_kg2_m2)
    variance = np.where(known, errors.c0_variance_kg2_m2, 1.0)
    return np.where(known, np.sqrt(variance) / np.where(known, cw, 1.0), 1.0)


def _terms_of_tows(
    c: Computed, factors: SeasonFactors | None, scatter: curve.Scatter
) -> pl.DataFrame:
    """What `propagation.budget` asks of tows, as far as it is the same at any speed."""
    tows = c.tows
    estimated = np.isfinite(c.estimated("ln_sd"))
    usual = np.full(tows.size, USUAL_BEND) if factors is None else _median_bends(c)
    bend = np.where(np.isfinite(c.estimated("bend")), c.estimated("bend"), usual)
    wanders = 0.0 if factors is None else factors.tow_log_sd_of(tows.of_tow("season"))
    is_wandering = (factors is not None) & ~c.calibrated
    # One coefficient for the archive is found by the same anemometer: its scale cancels in the air
    # taken off, and only what is put back for still air has it.
    by_archive = c.plan.of_runs("wind.coefficients") == "archive"
    net_air = tows.mean(np.where(by_archive, 0.0, c.air_kg_m) - c.still_air_kg_m, c.used)
    assumed = Assumed()
    if factors is not None:
        assumed = assumed.beside_repeats(factors.tow_sd, factors.calibration_sd)
    of_archive = np.isfinite(c.coefficient_sd)
    own = {
        "unmeasured_wind": c.expected_wind_sd,
        "wind_coefficient": np.where(of_archive, c.coefficient_sd, assumed.wind_coefficient),
    }
    # A larger coefficient takes more off as felt and puts more back for still air.
    still_unit = c.still_air_kg_m / np.maximum(c.air.still, 1e-9)
    felt_unit = c.by_true_speed(c.means.air.ahead + c.means.air.behind)
    return tows.frame.select(
        "tow_id",
        "fsn_no",
        "season",
        "declared_speed_m_s",
        part="log1_part",
        random_dof=pl.Series(scatter.dof),
        bend=pl.Series(bend),
        calibrated=pl.Series(c.calibrated),
        askew_ratio=pl.Series(c.estimated("askew_ratio")).fill_nan(None),
        log_sd=pl.Series(np.where(estimated, c.estimated("ln_sd"), 0.0)),
        log_dof=pl.Series(np.where(estimated, c.estimated("dof"), np.inf)),
        tow_log_sd=pl.Series(np.where(is_wandering, np.hypot(wanders, files_log_sd(c)), 0.0)),
        net_air_kg_m=pl.Series(net_air),
        wind_ln_sd=pl.Series(c.wind_ln_sd).fill_nan(None),
        air_per_coefficient_kg_m=pl.Series(tows.mean(still_unit - felt_unit, c.used)),
        wind_measured=pl.Series(tows.measured("wind")),
        still_air_kg_m=pl.Series(tows.mean(c.still_air_kg_m, c.used)),
        temperature_known=pl.Series(c.temperature_known),
        water_off_c=pl.Series(c.water_off_c),
        mass_ln_sd=pl.col("mass_ln_sd").fill_null(0.0),
        water_change_kg_m=pl.Series(tows.mean(c.temperature_kg_m, c.used)),
        force_sd=FORCE_SD,
        **{name: pl.lit(size) for name, size in asdict(assumed).items() if name not in own},
        **{name: pl.Series(size) for name, size in own.items()},
    )


def _median_bends(c: Computed) -> FloatArray:
    """Median of q at the declared speed over the tows with the same steps, (tows,)."""
    r = c.free.s_s2_m2 * c.tows.of_tow("declared_speed_m_s") ** 2
    known = c.free.converged & (r > 0.0) & (r < 1.0)
    q = pl.Series(np.where(known, r / np.where(known, 1.0 - r, 1.0), np.nan)).fill_nan(None)
    bends = pl.DataFrame({"which": c.plan.which, "q": q})
    median = bends.select(pl.col("q").median().over("which").fill_null(USUAL_BEND))
    return median.to_series().to_numpy()
