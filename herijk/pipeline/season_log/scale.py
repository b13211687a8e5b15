"""What a scale error of the log does to ln Cw at a fixed speed; nothing of how it is estimated."""

import numpy as np
from numpy.typing import ArrayLike

from herijk.pipeline.arrays import FloatArray, IntArray
from herijk.pipeline.curve import LEAST_MARGIN


def scale_effect(ln_factor: ArrayLike, r: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """What a log that reads low does to ln Cw at a fixed speed, and its slope.

    A log that must be multiplied by y = exp(ln factor) gives A y^2 and B / y. So ln Cw at the speed
    where (v/B)^2 = r is too high by 2 ln y - ln((1 - r y^2) / (1 - r)), about kappa ln y with kappa
    = 2 / (1 - r).
    """
    y2 = np.exp(2.0 * np.asarray(ln_factor, dtype=np.float64))
    bend = np.asarray(r, dtype=np.float64)
    margin = np.maximum(1.0 - bend * y2, LEAST_MARGIN)
    return np.log(y2) - np.log(margin / (1.0 - bend)), 2.0 / margin


def linear_scale(
    value: FloatArray, group: IntArray, r: FloatArray, ln_factor: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Observed values as linear in the ln factors, and the slope; 0 for anchored tows."""
    loose = group >= 0
    now = np.append(ln_factor, 0.0)[group]  # -1, anchored, reads the 0
    shift, slope = scale_effect(now, r)
    return value - np.where(loose, shift - slope * now, 0.0), np.where(loose, slope, 0.0)
