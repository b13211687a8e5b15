"""The level of the intervals, the quantiles that go with it, and a robust spread."""

from math import hypot
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from pipeline.arrays import FloatArray

LEVEL: Final = 0.95

NORMAL: Final = 1.959963984540054
"""Standard deviations to either side of a normal number, in an interval of `LEVEL`.

Written out, as to compute it would load SciPy wherever this is imported; a test compares the two.
"""

MAD_TO_SD: Final = 1.4826
"""Standard deviation over median distance from the median, of normal numbers."""


def t_quantile(dof: ArrayLike) -> FloatArray:
    """Return the two-sided quantile of Student's t at `LEVEL`: half an interval in deviations.

    Args:
        dof: degrees of freedom, of any shape, positive.
    """
    import scipy.special  # noqa: PLC0415 - what only reads finished tables does without

    freedom = np.asarray(dof, dtype=np.float64)
    return np.asarray(scipy.special.stdtrit(freedom, 0.5 * (1.0 + LEVEL)), dtype=np.float64)


def differ_beyond_intervals(
    one: tuple[float, float, float], other: tuple[float, float, float]
) -> bool:
    """Return whether two numbers differ by more than the half widths of their intervals together.

    Args:
        one, other: a number, and the lower and upper end of its interval. Half widths are added as
            independent errors are: the root of the sum of squares.
    """
    value, lower, upper = one
    other_value, other_lower, other_upper = other
    half_width = hypot(0.5 * (upper - lower), 0.5 * (other_upper - other_lower))
    return abs(value - other_value) > half_width
