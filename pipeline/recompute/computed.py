"""Tows under a method, as arrays: what was found step by step, and what follows.

Filled by `pipeline.recompute.recompute`, made into tables by `pipeline.recompute.results`.
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
from pipeline.recompute.plan import Plan
from pipeline.steps.resistance import RunMeans


class Coefficients(NamedTuple):
    """Air drag coefficients of each run, shape (runs,): of wind from ahead, behind, and still."""

    ahead: FloatArray
    behind: FloatArray
    still: FloatArray


@dataclass(frozen=True)
class Computed:
    """Tows under the steps that each follows.

    Attributes:
        plan: the tows and their steps.
        windows: of every run, by name as `Windows.of_runs` has them, shape (runs,).
        known_factor: speed factor of the log's known error, shape (tows,).
        y: calibration factor of each run's file, shape (runs,).
        calibrated: tows that have one, shape (tows,).
        instruments: what was estimated of each tow's instruments, a row per tow, as
            `season_factors.instruments_of` gives it; null where nothing was.
        reasons: why a run does not count, empty where it does, shape (runs,).
        temperature_kg_m: change to the reference temperature, shape (runs,).
        temperature_known: shape (tows,).
        air: coefficients of each run.
        coefficient_sd: standard deviation of the archive's coefficient, shape (tows,), as the next;
            NaN where there is none.
        wind_ln_scale: ln of the anemometer's scale, taken out of `means`, and
        wind_ln_sd: its standard deviation; NaN where the wind is taken as it reads.
        expected_wind, expected_wind_sd: net wind correction / its still-air part, mean of out and
            back, that is taken off where no wind was measured, and how uncertain that is.
    """

    plan: Plan
    windows: dict[str, Any]
    means: RunMeans
    known_factor: FloatArray
    y: FloatArray
    calibrated: BoolArray
    instruments: pl.DataFrame
    reasons: StrArray
    temperature_kg_m: FloatArray
    temperature_known: BoolArray
    air: Coefficients
    coefficient_sd: FloatArray
    wind_ln_scale: FloatArray
    wind_ln_sd: FloatArray
    expected_wind: FloatArray
    expected_wind_sd: FloatArray

    @property
    def tows(self) -> Tows:
        """The tows."""
        return self.plan.tows

    @cached_property
    def of_season(self) -> IntArray:
        """The same for tows of one season with the same steps, shape (tows,)."""
        pairs = np.stack([self.plan.which, self.tows.of_tow("season")])
        return np.unique(pairs, axis=1, return_inverse=True)[1].ravel()

    def estimated(self, name: str) -> FloatArray:
        """A column of `instruments`, shape (tows,); NaN where nothing was estimated."""
        return self.instruments[name].cast(pl.Float64).to_numpy()

    # Speed

    @cached_property
    def speed_factor(self) -> FloatArray:
        """True speed / log speed of each run, shape (runs,)."""
        return self.known_factor[self.tows.tow] * self.y

    @cached_property
    def calibration_factor(self) -> FloatArray:
        """Mean calibration factor of the runs that count, shape (tows,); 1 where there are none."""
        return np.where(self.tows.any(self.used), self.tows.mean(self.y, self.used), 1.0)

    @cached_property
    def speed_m_s(self) -> FloatArray:
        """Mean true speed, shape (runs,)."""
        return self.means.speed_m_s * self.speed_factor

    def by_true_speed(self, kg_m: FloatArray) -> FloatArray:
        """A coefficient of each run by log speed, now by true speed, shape (runs,)."""
        return kg_m / self.speed_factor**2

    # Runs

    @cached_property
    def used(self) -> BoolArray:
        """Runs that count, shape (runs,)."""
        return np.asarray(self.reasons == "")

    @cached_property
    def in_fit(self) -> BoolArray:
        """Runs that count, of tows that have enough of them, and both ways, shape (runs,)."""
        enough = self.tows.count(self.used) >= FEWEST_RUNS
        return self.used & (enough & self.tows.both_ways(self.used))[self.tows.tow]

    # Air and water

    @cached_property
    def water_off_c(self) -> FloatArray:
        """How far the water is from its day's, where the method corrects for it, shape (tows,)."""
        corrected: BoolArray = self.plan.option("temperature.rule") != "none"
        return self.tows.of_tow("water_off_c") * corrected

    @cached_property
    def still_unit_kg_m(self) -> FloatArray:
        """Still-air coefficient for a drag coefficient of 1, shape (runs,)."""
        tows = self.tows
        front = front_area_m2(tows.of_run("beam_m"), tows.of_run("bow_height_m"))
        return still_air_coefficient_kg_m(front, 1.0)

    @cached_property
    def air_kg_m(self) -> FloatArray:
        """The air part that is taken off, shape (runs,)."""
        return self.air_of(self.air)

    @cached_property
    def still_air_kg_m(self) -> FloatArray:
        """The still-air part that is put back, shape (runs,)."""
        return self.still_unit_kg_m * self.air.still

    def air_of(self, air: Coefficients) -> FloatArray:
        """The air part that is taken off for given coefficients, shape (runs,)."""
        side = self.plan.of_runs("wind.side")
        felt = self.by_true_speed(self.means.air.total(air.ahead, air.behind, side))
        missing = self.expects_unrecorded & ~self.tows.measured("wind")
        expected = (1.0 + self.expected_wind[self.tows.tow]) * self.still_unit_kg_m * air.ahead
        return np.where(missing[self.tows.tow], expected, felt)

    @property
    def expects_unrecorded(self) -> BoolArray:
        """Tows of which others say what nobody recorded, shape (tows,)."""
        return np.asarray(self.plan.option("unrecorded.rule") == "expected")

    def wind_ratio(self) -> FloatArray:
        """Net wind correction / still-air part, shape (tows,); NaN where no wind was measured."""
        tows = self.tows
        put_back = tows.mean(self.still_air_kg_m, self.used)
        net = tows.mean(self.air_kg_m, self.used) - put_back
        known = tows.measured("wind") & tows.trusted & (put_back > 0)
        return np.where(known, net / np.where(known, put_back, 1.0), np.nan)

    # Points and curve

    @cached_property
    def cw_kg_m(self) -> FloatArray:
        """Corrected coefficient, shape (runs,)."""
        return self.cw_of(self.air)

    def cw_of(self, air: Coefficients) -> FloatArray:
        """Corrected coefficient of each run for given drag coefficients, shape (runs,)."""
        gross, inertia = map(self.by_true_speed, (self.means.gross_kg_m, self.means.inertia_kg_m))
        net = self.air_of(air) - self.still_unit_kg_m * air.still
        return gross - inertia - net + self.temperature_kg_m

    @cached_property
    def points(self) -> curve.Points:
        """What the curve is fitted to."""
        return self.points_of(self.cw_kg_m)

    def points_of(self, cw_kg_m: FloatArray) -> curve.Points:
        """Points of all tows that have enough runs, for a batch fit."""
        tows = self.tows
        return curve.Points(
            tows.by_tow(self.speed_m_s),
            tows.by_tow(cw_kg_m),
            tows.by_tow(self.in_fit & (cw_kg_m > 0) & (self.speed_m_s > 0)) > 0,
        )

    @cached_property
    def free(self) -> curve.Curves:
        """The hyperbola with B free, shape (tows,)."""
        return curve.fit(self.points)

    @cached_property
    def curves(self) -> curve.Curves:
        """The hyperbola that the method chooses, shape (tows,)."""
        hull = hull_speed_m_s(self.tows.of_tow("waterline_length_m"))
        capped = curve.fit_capped(self.points, self.free, CAP_HULL_SPEEDS * hull)
        return curve.chosen(self.plan.option("curve.b") == "capped", capped, self.free)

    @property
    def cw_at_declared(self) -> FloatArray:
        """Cw at the declared speed of each tow, shape (tows,); NaN where there is no curve."""
        return self.cw_at(1.0)

    def cw_at(self, speed_ratio: float, curves: curve.Curves | None = None) -> FloatArray:
        """Cw of each tow at a speed / declared speed, shape (tows,); NaN where there is none."""
        by = self.curves if curves is None else curves
        cw = by.cw_at(speed_ratio * self.tows.of_tow("declared_speed_m_s"))
        return np.where(by.converged & np.isfinite(cw), cw, np.nan)
