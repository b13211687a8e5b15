"""Tows under a method, as arrays: the result of each step, and what follows from them.

Filled step by step by `pipeline.recompute.recompute`, made into tables by
`pipeline.recompute.results`.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray, IntArray, StrArray
from pipeline.blocks.tows import Tows
from pipeline.hull import front_area_m2, hull_speed_m_s, still_air_coefficient_kg_m
from pipeline.method.constants import CAP_HULL_SPEEDS, FEWEST_RUNS
from pipeline.recompute.options import StepOptions
from pipeline.recompute.plan import Plan
from pipeline.steps.resistance import RunMeans


class Drag(NamedTuple):
    """Air drag coefficients of each run, shape (runs,): of wind from ahead, behind, and still."""

    ahead: FloatArray
    behind: FloatArray
    still: FloatArray


@dataclass(frozen=True)
class SpeedCorrection:
    """What brings the log to true speed.

    Attributes:
        log_factor: factor of the log's known error, shape (tows,).
        gps_factor: calibration factor of each run's file, shape (runs,); 1 without calibration.
        is_calibrated: tows that are calibrated on dGPS, shape (tows,).
    """

    log_factor: FloatArray
    gps_factor: FloatArray
    is_calibrated: BoolArray


@dataclass(frozen=True)
class TemperatureCorrection:
    """What brings Cw to the reference temperature.

    Attributes:
        change_kg_m: change of Cw, shape (runs,).
        is_known: tows whose temperature was recorded and used, shape (tows,).
    """

    change_kg_m: FloatArray
    is_known: BoolArray


@dataclass(frozen=True)
class AirCorrection:
    """How the resistance in air is taken off; standard deviations are NaN where none was estimated.

    Attributes:
        drag: coefficients of each run.
        anemometer_ln_scale, anemometer_ln_sd: ln of the anemometer's scale, which is taken out of
            the means, shape (tows,).
        unrecorded_ratio, unrecorded_sd: net wind correction / its still-air part, mean of out and
            back, that is taken off where no wind was measured, shape (tows,).
    """

    drag: Drag
    anemometer_ln_scale: FloatArray
    anemometer_ln_sd: FloatArray
    unrecorded_ratio: FloatArray
    unrecorded_sd: FloatArray


@dataclass(frozen=True)
class Computed:
    """Tows under the steps that each follows.

    Attributes:
        plan: the tows and their steps.
        windows: of every run, by name as `Windows.columns_of_runs` has them, shape (runs,).
        means: of every run over its window, in log speed.
        instruments: what was estimated of each tow's instruments, a row per tow, as
            `season_factors.get_instruments` gives it; null where nothing was.
        speed: correction of the log.
        temperature: correction to the reference temperature.
        air: correction for wind.
        reasons: why a run does not count, empty where it does, shape (runs,).
    """

    plan: Plan
    windows: dict[str, Any]
    means: RunMeans
    instruments: pl.DataFrame
    speed: SpeedCorrection
    temperature: TemperatureCorrection
    air: AirCorrection
    reasons: StrArray

    @property
    def tows(self) -> Tows:
        """The tows."""
        return self.plan.tows

    @property
    def options(self) -> StepOptions:
        """The options of each tow."""
        return self.plan.options

    @cached_property
    def season_group(self) -> IntArray:
        """Group of each tow; tows of one season under the same steps share one, shape (tows,)."""
        pairs = np.stack([self.plan.which, self.tows.get_of_tows("season")])
        return np.unique(pairs, axis=1, return_inverse=True)[1].ravel()

    def get_estimated(self, name: str) -> FloatArray:
        """Return a column of `instruments`, shape (tows,); NaN where nothing was estimated."""
        return self.instruments[name].cast(pl.Float64).to_numpy()

    # Speed

    @cached_property
    def speed_factor(self) -> FloatArray:
        """True speed / log speed of each run, shape (runs,)."""
        return self.speed.log_factor[self.tows.tow] * self.speed.gps_factor

    @cached_property
    def calibration_factor(self) -> FloatArray:
        """Mean calibration factor of the runs that count, shape (tows,); 1 where there are none."""
        mean = self.tows.mean(self.speed.gps_factor, self.used)
        return np.where(self.tows.any(self.used), mean, 1.0)

    @cached_property
    def speed_m_s(self) -> FloatArray:
        """Mean true speed, shape (runs,)."""
        return self.means.speed_m_s * self.speed_factor

    def refer_to_true_speed(self, kg_m: FloatArray) -> FloatArray:
        """Return a coefficient by log speed of each run as one by true speed, shape (runs,)."""
        return kg_m / self.speed_factor**2

    # Runs

    @cached_property
    def used(self) -> BoolArray:
        """Runs that count, shape (runs,)."""
        return np.asarray(self.reasons == "")

    @cached_property
    def is_in_fit(self) -> BoolArray:
        """Runs that count, of tows that have enough of them, and both ways, shape (runs,)."""
        enough = self.tows.count(self.used) >= FEWEST_RUNS
        return self.used & (enough & self.tows.both_ways(self.used))[self.tows.tow]

    # Air and water

    @cached_property
    def water_off_c(self) -> FloatArray:
        """How far the water is from its day's, where the method corrects for it, shape (tows,)."""
        return self.tows.get_of_tows("water_off_c") * self.options.corrects_temperature

    @cached_property
    def still_unit_kg_m(self) -> FloatArray:
        """Still-air coefficient for a drag coefficient of 1, shape (runs,)."""
        front = front_area_m2(
            self.tows.get_of_runs("beam_m"), self.tows.get_of_runs("bow_height_m")
        )
        return still_air_coefficient_kg_m(front, 1.0)

    @cached_property
    def air_kg_m(self) -> FloatArray:
        """The air part that is taken off, shape (runs,)."""
        return self.air_with(self.air.drag)

    @cached_property
    def still_air_kg_m(self) -> FloatArray:
        """The still-air part that is put back, shape (runs,)."""
        return self.still_unit_kg_m * self.air.drag.still

    def air_with(self, drag: Drag) -> FloatArray:
        """Return the air part that is taken off with given coefficients, shape (runs,)."""
        side = self.plan.run_options.wind.side
        felt = self.refer_to_true_speed(self.means.air.total(drag.ahead, drag.behind, side))
        is_missing = self.options.expects_unrecorded & ~self.tows.has_channel("wind")
        net_ratio = self.air.unrecorded_ratio[self.tows.tow]
        expected = (1.0 + net_ratio) * self.still_unit_kg_m * drag.ahead
        return np.where(is_missing[self.tows.tow], expected, felt)

    def wind_ratio(self) -> FloatArray:
        """Return net wind correction / still-air part, shape (tows,); NaN without an anemometer."""
        put_back = self.tows.mean(self.still_air_kg_m, self.used)
        net = self.tows.mean(self.air_kg_m, self.used) - put_back
        is_known = self.tows.has_channel("wind") & self.tows.trusted & (put_back > 0)
        return np.where(is_known, net / np.where(is_known, put_back, 1.0), np.nan)

    # Points and curve

    @cached_property
    def cw_kg_m(self) -> FloatArray:
        """Corrected coefficient, shape (runs,)."""
        return self.cw_with(self.air.drag)

    def cw_with(self, drag: Drag) -> FloatArray:
        """Return the corrected coefficient of each run with given drag, shape (runs,)."""
        gross = self.refer_to_true_speed(self.means.gross_kg_m)
        inertia = self.refer_to_true_speed(self.means.inertia_kg_m)
        net_air = self.air_with(drag) - self.still_unit_kg_m * drag.still
        return gross - inertia - net_air + self.temperature.change_kg_m

    @cached_property
    def points(self) -> curve.Points:
        """What the curve is fitted to."""
        return self.points_with(self.cw_kg_m)

    def points_with(self, cw_kg_m: FloatArray) -> curve.Points:
        """Return points of all tows that have enough runs, for a batch fit."""
        is_used = self.is_in_fit & (cw_kg_m > 0) & (self.speed_m_s > 0)
        return curve.Points(
            speed_m_s=self.tows.group_by_tow(self.speed_m_s),
            cw_kg_m=self.tows.group_by_tow(cw_kg_m),
            used=self.tows.group_by_tow(is_used) > 0,
        )

    @cached_property
    def free(self) -> curve.Curves:
        """The hyperbola with B free, shape (tows,)."""
        return curve.fit(self.points)

    @cached_property
    def curves(self) -> curve.Curves:
        """The hyperbola that the method chooses, shape (tows,)."""
        hull_speed = hull_speed_m_s(self.tows.get_of_tows("waterline_length_m"))
        capped = curve.fit_capped(self.points, self.free, CAP_HULL_SPEEDS * hull_speed)
        return curve.choose_curves(self.options.caps_b, capped, self.free)

    @property
    def cw_at_declared(self) -> FloatArray:
        """Cw at the declared speed of each tow, shape (tows,); NaN where there is no curve."""
        return self.cw_at(1.0)

    def cw_at(self, speed_ratio: float, curves: curve.Curves | None = None) -> FloatArray:
        """Return Cw at a speed / declared speed, shape (tows,); NaN where there is none."""
        chosen = self.curves if curves is None else curves
        cw = chosen.cw_at(speed_ratio * self.tows.get_of_tows("declared_speed_m_s"))
        return np.where(chosen.converged & np.isfinite(cw), cw, np.nan)
