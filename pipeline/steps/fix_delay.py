"""How late the GPS is: a receiver that smooths or waits tells the speed of some seconds before.

"dGPS sterk vertraagd!" (presentation, R. Pot 2015, "Meten van de sleepsnelheid"). While the ship
gains speed, a late GPS reads too low, and so does the calibration factor. How late it is shows in
every run: its unrest is that of the log, later.
"""

from typing import Final

import numpy as np
import scipy

from pipeline.arrays import FloatArray, IntArray
from pipeline.blocks.run_blocks import RunBlocks
from pipeline.choice import first_largest

MOST_S: Final = 12
"""Longest delay that is looked for (inferred: runs last 50 s)."""
FEWEST_TOWS: Final = 4
"""Tows that a season needs before they tell (inferred)."""
CHANCE: Final = 0.001
"""Share of seasons without delay in which chance alone shows one."""

FIXES: Final = ("gps", "gps_n")


def fix_delay_s(blocks: RunBlocks, season: IntArray) -> IntArray:
    """Whole seconds by which the GPS of each run's season follows its log; 0 where that is chance.

    Of each delay, the sum over all runs of the season of what it explains of the GPS about its mean
    (lagged cross-correlation; Box & Jenkins 1976, ch. 11). The best of them counts where the tows
    together show that it explains more than no delay does (t test over the tows).

    Args:
        blocks: the runs, of all tows.
        season: of each run, shape (runs,).

    Returns:
        Shape (runs,).
    """
    delay = np.zeros(len(season), dtype=np.int64)
    if blocks.seconds <= MOST_S + 1 or not blocks["gps_n"].any():
        return delay
    tow = np.unique(blocks.runs["tow_id"].to_numpy(), return_inverse=True)[1]
    both, square = _products(blocks)
    for year in np.unique(season):
        mine = season == year
        _, place = np.unique(tow[mine], return_inverse=True)
        of_tows = (_summed(products[:, mine], place) for products in (both, square))
        delay[mine] = _of_season(*of_tows)
    return delay


def _summed(of_runs: FloatArray, tow: IntArray) -> FloatArray:
    """Sums over the runs of each tow, shape (delays, tows)."""
    return np.stack([np.bincount(tow, lag).astype(np.float64) for lag in of_runs])


def _products(blocks: RunBlocks) -> tuple[FloatArray, FloatArray]:
    """Sums of GPS times log and of log squared, about their means, both (delays, runs).

    Over the seconds whose log is known at every delay, so that all explain the same.
    """
    log, fixes = blocks.block_means("log1_v"), blocks["gps_n"]
    gps = blocks["gps"] / np.maximum(fixes, 1.0)
    counts = (fixes > 0)[:, MOST_S:].astype(np.float64)
    of_gps = _about_mean(gps[:, MOST_S:], counts)
    end = blocks.seconds
    both, square = [], []
    for delay in range(MOST_S + 1):
        of_log = _about_mean(log[:, MOST_S - delay : end - delay], counts)
        both.append((of_gps * of_log).sum(axis=1))
        square.append((of_log**2).sum(axis=1))
    return np.stack(both), np.stack(square)


def _about_mean(values: FloatArray, counts: FloatArray) -> FloatArray:
    mean = (counts * values).sum(axis=1) / np.maximum(counts.sum(axis=1), 1.0)
    return np.asarray(counts * (values - mean[:, None]), dtype=np.float64)


def _of_season(both: FloatArray, log: FloatArray) -> int:
    """The delay of a season by the `_products` of its tows, each of shape (delays, tows)."""
    tows = int((log[0] > 0).sum())
    square = log.sum(axis=1)
    if tows < FEWEST_TOWS or not square.all():
        return 0
    slope = both.sum(axis=1) / square
    explained = np.where(slope > 0, slope * both.sum(axis=1), 0.0)
    best = int(first_largest(explained[:, None])[0])
    # A delay explains 2 b (g l) - b^2 (l l) of the GPS of a tow, with b that of the season.
    of_tows = 2.0 * slope[:, None] * both - slope[:, None] ** 2 * log
    gain = (of_tows[best] - of_tows[0])[log[0] > 0]
    sd = float(gain.std(ddof=1)) / np.sqrt(tows)
    sure = gain.mean() > scipy.special.stdtrit(tows - 1.0, 1.0 - CHANCE) * sd
    return best if sure else 0


def fixes_in_time(blocks: RunBlocks, delay_s: IntArray) -> dict[str, FloatArray]:
    """Sums and numbers of fixes of each second as they would have been without delay.

    The last seconds of a run have none: their fixes came after it.

    Args:
        delay_s: of each run, shape (runs,).
    """
    at = np.arange(blocks.seconds) + delay_s[:, None]
    there = at < blocks.seconds
    return {
        name: np.where(there, np.take_along_axis(blocks[name], np.where(there, at, 0), axis=1), 0.0)
        for name in FIXES
    }
