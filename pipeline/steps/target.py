"""The intended speed of a run, and runs towed so much faster that they do not count.

"Geen v = +20% runs meer uitvoeren" (presentation 2015): a run at 120 % of the declared speed lies
outside the part of the curve that is used. Runs are judged against each other and not against a
corrected speed: a tow was steered by what the log read, so a log that read 6 % low made 110 % look
like 117 % afterwards.
"""

import numpy as np
import polars as pl

from pipeline.arrays import BoolArray, FloatArray
from pipeline.blocks.tows import Tows


def is_above_target(
    tows: Tows, log_m_s: FloatArray, runs: BoolArray, highest_ratio: FloatArray | float
) -> BoolArray:
    """Return which runs are faster than `highest_ratio` of the declared speed, on their scale.

    The scale is the median of speed / intended speed over the tow's runs (of two in the middle the
    lower, as the runs towed too fast are the high ones): a factor on all speeds drops out. Of
    runs of one intended speed, out and back, the slowest decides: of a pair that stays or goes
    apart, current and wind would not cancel.

    Args:
        log_m_s: mean speed of each run as read, shape (runs,).
        runs: runs that take part, shape (runs,).
        highest_ratio: limit of speed / declared speed, of each run or of all.
    """
    speed = np.where(runs & (log_m_s > 0), log_m_s / tows.get_of_runs("declared_speed_m_s"), np.nan)
    ratios = pl.DataFrame(
        {"tow": tows.tow, "intended": tows.target_speed_ratio, "speed": speed}, nan_to_null=True
    ).with_columns(highest=highest_ratio)
    level = (pl.col("speed") / pl.col("intended")).quantile(0.5, "lower").over("tow")
    of_pair = pl.col("speed").min().over("tow", "intended")
    too_fast = pl.col("speed").is_not_null() & (of_pair > pl.col("highest") * level)
    return ratios.select(too_fast.fill_null(False)).to_series().to_numpy()
