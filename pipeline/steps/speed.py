"""The correction of a speed log that is known to be wrong, before any calibration on GPS.

In 2009-2011 the propeller logs were worn and read low; the correction found in 2013 was up to
6 % (presentation 2015, "Meten van de sleepsnelheid"). Whether one multiplies by 1.06 or divides
by 0.94 is written nowhere: the factor is an option. A percentage in the tow list goes before it.
How a season's factor is estimated instead is in `pipeline.season_log`.
"""

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from pipeline.arrays import FloatArray

LOG: Final = "log1"
"""The log in use: "De berekeningen worden gebaseerd op log1" (Sleepproef, R. Pot 2017)."""


def log_factor(
    correction: ArrayLike,
    factor: ArrayLike,
    tow_list_ratio: FloatArray,
    estimated_factor: FloatArray,
) -> FloatArray:
    """Return true speed / log speed for each tow.

    Args:
        correction, factor: options of the method, of each tow or of all.
        tow_list_ratio: correction of the tow list as a ratio (0.06 for 6 %), NaN where the list
            gives none, shape (tows,).
        estimated_factor: factor estimated for the tow's season and log, NaN where there is none,
            shape (tows,). Where it is used, the correction of the tow list does not count.

    Returns:
        Factor of shape (tows,): 1 + the ratio of the tow list, or the prescribed factor. Where an
        estimate is asked for and there is none, the same.
    """
    asked = np.asarray(correction)
    prescribed = np.where(np.isnan(tow_list_ratio), factor, 1.0 + tow_list_ratio)
    estimated = np.where(np.isnan(estimated_factor), prescribed, estimated_factor)
    return np.select([asked == "none", asked == "prescribed"], [1.0, prescribed], estimated)
