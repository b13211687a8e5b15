"""Recompute: every tow under one method, from blocks to curves.

Here the steps are put in their order; each step's formulas are in its own module and the tables
are filled in `pipeline.recompute.results`. The order is: steady window, means, speed correction,
runs that count, calibration, corrections of the coefficient, wind coefficients, curve. What is
searched over the whole archive is found first and applied after. Nothing here knows a season: the
method says what holds when.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray, StrArray
from pipeline.blocks.batch import Batch
from pipeline.blocks.run_blocks import RunBlocks
from pipeline.method.definition import Method, Steps
from pipeline.recompute.anemometer import with_anemometer
from pipeline.recompute.computed import Coefficients, Computed, ExpectedWind
from pipeline.recompute.facts import with_expected_water
from pipeline.recompute.results import Recomputed, as_tables
from pipeline.recompute.run_cache import RunCache
from pipeline.recompute.season_factors import (
    find_season_factors,
    instruments_of,
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

Plans = Sequence[tuple[Batch, Steps]]
"""Batches of tows, each with its steps."""

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
    computed = evaluate(plans, cache, None if estimated is None else estimated.tows)
    return as_tables(method, tows, computed, estimated, with_bands)


def season_factors(plans: Plans, cache: RunCache) -> SeasonFactors | None:
    """The log factors that the given steps ask to estimate, and how far tows scatter.

    None if not a single tow has a curve from which to estimate.
    """
    as_read = evaluate([(batch, without_factor(steps)) for batch, steps in plans], cache)
    if not any((np.isfinite(c.cw_at_declared) & c.batch.trusted).any() for c in as_read):
        return None
    return find_season_factors(as_read)


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
    plans: Plans, cache: RunCache, instruments: pl.DataFrame | None = None
) -> list[Computed]:
    """What the given steps make of each batch.

    Args:
        plans: batches with their steps; what is searched over the archive is searched over them.
        cache: what was found before of the same tows; added to.
        instruments: rows of the table `tow_instruments`, for steps that ask for an estimate.
    """
    read = [
        _prepare(batch, steps, cache, instruments_of(batch, steps, instruments))
        for batch, steps in plans
    ]
    return _with_expected_wind(_with_coefficients(with_anemometer(read)))


def _with_expected_wind(computed: list[Computed]) -> list[Computed]:
    """The wind that tows without an anemometer must have had, by those with one, if a method asks.

    Wind along the course adds more on one way than it takes off on the other, so that a tow whose
    wind nobody measured comes out too high.
    """
    asking = [c for c in computed if c.steps.expects_unrecorded]
    ratios = np.concatenate([[], *(c.wind_ratio() for c in asking)])
    known = ratios[np.isfinite(ratios)]
    if len(known) < FEWEST_WINDS:
        return computed
    expected = ExpectedWind(float(known.mean()), float(known.std(ddof=1)))
    return [
        replace(c, expected_wind=expected) if c.steps.expects_unrecorded else c for c in computed
    ]


def _prepare(batch: Batch, steps: Steps, cache: RunCache, instruments: pl.DataFrame) -> Computed:
    """All that does not depend on the wind coefficients; these are fixed for now."""
    windows, means = cache.windows(batch, steps), cache.means(batch, steps)
    scale, zero_n = (
        instruments[name].to_numpy()[batch.tow] for name in ("force_factor", "force_zero_n")
    )
    as_voted = np.full(len(batch.tow), steps.force.ratio)
    means = means.with_force(as_voted, np.zeros(len(batch.tow))).with_force(scale, zero_n)
    estimated = instruments["factor"].cast(pl.Float64).to_numpy()
    known = log_factor(steps.speed, batch.of_tow("speed_correction_ratio"), estimated)
    reasons = _reasons(batch, steps, windows, means)
    y, determined = _calibrate(batch, steps, windows, means, known, reasons == "")
    calibrated = batch.any(determined & (reasons == "")) & (steps.calibration.rule != "none")
    reasons = np.where((reasons == "") & ~determined, NOT_CALIBRATED, reasons)
    speed = means.speed_m_s * known[batch.tow] * y
    temperature, temperature_known = temperature_change_kg_m(batch, steps, speed)
    ahead, behind = (np.full(len(batch.tow), c) for c in (steps.wind.ahead, steps.wind.behind))
    return Computed(
        batch,
        steps,
        windows,
        means,
        known,
        y,
        calibrated,
        instruments,
        reasons,
        temperature,
        temperature_known,
        Coefficients(ahead, behind, still=ahead),
        wind_ln_scale=np.zeros(batch.size),
        wind_ln_sd=np.full(batch.size, np.nan),
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


def _with_coefficients(computed: list[Computed]) -> list[Computed]:
    """The batches with the drag coefficients that their steps ask for."""
    by_archive = [c for c in computed if c.steps.wind.coefficients == "archive"]
    shared = _archive_coefficient(by_archive)

    def found(c: Computed) -> Computed:
        if c.steps.wind.coefficients == "per_run":
            return replace(c, air=_best_per_run(c))
        if c.steps.wind.coefficients == "archive" and shared is not None:
            one = _alike(c, shared.value)
            return replace(c, air=one, coefficient_sd=shared.sd)
        return c

    return [found(c) for c in computed]


def _alike(computed: Computed, value: float) -> Coefficients:
    one = np.full(len(computed.batch.tow), value)
    return Coefficients(one, one, one)


def _best_per_run(computed: Computed) -> Coefficients:
    """Coefficients searched run by run so that each point comes nearest to the curve.

    The old rule: fit, move every run as near to the curve as its wind allows, fit again. The
    still-air part keeps its fixed coefficient (inferred).
    """
    air, tow = computed.air, computed.batch.tow
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


def _misfits(computed: Computed, grid: FloatArray) -> FloatArray:
    """Residuals' squares / Cw^2, (coefficients, tows); infinite without a curve of all points."""
    points = [computed.points_of(computed.cw_of(_alike(computed, value))) for value in grid]
    stacked = zip(*((p.speed_m_s, p.cw_kg_m, p.used) for p in points), strict=True)
    curves = curve.fit(curve.Points(*map(np.concatenate, stacked)))
    scale = curves.cw_at(np.tile(computed.batch.of_tow("declared_speed_m_s"), len(grid)))
    runs = np.tile(computed.batch.count(computed.in_fit), len(grid))
    sound = curves.converged & np.isfinite(scale) & (curves.n_points == runs)
    misfit = np.where(sound, curves.rss_kg2_m2 / np.where(sound, scale, 1.0) ** 2, np.inf)
    return misfit.reshape(len(grid), -1)


def _archive_coefficient(computed: list[Computed]) -> ArchiveCoefficient | None:
    """One coefficient for the whole archive: the least misfit of all tows together.

    Out and back feel different wind, so a wrong coefficient drives their points apart. Tows that
    one of the coefficients leaves without a curve take no part, so that every sum is of the same
    tows. The misfit is a parabola in the coefficient, near its minimum; None without tows. The
    standard deviation is the sandwich over tows (Huber 1967): what is odd about one tow is shared
    by its runs.
    """
    misfits = (_misfits(c, ARCHIVE_GRID)[:, c.batch.trusted] for c in computed)
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
