"""The steady window of a run: which seconds count (the Dutch texts call it "knippen").

Only the start and the end of a run may be cut, because speed rose or fell, the force shows an
unexplained peak (steering) or a gust passed. What remains begins and ends at equal speed, equal
force and about equal wind and lasts at least 30 s (Sleepproef, R. Pot 2017, "Knippen"). With blocks
of a second there are so few windows that all of them are tried, longest first: the rule, not a
hand, decides. A window within the three limits goes before every other. Where there is none, speed
must be within its limit all the same, or the run does not count; by how much force or wind exceeds
its limit, the window says. A window that a person gave goes before the one that is found.
"""

from dataclasses import dataclass
from itertools import compress
from typing import Any, Final

import numpy as np
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.blocks.run_blocks import RunBlocks, WindowSums
from pipeline.method.constants import FORCE_ENDS_RATIO, SHORTEST_WINDOW_S, SPEED_ENDS_M_S
from pipeline.quantiles import MAD_TO_SD

WORTH_DECIMALS: Final = 6
"""Windows whose worth is equal to the microsecond are equals: the same faults in another order of
summing cost the same."""

END_SECONDS: Final = 5
"""Length of the two ends that are compared, s (docs/method-details.md, 2)."""

BLOCK_PRICE_S: Final = 10.0
"""What a peak or gust inside a window costs, in seconds of its length, for each block and each
limit's worth over the limit."""

NOT_WITHIN_S: Final = 1e3
"""What force or wind that differs beyond its limit costs for each limit's worth: more than any
length, so that every window within the limits goes before, and else the one that exceeds them
least."""

WIND_ENDS_M_S: Final = 1.0
"""Allowed difference of the wind between the ends (inferred; S2017: "about equal")."""

LEAST_RAMP_M_S: Final = 0.08
"""Smallest ramp of the speed that is cut (inferred; the text says 0.1 m/s)."""

PEAK_SD: Final = 3.0
GUST_SD: Final = 2.4
"""A peak of the force and a gust, in robust standard deviations (inferred)."""

LONGEST_RAMP_S: Final = 12
RAMP_MARGIN_S: Final = 5
"""Cut beyond the end of the straight line that is fitted to a ramp, whose tail it misses."""

PEAK_MARGIN_S: Final = 1
"""Cut on both sides of a peak or gust, for its flanks."""

FORCE_SD_FLOOR: Final = 0.01
"""Smallest spread of block means that a peak is measured by, as a share of the median force."""

WIND_SD_FLOOR_M_S: Final = 0.25

HAND_COLUMNS: Final = {"start_s": "hand_start_s", "end_s": "hand_end_s", "reason": "hand_reason"}
"""Columns of `blocks.runs` with the windows given by hand, by their name in `hand_windows`; null
where a run has none."""

BY_HAND: Final = "by_hand"
CUT_REASONS: Final = ("speed_drift", "force_peak", "gust", "ends_differ")


@dataclass(frozen=True)
class Windows:
    """One window per run.

    Attributes:
        mask: blocks inside the window, shape (runs, seconds); empty where there is none.
        start_s, end_s: the same in seconds, shape (runs,).
        exists: whether the run has a window of at least the prescribed length, shape (runs,).
        reasons: why the rest was cut, one text per run; empty when nothing was.
        speed_rise_m_s, force_rise_ratio, wind_rise_m_s: the last `END_SECONDS` less the first, of
            mean speed by log 1, of mean force / that of the window, and of mean wind speed, shape
            (runs,); 0 without a window.
    """

    mask: BoolArray
    start_s: IntArray
    end_s: IntArray
    exists: BoolArray
    reasons: tuple[str, ...]
    speed_rise_m_s: FloatArray
    force_rise_ratio: FloatArray
    wind_rise_m_s: FloatArray

    @property
    def ends_ratio(self) -> FloatArray:
        """The largest of the three differences in their limits: over 1 exceeds one."""
        speed = np.abs(self.speed_rise_m_s) / SPEED_ENDS_M_S
        force = np.abs(self.force_rise_ratio) / FORCE_ENDS_RATIO
        return np.maximum(np.maximum(speed, force), np.abs(self.wind_rise_m_s) / WIND_ENDS_M_S)

    @property
    def of_runs(self) -> dict[str, Any]:
        """What a method keeps of them, (runs,) each: all but the mask."""
        return {
            "start_s": self.start_s,
            "end_s": self.end_s,
            "exists": self.exists,
            "cut_reason": np.array(self.reasons, dtype=np.str_),
            "ends_ratio": self.ends_ratio,
            "rise_m_s": self.speed_rise_m_s,
        }


def whole_runs(blocks: RunBlocks) -> Windows:
    """Windows that hold all of every run; runs without any block have none."""
    return _windows(blocks, blocks.inside, ("",) * len(blocks.n))


def steady_windows(blocks: RunBlocks) -> Windows:
    """The steady part of every run, or the window that a person gave; some runs have none."""
    present, judged = blocks.inside, _Runs.of(blocks)
    start, length = _search(present, judged)
    second = np.arange(blocks.seconds)
    mask = (second >= start[:, None]) & (second < (start + length)[:, None])
    searched = _windows(blocks, mask, tuple(_reasons(present, mask, judged)))
    return _given_by_hand(blocks, searched)


def _given_by_hand(blocks: RunBlocks, searched: Windows) -> Windows:
    """The windows given by hand, which must be as long as any other, else the searched ones."""
    if not set(HAND_COLUMNS.values()) <= set(blocks.runs.columns):
        return searched
    hand_start, hand_end, hand_reason = (blocks.runs[c] for c in HAND_COLUMNS.values())
    given = hand_start.is_not_null().to_numpy()
    start, end = (bound.fill_null(0).to_numpy()[:, None] for bound in (hand_start, hand_end))
    second = np.arange(blocks.seconds)
    inside = (second >= start) & (second < end) & blocks.inside
    long_enough = inside.sum(axis=1, keepdims=True) >= SHORTEST_WINDOW_S
    reasons = tuple(
        f"{BY_HAND}: {why}" if hand else reason
        for hand, why, reason in zip(given, hand_reason, searched.reasons, strict=True)
    )
    mask = np.where(given[:, None], inside & long_enough, searched.mask)
    return _windows(blocks, mask, reasons)


def _windows(blocks: RunBlocks, mask: BoolArray, reasons: tuple[str, ...]) -> Windows:
    length = mask.sum(axis=1)
    start = np.where(length > 0, mask.argmax(axis=1), 0)
    second = np.arange(blocks.seconds)
    first = mask & (second < (start + END_SECONDS)[:, None])
    last = mask & (second >= (start + length - END_SECONDS)[:, None])
    ends = [WindowSums(blocks, end) for end in (first, last)]
    speed, force, wind = (
        ends[1].mean(name) - ends[0].mean(name) for name in ("log1_v", "force", "wind_v")
    )
    mean_force = np.abs(WindowSums(blocks, mask).mean("force"))
    force /= np.where(mean_force > 0, mean_force, 1.0)
    return Windows(mask, start, start + length, length > 0, reasons, speed, force, wind)


@dataclass(frozen=True)
class _Runs:
    """What windows are judged by, per block, shape (runs, seconds).

    Attributes:
        ramp: at the start or the end, where the speed still rises or falls.
        force_peak, gust: relative to their limits; over 1 is a fault.
        speed, speed_time: running sums of the speed less its mean, and of that times the second.
        speed_ends, force_ends, wind_ends: mean of `END_SECONDS` from every second on.
        force_median: of each run, shape (runs, 1).
    """

    ramp: BoolArray
    force_peak: FloatArray
    gust: FloatArray
    speed: FloatArray
    speed_time: FloatArray
    speed_ends: FloatArray
    force_ends: FloatArray
    wind_ends: FloatArray
    force_median: FloatArray

    @classmethod
    def of(cls, blocks: RunBlocks) -> "_Runs":
        present = blocks.inside
        speed, force, wind = (blocks.block_means(name) for name in ("log1_v", "force", "wind_v"))
        force_median, force_sd = median_and_sd(force, present)
        force_floor = np.maximum(FORCE_SD_FLOOR * np.abs(force_median), 1e-9)
        force_sd = np.maximum(force_sd, force_floor)
        centred = speed - speed.mean(axis=1, keepdims=True)
        speed_ends, force_ends, wind_ends = (
            _span(_running_sum(v), END_SECONDS) / END_SECONDS for v in (speed, force, wind)
        )
        return cls(
            _ramps(speed, present),
            _widened(np.abs(force - force_median) / (PEAK_SD * force_sd)),
            _widened(_wind_change(blocks, present) / GUST_SD),
            _running_sum(centred),
            _running_sum(centred * np.arange(blocks.seconds, dtype=np.float64)),
            speed_ends,
            force_ends,
            wind_ends,
            force_median,
        )

    def price_s(self) -> FloatArray:
        """What each block costs a window that holds it, shape (runs, seconds)."""
        excess = np.maximum(self.force_peak - 1.0, 0.0) + np.maximum(self.gust - 1.0, 0.0)
        return BLOCK_PRICE_S * np.asarray(excess, dtype=np.float64)

    def unsteadiness(self, size: int) -> tuple[FloatArray, FloatArray]:
        """How far speed, and the worse of force and wind, are from their limits (1).

        For every window of a size. Of the speed both the rise of a straight line and the difference
        of its ends count.
        """
        drift = np.abs(self._slope(size)) * size / SPEED_ENDS_M_S
        speed = np.abs(_ends_difference(self.speed_ends, size)) / SPEED_ENDS_M_S
        force_limit = FORCE_ENDS_RATIO * np.abs(self.force_median)
        force = np.abs(_ends_difference(self.force_ends, size)) / np.maximum(force_limit, 1e-9)
        wind = np.abs(_ends_difference(self.wind_ends, size)) / WIND_ENDS_M_S
        return np.maximum(drift, speed), np.maximum(force, wind)

    def _slope(self, size: int) -> FloatArray:
        """Slope of the least-squares line through the speed of every span, per block."""
        sum_v, sum_tv = _span(self.speed, size), _span(self.speed_time, size)
        mean_time = np.arange(sum_v.shape[1]) + (size - 1) / 2
        return np.asarray((sum_tv - mean_time * sum_v) / (size * (size**2 - 1) / 12))


def _wind_change(blocks: RunBlocks, present: BoolArray) -> FloatArray:
    """Distance of each block's wind vector from the run's median one, in robust deviations."""
    squares = np.zeros(present.shape)
    for component in ("wind_x", "wind_y"):
        wind = blocks.block_means(component)
        median, sd = median_and_sd(wind, present)
        squares += ((wind - median) / np.maximum(sd, WIND_SD_FLOOR_M_S)) ** 2
    return np.sqrt(squares)


def median_and_sd(values: FloatArray, present: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Return median and robust standard deviation of each row, (runs, 1); 0 for an empty row."""
    empty = ~present.any(axis=1, keepdims=True)
    filled = np.where(present, values, np.where(empty, 0.0, np.nan))
    median = np.nanmedian(filled, axis=1, keepdims=True)
    return median, MAD_TO_SD * np.nanmedian(np.abs(filled - median), axis=1, keepdims=True)


def _widened(values: FloatArray) -> FloatArray:
    """The largest value among each block and its neighbours within `PEAK_MARGIN_S`."""
    return np.asarray(
        scipy.ndimage.maximum_filter1d(values, 2 * PEAK_MARGIN_S + 1, axis=1, mode="nearest")
    )


def _ramps(speed: FloatArray, present: BoolArray) -> BoolArray:
    """Blocks at the start and the end of a run in which the speed still rises or falls."""
    length = present.sum(axis=1)
    second = np.arange(speed.shape[1])
    from_end = np.clip(length[:, None] - 1 - second, 0, None)
    backwards = np.take_along_axis(speed, from_end, axis=1)
    at_start, at_end = (_ramp_length(v, present)[:, None] for v in (speed, backwards))
    return np.asarray((second < at_start) | (second >= length[:, None] - at_end))


def _ramp_length(speed: FloatArray, present: BoolArray) -> IntArray:
    """Length of the ramp with which each run begins, 0 where there is none, in blocks.

    Fitted by least squares: a straight line up (or down) to second p, level from there, for every
    p up to `LONGEST_RAMP_S`; the best p, if the line spans at least `LEAST_RAMP_M_S`.
    """
    count = np.maximum(present.sum(axis=1), 1)
    mean = np.where(present, speed, 0.0).sum(axis=1) / count
    centred = np.where(present, speed - mean[:, None], 0.0)
    second = np.arange(speed.shape[1])
    best_gain, best_length, best_span = np.zeros((3, len(speed)))
    for p in range(1, LONGEST_RAMP_S + 1):
        line = np.where(present, np.clip(p - second, 0, None), 0.0)
        line = np.where(present, line - line.sum(axis=1, keepdims=True) / count[:, None], 0.0)
        norm, product = (line * line).sum(axis=1), (line * centred).sum(axis=1)
        gain = product**2 / np.maximum(norm, 1e-12)
        span = np.abs(product) / np.maximum(norm, 1e-12) * p
        better = gain > best_gain
        best_gain = np.where(better, gain, best_gain)
        best_length, best_span = np.where(better, p, best_length), np.where(better, span, best_span)
    return np.where(best_span >= LEAST_RAMP_M_S, best_length + RAMP_MARGIN_S, 0).astype(np.int64)


def _search(present: BoolArray, judged: _Runs) -> tuple[IntArray, IntArray]:
    """Start and length of the best window of every run; length 0 where none is good enough.

    Best is the longest, less what the faults inside it cost; of equals, the first and longest.
    """
    runs, seconds = present.shape
    start, length = np.zeros(runs, np.int64), np.zeros(runs, np.int64)
    value = np.full(runs, -np.inf)
    good = _running_sum((present & ~judged.ramp).astype(np.float64))
    price = _running_sum(judged.price_s())
    for size in range(seconds, SHORTEST_WINDOW_S - 1, -1):
        speed, ends = judged.unsteadiness(size)
        worth = size - _span(price, size) - np.where(ends > 1.0, NOT_WITHIN_S * ends, 0.0)
        accepted = (_span(good, size) == size) & (speed <= 1.0)
        worth = np.where(accepted, np.round(worth, WORTH_DECIMALS), -np.inf)
        best = worth.argmax(axis=1)
        highest = np.take_along_axis(worth, best[:, None], 1)[:, 0]
        better = highest > value
        start, length = np.where(better, best, start), np.where(better, size, length)
        value = np.maximum(highest, value)
    return start, length


def _running_sum(values: FloatArray) -> FloatArray:
    """Sum of each row up to every place, beginning with 0: one column more than `values`."""
    return np.pad(np.cumsum(values, axis=1), ((0, 0), (1, 0)))


def _span(running: FloatArray, size: int) -> FloatArray:
    """Sums over every span of `size` blocks from a running sum."""
    return np.asarray(running[:, size:] - running[:, :-size])


def _ends_difference(ends: FloatArray, size: int) -> FloatArray:
    """Mean of the last minus mean of the first `END_SECONDS` of every span of `size` blocks."""
    starts = ends.shape[1] - size + END_SECONDS
    return np.asarray(ends[:, size - END_SECONDS :][:, :starts] - ends[:, :starts])


def _reasons(present: BoolArray, mask: BoolArray, judged: _Runs) -> list[str]:
    """What was wrong in the part that was cut, as codes joined by commas."""
    cut = present & ~mask
    seen = (judged.ramp, judged.force_peak > 1.0, judged.gust > 1.0)
    explained = [(cut & fault).any(axis=1) for fault in seen]
    rest = cut.any(axis=1) & ~np.any(explained, axis=0)
    rows = np.stack([*explained, rest], axis=1).tolist()
    return [",".join(compress(CUT_REASONS, row)) for row in rows]
