"""Assessment: what a person should look at in a tow. A flag never changes a number.

The checks are those of the federation's first assessment (Sleepproef, R. Pot 2017, "Eerste
beoordeling"). Each flag is a code; its limit stands here with
its source.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from pipeline.arrays import BoolArray, FloatArray
from pipeline.batch import Batch
from pipeline.channels import BACK, OUT

FULL_RUNS: Final = 6
MAX_SD_RATIO: Final = 0.10
"""Standard deviation in a run under 10 % of the mean (Sleepproef 2017)."""

MAX_OFF_TARGET_RATIO: Final = 0.05
"""Speed near the intended one; 5 % is half the step between intended speeds (inferred)."""

MAX_OUT_BACK_RATIO: Final = 0.05
"""Out and back agree after the wind correction; 5 % is inferred, the text says "about"."""

CALIBRATION_RANGE: Final = (0.98, 1.02)
"""Calibration factor in practice (Sleepproef 2017, "IJking snelheid")."""


@dataclass(frozen=True)
class Observed:
    """What the checks look at.

    Attributes:
        batch: tows and runs.
        used: the run counts, shape (runs,).
        speed_m_s, cw_kg_m, sd_kg_m: of the run, shape (runs,).
        curve_found, b_capped, b_determined, calibration_factor: shape (tows,).
    """

    batch: Batch
    used: BoolArray
    speed_m_s: FloatArray
    cw_kg_m: FloatArray
    sd_kg_m: FloatArray
    curve_found: BoolArray
    b_capped: BoolArray
    b_determined: BoolArray
    calibration_factor: FloatArray


def flags_of(seen: Observed) -> list[list[str]]:
    """The flags of every tow, in a fixed order."""
    batch, used = seen.batch, seen.used
    intended = batch.target_speed_ratio * batch.of_run("declared_speed_m_s")
    scatter = seen.sd_kg_m / np.where(seen.cw_kg_m > 0, seen.cw_kg_m, 1.0)
    low, high = CALIBRATION_RANGE
    checks = {
        "few_runs": batch.count(used) < FULL_RUNS,
        "no_curve": ~seen.curve_found,
        "b_at_cap": seen.b_capped,
        "b_not_determined": seen.curve_found & ~seen.b_determined,
        "large_scatter_in_run": batch.any(used & (scatter > MAX_SD_RATIO)),
        "off_target_speed": batch.any(
            used & (np.abs(seen.speed_m_s / intended - 1.0) > MAX_OFF_TARGET_RATIO)
        ),
        "out_and_back_differ": np.abs(_out_back_ratio(seen) - 1.0) > MAX_OUT_BACK_RATIO,
        "unusual_calibration": (seen.calibration_factor < low) | (seen.calibration_factor > high),
    }
    return [[code for code, found in checks.items() if found[i]] for i in range(batch.size)]


def _out_back_ratio(seen: Observed) -> FloatArray:
    """Mean Cw out / mean Cw back per tow; 1 where a way is missing."""
    out, back = (
        seen.batch.mean(seen.cw_kg_m, seen.used & (seen.batch.direction == way))
        for way in (OUT, BACK)
    )
    both = (out > 0) & (back > 0)
    return np.where(both, out / np.where(both, back, 1.0), 1.0)
