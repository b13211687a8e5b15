"""Calibration: the factor y that brings the log of a tow's file to ground speed.

`y = mean(v_dGPS) / mean(v_log)` over the steady parts of all runs together, as many out as back,
so that the current drops out (Sleepproef, R. Pot 2017, "IJking snelheid"). Every run weighs the
same, whatever the length of its window: with unequal windows and 5 cm/s of current a ratio over
samples is wrong by 0.5 % (docs/method-details.md, 4).
"""

import numpy as np

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.blocks.tows import Tows
from pipeline.channels import BACK, OUT


def mean_over_both_ways(
    values: FloatArray, direction: IntArray, tow: IntArray, used: BoolArray, tows: int
) -> tuple[FloatArray, BoolArray]:
    """Return the mean per tow of the mean out and the mean back, over runs.

    With as many runs out as back this is the plain mean of run means; with one run lost it still
    lets a constant current drop out.

    Args:
        values: one number per run, shape (runs,).
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
    """Return the factor y of every tow, and whether it could be determined (runs both ways).

    Arguments as in `mean_over_both_ways`, with the run means of ground speed, NaN without a fix,
    and of log speed. Undetermined factors are given as 1 and must not be used.
    """
    with_fix = used & np.isfinite(gps_m_s)
    fixed = np.where(with_fix, gps_m_s, 0.0)
    gps, both = mean_over_both_ways(fixed, direction, tow, with_fix, tows)
    log, _ = mean_over_both_ways(log_m_s, direction, tow, with_fix, tows)
    return np.where(both, gps / np.where(both, log, 1.0), 1.0), both


def estimate_gps_factor_of_files(
    tows: Tows, gps_m_s: FloatArray, log_m_s: FloatArray, used: BoolArray, steady: BoolArray
) -> tuple[FloatArray, BoolArray]:
    """Return the factor y of every file of a tow, and whether it could be determined.

    "Log1 bij elke sleep calibreren aan dGPS" (presentation 2015): the files of a combined tow are
    two tows, each with a log of its own. A file whose used runs all go one way is calibrated over
    all its steady runs, those that were not chosen too; one that was only towed one way shares the
    factor of the tow.

    Args:
        gps_m_s, log_m_s, used: as in `gps_factor`.
        steady: runs with a steady window, chosen or not, shape (runs,).

    Returns:
        Both of shape (tows, 2): by tow, of the first and of the second file.
    """

    def factor(of: IntArray, runs: BoolArray, count: int) -> tuple[FloatArray, BoolArray]:
        return gps_factor(gps_m_s, log_m_s, tows.direction, of, runs, count)

    files = 2 * tows.size
    y, known = factor(tows.file, used, files)
    of_all, known_of_all = factor(tows.file, steady, files)
    of_tow, known_of_tow = factor(tows.tow, used, tows.size)
    known_of_all &= np.repeat(tows.any(tows.is_in_second_file), 2)
    y = np.select([known, known_of_all], [y, of_all], np.repeat(of_tow, 2))
    known = known | known_of_all | np.repeat(known_of_tow, 2)
    return y.reshape(-1, 2), known.reshape(-1, 2)
