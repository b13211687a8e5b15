"""What a scale error of the log does to ln Cw at a fixed speed; nothing of how it is estimated."""

import numpy as np
from numpy.typing import ArrayLike

from pipeline.arrays import FloatArray, IntArray
from pipeline.curve import LEAST_MARGIN


def scale_effect(
    ln_factor: ArrayLike, r: ArrayLike, reference_ln: ArrayLike = 0.0
) -> tuple[FloatArray, FloatArray]:
    """What a log that reads low does to ln Cw where it reads v / y0, and its slope.

    A log that must be multiplied by y = exp(ln factor) gives A y^2 and B / y. With (v/B)^2 = r and
    z = y / y0, ln Cw is too high by 2 ln y - ln((1 - r z^2) / (1 - r)), about kappa ln y with kappa
    = 2 / (1 - r).

    Args:
        ln_factor: ln y.
        r: (v/B)^2 of the true curve.
        reference_ln: ln y0.
    """
    ln_y, ln_y0 = (np.asarray(x, dtype=np.float64) for x in (ln_factor, reference_ln))
    bend = np.asarray(r, dtype=np.float64)
    margin = np.maximum(1.0 - bend * np.exp(2.0 * (ln_y - ln_y0)), LEAST_MARGIN)
    return 2.0 * ln_y - np.log(margin / (1.0 - bend)), 2.0 / margin


def linear_scale(
    value: FloatArray,
    group: IntArray,
    r: FloatArray,
    reference_ln: FloatArray,
    ln_factor: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Observed values as linear in the ln factors, and the slope; 0 for anchored tows."""
    loose = group >= 0
    now = np.append(ln_factor, 0.0)[group]  # -1, anchored, reads the 0
    shift, slope = scale_effect(now, r, reference_ln)
    return value - np.where(loose, shift - slope * now, 0.0), np.where(loose, slope, 0.0)
