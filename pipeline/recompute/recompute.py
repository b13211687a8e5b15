"""Recompute: every tow under one method, from blocks to curves.

Here the steps are put in their order; each step's formulas are in its own module and the tables
are filled in `pipeline.recompute.results`. The order is: steady window, means, speed correction,
runs that count, calibration, corrections of the coefficient, wind coefficients, curve. What is
searched over the whole archive is found first and applied after. Nothing here knows a season: the
method says what holds when.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray, StrArray
from pipeline.blocks.batch import Batch
from pipeline.blocks.run_blocks import RunBlocks
from pipeline.hull import front_area_m2, hull_speed_m_s, still_air_coefficient_kg_m
from pipeline.method.definition import Method, Steps
from pipeline.recompute.anemometer import with_anemometer
from pipeline.recompute.facts import with_expected_water
from pipeline.recompute.outcome import (
    STILL_AIR,
    ExpectedWind,
    Outcome,
    Prepared,
    TowFactor,
)
from pipeline.recompute.results import Recomputed, as_tables
from pipeline.recompute.run_cache import RunCache
from pipeline.recompute.season_factors import (
    Instruments,
    find_season_factors,
    is_estimated,
    without_factor,
    without_gps,
)
from pipeline.season_log import SeasonFactors
from pipeline.steps.calibration import gps_factor_of_files
from pipeline.steps.resistance import RunMeans, temperature_change_kg_m
from pipeline.steps.speed import log_factor
from pipeline.steps.target import above_target
from pipeline.steps.wind import nearest_coefficients
from pipeline.steps.window import Windows
from pipeline.uncertainty.propagation import Assumed

NOT_SELECTED = "not_selected"
NO_STEADY_WINDOW = "no_steady_window"
ABOVE_TARGET = "above_target_speed"
NOT_CALIBRATED = "not_calibrated"

PER_RUN_ITERATIONS = 4
"""The old tool printed "4 iteraties" (presentation 2015, screens of Razende Snol)."""


class ArchiveCoefficient(NamedTuple):
    """The drag coefficient of the whole archive, with its standard deviation."""

    value: float
    sd: float


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
    plans = [(batch, steps) for batch, (steps,) in batches([method], tows, blocks)]
    cache = RunCache() if cache is None else cache
    estimated = season_factors(plans, cache) if method.estimates_logs else None
    outcomes = evaluate(plans, cache, Instruments.of(estimated))
    return as_tables(method, tows, outcomes, estimated, with_bands)


def season_factors(plans: Sequence[tuple[Batch, Steps]], cache: RunCache) -> SeasonFactors | None:
    """The log factors that the given steps ask to estimate, and how far tows scatter.

    None if not a single tow has a curve from which to estimate.
    """
    as_read = [(batch, without_factor(steps)) for batch, steps in plans]
    before = evaluate(as_read, cache, Instruments())
    if not any((np.isfinite(o.cw_at_declared) & o.batch.trusted).any() for o in before):
        return None
    return find_season_factors(before)


def instruments_of(plans: Sequence[tuple[Batch, Steps]], cache: RunCache) -> Instruments:
    """What is estimated of the tows' instruments, as far as the steps ask for it."""
    asked = any(is_estimated(steps) for _, steps in plans)
    return Instruments.of(season_factors(plans, cache) if asked else None)


def batches(
    methods: Sequence[Method], tows: pl.DataFrame, blocks: RunBlocks
) -> list[tuple[Batch, tuple[Steps, ...]]]:
    """Tows that share their steps under every method, together: each step works on all at once.

    Tows without GPS are batches of their own where a method says what they get instead.

    Returns:
        Batches, each with its steps under each of the methods.
    """
    tows = with_expected_water(tows)
    seasons: dict[str, tuple[tuple[Steps, ...], list[int]]] = {}
    for season in tows["season"].unique().sort():
        steps = tuple(method.for_season(season) for method in methods)
        seasons.setdefault(str(steps), (steps, []))[1].append(season)
    whole = Batch.of(tows, blocks)
    alike = [
        (whole.part(np.isin(whole.of_tow("season"), season_batch)), steps)
        for steps, season_batch in seasons.values()
    ]
    return [part for batch, steps in alike for part in _by_gps(batch, steps)]


def _by_gps(batch: Batch, steps: tuple[Steps, ...]) -> Iterator[tuple[Batch, tuple[Steps, ...]]]:
    """A batch as it is, or its tows with GPS and those without."""
    otherwise = tuple(without_gps(one) for one in steps)
    if otherwise == steps or (has_gps := batch.has_gps).all():
        yield batch, steps
        return
    for mine, own in ((has_gps, steps), (~has_gps, otherwise)):
        if mine.any():
            yield batch.part(mine), own


def evaluate(
    plans: Sequence[tuple[Batch, Steps]],
    cache: RunCache,
    instruments: Instruments,
) -> list[Outcome]:
    """What the given steps make of each batch.

    Args:
        plans: batches with their steps; what is searched over the archive is searched over them.
        cache: what was found before of the same tows; added to.
        instruments: what was estimated, for steps that ask for it.
    """
    prepared = with_anemometer(
        [_prepare(batch, steps, cache, instruments.of_tows(batch, steps)) for batch, steps in plans]
    )
    shared = _archive_coefficient([p for p in prepared if p.steps.wind.coefficients == "archive"])
    return [_finish(p, shared) for p in _with_expected_wind(prepared, shared)]


def _with_expected_wind(
    prepared: list[Prepared], shared: ArchiveCoefficient | None
) -> list[Prepared]:
    """The wind that tows without an anemometer must have had, by those with one, if a method asks.

    Wind along the course adds more on one way than it takes off on the other, so that a tow whose
    wind nobody measured comes out too high.
    """
    asking = [p for p in prepared if _expects_wind(p)]
    ratios = np.concatenate([[], *(p.wind_ratio(*_coefficients(p, shared)) for p in asking)])
    known = ratios[np.isfinite(ratios)]
    if len(known) < FEWEST_WINDS:
        return prepared
    expected = ExpectedWind(float(known.mean()), float(known.std(ddof=1)))
    return [replace(p, expected_wind=expected) if _expects_wind(p) else p for p in prepared]


def _expects_wind(prepared: Prepared) -> bool:
    return prepared.steps.wind.unmeasured == "expected"


def evaluate_each(
    variants: Iterable[Sequence[tuple[Batch, Steps]]],
    cache: RunCache,
    instruments: Instruments,
) -> Iterator[list[Outcome]]:
    """The same for variants of the steps of the same batches.

    Where a variant differs from the one before it in the rule for the curve alone, all that comes
    before the curve is kept.
    """
    last: list[Outcome] = []
    for plans in variants:
        asked = [steps for _, steps in plans]
        if last and all(map(_differ_in_curve_alone, last, asked)):
            last = list(map(_with_curve, last, asked))
        else:
            last = evaluate(plans, cache, instruments)
        yield last


def _differ_in_curve_alone(outcome: Outcome, steps: Steps) -> bool:
    return bool(outcome.steps.model_copy(update={"curve": steps.curve}) == steps)


def _with_curve(outcome: Outcome, steps: Steps) -> Outcome:
    """The same points with the curve that other steps choose."""
    prepared = replace(outcome.prepared, steps=steps)
    curves = _choose_curve(prepared, outcome.points, outcome.free)
    return replace(outcome, prepared=prepared, curves=curves)


def _prepare(batch: Batch, steps: Steps, cache: RunCache, estimated: TowFactor) -> Prepared:
    windows, means = cache.windows(batch, steps), cache.means(batch, steps)
    means = means.with_force(estimated.force_factor[batch.tow], estimated.force_zero_n[batch.tow])
    tow_list = batch.of_tow("speed_correction_ratio")
    known = log_factor(steps.speed, tow_list, estimated.factor)
    reasons = _reasons(batch, steps, windows, means)
    y, determined = _calibrate(batch, steps, windows, means, known, reasons == "")
    calibrated = batch.any(determined & (reasons == "")) & (steps.calibration.rule != "none")
    reasons = np.where((reasons == "") & ~determined, NOT_CALIBRATED, reasons)
    speed = means.speed_m_s * known[batch.tow] * y
    temperature, temperature_known = temperature_change_kg_m(batch, steps.temperature, speed)
    front = front_area_m2(batch.of_run("beam_m"), batch.of_run("bow_height_m"))
    return Prepared(
        batch,
        steps,
        windows,
        means,
        known,
        y,
        calibrated,
        estimated,
        reasons,
        still_unit_kg_m=still_air_coefficient_kg_m(front, 1.0),
        temperature_kg_m=temperature,
        temperature_known=temperature_known,
        wind_ln_scale=np.zeros(batch.size),
        wind_ln_sd=np.full(batch.size, np.nan),
        expected_wind=STILL_AIR,
    )


def _reasons(batch: Batch, steps: Steps, windows: Windows, means: RunMeans) -> StrArray:
    """Why a run does not count, before calibration; empty where it does."""
    chosen = batch.selected & windows.exists
    too_fast = above_target(batch, means.speed_m_s, chosen, steps.runs.highest_target_ratio)
    return np.select(
        [~batch.selected, ~windows.exists, too_fast],
        [NOT_SELECTED, NO_STEADY_WINDOW, ABOVE_TARGET],
        "",
    )


def _calibrate(
    batch: Batch,
    steps: Steps,
    windows: Windows,
    means: RunMeans,
    known_factor: FloatArray,
    used: BoolArray,
) -> tuple[FloatArray, BoolArray]:
    """Factor on the log speed as corrected so far, and whether it is known, shape (runs,)."""
    if steps.calibration.rule == "none":
        return np.ones(len(batch.tow)), np.ones(len(batch.tow), dtype=bool)
    log = means.speed_m_s * known_factor[batch.tow]
    y, determined = gps_factor_of_files(batch, means.gps_m_s, log, used, windows.exists & (log > 0))
    return y.ravel()[batch.file], determined.ravel()[batch.file]


def _finish(prepared: Prepared, shared: ArchiveCoefficient | None) -> Outcome:
    ahead, behind, still = _coefficients(prepared, shared)
    cw = prepared.cw_of(ahead, behind, still)
    points = prepared.points_of(cw)
    free = curve.fit(points)
    return Outcome(
        prepared,
        ahead=ahead,
        behind=behind,
        still_air_coefficient=still,
        coefficient_sd=np.nan if shared is None else shared.sd,
        cw_kg_m=cw,
        points=points,
        free=free,
        curves=_choose_curve(prepared, points, free),
    )


def _choose_curve(prepared: Prepared, points: curve.Points, free: curve.Curves) -> curve.Curves:
    rule = prepared.steps.curve
    if rule.b == "free":
        return free
    hull = hull_speed_m_s(prepared.batch.of_tow("waterline_length_m"))
    if rule.b == "capped":
        return curve.fit_capped(points, free, rule.cap_hull_speeds * hull)
    return curve.fit_given_b(points, hull)


def _coefficients(
    prepared: Prepared, shared: ArchiveCoefficient | None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Drag coefficients ahead, behind and in still air, each of shape (runs,)."""
    wind = prepared.steps.wind
    runs = len(prepared.batch.tow)
    fixed = np.full(runs, wind.ahead), np.full(runs, wind.behind)
    if wind.coefficients == "archive" and shared is not None:
        one = np.full(runs, shared.value)
        return one, one, one
    if wind.coefficients == "per_run":
        return *_best_per_run(prepared, *fixed), fixed[0]
    return *fixed, fixed[0]


def _best_per_run(
    prepared: Prepared, ahead: FloatArray, behind: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Coefficients searched run by run so that each point comes nearest to the curve.

    The old rule: fit, move every run as near to the curve as its wind allows, fit again. The
    still-air part keeps its fixed coefficient (inferred).
    """
    still = ahead
    for _ in range(PER_RUN_ITERATIONS):
        cw = prepared.cw_of(ahead, behind, still)
        curves = curve.fit(prepared.points_of(cw))
        tow = prepared.batch.tow
        on_curve = curve.cw(curves.a_kg_m[tow], curves.s_s2_m2[tow], prepared.speed_m_s)
        fits = curves.converged[tow] & np.isfinite(on_curve)
        excess = cw + prepared.air_of(ahead, behind) - np.where(fits, on_curve, cw)
        searched = nearest_coefficients(prepared.means.air, excess * prepared.speed_factor**2)
        ahead = np.where(fits, searched[0], ahead)
        behind = np.where(fits, searched[1], behind)
    return ahead, behind


def _misfits(prepared: Prepared, grid: FloatArray) -> FloatArray:
    """Residuals' squares / Cw^2, (coefficients, tows); infinite without a curve of all points."""
    each = [np.full(len(prepared.batch.tow), coefficient) for coefficient in grid]
    points = [prepared.points_of(prepared.cw_of(one, one, one)) for one in each]
    curves = curve.fit(curve.Points.stack(points))
    scale = curves.cw_at(np.tile(prepared.batch.of_tow("declared_speed_m_s"), len(grid)))
    runs = np.tile(prepared.batch.count(prepared.in_fit), len(grid))
    sound = curves.converged & np.isfinite(scale) & (curves.n_points == runs)
    misfit = np.where(sound, curves.rss_kg2_m2 / np.where(sound, scale, 1.0) ** 2, np.inf)
    return misfit.reshape(len(grid), -1)


def _archive_coefficient(prepared: list[Prepared]) -> ArchiveCoefficient | None:
    """One coefficient for the whole archive: the least misfit of all tows together.

    Out and back feel different wind, so a wrong coefficient drives their points apart. Tows that
    one of the coefficients leaves without a curve take no part, so that every sum is of the same
    tows. The misfit is a parabola in the coefficient, near its minimum; None without tows. The
    standard deviation is the sandwich over tows (Huber 1967): what is odd about one tow is shared
    by its runs.
    """
    misfits = (_misfits(p, ARCHIVE_GRID)[:, p.batch.trusted] for p in prepared)
    each = np.concatenate([np.empty((len(ARCHIVE_GRID), 0)), *misfits], axis=1)
    if not (each := each[:, np.isfinite(each).all(axis=0)]).size:
        return None
    best = int(np.clip(each.sum(axis=1).argmin(), 1, len(ARCHIVE_GRID) - 2))
    below, here, above = each[best - 1 : best + 2]
    bends = below - 2.0 * here + above
    if (bend := bends.sum()) <= 0:
        return ArchiveCoefficient(float(ARCHIVE_GRID[best]), Assumed().wind_coefficient)
    step, shift = ARCHIVE_GRID[1] - ARCHIVE_GRID[0], 0.5 * (below - above).sum() / bend
    slopes = 0.5 * (above - below) + bends * shift
    value = np.clip(ARCHIVE_GRID[best] + step * shift, ARCHIVE_GRID[0], ARCHIVE_GRID[-1])
    return ArchiveCoefficient(float(value), float(step * np.sqrt((slopes**2).sum()) / bend))
