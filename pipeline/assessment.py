"""Assessment: what a person should look at in a tow. A flag never changes a number.

The checks are those of the federation's first assessment (Sleepproef, R. Pot 2017, "Eerste
beoordeling", and `design` limits quoted there). Each flag is a code; its limit stands here with
its source.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from pipeline.arrays import BoolArray, FloatArray, IntArray
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
    """What the checks look at; arrays of shape (runs,) unless said otherwise.

    Attributes:
        tow: index of the run's tow.
        tows: number of tows.
        used: the run counts.
        speed_m_s, intended_m_s, cw_kg_m, cw_sd_kg_m, direction: of the run.
        runs_used, curve_found, b_capped, b_determined, calibration_factor: shape (tows,).
    """

    tow: IntArray
    tows: int
    used: BoolArray
    speed_m_s: FloatArray
    intended_m_s: FloatArray
    cw_kg_m: FloatArray
    cw_sd_kg_m: FloatArray
    direction: FloatArray
    runs_used: IntArray
    curve_found: BoolArray
    b_capped: BoolArray
    b_determined: BoolArray
    calibration_factor: FloatArray


def flags(seen: Observed) -> list[list[str]]:
    """The flags of every tow, in a fixed order."""
    safe_cw = np.where(seen.cw_kg_m > 0, seen.cw_kg_m, 1.0)
    checks = {
        "few_runs": seen.runs_used < FULL_RUNS,
        "no_curve": ~seen.curve_found,
        "b_at_cap": seen.b_capped,
        "b_not_determined": seen.curve_found & ~seen.b_determined,
        "large_scatter_in_run": _any_run(seen, seen.cw_sd_kg_m / safe_cw > MAX_SD_RATIO),
        "off_target_speed": _any_run(
            seen, np.abs(seen.speed_m_s / seen.intended_m_s - 1.0) > MAX_OFF_TARGET_RATIO
        ),
        "out_and_back_differ": np.abs(_out_back_ratio(seen) - 1.0) > MAX_OUT_BACK_RATIO,
        "unusual_calibration": (seen.calibration_factor < CALIBRATION_RANGE[0])
        | (seen.calibration_factor > CALIBRATION_RANGE[1]),
    }
    return [[code for code, found in checks.items() if found[i]] for i in range(seen.tows)]


def _any_run(seen: Observed, condition: BoolArray) -> BoolArray:
    return np.bincount(seen.tow, seen.used & condition, seen.tows) > 0


def _out_back_ratio(seen: Observed) -> FloatArray:
    """Mean Cw out / mean Cw back per tow; 1 where a way is missing."""
    means = []
    for way in (OUT, BACK):
        weight = (seen.used & (seen.direction == way)).astype(np.float64)
        count = np.bincount(seen.tow, weight, seen.tows)
        total = np.bincount(seen.tow, weight * seen.cw_kg_m, seen.tows)
        means.append(np.where(count > 0, total / np.maximum(count, 1.0), 0.0))
    both = (means[0] > 0) & (means[1] > 0)
    return np.where(both, means[0] / np.where(both, means[1], 1.0), 1.0)
