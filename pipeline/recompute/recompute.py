"""Recompute: every tow under one method, from blocks to curves.

`evaluate` calls the steps in the order of the method's text (docs/method.md): window, mean, speed,
temperature, wind and runs; the curve follows from them. Each step's formulas are in its own module
of `pipeline.steps`, and the tables are filled in `pipeline.recompute.results`. What is searched
over the whole archive is found first and applied after. Nothing here knows a season: the method
says what holds when.
"""

from dataclasses import replace
from typing import Any, Final

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray, StrArray
from pipeline.blocks.run_blocks import RunBlocks
from pipeline.crews import STANDARD_CREWS
from pipeline.method.definition import Method
from pipeline.recompute.anemometer import correct_anemometers
from pipeline.recompute.computed import (
    AirCorrection,
    Computed,
    Drag,
    SpeedCorrection,
    TemperatureCorrection,
)
from pipeline.recompute.plan import Plan, leave_out_factor
from pipeline.recompute.results import Recomputed, build_tables
from pipeline.recompute.run_cache import RunCache
from pipeline.recompute.season_factors import find_season_factors, get_instruments
from pipeline.run_reasons import ABOVE_TARGET, NO_STEADY_WINDOW, NOT_CALIBRATED, NOT_SELECTED
from pipeline.season_log import SeasonFactors
from pipeline.steps.calibration import estimate_gps_factor_of_files
from pipeline.steps.resistance import (
    RunMeans,
    accelerated_mass_kg,
    run_means,
    water_change_kg_m,
)
from pipeline.steps.speed import log_factor
from pipeline.steps.target import is_above_target
from pipeline.steps.wind import find_nearest_coefficients
from pipeline.uncertainty.propagation import Assumed

PER_RUN_ITERATIONS: Final = 4
"""The old tool printed "4 iteraties" (presentation 2015, screens of Razende Snol)."""

MIN_MEASURED_WINDS: Final = 10
"""Tows with an anemometer from which those without learn (inferred)."""


def recompute(
    method: Method,
    tows: pl.DataFrame,
    blocks: RunBlocks,
    cache: RunCache | None = None,
    with_bands: bool = True,
    crew_classes: pl.DataFrame = STANDARD_CREWS,
) -> Recomputed:
    """Make the tables of all tows under a method.

    Args:
        tows: rows of the warehouse's `tows`, with `boat_type` where it is known, so that a tow can
            be compared with like boats.
        blocks: their runs; `blocks.runs` has the columns of `tow_runs`.
        cache: what was found before of the same tows; added to.
        with_bands: make `curve_points`, a tenth of the work; without, it is empty.
        crew_classes: the table of that name.

    Raises:
        MissingKnowledgeError: the method says nothing about a season of `tows`.
    """
    plan = Plan.from_method(method, tows, blocks, cache)
    estimated = estimate_season_factors(plan) if method.estimates_logs else None
    computed = evaluate(plan, None if estimated is None else estimated.tows)
    return build_tables(method, computed, estimated, with_bands, crew_classes)


def estimate_season_factors(plan: Plan) -> SeasonFactors | None:
    """Estimate the log factors that the steps ask for, and how far tows scatter.

    Returns:
        None if not a single tow has a curve from which to estimate.
    """
    as_read = evaluate(plan.replace_steps(leave_out_factor))
    if not (np.isfinite(as_read.cw_at_declared) & as_read.tows.trusted).any():
        return None
    return find_season_factors(as_read)


def evaluate(plan: Plan, instruments: pl.DataFrame | None = None) -> Computed:
    """Compute the tows, step by step.

    Args:
        plan: the tows and their steps; what is searched over the archive is searched over these.
        instruments: rows of the table `tow_instruments`, for steps that ask for an estimate.
    """
    known_instruments = get_instruments(plan, instruments)
    windows = plan.average_windows()
    means = average_runs(plan, windows, known_instruments)
    speed, is_determined = correct_speed(plan, windows["exists"], means, known_instruments)
    true_speed = means.speed_m_s * speed.log_factor[plan.tows.tow] * speed.gps_factor
    computed = Computed(
        plan=plan,
        windows=windows,
        means=means,
        instruments=known_instruments,
        speed=speed,
        temperature=correct_temperature(plan, true_speed),
        air=prescribe_air(plan),
        reasons=select_runs(plan, windows["exists"], means.speed_m_s, is_determined),
    )
    computed = correct_anemometers(computed)
    computed = search_drag_per_run(computed)
    return expect_unrecorded_wind(computed)


# The steps up to the wind


def average_runs(plan: Plan, windows: dict[str, Any], instruments: pl.DataFrame) -> RunMeans:
    """Average each run over its window, with the load cell as it is known to read.

    Args:
        windows: as `Plan.average_windows` gives them.
        instruments: rows of `get_instruments`.
    """
    options = plan.run_options
    means = run_means(
        plan.tows,
        windows,
        of_ratios=options.run.uses_mean_of_ratios,
        oblique=options.wind.is_oblique,
        accelerated_kg=accelerated_mass_kg(plan.tows) * options.run.corrects_inertia,
    )
    force_factor = instruments["force_factor"].to_numpy()[plan.tows.tow]
    force_zero_n = instruments["force_zero_n"].to_numpy()[plan.tows.tow]
    return means.correct_force(
        options.run.force_ratio * force_factor, options.run.force_ratio * force_zero_n
    )


def correct_speed(
    plan: Plan, has_window: BoolArray, means: RunMeans, instruments: pl.DataFrame
) -> tuple[SpeedCorrection, BoolArray]:
    """Correct the log's known error, then calibrate it on dGPS where the method asks.

    Calibration is over all runs that are to be used, also those that are too fast to count: their
    speeds are measured as well as any.

    Returns:
        The correction, and for which runs it is determined, shape (runs,).
    """
    tows, options = plan.tows, plan.options.speed
    factor = log_factor(
        options.correction,
        options.factor,
        tow_list_ratio=tows.get_of_tows("speed_correction_ratio"),
        estimated_factor=instruments["factor"].cast(pl.Float64).to_numpy(),
    )
    is_measured = tows.selected & has_window
    corrected_log = means.speed_m_s * factor[tows.tow]
    is_steady = has_window & (corrected_log > 0)
    of_files, is_known = estimate_gps_factor_of_files(
        tows, means.gps_m_s, corrected_log, is_measured, is_steady
    )
    needs_gps = options.is_calibrated[tows.tow]
    is_determined = is_known.ravel()[tows.file] | ~needs_gps
    correction = SpeedCorrection(
        log_factor=factor,
        gps_factor=np.where(needs_gps, of_files.ravel()[tows.file], 1.0),
        is_calibrated=tows.any(is_determined & is_measured) & options.is_calibrated,
    )
    return correction, is_determined


def select_runs(
    plan: Plan, has_window: BoolArray, log_m_s: FloatArray, is_determined: BoolArray
) -> StrArray:
    """Return why each run does not count; empty where it does.

    Args:
        plan: the tows and their steps.
        has_window: runs with a window, shape (runs,).
        log_m_s: mean speed of each run by its log, shape (runs,).
        is_determined: runs whose speed correction is determined, shape (runs,).
    """
    is_selected = plan.tows.selected
    highest_ratio = plan.run_options.run.highest_target_ratio
    is_too_fast = is_above_target(plan.tows, log_m_s, is_selected & has_window, highest_ratio)
    return np.select(
        [~is_selected, ~has_window, is_too_fast, ~is_determined],
        [NOT_SELECTED, NO_STEADY_WINDOW, ABOVE_TARGET, NOT_CALIBRATED],
        "",
    )


def correct_temperature(plan: Plan, speed_m_s: FloatArray) -> TemperatureCorrection:
    """Bring Cw to fresh water of the reference temperature, where the method asks."""
    change_kg_m, is_known = water_change_kg_m(
        plan.tows,
        plan.options.corrects_temperature,
        plan.options.expects_unrecorded,
        speed_m_s,
    )
    return TemperatureCorrection(change_kg_m, is_known)


def prescribe_air(plan: Plan) -> AirCorrection:
    """Return the air correction with the coefficients that the method prescribes."""
    wind = plan.run_options.wind
    return AirCorrection(
        drag=Drag(ahead=wind.ahead, behind=wind.behind, still=wind.ahead),
        anemometer_ln_scale=np.zeros(plan.tows.size),
        anemometer_ln_sd=np.full(plan.tows.size, np.nan),
        unrecorded_ratio=np.zeros(plan.tows.size),
        unrecorded_sd=np.full(plan.tows.size, Assumed().unmeasured_wind),
    )


# Wind


def search_drag_per_run(computed: Computed) -> Computed:
    """Search the coefficients run by run, so that each point comes nearest to the curve.

    The old rule: fit, move every run as near to the curve as its wind allows, fit again. The
    still-air part keeps its fixed coefficient (inferred).
    """
    is_searched = (computed.options.wind.coefficients == "per_run")[computed.tows.tow]
    if not is_searched.any():
        return computed
    prescribed, tow = computed.air.drag, computed.tows.tow
    drag = prescribed
    for _ in range(PER_RUN_ITERATIONS):
        cw = computed.cw_with(drag)
        curves = curve.fit(computed.points_with(cw))
        on_curve = curve.cw(curves.a_kg_m[tow], curves.s_s2_m2[tow], computed.speed_m_s)
        has_curve = curves.converged[tow] & np.isfinite(on_curve)
        wanted_air = cw + computed.air_with(drag) - np.where(has_curve, on_curve, cw)
        ahead, behind = find_nearest_coefficients(
            computed.means.air, wanted_air * computed.speed_factor**2
        )
        drag = Drag(
            ahead=np.where(has_curve, ahead, drag.ahead),
            behind=np.where(has_curve, behind, drag.behind),
            still=drag.still,
        )
    chosen = Drag(
        ahead=np.where(is_searched, drag.ahead, prescribed.ahead),
        behind=np.where(is_searched, drag.behind, prescribed.behind),
        still=prescribed.still,
    )
    return replace(computed, air=replace(computed.air, drag=chosen))


def expect_unrecorded_wind(computed: Computed) -> Computed:
    """Give tows without an anemometer the wind that those with one had, where the method asks.

    Wind along the course adds more on one way than it takes off on the other, so that a tow whose
    wind nobody measured comes out too high.
    """
    is_expected = computed.options.expects_unrecorded
    measured = computed.wind_ratio()[is_expected]
    measured = measured[np.isfinite(measured)]
    if len(measured) < MIN_MEASURED_WINDS:
        return computed
    ratio = np.where(is_expected, measured.mean(), 0.0)
    sd = np.where(is_expected, measured.std(ddof=1), computed.air.unrecorded_sd)
    air = replace(computed.air, unrecorded_ratio=ratio, unrecorded_sd=sd)
    return replace(computed, air=air)
