"""The level of the intervals, and the quantile that goes with it."""

from typing import Final

import numpy as np
import scipy
from numpy.typing import ArrayLike

from herijk.pipeline.arrays import FloatArray

LEVEL: Final = 0.95


def t_quantile(dof: ArrayLike, level: float = LEVEL) -> FloatArray:
    """Two-sided quantile of Student's t: an interval of this level is +- so many deviations.

    Args:
        dof: degrees of freedom, of any shape, positive.
        level: share that the interval holds.
    """
    freedom = np.asarray(dof, dtype=np.float64)
    return np.asarray(scipy.special.stdtrit(freedom, 0.5 * (1.0 + level)), dtype=np.float64)
