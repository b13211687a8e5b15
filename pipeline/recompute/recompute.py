"""Recompute: every tow under one method, from blocks to curves.

Here the steps are put in their order; each step's formulas are in its own module and the tables
are filled in `pipeline.recompute.results`. The order is: steady window, means, speed correction,
runs that count, calibration, corrections of the coefficient, wind coefficients, curve. What is
searched over the whole archive is found first and applied after. Nothing here knows a season: the
method says what holds when.
"""

from dataclasses import replace

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray, StrArray
from pipeline.blocks.run_blocks import RunBlocks
from pipeline.method.definition import Method
from pipeline.recompute.anemometer import correct_anemometers
from pipeline.recompute.computed import Coefficients, Computed
from pipeline.recompute.plan import Plan, without_factor
from pipeline.recompute.results import Recomputed, as_tables
from pipeline.recompute.run_cache import RunCache
from pipeline.recompute.season_factors import find_season_factors, instruments_of
from pipeline.run_reasons import ABOVE_TARGET, NO_STEADY_WINDOW, NOT_CALIBRATED, NOT_SELECTED
from pipeline.season_log import SeasonFactors
from pipeline.steps.calibration import gps_factor_of_files
from pipeline.steps.resistance import accelerated_mass_kg, run_means, temperature_change_kg_m
from pipeline.steps.speed import log_factor
from pipeline.steps.target import above_target
from pipeline.steps.wind import nearest_coefficients
from pipeline.uncertainty.propagation import Assumed

PER_RUN_ITERATIONS = 4
"""The old tool printed "4 iteraties" (presentation 2015, screens of Razende Snol)."""


ARCHIVE_GRID = np.linspace(0.0, 1.2, 13)

FEWEST_WINDS = 10
"""Tows with an anemometer from which those without learn (inferred)."""


def recompute(
    method: Method,
    tows: pl.DataFrame,
    blocks: RunBlocks,
    cache: RunCache | None = None,
    with_bands: bool = True,
) -> Recomputed:
    """Run points, curves, log factors and assessments of all tows under a method.

    Args:
        tows: rows of the warehouse's `tows`, with `boat_type` where it is known, so that a tow can
            be compared with like boats.
        blocks: their runs; `blocks.runs` has the columns of `tow_runs`.
        cache: what was found before of the same tows; added to.
        with_bands: make `curve_points`, a tenth of the work; without, it is empty.

    Raises:
        MissingKnowledgeError: the method says nothing about a season of `tows`.
    """
    plan = Plan.of(method, tows, blocks, cache)
    estimated = season_factors(plan) if method.estimates_logs else None
    computed = evaluate(plan, None if estimated is None else estimated.tows)
    return as_tables(method, computed, estimated, with_bands)


def season_factors(plan: Plan) -> SeasonFactors | None:
    """The log factors that the given steps ask to estimate, and how far tows scatter.

    None if not a single tow has a curve from which to estimate.
    """
    as_read = evaluate(plan.changed(without_factor))
    if not (np.isfinite(as_read.cw_at_declared) & as_read.tows.trusted).any():
        return None
    return find_season_factors(as_read)


def evaluate(plan: Plan, instruments: pl.DataFrame | None = None) -> Computed:
    """What the given steps make of the tows.

    Args:
        plan: what is searched over the archive is searched over its tows.
        instruments: rows of the table `tow_instruments`, for steps that ask for an estimate.
    """
    read = _prepare(plan, instruments_of(plan, instruments))
    return _with_expected_wind(_with_coefficients(correct_anemometers(read)))


def _with_expected_wind(c: Computed) -> Computed:
    """The wind that tows without an anemometer must have had, by those with one, where it is asked.

    Wind along the course adds more on one way than it takes off on the other, so that a tow whose
    wind nobody measured comes out too high.
    """
    asked = c.expects_unrecorded
    known = c.wind_ratio()[asked]
    known = known[np.isfinite(known)]
    if len(known) < FEWEST_WINDS:
        return c
    sd = np.where(asked, known.std(ddof=1), c.expected_wind_sd)
    return replace(c, expected_wind=np.where(asked, known.mean(), 0.0), expected_wind_sd=sd)


def _prepare(plan: Plan, instruments: pl.DataFrame) -> Computed:
    """All that does not depend on the wind coefficients; these are fixed for now."""
    tows, windows = plan.tows, plan.windows()
    means = run_means(
        tows,
        windows,
        plan.of_runs("run_point.estimator") == "mean_of_ratios",
        plan.of_runs("wind.model") == "oblique",
        accelerated_mass_kg(tows) * (plan.of_runs("run_point.inertia") != "none"),
    )
    scale, zero_n = (
        instruments[name].to_numpy()[tows.tow] for name in ("force_factor", "force_zero_n")
    )
    ratio = plan.of_runs("force.ratio")
    means = means.with_force(ratio * scale, ratio * zero_n)
    known = log_factor(
        plan.option("speed.correction"),
        plan.option("speed.factor"),
        tows.of_tow("speed_correction_ratio"),
        instruments["factor"].cast(pl.Float64).to_numpy(),
    )
    reasons = _reasons(plan, windows["exists"], means.speed_m_s)
    used, by_gps = reasons == "", plan.option("calibration.rule") != "none"
    log = means.speed_m_s * known[tows.tow]
    y, found = gps_factor_of_files(tows, means.gps_m_s, log, used, windows["exists"] & (log > 0))
    determined = found.ravel()[tows.file] | ~by_gps[tows.tow]
    y = np.where(by_gps[tows.tow], y.ravel()[tows.file], 1.0)
    corrected = plan.option("temperature.rule") != "none"
    expected = plan.option("unrecorded.rule") == "expected"
    temperature = temperature_change_kg_m(tows, corrected, expected, log * y)
    ahead, behind = (plan.of_runs(f"wind.{way}") for way in ("ahead", "behind"))
    nothing = np.full(tows.size, np.nan)
    return Computed(
        plan,
        windows,
        means,
        known,
        y,
        tows.any(determined & used) & by_gps,
        instruments,
        np.where(used & ~determined, NOT_CALIBRATED, reasons),
        *temperature,
        Coefficients(ahead, behind, still=ahead),
        coefficient_sd=nothing,
        wind_ln_scale=np.zeros(tows.size),
        wind_ln_sd=nothing,
        expected_wind=np.zeros(tows.size),
        expected_wind_sd=np.full(tows.size, Assumed().unmeasured_wind),
    )


def _reasons(plan: Plan, has_window: BoolArray, log_m_s: FloatArray) -> StrArray:
    """Why a run does not count, before calibration; empty where it does."""
    selected, highest = plan.tows.selected, plan.of_runs("runs.highest_target_ratio")
    too_fast = above_target(plan.tows, log_m_s, selected & has_window, highest)
    return np.select(
        [~selected, ~has_window, too_fast], [NOT_SELECTED, NO_STEADY_WINDOW, ABOVE_TARGET], ""
    )


def _with_coefficients(c: Computed) -> Computed:
    """The tows with the drag coefficients that their steps ask for."""
    rule = c.plan.option("wind.coefficients")
    if (per_run := (rule == "per_run")[c.tows.tow]).any():
        pairs = zip(_best_per_run(c), c.air, strict=True)
        c = replace(c, air=Coefficients(*(np.where(per_run, *pair) for pair in pairs)))
    asked = rule == "archive"
    if asked.any() and (shared := _archive_coefficient(c, asked)) is not None:
        value, sd = shared
        air = (np.where(asked[c.tows.tow], value, fixed) for fixed in c.air)
        c = replace(c, air=Coefficients(*air), coefficient_sd=np.where(asked, sd, np.nan))
    return c


def _best_per_run(computed: Computed) -> Coefficients:
    """Coefficients searched run by run so that each point comes nearest to the curve.

    The old rule: fit, move every run as near to the curve as its wind allows, fit again. The
    still-air part keeps its fixed coefficient (inferred).
    """
    air, tow = computed.air, computed.tows.tow
    for _ in range(PER_RUN_ITERATIONS):
        cw = computed.cw_of(air)
        curves = curve.fit(computed.points_of(cw))
        on_curve = curve.cw(curves.a_kg_m[tow], curves.s_s2_m2[tow], computed.speed_m_s)
        fits = curves.converged[tow] & np.isfinite(on_curve)
        excess = cw + computed.air_of(air) - np.where(fits, on_curve, cw)
        searched = nearest_coefficients(computed.means.air, excess * computed.speed_factor**2)
        ahead, behind = (np.where(fits, *pair) for pair in zip(searched, air, strict=False))
        air = Coefficients(ahead, behind, air.still)
    return air


def _misfits(c: Computed, grid: FloatArray) -> FloatArray:
    """Residuals' squares / Cw^2, (coefficients, tows); infinite without a curve of all points."""
    alike = (np.full(len(c.tows.tow), value) for value in grid)
    points = [c.points_of(c.cw_of(Coefficients(one, one, one))) for one in alike]
    stacked = zip(*((p.speed_m_s, p.cw_kg_m, p.used) for p in points), strict=True)
    curves = curve.fit(curve.Points(*map(np.concatenate, stacked)))
    scale = curves.cw_at(np.tile(c.tows.of_tow("declared_speed_m_s"), len(grid)))
    runs = np.tile(c.tows.count(c.in_fit), len(grid))
    sound = curves.converged & np.isfinite(scale) & (curves.n_points == runs)
    misfit = np.where(sound, curves.rss_kg2_m2 / np.where(sound, scale, 1.0) ** 2, np.inf)
    return misfit.reshape(len(grid), -1)


def _archive_coefficient(c: Computed, asked: BoolArray) -> tuple[float, float] | None:
    """One coefficient for the whole archive, and its standard deviation; None without tows.

    It has the least misfit of all tows together.

    Out and back feel different wind, so a wrong coefficient drives their points apart. Tows that
    one of the coefficients leaves without a curve take no part, so that every sum is of the same
    tows. The misfit is a parabola in the coefficient, near its minimum. The
    standard deviation is the sandwich over tows (Huber 1967): what is odd about one tow is shared
    by its runs.
    """
    each = _misfits(c, ARCHIVE_GRID)[:, asked & c.tows.trusted]
    if not (each := each[:, np.isfinite(each).all(axis=0)]).size:
        return None
    best = int(np.clip(each.sum(axis=1).argmin(), 1, len(ARCHIVE_GRID) - 2))
    below, here, above = each[best - 1 : best + 2]
    bends = below - 2.0 * here + above
    if (bend := bends.sum()) <= 0:
        return float(ARCHIVE_GRID[best]), Assumed().wind_coefficient
    step, shift = ARCHIVE_GRID[1] - ARCHIVE_GRID[0], 0.5 * (below - above).sum() / bend
    slopes = 0.5 * (above - below) + bends * shift
    value = np.clip(ARCHIVE_GRID[best] + step * shift, ARCHIVE_GRID[0], ARCHIVE_GRID[-1])
    return float(value), float(step * np.sqrt((slopes**2).sum()) / bend)
