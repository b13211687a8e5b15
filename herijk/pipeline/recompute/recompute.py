"""Recompute: every tow under one method, from blocks to curves.

Here the steps are put in their order; each step's formulas stand in its own module and the tables
are filled in `pipeline.recompute.outcome`. The order is: steady window, means, speed correction,
runs that count, calibration, corrections of the coefficient, wind coefficients, curve. What is
searched over the whole archive is found first and applied after. Nothing here knows a season: the
method says what holds when.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np
import polars as pl

from herijk.pipeline import curve
from herijk.pipeline.arrays import BoolArray, FloatArray
from herijk.pipeline.blocks.batch import Batch
from herijk.pipeline.blocks.run_blocks import RunBlocks
from herijk.pipeline.channels import BACK, OUT
from herijk.pipeline.choice import first_largest
from herijk.pipeline.method.definition import Method, Steps
from herijk.pipeline.recompute.outcome import Outcome, TowFactor
from herijk.pipeline.recompute.results import Recomputed, as_tables
from herijk.pipeline.recompute.run_cache import RunCache
from herijk.pipeline.recompute.season_factors import (
    factor_of_tows,
    find_season_factors,
    is_estimated,
    without_factor,
)
from herijk.pipeline.season_log import SeasonFactors
from herijk.pipeline.steps.calibration import gps_factor
from herijk.pipeline.steps.hull import front_area_m2, hull_speed_m_s, still_air_coefficient_kg_m
from herijk.pipeline.steps.resistance import RunMeans, temperature_change_kg_m
from herijk.pipeline.steps.speed import log_factor
from herijk.pipeline.steps.wind import PER_TOW_BOUNDS, nearest_coefficients
from herijk.pipeline.steps.window import Windows

NOT_SELECTED = "not_selected"
NO_STEADY_WINDOW = "no_steady_window"
ABOVE_TARGET = "above_target_speed"
NOT_CALIBRATED = "not_calibrated"

PER_RUN_ITERATIONS = 4
"""The old tool printed "4 iteraties" (presentation 2015, screens of Razende Snol)."""

PER_TOW_GRID = np.linspace(*PER_TOW_BOUNDS, 41)
ARCHIVE_GRID = np.linspace(0.0, 1.2, 13)

Texts: TypeAlias = np.ndarray[tuple[int, ...], np.dtype[np.str_]]


def recompute(
    method: Method,
    tows: pl.DataFrame,
    blocks: RunBlocks,
    cache: RunCache | None = None,
    with_bands: bool = True,
) -> Recomputed:
    """Run points, curves, log factors and assessments of all tows under a method.

    Args:
        method: the method.
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
    asked = any(is_estimated(held.steps) for held in method.ranges)
    found = season_factors(plans, cache) if asked else None
    factors = None if found is None else found.factors
    return as_tables(method, tows, evaluate(plans, cache, factors), found, with_bands)


def season_factors(plans: Sequence[tuple[Batch, Steps]], cache: RunCache) -> SeasonFactors | None:
    """The log factors that the given steps ask to estimate, and how far tows scatter.

    None if not a single tow has a curve from which to estimate.
    """
    before = evaluate([(batch, without_factor(steps)) for batch, steps in plans], cache)
    if not any((np.isfinite(o.cw_at_declared) & o.batch.trusted).any() for o in before):
        return None
    return find_season_factors(before)


def log_factors(plans: Sequence[tuple[Batch, Steps]], cache: RunCache) -> pl.DataFrame | None:
    """The factors alone, as `evaluate` wants them; None if the steps ask for none."""
    if not any(is_estimated(steps) for _, steps in plans):
        return None
    found = season_factors(plans, cache)
    return None if found is None else found.factors


def batches(
    methods: Sequence[Method], tows: pl.DataFrame, blocks: RunBlocks
) -> list[tuple[Batch, tuple[Steps, ...]]]:
    """Tows that share their steps under every method, together: each step works on all at once.

    Returns:
        Batches, each with its steps under each of the methods.
    """
    seasons: dict[str, tuple[tuple[Steps, ...], list[int]]] = {}
    for season in tows["season"].unique().sort():
        steps = tuple(method.for_season(season) for method in methods)
        seasons.setdefault(str(steps), (steps, []))[1].append(season)
    return [
        (Batch.of(tows.filter(pl.col("season").is_in(held)), blocks), steps)
        for steps, held in seasons.values()
    ]


def evaluate(
    plans: Sequence[tuple[Batch, Steps]],
    cache: RunCache,
    factors: pl.DataFrame | None = None,
) -> list[Outcome]:
    """What the given steps make of each batch.

    Args:
        plans: batches with their steps; what is searched over the archive is searched over them.
        cache: what was found before of the same tows; added to.
        factors: rows of `SeasonFactors.factors` or of the table `season_links`, for steps that
            ask for estimated log factors.
    """
    prepared = [
        _prepare(batch, steps, cache, factor_of_tows(batch, steps, factors))
        for batch, steps in plans
    ]
    shared = _archive_coefficient([p for p in prepared if p.steps.wind.coefficients == "archive"])
    return [_finish(p, shared) for p in prepared]


@dataclass(frozen=True)
class _Prepared:
    """A batch with everything that does not depend on the wind coefficients.

    Attributes:
        known: speed factor of the log's known error, shape (tows,).
        y: calibration factor, shape (tows,).
        calibrated: there is one, shape (tows,).
        estimated: what was estimated of the log factor.
        reasons: why a run does not count, empty where it does, shape (runs,).
        still_unit_kg_m: still-air coefficient for a drag coefficient of 1, shape (runs,).
        temperature_kg_m: change to the reference temperature, shape (runs,).
        temperature_known: shape (tows,).
    """

    batch: Batch
    steps: Steps
    windows: Windows
    means: RunMeans
    known: FloatArray
    y: FloatArray
    calibrated: BoolArray
    estimated: TowFactor
    reasons: Texts
    still_unit_kg_m: FloatArray
    temperature_kg_m: FloatArray
    temperature_known: BoolArray

    @cached_property
    def factor(self) -> FloatArray:
        """True speed / log speed of each run, shape (runs,)."""
        return (self.known * self.y)[self.batch.tow]

    @cached_property
    def used(self) -> BoolArray:
        """Runs that count, shape (runs,)."""
        return np.asarray(self.reasons == "")

    @cached_property
    def in_fit(self) -> BoolArray:
        """Runs that count, of tows that have enough of them, shape (runs,)."""
        return (
            self.used & enough_runs(self.batch, self.used, self.steps.runs.minimum)[self.batch.tow]
        )

    @cached_property
    def speed_m_s(self) -> FloatArray:
        """Mean true speed, shape (runs,)."""
        return self.means.speed_m_s * self.factor

    def air_kg_m(self, ahead: FloatArray, behind: FloatArray) -> FloatArray:
        """The air part that is taken off, shape (runs,)."""
        if self.steps.wind.reading == "cw_vac_2014":
            return 2.0 * self.still_kg_m(ahead)
        return self.means.air.total(ahead, behind, self.steps.wind.side) / self.factor**2

    def still_kg_m(self, ahead: FloatArray) -> FloatArray:
        """The still-air part that is put back, shape (runs,)."""
        return self.still_unit_kg_m * ahead

    def cw_kg_m(self, ahead: FloatArray, behind: FloatArray, still: FloatArray) -> FloatArray:
        """Corrected coefficient of each run for given drag coefficients, shape (runs,)."""
        water = (self.means.gross_kg_m - self.means.inertia_kg_m) / self.factor**2
        return water - self.air_kg_m(ahead, behind) + self.still_kg_m(still) + self.temperature_kg_m

    def points(self, cw_kg_m: FloatArray) -> curve.Points:
        """Points of all tows that have enough runs, for a batch fit."""
        batch = self.batch
        return curve.Points(
            batch.by_tow(self.speed_m_s),
            batch.by_tow(cw_kg_m),
            batch.by_tow(self.in_fit & (cw_kg_m > 0) & (self.speed_m_s > 0)) > 0,
        )


def enough_runs(batch: Batch, used: BoolArray, minimum: int) -> BoolArray:
    """Tows with enough runs, and runs both ways so that wind and stream can be judged."""
    out = batch.count(used & (batch.direction == OUT))
    back = batch.count(used & (batch.direction == BACK))
    return (out + back >= minimum) & (out > 0) & (back > 0)


def _prepare(batch: Batch, steps: Steps, cache: RunCache, estimated: TowFactor) -> _Prepared:
    windows, means = cache.windows(batch, steps), cache.means(batch, steps)
    tow_list = batch.of_tow("speed_correction_ratio")
    known = log_factor(steps.speed, tow_list, estimated.factor)
    reasons = _reasons(batch, steps, windows, means.speed_m_s * known[batch.tow])
    y, determined = _calibrate(
        batch, steps, windows, means.speed_m_s * known[batch.tow], reasons == ""
    )
    reasons = np.where((reasons == "") & ~determined[batch.tow], NOT_CALIBRATED, reasons)
    speed = means.speed_m_s * (known * y)[batch.tow]
    temperature, temperature_known = temperature_change_kg_m(batch, steps.temperature, speed)
    front = front_area_m2(batch.of_run("beam_m"), batch.of_run("bow_height_m"))
    has_wind = float(steps.wind.model != "none")
    return _Prepared(
        batch,
        steps,
        windows,
        means,
        known,
        y,
        determined & (steps.calibration.rule != "none"),
        estimated,
        reasons,
        still_unit_kg_m=still_air_coefficient_kg_m(front, has_wind),
        temperature_kg_m=temperature,
        temperature_known=temperature_known,
    )


def _reasons(batch: Batch, steps: Steps, windows: Windows, speed_m_s: FloatArray) -> Texts:
    """Why a run does not count, before calibration; empty where it does."""
    too_fast = speed_m_s > steps.runs.highest_target_ratio * batch.of_run("declared_speed_m_s")
    return np.select(
        [~batch.selected, ~windows.found, too_fast],
        [NOT_SELECTED, NO_STEADY_WINDOW, ABOVE_TARGET],
        "",
    )


def _calibrate(
    batch: Batch, steps: Steps, windows: Windows, log_m_s: FloatArray, used: BoolArray
) -> tuple[FloatArray, BoolArray]:
    """Factor on the log speed as corrected so far, and whether it is known, shape (tows,)."""
    if steps.calibration.rule == "none":
        return np.ones(batch.size), np.ones(batch.size, dtype=bool)
    samples = batch.blocks.total("gps_n", windows.mask)
    gps = batch.blocks.total("gps", windows.mask) / np.maximum(samples, 1.0)
    y, determined = gps_factor(
        gps, log_m_s, batch.direction, batch.tow, used & (samples > 0), batch.size
    )
    if steps.calibration.rule == "gps_per_tow":
        return y, determined
    return _mean_of_season(batch, y, determined)


def _mean_of_season(
    batch: Batch, y: FloatArray, determined: BoolArray
) -> tuple[FloatArray, BoolArray]:
    """The mean factor of each season's tows, for all of its tows."""
    _, season = np.unique(batch.of_tow("season"), return_inverse=True)
    count = np.bincount(season, determined)
    mean = np.bincount(season, np.where(determined, y, 0.0)) / np.maximum(count, 1)
    return np.where(count > 0, mean, 1.0)[season], (count > 0)[season]


def _finish(prepared: _Prepared, archive_coefficient: float | None) -> Outcome:
    ahead, behind, still = _coefficients(prepared, archive_coefficient)
    cw = prepared.cw_kg_m(ahead, behind, still)
    points = prepared.points(cw)
    free = curve.fit(points)
    return Outcome(
        batch=prepared.batch,
        steps=prepared.steps,
        windows=prepared.windows,
        reasons=prepared.reasons,
        known_factor=prepared.known,
        calibration_factor=prepared.y,
        calibrated=prepared.calibrated,
        estimated=prepared.estimated,
        speed_m_s=prepared.speed_m_s,
        speed_factor=prepared.factor,
        gross_kg_m=prepared.means.gross_kg_m / prepared.factor**2,
        sd_kg_m=prepared.means.sd_kg_m / prepared.factor**2,
        inertia_kg_m=prepared.means.inertia_kg_m / prepared.factor**2,
        air_kg_m=prepared.air_kg_m(ahead, behind),
        still_air_kg_m=prepared.still_kg_m(still),
        still_air_coefficient=still,
        air_unit_kg_m=(prepared.means.air.ahead + prepared.means.air.behind) / prepared.factor**2,
        temperature_kg_m=prepared.temperature_kg_m,
        temperature_known=prepared.temperature_known,
        ahead=ahead,
        behind=behind,
        cw_kg_m=cw,
        points=points,
        free=free,
        curves=_choose_curve(prepared, points, free),
    )


def _choose_curve(prepared: _Prepared, points: curve.Points, free: curve.Curves) -> curve.Curves:
    rule = prepared.steps.curve
    if rule.b == "free":
        return free
    hull = hull_speed_m_s(prepared.batch.of_tow("waterline_length_m"))
    if rule.b == "capped":
        return curve.fit_capped(points, free, rule.cap_hull_speeds * hull)
    return curve.fit_given_b(points, hull)


def _coefficients(
    prepared: _Prepared, archive_coefficient: float | None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Drag coefficients ahead, behind and in still air, each of shape (runs,)."""
    wind = prepared.steps.wind
    runs = len(prepared.batch.tow)
    fixed = np.full(runs, wind.ahead), np.full(runs, wind.behind)
    if wind.coefficients == "archive" and archive_coefficient is not None:
        one = np.full(runs, archive_coefficient)
        return one, one, one
    if wind.coefficients == "per_tow":
        one = _best_per_tow(prepared)[prepared.batch.tow]
        return one, one, one
    if wind.coefficients == "per_run":
        return *_best_per_run(prepared, *fixed), fixed[0]
    return *fixed, fixed[0]


def _best_per_run(
    prepared: _Prepared, ahead: FloatArray, behind: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Coefficients searched run by run so that each point comes nearest to the curve.

    The old rule: fit, move every run as near to the curve as its wind allows, fit again. The
    still-air part keeps its fixed coefficient (inferred).
    """
    still = ahead
    for _ in range(PER_RUN_ITERATIONS):
        cw = prepared.cw_kg_m(ahead, behind, still)
        curves = curve.fit(prepared.points(cw))
        tow = prepared.batch.tow
        on_curve = curve.cw(curves.a_kg_m[tow], curves.s_s2_m2[tow], prepared.speed_m_s)
        fits = curves.converged[tow] & np.isfinite(on_curve)
        excess = cw + prepared.air_kg_m(ahead, behind) - np.where(fits, on_curve, cw)
        searched = nearest_coefficients(prepared.means.air, excess * prepared.factor**2)
        ahead = np.where(fits, searched[0], ahead)
        behind = np.where(fits, searched[1], behind)
    return ahead, behind


def _misfits(prepared: _Prepared, grid: FloatArray) -> FloatArray:
    """Residual sum of squares / Cw^2 with each drag coefficient, shape (coefficients, tows)."""
    each = [np.full(len(prepared.batch.tow), coefficient) for coefficient in grid]
    points = [prepared.points(prepared.cw_kg_m(one, one, one)) for one in each]
    curves = curve.fit(curve.Points.stack(points))
    scale = curves.cw_at(np.tile(prepared.batch.of_tow("declared_speed_m_s"), len(grid)))
    sound = curves.converged & np.isfinite(scale)
    misfit = np.where(sound, curves.rss_kg2_m2 / np.where(sound, scale, 1.0) ** 2, 0.0)
    return misfit.reshape(len(grid), -1)


def _best_per_tow(prepared: _Prepared) -> FloatArray:
    """One coefficient per tow within its bounds, by trying all of a fine grid, shape (tows,)."""
    best = first_largest(-_misfits(prepared, PER_TOW_GRID))
    return np.asarray(PER_TOW_GRID[best], dtype=np.float64)


def _archive_coefficient(prepared: list[_Prepared]) -> float | None:
    """One coefficient for the whole archive: the least misfit of all tows together.

    Out and back feel different wind, so a wrong coefficient drives their points apart. The misfit
    is a parabola in the coefficient, near its minimum; None without tows.
    """
    if not prepared:
        return None
    total = np.sum(
        [np.where(p.batch.trusted, _misfits(p, ARCHIVE_GRID), 0.0).sum(axis=1) for p in prepared],
        axis=0,
    )
    best = int(np.clip(total.argmin(), 1, len(ARCHIVE_GRID) - 2))
    below, here, above = total[best - 1 : best + 2]
    bend = below - 2.0 * here + above
    step = ARCHIVE_GRID[1] - ARCHIVE_GRID[0]
    shift = 0.5 * (below - above) / bend if bend > 0 else 0.0
    return float(np.clip(ARCHIVE_GRID[best] + step * shift, ARCHIVE_GRID[0], ARCHIVE_GRID[-1]))
