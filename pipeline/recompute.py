"""Recompute: every tow under one method, from blocks to curves.

Here the steps are put in their order and the tables are filled; each step's formulas stand in its
own module. The order is: speed correction, steady window, run means, calibration, wind, run point,
choice of runs, curve, assessment. Nothing here knows a season: the method says what holds when.
"""

from dataclasses import dataclass

import numpy as np
import polars as pl

from pipeline import assessment, curve
from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.blocks import RunBlocks
from pipeline.calibration import gps_factor
from pipeline.channels import BACK, OUT
from pipeline.hull import (
    front_area_m2,
    hull_speed_m_s,
    side_area_m2,
    still_air_coefficient_kg_m,
)
from pipeline.method import Method, Steps
from pipeline.race import power_per_rower_w
from pipeline.resistance import RunPoints, run_points
from pipeline.speed import prescribed_factor
from pipeline.steady import Windows, choose_windows
from pipeline.wind import air_part, air_weights, mean_wind_angle_deg

NOT_SELECTED = "not_selected"
NO_STEADY_WINDOW = "no_steady_window"
ABOVE_TARGET = "above_target_speed"
NOT_CALIBRATED = "not_calibrated"


@dataclass(frozen=True)
class Recomputed:
    """The tables of one method: `run_points`, `curves` and `log_factors` of the warehouse."""

    run_points: pl.DataFrame
    curves: pl.DataFrame
    log_factors: pl.DataFrame


def recompute(method: Method, tows: pl.DataFrame, blocks: RunBlocks) -> Recomputed:
    """Run points, curves and log factors of all tows under a method.

    Args:
        method: the method.
        tows: rows of the warehouse's `tows`.
        blocks: their runs; `blocks.runs` has `tow_id`, `run`, `direction`,
            `target_speed_ratio` and `selected`.

    Raises:
        MissingKnowledgeError: the method says nothing about a season of `tows`.
    """
    tows = tows.sort("tow_id")
    seasons = tows["season"].unique().sort().to_list()
    parts = []
    for steps, held in _seasons_by_steps(method, seasons):
        some = tows.filter(pl.col("season").is_in(held))
        inside = blocks.runs["tow_id"].is_in(some["tow_id"].implode()).to_numpy()
        parts.append(_Batch.of(some, blocks.take(inside)).recompute(steps))
    name = pl.lit(method.name).alias("method")
    return Recomputed(
        run_points=pl.concat([p.run_points for p in parts]).select(name, pl.all()),
        curves=pl.concat([p.curves for p in parts]).select(name, pl.all()),
        log_factors=pl.concat([p.log_factors for p in parts]).select(name, pl.all()),
    )


def _seasons_by_steps(method: Method, seasons: list[int]) -> list[tuple[Steps, list[int]]]:
    """Seasons that share their steps, together, so that each step works on all of them at once."""
    groups: list[tuple[Steps, list[int]]] = []
    for season in seasons:
        steps = method.for_season(season)
        held = next((seen for other, seen in groups if other == steps), None)
        if held is None:
            groups.append((steps, [season]))
        else:
            held.append(season)
    return groups


@dataclass(frozen=True)
class _Batch:
    """Tows with equal steps, and their runs; arrays are of shape (runs,) or (tows,)."""

    tows: pl.DataFrame
    blocks: RunBlocks
    tow: IntArray
    """Index of each run's tow."""

    @classmethod
    def of(cls, tows: pl.DataFrame, blocks: RunBlocks) -> "_Batch":
        index = tows.select("tow_id").with_row_index("tow")
        joined = blocks.runs.join(index, on="tow_id", how="left", maintain_order="left")
        return cls(tows, blocks, joined["tow"].to_numpy().astype(np.int64))

    def tow_column(self, name: str) -> FloatArray:
        """A number of the tow; NaN where it is null."""
        return self.tows[name].cast(pl.Float64).to_numpy()

    def run_column(self, name: str) -> FloatArray:
        return self.blocks.runs[name].cast(pl.Float64).to_numpy()

    def recompute(self, steps: Steps) -> Recomputed:
        windows = choose_windows(self.blocks, steps.window)
        known = prescribed_factor(steps.speed, self.tow_column("speed_correction_ratio"))
        reasons = self._reasons_before_calibration(steps, windows, known)
        y, determined = self._calibrate(steps, windows, reasons == "")
        reasons = np.where((reasons == "") & ~determined[self.tow], NOT_CALIBRATED, reasons)
        factor = known * y
        points = self._run_points(steps, windows.mask, factor[self.tow])
        used = reasons == ""
        curves = self._fit(steps, points, used)
        return Recomputed(
            self._run_points_table(windows, points, factor, reasons, curves),
            self._curves_table(steps, points, used, curves, y),
            self._log_factors_table(steps, known),
        )

    def _reasons_before_calibration(
        self, steps: Steps, windows: Windows, known: FloatArray
    ) -> np.ndarray[tuple[int], np.dtype[np.str_]]:
        """Why a run does not count, empty where it does."""
        speed = self.blocks.mean(f"{steps.speed.source}_v", windows.mask) * known[self.tow]
        too_fast = speed > steps.runs.highest_target_ratio * self._of_run("declared_speed_m_s")
        selected = self.blocks.runs["selected"].to_numpy()
        return np.select(
            [~selected, ~windows.found, too_fast],
            [NOT_SELECTED, NO_STEADY_WINDOW, ABOVE_TARGET],
            "",
        )

    def _of_run(self, tow_column: str) -> FloatArray:
        return self.tow_column(tow_column)[self.tow]

    def _calibrate(
        self, steps: Steps, windows: Windows, used: BoolArray
    ) -> tuple[FloatArray, BoolArray]:
        tows = self.tows.height
        if steps.calibration.rule == "none":
            return np.ones(tows), np.ones(tows, dtype=bool)
        has_gps = self.blocks.total("gps_n", windows.mask) > 0
        return gps_factor(
            gps_m_s=self._gps_mean(windows.mask),
            log_m_s=self.blocks.mean(f"{steps.speed.source}_v", windows.mask),
            direction=self.run_column("direction").astype(np.int64),
            tow=self.tow,
            used=used & has_gps,
            tows=tows,
        )

    def _gps_mean(self, window: BoolArray) -> FloatArray:
        samples = self.blocks.total("gps_n", window)
        return self.blocks.total("gps", window) / np.maximum(samples, 1.0)

    def _run_points(self, steps: Steps, window: BoolArray, factor: FloatArray) -> RunPoints:
        front = front_area_m2(self._of_run("beam_m"), self._of_run("bow_height_m"))
        side = side_area_m2(self._of_run("waterline_length_m"), self._of_run("bow_height_m"))
        source = steps.speed.source
        weights = air_weights(steps.wind, front, side)
        air = air_part(self.blocks, window, source, weights)
        still = still_air_coefficient_kg_m(front, steps.wind.ahead)
        return run_points(self.blocks, window, source, factor, air, still)

    def _fit(self, steps: Steps, points: RunPoints, used: BoolArray) -> "_Fitted":
        held = used & self._enough_runs(steps, used)[self.tow]
        place = _place_in_tow(self.tow)
        shape = (self.tows.height, int(place.max(initial=0)) + 1)
        speed, cw = np.zeros(shape), np.zeros(shape)
        mask = np.zeros(shape, dtype=bool)
        speed[self.tow, place], cw[self.tow, place] = points.speed_m_s, points.cw_kg_m
        mask[self.tow, place] = held & (points.cw_kg_m > 0)
        batch = curve.Points(speed, cw, mask)
        free = curve.fit(batch)
        hull = hull_speed_m_s(self.tow_column("waterline_length_m"))
        capped = curve.fit_capped(batch, steps.curve.cap_hull_speeds * hull)
        return _Fitted(batch, free, capped if steps.curve.b == "capped" else free)

    def _enough_runs(self, steps: Steps, used: BoolArray) -> BoolArray:
        """Tows with enough runs, and runs both ways so that wind and stream can be judged."""
        direction = self.run_column("direction")
        out = np.bincount(self.tow, used & (direction == OUT), self.tows.height)
        back = np.bincount(self.tow, used & (direction == BACK), self.tows.height)
        return (out + back >= steps.runs.minimum) & (out > 0) & (back > 0)

    def _run_points_table(
        self,
        windows: Windows,
        points: RunPoints,
        factor: FloatArray,
        reasons: np.ndarray[tuple[int], np.dtype[np.str_]],
        fitted: "_Fitted",
    ) -> pl.DataFrame:
        mask, used = windows.mask, reasons == ""
        log1 = self.blocks.mean("log1_v", mask)
        curves = fitted.curves
        on_curve = curve.cw(curves.a_kg_m[self.tow], curves.s_s2_m2[self.tow], points.speed_m_s)
        has_gps = windows.found & (self.blocks.total("gps_n", mask) > 0)
        found, fits = windows.found, windows.found & curves.converged[self.tow]
        fits &= np.isfinite(on_curve)
        return self.blocks.runs.select(
            "tow_id", "run", "direction", "target_speed_ratio"
        ).with_columns(
            _column("window_start_s", windows.start_s, found),
            _column("window_end_s", windows.end_s, found),
            pl.Series("cut_reason", windows.reasons, pl.String),
            _column("speed_factor", factor[self.tow], found),
            _column("speed_m_s", points.speed_m_s, found),
            _column("gross_cw_kg_m", points.gross_kg_m, found),
            _column("air_cw_kg_m", points.air_kg_m, found),
            _column("still_air_cw_kg_m", points.still_air_kg_m, found),
            _column("cw_kg_m", points.cw_kg_m, found),
            _column("cw_sd", points.cw_sd, found),
            _column("fitted_cw_kg_m", on_curve, fits),
            _column("wind_m_s", self.blocks.mean("wind_v", mask), found),
            _column("wind_angle_deg", mean_wind_angle_deg(self.blocks, mask), found),
            _column(
                "log2_ratio", self.blocks.mean("log2_v", mask) / np.where(found, log1, 1), found
            ),
            _column("gps_ratio", self._gps_mean(mask) / np.where(found, log1, 1), has_gps),
            pl.Series("used", used),
            pl.Series("reason", reasons, pl.String),
        )

    def _curves_table(
        self,
        steps: Steps,
        points: RunPoints,
        used: BoolArray,
        fitted: "_Fitted",
        y: FloatArray,
    ) -> pl.DataFrame:
        declared = self.tow_column("declared_speed_m_s")
        curves = fitted.curves
        cw = curves.cw_at(declared)
        sound = curves.converged & np.isfinite(cw)
        cw_interval, b_interval = fitted.intervals(declared)
        count = np.bincount(self.tow, used, self.tows.height).astype(np.int64)
        rowers = self.tow_column("rowers")
        residual = np.sqrt(curves.rss_kg2_m2 / np.maximum(curves.n_points - 2, 1))
        safe = np.where(sound, cw, 1.0)
        flags = assessment.flags(
            assessment.Observed(
                tow=self.tow,
                tows=self.tows.height,
                used=used,
                speed_m_s=points.speed_m_s,
                intended_m_s=self.run_column("target_speed_ratio")
                * self._of_run("declared_speed_m_s"),
                cw_kg_m=points.cw_kg_m,
                cw_sd_kg_m=points.cw_sd,
                direction=self.run_column("direction"),
                runs_used=count,
                curve_found=sound,
                b_capped=curves.b_capped,
                b_determined=curves.b_determined,
                calibration_factor=y,
            )
        )
        rejected = ~sound
        status = np.where(
            rejected, "rejected", np.where([bool(f) for f in flags], "flagged", "accepted")
        )
        chosen = self.tows.select(
            "tow_id", "fsn_no", "season", "rowers", "crew_class", "declared_speed_m_s"
        )
        calibrated = np.full(self.tows.height, steps.calibration.rule != "none")
        return chosen.with_columns(
            _column("a_kg_m", curves.a_kg_m, sound),
            _column("b_m_s", curves.b_m_s, sound & curves.b_determined),
            pl.Series("b_capped", curves.b_capped),
            _column("cw_kg_m", cw, sound),
            _column("cw_lo_kg_m", cw_interval.lo, sound & (cw_interval.lo > 0)),
            _column("cw_hi_kg_m", cw_interval.hi, sound),
            _column("b_lo_m_s", b_interval.lo, sound),
            _column("b_hi_m_s", b_interval.hi, sound),
            _column("power_w", power_per_rower_w(safe, declared, rowers), sound),
            _column("residual_sd_ratio", residual / safe, sound),
            _column("calibration_factor", y, calibrated),
            pl.Series("runs_used", count, pl.Int8),
            pl.Series("status", status, pl.String),
            pl.Series("flags", flags, pl.List(pl.String)),
        )

    def _log_factors_table(self, steps: Steps, known: FloatArray) -> pl.DataFrame:
        """The season's factor; a tow's own percentage stands in `run_points.speed_factor`."""
        seasons = self.tows["season"].unique().sort()
        factor = prescribed_factor(steps.speed, np.full(len(seasons), np.nan))
        return pl.DataFrame(
            {
                "season": seasons,
                "factor": factor,
                "lo": pl.Series([None] * len(seasons), dtype=pl.Float64),
                "hi": pl.Series([None] * len(seasons), dtype=pl.Float64),
                "source": [steps.speed.correction] * len(seasons),
            }
        )


@dataclass(frozen=True)
class _Fitted:
    """The points that were fitted, their free fit, and the curves that the method asks for."""

    points: curve.Points
    free: curve.Curves
    curves: curve.Curves

    def intervals(self, declared_m_s: FloatArray) -> tuple[curve.Interval, curve.Interval]:
        """95 % intervals of Cw at the declared speed and of B, from the points' own scatter."""
        scatter = curve.own_scatter(self.free)
        errors = curve.covariance(self.points, self.free, scatter, declared_m_s)
        cw = curve.cw_interval(self.curves, errors, scatter.dof, declared_m_s)
        return cw, curve.b_interval(self.points, self.free, scatter)


def _place_in_tow(tow: IntArray) -> IntArray:
    """Rank of each run within its tow: 0, 1, 2, ... for runs that are sorted by tow."""
    first = np.searchsorted(tow, tow, side="left")
    return np.asarray(np.arange(len(tow)) - first, dtype=np.int64)


def _column(name: str, values: FloatArray | IntArray, known: BoolArray) -> pl.Series:
    """A column of numbers, null where nothing is known or the number is infinite."""
    numbers = np.asarray(values, dtype=np.float64)
    sound = known & np.isfinite(numbers)
    column = pl.Series(name, np.where(sound, numbers, 0.0))
    return pl.select(pl.when(pl.Series(sound)).then(column).alias(name)).to_series()
