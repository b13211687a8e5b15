"""The outcome of a method for a batch: all that was found out, as arrays.

Filled by `pipeline.recompute.recompute`, made into tables by `pipeline.recompute.results`.
"""

from dataclasses import dataclass

import numpy as np

from herijk.pipeline import curve
from herijk.pipeline.arrays import BoolArray, FloatArray
from herijk.pipeline.blocks.batch import Batch
from herijk.pipeline.method.definition import Steps
from herijk.pipeline.steps.window import Windows


@dataclass(frozen=True)
class TowFactor:
    """What was estimated of each tow's log factor, shape (tows,); NaN where nothing was.

    Attributes:
        factor: true speed / log speed on its day.
        ln_sd, dof: standard deviation of its logarithm, that of the load cell with it, and degrees
            of freedom.
        force_factor, force_zero_n: of the load cell, where one was found faulty; else 1 and 0.
        bend: q of the boat at its usual speed, by all that is known of it.
    """

    factor: FloatArray
    ln_sd: FloatArray
    dof: FloatArray
    force_factor: FloatArray
    force_zero_n: FloatArray
    bend: FloatArray


@dataclass(frozen=True)
class Outcome:
    """A batch with all that a method found out about it.

    Arrays are of shape (runs,), but for `known_factor`, `calibration_factor`, `calibrated`,
    `temperature_known`, `estimated` and the curves, which are of shape (tows,).
    """

    batch: Batch
    steps: Steps
    windows: Windows
    reasons: np.ndarray[tuple[int, ...], np.dtype[np.str_]]
    known_factor: FloatArray
    calibration_factor: FloatArray
    calibrated: BoolArray
    estimated: TowFactor
    speed_m_s: FloatArray
    speed_factor: FloatArray
    gross_kg_m: FloatArray
    sd_kg_m: FloatArray
    inertia_kg_m: FloatArray
    air_kg_m: FloatArray
    still_air_kg_m: FloatArray
    still_air_coefficient: FloatArray
    air_unit_kg_m: FloatArray
    temperature_kg_m: FloatArray
    temperature_known: BoolArray
    ahead: FloatArray
    behind: FloatArray
    cw_kg_m: FloatArray
    points: curve.Points
    free: curve.Curves
    curves: curve.Curves

    @property
    def used(self) -> BoolArray:
        """Runs that count."""
        return np.asarray(self.reasons == "")

    @property
    def cw_at_declared(self) -> FloatArray:
        """Cw at the declared speed of each tow, shape (tows,); NaN where there is no curve."""
        return self.cw_at(1.0)

    def cw_at(self, speed_ratio: float) -> FloatArray:
        """Cw of each tow at a speed / declared speed, shape (tows,); NaN where there is none."""
        cw = self.curves.cw_at(speed_ratio * self.batch.of_tow("declared_speed_m_s"))
        return np.where(self.curves.converged & np.isfinite(cw), cw, np.nan)
