"""The intended speed of a run, and runs towed so much faster that they do not count.

"Geen v = +20% runs meer uitvoeren" (presentation 2015): a run at 120 % of the declared speed lies
outside the part of the curve that is used. Runs are judged against each other and not against a
corrected speed: a tow was steered by what the log read, so a log that read 6 % low made 110 % look
like 117 % afterwards.
"""

import numpy as np

from herijk.pipeline.arrays import BoolArray, FloatArray
from herijk.pipeline.blocks.batch import Batch


def above_target(
    batch: Batch, log_m_s: FloatArray, runs: BoolArray, highest_ratio: float
) -> BoolArray:
    """Runs faster than `highest_ratio` of the declared speed, on the scale of the tow's own runs.

    The scale is the median of speed / intended speed over the tow's runs (of two in the middle the
    lower, as the runs towed too fast are the high ones): a factor on all speeds drops out.

    Args:
        log_m_s: mean speed of each run as read, shape (runs,).
        runs: runs that take part, shape (runs,).
        highest_ratio: limit of speed / declared speed.
    """
    declared = batch.of_run("declared_speed_m_s")
    ratio = log_m_s / (declared * batch.target_speed_ratio)
    takes_part = runs & np.isfinite(ratio) & (ratio > 0)
    of_tow = np.where(batch.by_tow(takes_part) > 0, batch.by_tow(ratio), np.inf)
    middle = np.maximum(batch.count(takes_part) - 1, 0) // 2
    level = np.take_along_axis(np.sort(of_tow, axis=1), middle[:, None], axis=1)[:, 0]
    return np.asarray(runs & (log_m_s > highest_ratio * declared * level[batch.tow]))
