"""The steady window of a run: which seconds count (the Dutch texts call it "knippen").

Only the start and the end of a run may be cut, because speed rose or fell, the force shows an
unexplained peak (steering) or a gust passed; what remains begins and ends at equal speed and
force and lasts at least 30 s (Sleepproef, R. Pot 2017, "Knippen"). With blocks of a second there
are so few windows that all of them are tried, longest first: the rule, not a hand, decides.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.blocks import RunBlocks
from pipeline.method import Window

END_SECONDS: Final = 5
"""Length of the two ends that are compared, s (research, method.md 6.4)."""

MAD_TO_SD: Final = 1.4826
FORCE_SD_FLOOR: Final = 0.01
"""Smallest spread of block means that a peak is measured by, as a share of the median force."""

WIND_SD_FLOOR_M_S: Final = 0.25

DRIFT_M_S: Final = 0.1
"""Rise or fall of speed that is a reason to cut (Sleepproef 2017, "Knippen", reason 1)."""

CUT_REASONS: Final = ("speed_drift", "force_peak", "gust", "ends_differ")


@dataclass(frozen=True)
class Windows:
    """One window per run.

    Attributes:
        mask: blocks inside the window, shape (runs, seconds); empty where none was found.
        start_s, end_s: the same in seconds, shape (runs,).
        found: a window of at least the prescribed length exists, shape (runs,).
        reasons: why the rest was cut, one text a run; empty when nothing was.
    """

    mask: BoolArray
    start_s: IntArray
    end_s: IntArray
    found: BoolArray
    reasons: tuple[str, ...]


def choose_windows(blocks: RunBlocks, rule: Window) -> Windows:
    """The window of every run under a rule; runs without any block have none."""
    present = blocks.n > 0
    if rule.rule == "all":
        return _windows(present, ("",) * present.shape[0])
    faults = _Faults.of(blocks, rule)
    start, length = _search(present, faults, rule)
    second = np.arange(blocks.seconds)
    mask = (second >= start[:, None]) & (second < (start + length)[:, None])
    return _windows(mask, tuple(_reasons(present, mask, faults)))


def _windows(mask: BoolArray, reasons: tuple[str, ...]) -> Windows:
    length = mask.sum(axis=1)
    start = np.where(length > 0, mask.argmax(axis=1), 0)
    return Windows(mask, start, start + length, length > 0, reasons)


@dataclass(frozen=True)
class _Faults:
    """What disturbs a run, per block or from block to block, shape (runs, seconds)."""

    speed: FloatArray
    force: FloatArray
    force_median: FloatArray
    force_peak: BoolArray
    gust: BoolArray

    @classmethod
    def of(cls, blocks: RunBlocks, rule: Window) -> "_Faults":
        present = blocks.n > 0
        force, wind = blocks.block_means("force"), blocks.block_means("wind_v")
        median, spread = _robust(force, present)
        peak = np.abs(force - median) > rule.outlier_sd * np.maximum(
            spread, FORCE_SD_FLOOR * np.abs(median)
        )
        wind_median, wind_spread = _robust(wind, present)
        gust = wind - wind_median > rule.outlier_sd * np.maximum(wind_spread, WIND_SD_FLOOR_M_S)
        speed = blocks.block_means("log1_v")
        return cls(speed, force, median[:, 0], peak & present, gust & present)


def _robust(values: FloatArray, present: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Median and robust standard deviation of each row, shape (runs, 1)."""
    held = np.where(present, values, np.nan)
    median = np.nanmedian(held, axis=1, keepdims=True)
    return median, MAD_TO_SD * np.nanmedian(np.abs(held - median), axis=1, keepdims=True)


def _search(present: BoolArray, faults: _Faults, rule: Window) -> tuple[IntArray, IntArray]:
    """Start and length of the best window of every run; length 0 where none is good enough."""
    runs, seconds = present.shape
    start, length = np.zeros(runs, np.int64), np.zeros(runs, np.int64)
    good = np.cumsum(present & ~faults.force_peak & ~faults.gust, axis=1, dtype=np.float64)
    for size in range(seconds, int(np.ceil(rule.minimum_s)) - 1, -1):
        todo = length == 0
        if not todo.any():
            break
        whole = _span(good, size)[todo] == size
        score = _unsteadiness(faults, size, rule, todo)
        score = np.where(whole, score, np.inf)
        best = score.argmin(axis=1)
        fits = np.take_along_axis(score, best[:, None], 1)[:, 0] <= 1.0
        rows = np.flatnonzero(todo)[fits]
        start[rows], length[rows] = best[fits], size
    return start, length


def _unsteadiness(faults: _Faults, size: int, rule: Window, rows: BoolArray) -> FloatArray:
    """How far the worst steadiness criterion is from its limit (1), for every window of a size.

    The criteria: drift of speed by a fitted line over the window, difference of mean speed and
    of mean force between its first and last `END_SECONDS`.
    """
    speed, force = faults.speed[rows], faults.force[rows]
    drift = np.abs(_slope(speed, size)) * size / rule.speed_drift_m_s
    speed_ends = np.abs(_ends_difference(speed, size)) / rule.speed_drift_m_s
    force_limit = rule.force_ends_ratio * np.abs(faults.force_median[rows, None])
    force_ends = np.abs(_ends_difference(force, size)) / np.maximum(force_limit, 1e-9)
    return np.maximum(np.maximum(drift, speed_ends), force_ends)


def _span(cumulative: FloatArray, size: int) -> FloatArray:
    """Sums over every span of `size` blocks from a cumulative sum along axis 1."""
    total = np.pad(cumulative, ((0, 0), (1, 0)))
    return np.asarray(total[:, size:] - total[:, :-size])


def _slope(values: FloatArray, size: int) -> FloatArray:
    """Slope of the least-squares line through every span of `size` blocks, per block."""
    centred = values - values.mean(axis=1, keepdims=True)
    time = np.arange(values.shape[1], dtype=np.float64)
    sum_v, sum_tv = _span(np.cumsum(centred, 1), size), _span(np.cumsum(centred * time, 1), size)
    mean_time = np.arange(sum_v.shape[1]) + (size - 1) / 2
    return np.asarray((sum_tv - mean_time * sum_v) / (size * (size**2 - 1) / 12))


def _ends_difference(values: FloatArray, size: int) -> FloatArray:
    """Mean of the last minus mean of the first `END_SECONDS` of every span of `size` blocks."""
    ends = _span(np.cumsum(values, 1), END_SECONDS) / END_SECONDS
    starts = values.shape[1] - size + 1
    return np.asarray(ends[:, size - END_SECONDS :][:, :starts] - ends[:, :starts])


def _reasons(present: BoolArray, mask: BoolArray, faults: _Faults) -> list[str]:
    """What was wrong in the part that was cut, as codes joined by commas."""
    cut = present & ~mask
    drift = np.abs(faults.speed - _robust(faults.speed, present)[0]) > DRIFT_M_S
    found = np.stack(
        [
            (cut & drift).any(axis=1),
            (cut & faults.force_peak).any(axis=1),
            (cut & faults.gust).any(axis=1),
        ],
        axis=1,
    )
    found = np.column_stack([found, cut.any(axis=1) & ~found.any(axis=1)])
    return [",".join(np.compress(row, CUT_REASONS)) for row in found]
