"""Calibration: the factor y that brings a tow's log to ground speed.

`y = mean(v_dGPS) / mean(v_log)` over the steady parts of all runs together, as many out as back,
so that the stream drops out (Sleepproef, R. Pot 2017, "IJking snelheid"). Every run weighs the
same, whatever the length of its window: with unequal windows and 5 cm/s of stream a ratio over
samples is wrong by 0.5 % (research, method.md 9.2).
"""

import numpy as np

from herijk.pipeline.arrays import BoolArray, FloatArray, IntArray
from herijk.pipeline.channels import BACK, OUT


def mean_over_both_ways(
    values: FloatArray, direction: IntArray, tow: IntArray, used: BoolArray, tows: int
) -> tuple[FloatArray, BoolArray]:
    """Mean of the run means out and of those back, then the mean of the two, per tow.

    With as many runs out as back this is the plain mean of run means; with one run lost it still
    lets a constant stream drop out.

    Args:
        values: one number a run, shape (runs,).
        direction: 1 out, -1 back, shape (runs,).
        tow: index of the run's tow, shape (runs,).
        used: runs that count, shape (runs,).
        tows: number of tows.

    Returns:
        The mean per tow, shape (tows,), 0 where a way has no run; and whether both ways have one.
    """
    ways = []
    counted = np.ones(tows, dtype=bool)
    for way in (OUT, BACK):
        weight = (used & (direction == way)).astype(np.float64)
        count = np.bincount(tow, weight, tows)
        counted &= count > 0
        ways.append(np.bincount(tow, weight * values, tows) / np.maximum(count, 1.0))
    return np.where(counted, 0.5 * (ways[0] + ways[1]), 0.0), counted


def gps_factor(
    gps_m_s: FloatArray,
    log_m_s: FloatArray,
    direction: IntArray,
    tow: IntArray,
    used: BoolArray,
    tows: int,
) -> tuple[FloatArray, BoolArray]:
    """The factor y of every tow, and whether it could be determined (runs both ways).

    Arguments as in `mean_over_both_ways`, with the run means of ground speed and of log speed.
    Undetermined factors are given as 1 and must not be used.
    """
    gps, both = mean_over_both_ways(gps_m_s, direction, tow, used, tows)
    log, _ = mean_over_both_ways(log_m_s, direction, tow, used, tows)
    return np.where(both, gps / np.where(both, log, 1.0), 1.0), both
