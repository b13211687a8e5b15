"""What a method makes of a batch, as arrays: before the wind coefficients are known, and after.

Filled by `pipeline.recompute.recompute`, made into tables by `pipeline.recompute.results`.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray, StrArray
from pipeline.blocks.batch import Batch
from pipeline.method.definition import Steps
from pipeline.steps.resistance import RunMeans
from pipeline.steps.window import Windows
from pipeline.uncertainty.propagation import Assumed


@dataclass(frozen=True)
class TowFactor:
    """What was estimated of each tow's log factor, shape (tows,); NaN where nothing was.

    Attributes:
        factor: true speed / log speed on its day.
        ln_sd, dof: standard deviation of its logarithm, that of the load cell with it, and degrees
            of freedom.
        force_factor, force_zero_n: of the load cell, where one was found faulty; else 1 and 0.
        bend: q of the boat at its usual speed, by all that is known of it.
        askew_ratio: what being pulled askew may have added to Cw.
    """

    factor: FloatArray
    ln_sd: FloatArray
    dof: FloatArray
    force_factor: FloatArray
    force_zero_n: FloatArray
    bend: FloatArray
    askew_ratio: FloatArray


class ExpectedWind(NamedTuple):
    """Net wind correction of a tow / its still-air part, mean of out and back."""

    mean: float
    sd: float


STILL_AIR: Final = ExpectedWind(0.0, Assumed().unmeasured_wind)
"""Where nothing is expected: as if there was no wind."""


@dataclass(frozen=True)
class Prepared:
    """A batch with everything that does not depend on the wind coefficients.

    Attributes:
        known_factor: speed factor of the log's known error, shape (tows,).
        y: calibration factor of each run's file, shape (runs,).
        calibrated: tows that have one, shape (tows,).
        estimated: what was estimated of the log factor.
        reasons: why a run does not count, empty where it does, shape (runs,).
        still_unit_kg_m: still-air coefficient for a drag coefficient of 1, shape (runs,).
        temperature_kg_m: change to the reference temperature, shape (runs,).
        temperature_known: shape (tows,).
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
    estimated: TowFactor
    reasons: StrArray
    still_unit_kg_m: FloatArray
    temperature_kg_m: FloatArray
    temperature_known: BoolArray
    wind_ln_scale: FloatArray
    wind_ln_sd: FloatArray
    expected_wind: ExpectedWind

    @cached_property
    def speed_factor(self) -> FloatArray:
        """True speed / log speed of each run, shape (runs,)."""
        return self.known_factor[self.batch.tow] * self.y

    @cached_property
    def used(self) -> BoolArray:
        """Runs that count, shape (runs,)."""
        return np.asarray(self.reasons == "")

    @cached_property
    def calibration_factor(self) -> FloatArray:
        """Mean calibration factor of the runs that count, shape (tows,); 1 where there are none."""
        return np.where(self.batch.any(self.used), self.batch.mean(self.y, self.used), 1.0)

    @cached_property
    def in_fit(self) -> BoolArray:
        """Runs that count, of tows that have enough of them, and both ways, shape (runs,)."""
        enough = self.batch.count(self.used) >= self.steps.runs.minimum
        return self.used & (enough & self.batch.both_ways(self.used))[self.batch.tow]

    @cached_property
    def speed_m_s(self) -> FloatArray:
        """Mean true speed, shape (runs,)."""
        return self.means.speed_m_s * self.speed_factor

    @cached_property
    def water_off_c(self) -> FloatArray:
        """How far the water is from its day's, where the method corrects for it, shape (tows,)."""
        return self.batch.of_tow("water_off_c") * (self.steps.temperature.rule != "none")

    def by_true_speed(self, kg_m: FloatArray) -> FloatArray:
        """A coefficient of each run by log speed, now by true speed, shape (runs,)."""
        return kg_m / self.speed_factor**2

    def air_of(self, ahead: FloatArray, behind: FloatArray) -> FloatArray:
        """The air part that is taken off for given drag coefficients, shape (runs,)."""
        if self.steps.wind.reading == "cw_vac_2014":
            return 2.0 * self.still_air_of(ahead)
        felt = self.by_true_speed(self.means.air.total(ahead, behind, self.steps.wind.side))
        if self.steps.wind.unmeasured == "still_air":
            return felt
        expected = (1.0 + self.expected_wind.mean) * self.still_air_of(ahead)
        return np.where(self.batch.measured("wind")[self.batch.tow], felt, expected)

    def wind_ratio(self, ahead: FloatArray, behind: FloatArray, still: FloatArray) -> FloatArray:
        """Net wind correction / still-air part, shape (tows,); NaN where no wind was measured."""
        batch = self.batch
        put_back = batch.mean(self.still_air_of(still), self.used)
        net = batch.mean(self.air_of(ahead, behind), self.used) - put_back
        known = batch.measured("wind") & batch.trusted & (put_back > 0)
        return np.where(known, net / np.where(known, put_back, 1.0), np.nan)

    def still_air_of(self, coefficient: FloatArray) -> FloatArray:
        """The still-air part that is put back for a drag coefficient, shape (runs,)."""
        put_back = self.steps.wind.reading != "cw_opt_2014"
        return self.still_unit_kg_m * coefficient * put_back

    def cw_of(self, ahead: FloatArray, behind: FloatArray, still: FloatArray) -> FloatArray:
        """Corrected coefficient of each run for given drag coefficients, shape (runs,)."""
        gross, inertia = map(self.by_true_speed, (self.means.gross_kg_m, self.means.inertia_kg_m))
        air = self.air_of(ahead, behind) - self.still_air_of(still)
        return gross - inertia - air + self.temperature_kg_m

    def points_of(self, cw_kg_m: FloatArray) -> curve.Points:
        """Points of all tows that have enough runs, for a batch fit."""
        batch = self.batch
        return curve.Points(
            batch.by_tow(self.speed_m_s),
            batch.by_tow(cw_kg_m),
            batch.by_tow(self.in_fit & (cw_kg_m > 0) & (self.speed_m_s > 0)) > 0,
        )


@dataclass(frozen=True)
class Outcome:
    """A batch with all that a method found out about it.

    Attributes:
        prepared: what does not depend on the wind coefficients.
        ahead, behind, still_air_coefficient: drag coefficients of each run, shape (runs,).
        coefficient_sd: standard deviation of the archive's coefficient; NaN where there is none.
        cw_kg_m: corrected coefficient, shape (runs,).
        points, free, curves: the fit's input, the free hyperbola and the one that the method
            chose, shape (tows,).
    """

    prepared: Prepared
    ahead: FloatArray
    behind: FloatArray
    still_air_coefficient: FloatArray
    coefficient_sd: float
    cw_kg_m: FloatArray
    points: curve.Points
    free: curve.Curves
    curves: curve.Curves

    @property
    def batch(self) -> Batch:
        """The tows."""
        return self.prepared.batch

    @property
    def steps(self) -> Steps:
        """The steps of the method for them."""
        return self.prepared.steps

    @cached_property
    def air_kg_m(self) -> FloatArray:
        """The air part that was taken off, shape (runs,)."""
        return self.prepared.air_of(self.ahead, self.behind)

    @cached_property
    def still_air_kg_m(self) -> FloatArray:
        """The still-air part that was put back, shape (runs,)."""
        return self.prepared.still_air_of(self.still_air_coefficient)

    @property
    def cw_at_declared(self) -> FloatArray:
        """Cw at the declared speed of each tow, shape (tows,); NaN where there is no curve."""
        return self.cw_at(1.0)

    def cw_at(self, speed_ratio: float) -> FloatArray:
        """Cw of each tow at a speed / declared speed, shape (tows,); NaN where there is none."""
        cw = self.curves.cw_at(speed_ratio * self.batch.of_tow("declared_speed_m_s"))
        return np.where(self.curves.converged & np.isfinite(cw), cw, np.nan)
