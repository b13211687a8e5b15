"""A batch of tows under a method, as arrays: what was found step by step, and what follows.

Filled by `pipeline.recompute.recompute`, made into tables by `pipeline.recompute.results`.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray, StrArray
from pipeline.blocks.batch import Batch
from pipeline.hull import front_area_m2, hull_speed_m_s, still_air_coefficient_kg_m
from pipeline.method.constants import CAP_HULL_SPEEDS, FEWEST_RUNS
from pipeline.method.definition import Steps
from pipeline.steps.resistance import RunMeans
from pipeline.steps.window import Windows
from pipeline.uncertainty.propagation import Assumed


class Coefficients(NamedTuple):
    """Air drag coefficients of each run, shape (runs,): of wind from ahead, behind, and still."""

    ahead: FloatArray
    behind: FloatArray
    still: FloatArray


class ExpectedWind(NamedTuple):
    """Net wind correction of a tow / its still-air part, mean of out and back."""

    mean: float
    sd: float


STILL_AIR: Final = ExpectedWind(0.0, Assumed().unmeasured_wind)
"""Where nothing is expected: as if there was no wind."""


@dataclass(frozen=True)
class Computed:
    """A batch under the steps of a method.

    Attributes:
        known_factor: speed factor of the log's known error, shape (tows,).
        y: calibration factor of each run's file, shape (runs,).
        calibrated: tows that have one, shape (tows,).
        instruments: what was estimated of each tow's instruments, a row per tow, as
            `season_factors.instruments_of` gives it; null where nothing was.
        reasons: why a run does not count, empty where it does, shape (runs,).
        temperature_kg_m: change to the reference temperature, shape (runs,).
        temperature_known: shape (tows,).
        air: coefficients of each run.
        coefficient_sd: standard deviation of the archive's coefficient; NaN where there is none.
        wind_ln_scale: ln of the anemometer's scale, taken out of `means`, shape (tows,), and
        wind_ln_sd: its standard deviation; NaN where the wind is taken as it reads.
        expected_wind: what is taken off, and how uncertain that is, where no wind was measured.
    """

    batch: Batch
    steps: Steps
    windows: Windows
    means: RunMeans
    known_factor: FloatArray
    y: FloatArray
    calibrated: BoolArray
    instruments: pl.DataFrame
    reasons: StrArray
    temperature_kg_m: FloatArray
    temperature_known: BoolArray
    air: Coefficients
    wind_ln_scale: FloatArray
    wind_ln_sd: FloatArray
    coefficient_sd: float = np.nan
    expected_wind: ExpectedWind = STILL_AIR

    def estimated(self, name: str) -> FloatArray:
        """A column of `instruments`, shape (tows,); NaN where nothing was estimated."""
        return self.instruments[name].cast(pl.Float64).to_numpy()

    # Speed

    @cached_property
    def speed_factor(self) -> FloatArray:
        """True speed / log speed of each run, shape (runs,)."""
        return self.known_factor[self.batch.tow] * self.y

    @cached_property
    def calibration_factor(self) -> FloatArray:
        """Mean calibration factor of the runs that count, shape (tows,); 1 where there are none."""
        return np.where(self.batch.any(self.used), self.batch.mean(self.y, self.used), 1.0)

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
        enough = self.batch.count(self.used) >= FEWEST_RUNS
        return self.used & (enough & self.batch.both_ways(self.used))[self.batch.tow]

    # Air and water

    @cached_property
    def water_off_c(self) -> FloatArray:
        """How far the water is from its day's, where the method corrects for it, shape (tows,)."""
        return self.batch.of_tow("water_off_c") * (self.steps.temperature.rule != "none")

    @cached_property
    def still_unit_kg_m(self) -> FloatArray:
        """Still-air coefficient for a drag coefficient of 1, shape (runs,)."""
        batch = self.batch
        front = front_area_m2(batch.of_run("beam_m"), batch.of_run("bow_height_m"))
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
        parts = self.means.air.total(air.ahead, air.behind, self.steps.wind.side)
        felt = self.by_true_speed(parts)
        if not self.steps.expects_unrecorded:
            return felt
        expected = (1.0 + self.expected_wind.mean) * self.still_unit_kg_m * air.ahead
        return np.where(self.batch.measured("wind")[self.batch.tow], felt, expected)

    def wind_ratio(self) -> FloatArray:
        """Net wind correction / still-air part, shape (tows,); NaN where no wind was measured."""
        batch = self.batch
        put_back = batch.mean(self.still_air_kg_m, self.used)
        net = batch.mean(self.air_kg_m, self.used) - put_back
        known = batch.measured("wind") & batch.trusted & (put_back > 0)
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
        batch = self.batch
        return curve.Points(
            batch.by_tow(self.speed_m_s),
            batch.by_tow(cw_kg_m),
            batch.by_tow(self.in_fit & (cw_kg_m > 0) & (self.speed_m_s > 0)) > 0,
        )

    @cached_property
    def free(self) -> curve.Curves:
        """The hyperbola with B free, shape (tows,)."""
        return curve.fit(self.points)

    @cached_property
    def curves(self) -> curve.Curves:
        """The hyperbola that the method chooses, shape (tows,)."""
        if self.steps.curve.b == "free":
            return self.free
        hull = hull_speed_m_s(self.batch.of_tow("waterline_length_m"))
        return curve.fit_capped(self.points, self.free, CAP_HULL_SPEEDS * hull)

    @property
    def cw_at_declared(self) -> FloatArray:
        """Cw at the declared speed of each tow, shape (tows,); NaN where there is no curve."""
        return self.cw_at(1.0)

    def cw_at(self, speed_ratio: float, curves: curve.Curves | None = None) -> FloatArray:
        """Cw of each tow at a speed / declared speed, shape (tows,); NaN where there is none."""
        by = self.curves if curves is None else curves
        cw = by.cw_at(speed_ratio * self.batch.of_tow("declared_speed_m_s"))
        return np.where(by.converged & np.isfinite(cw), cw, np.nan)
