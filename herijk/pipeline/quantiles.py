"""The level of the intervals, and the quantile that goes with it."""

from typing import Final

import numpy as np
import scipy
from numpy.typing import ArrayLike

from herijk.pipeline.arrays import FloatArray

LEVEL: Final = 0.95


def t_quantile(dof: ArrayLike) -> FloatArray:
    """Two-sided quantile of Student's t: an interval of `LEVEL` is +- so many deviations.

    Args:
        dof: degrees of freedom, of any shape, positive.
    """
    freedom = np.asarray(dof, dtype=np.float64)
    return np.asarray(scipy.special.stdtrit(freedom, 0.5 * (1.0 + LEVEL)), dtype=np.float64)
