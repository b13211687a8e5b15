"""Run points: mean speed and mean resistance coefficient of each run's steady window.

Per sample the gross coefficient is `Cw = F / (v y)^2` (Sleepproef, R. Pot 2017, "IJking
snelheid"); a run point is the mean over the window, with the air part taken off and the still-air
part put back. A speed factor k turns log speed into true speed and so divides every coefficient
by k^2. Here: the arithmetic of one run. Which runs count is decided in `pipeline.recompute`.
"""

from dataclasses import dataclass

import numpy as np

from pipeline.arrays import BoolArray, FloatArray
from pipeline.blocks import RunBlocks


@dataclass(frozen=True)
class RunPoints:
    """One point per run, each array of shape (runs,); coefficients in kg/m.

    Attributes:
        speed_m_s: mean true speed.
        cw_kg_m: coefficient in still air.
        cw_sd: standard deviation of the samples' gross coefficient, kg/m.
        gross_kg_m: mean gross coefficient.
        air_kg_m: the air part that was taken off.
        still_air_kg_m: the still-air part that was put back.
    """

    speed_m_s: FloatArray
    cw_kg_m: FloatArray
    cw_sd: FloatArray
    gross_kg_m: FloatArray
    air_kg_m: FloatArray
    still_air_kg_m: FloatArray


def run_points(
    blocks: RunBlocks,
    window: BoolArray,
    source: str,
    speed_factor: FloatArray,
    air_part_kg_m: FloatArray,
    still_air_kg_m: FloatArray,
) -> RunPoints:
    """Means over samples of speed and coefficient, corrected for speed and wind.

    Args:
        blocks: the runs.
        window: shape (runs, seconds).
        source: speed source of `pipeline.blocks`.
        speed_factor: true speed / log speed, shape (runs,).
        air_part_kg_m: mean F_air / v_log^2, shape (runs,).
        still_air_kg_m: shape (runs,).
    """
    scale = 1.0 / speed_factor**2
    log_cw = blocks.mean(f"{source}_cw", window)
    variance = blocks.mean(f"{source}_cw2", window) - log_cw**2
    gross, air = scale * log_cw, scale * air_part_kg_m
    return RunPoints(
        speed_m_s=speed_factor * blocks.mean(f"{source}_v", window),
        cw_kg_m=gross - air + still_air_kg_m,
        cw_sd=scale * np.sqrt(np.maximum(variance, 0.0)),
        gross_kg_m=gross,
        air_kg_m=air,
        still_air_kg_m=still_air_kg_m,
    )
