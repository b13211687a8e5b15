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
from typing import Any, Final, Self

import numpy as np
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.blocks.run_blocks import RunBlocks, WindowSums
from pipeline.method.constants import FORCE_ENDS_RATIO, SHORTEST_WINDOW_S, SPEED_ENDS_M_S
from pipeline.quantiles import MAD_TO_SD
from pipeline.tables.keys import HAND_COLUMNS

SCORE_DECIMALS: Final = 6
"""Windows whose scores are equal to the microsecond are equals: the same faults in another order of
summing cost the same."""

END_SECONDS: Final = 5
"""Length of the two ends that are compared, s (docs/method-details.md, 2)."""

FAULT_COST_S: Final = 10.0
"""What a peak or gust inside a window costs, in seconds of its length, for each block and each
limit's worth over the limit."""

OVER_LIMIT_COST_S: Final = 1e3
"""What force or wind that differs beyond its limit costs for each limit's worth: more than any
length, so that every window within the limits goes before, and else the one that exceeds them
least."""

WIND_ENDS_M_S: Final = 1.0
"""Allowed difference of the wind between the ends (inferred; S2017: "about equal")."""

MIN_RAMP_M_S: Final = 0.08
"""Smallest ramp of the speed that is cut (inferred; the text says 0.1 m/s)."""

PEAK_SD: Final = 3.0
GUST_SD: Final = 2.4
"""A peak of the force and a gust, in robust standard deviations (inferred)."""

MAX_RAMP_S: Final = 12
RAMP_MARGIN_S: Final = 5
"""Cut beyond the end of the straight line that is fitted to a ramp, whose tail it misses."""

PEAK_MARGIN_S: Final = 1
"""Cut on both sides of a peak or gust, for its flanks."""

FORCE_SD_FLOOR: Final = 0.01
"""Smallest spread of block means that a peak is measured by, as a share of the median force."""

WIND_SD_FLOOR_M_S: Final = 0.25

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
    def columns_of_runs(self) -> dict[str, Any]:
        """What a method keeps of them, (runs,) each: all but the mask."""
        return {
            "start_s": self.start_s,
            "end_s": self.end_s,
            "exists": self.exists,
            "cut_reason": np.array(self.reasons, dtype=np.str_),
            "ends_ratio": self.ends_ratio,
            "rise_m_s": self.speed_rise_m_s,
        }


def take_whole_runs(blocks: RunBlocks) -> Windows:
    """Return windows that hold all of every run; runs without any block have none."""
    return describe_windows(blocks, blocks.inside, ("",) * len(blocks.n))


def find_steady_windows(blocks: RunBlocks) -> Windows:
    """Return the steady part of every run, or the window a person gave; some runs have none."""
    faults = Faults.from_blocks(blocks)
    start, length = find_best_windows(blocks.inside, faults, Ends.from_blocks(blocks))
    second = np.arange(blocks.seconds)
    mask = (second >= start[:, None]) & (second < (start + length)[:, None])
    reasons = explain_cuts(blocks.inside, mask, faults)
    return apply_hand_windows(blocks, describe_windows(blocks, mask, reasons))


def apply_hand_windows(blocks: RunBlocks, found: Windows) -> Windows:
    """Return the windows given by hand, which must be as long as any other, else those found."""
    if not set(HAND_COLUMNS.values()) <= set(blocks.runs.columns):
        return found
    hand_start = blocks.runs[HAND_COLUMNS["start_s"]]
    hand_end = blocks.runs[HAND_COLUMNS["end_s"]]
    hand_reason = blocks.runs[HAND_COLUMNS["reason"]]
    is_given = hand_start.is_not_null().to_numpy()
    start = hand_start.fill_null(0).to_numpy()[:, None]
    end = hand_end.fill_null(0).to_numpy()[:, None]
    second = np.arange(blocks.seconds)
    inside = (second >= start) & (second < end) & blocks.inside
    is_long_enough = inside.sum(axis=1, keepdims=True) >= SHORTEST_WINDOW_S
    reasons = tuple(
        f"{BY_HAND}: {given_reason}" if given else found_reason
        for given, given_reason, found_reason in zip(
            is_given, hand_reason, found.reasons, strict=True
        )
    )
    mask = np.where(is_given[:, None], inside & is_long_enough, found.mask)
    return describe_windows(blocks, mask, reasons)


def describe_windows(blocks: RunBlocks, mask: BoolArray, reasons: tuple[str, ...]) -> Windows:
    """Measure how far the two ends of each window differ.

    Args:
        mask: blocks inside the window, shape (runs, seconds).
        reasons: why the rest was cut, one text per run.
    """
    length = mask.sum(axis=1)
    start = np.where(length > 0, mask.argmax(axis=1), 0)
    end = start + length
    second = np.arange(blocks.seconds)
    first = WindowSums(blocks, mask & (second < (start + END_SECONDS)[:, None]))
    last = WindowSums(blocks, mask & (second >= (end - END_SECONDS)[:, None]))
    mean_force = np.abs(WindowSums(blocks, mask).mean("force"))
    force_rise = last.mean("force") - first.mean("force")
    return Windows(
        mask=mask,
        start_s=start,
        end_s=end,
        exists=length > 0,
        reasons=reasons,
        speed_rise_m_s=last.mean("log1_v") - first.mean("log1_v"),
        force_rise_ratio=force_rise / np.where(mean_force > 0, mean_force, 1.0),
        wind_rise_m_s=last.mean("wind_v") - first.mean("wind_v"),
    )


# The search


@dataclass(frozen=True)
class Faults:
    """What is wrong in each block, shape (runs, seconds).

    Attributes:
        is_ramp: at the start or the end, where the speed still rises or falls.
        force_peak, gust: size relative to its limit; over 1 is a fault.
    """

    is_ramp: BoolArray
    force_peak: FloatArray
    gust: FloatArray

    @classmethod
    def from_blocks(cls, blocks: RunBlocks) -> Self:
        """Find the faults of every run."""
        force = blocks.block_means("force")
        median, sd = compute_robust_moments(force, blocks.inside)
        sd_floor = np.maximum(FORCE_SD_FLOOR * np.abs(median), 1e-9)
        force_peak = np.abs(force - median) / (PEAK_SD * np.maximum(sd, sd_floor))
        return cls(
            is_ramp=find_ramps(blocks.block_means("log1_v"), blocks.inside),
            force_peak=widen(force_peak),
            gust=widen(measure_wind_change(blocks) / GUST_SD),
        )

    @property
    def cost_s(self) -> FloatArray:
        """Seconds that each block costs a window that holds it, shape (runs, seconds)."""
        peak_excess = np.maximum(self.force_peak - 1.0, 0.0)
        gust_excess = np.maximum(self.gust - 1.0, 0.0)
        return FAULT_COST_S * np.asarray(peak_excess + gust_excess, dtype=np.float64)


@dataclass(frozen=True)
class Ends:
    """Running sums from which the ends of any window are compared, shape (runs, seconds).

    Speed, force and wind are in units of the difference that is allowed between the ends.

    Attributes:
        speed, speed_time: sums up to each second of the speed less its mean, and of that times the
            second; one column more.
        speed_ends, force_ends, wind_ends: means over `END_SECONDS` from every second on.
    """

    speed: FloatArray
    speed_time: FloatArray
    speed_ends: FloatArray
    force_ends: FloatArray
    wind_ends: FloatArray

    @classmethod
    def from_blocks(cls, blocks: RunBlocks) -> Self:
        """Sum the blocks of every run."""
        force_n = blocks.block_means("force")
        force_limit_n = FORCE_ENDS_RATIO * np.abs(compute_medians(force_n, blocks.inside))
        force = force_n / np.maximum(force_limit_n, 1e-9)
        speed = blocks.block_means("log1_v") / SPEED_ENDS_M_S
        wind = blocks.block_means("wind_v") / WIND_ENDS_M_S
        centred = speed - speed.mean(axis=1, keepdims=True)
        return cls(
            speed=compute_running_sum(centred),
            speed_time=compute_running_sum(centred * np.arange(blocks.seconds, dtype=np.float64)),
            speed_ends=compute_span_sum(compute_running_sum(speed), END_SECONDS) / END_SECONDS,
            force_ends=compute_span_sum(compute_running_sum(force), END_SECONDS) / END_SECONDS,
            wind_ends=compute_span_sum(compute_running_sum(wind), END_SECONDS) / END_SECONDS,
        )

    def compare(self, size: int) -> tuple[FloatArray, FloatArray]:
        """Compare the ends of all windows of a size with their limits; over 1 exceeds one.

        Returns:
            For speed, the larger of the difference between the ends and the rise of a straight
            line; and for force and wind, the larger of both. Shape (runs, windows) each.
        """
        drift = np.abs(self._speed_slope(size)) * size
        speed = np.abs(compute_ends_difference(self.speed_ends, size))
        force = np.abs(compute_ends_difference(self.force_ends, size))
        wind = np.abs(compute_ends_difference(self.wind_ends, size))
        return np.maximum(drift, speed), np.maximum(force, wind)

    def _speed_slope(self, size: int) -> FloatArray:
        """Return the least-squares slope of the speed over every window of a size, per block."""
        sum_speed = compute_span_sum(self.speed, size)
        sum_speed_time = compute_span_sum(self.speed_time, size)
        mean_time = np.arange(sum_speed.shape[1]) + (size - 1) / 2
        time_squares = size * (size**2 - 1) / 12
        return np.asarray((sum_speed_time - mean_time * sum_speed) / time_squares)


def find_best_windows(
    is_present: BoolArray, faults: Faults, ends: Ends
) -> tuple[IntArray, IntArray]:
    """Find the best window of every run among all windows, longest first.

    Best is the longest, less what the faults inside it and its ends cost; of equals, the first and
    longest. A window with a ramp in it, or whose speed changes beyond its limit, never counts.

    Args:
        is_present: blocks that the run has, shape (runs, seconds).

    Returns:
        Start and length in seconds, shape (runs,); length 0 where no window is good enough.
    """
    n_runs, n_seconds = is_present.shape
    best_start = np.zeros(n_runs, np.int64)
    best_length = np.zeros(n_runs, np.int64)
    best_score = np.full(n_runs, -np.inf)
    usable = compute_running_sum((is_present & ~faults.is_ramp).astype(np.float64))
    cost_s = compute_running_sum(faults.cost_s)
    for size in range(n_seconds, SHORTEST_WINDOW_S - 1, -1):
        speed_excess, other_excess = ends.compare(size)
        over_limit_cost_s = np.where(other_excess > 1.0, OVER_LIMIT_COST_S * other_excess, 0.0)
        score = size - compute_span_sum(cost_s, size) - over_limit_cost_s
        is_allowed = (compute_span_sum(usable, size) == size) & (speed_excess <= 1.0)
        score = np.where(is_allowed, np.round(score, SCORE_DECIMALS), -np.inf)
        start = score.argmax(axis=1)
        highest = score.max(axis=1)
        is_better = highest > best_score
        best_start = np.where(is_better, start, best_start)
        best_length = np.where(is_better, size, best_length)
        best_score = np.maximum(highest, best_score)
    return best_start, best_length


def explain_cuts(is_present: BoolArray, mask: BoolArray, faults: Faults) -> tuple[str, ...]:
    """Return why the cut part was cut, as codes joined by commas, per run."""
    is_cut = is_present & ~mask
    faulty = (faults.is_ramp, faults.force_peak > 1.0, faults.gust > 1.0)
    explained = np.stack([(is_cut & fault).any(axis=1) for fault in faulty], axis=1)
    is_unexplained = is_cut.any(axis=1) & ~explained.any(axis=1)
    applies = np.column_stack([explained, is_unexplained])
    return tuple(
        ",".join(code for code, cut in zip(CUT_REASONS, row, strict=True) if cut)
        for row in applies.tolist()
    )


# Faults


def find_ramps(speed: FloatArray, is_present: BoolArray) -> BoolArray:
    """Return blocks at the start and the end of a run in which the speed still rises or falls."""
    length = is_present.sum(axis=1)
    second = np.arange(speed.shape[1])
    from_end = np.clip(length[:, None] - 1 - second, 0, None)
    backwards = np.take_along_axis(speed, from_end, axis=1)
    ramp_at_start = measure_ramp(speed, is_present)[:, None]
    ramp_at_end = measure_ramp(backwards, is_present)[:, None]
    return np.asarray((second < ramp_at_start) | (second >= length[:, None] - ramp_at_end))


def measure_ramp(speed: FloatArray, is_present: BoolArray) -> IntArray:
    """Return the length of the ramp with which each run begins, in blocks; 0 without one.

    By least squares: a straight line up (or down) to second p, level from there, for every p up to
    `MAX_RAMP_S`; the best p, if the line spans at least `MIN_RAMP_M_S`. The line is 0 from p on, so
    that its products with the centred speed need the first p seconds alone.
    """
    count = np.maximum(is_present.sum(axis=1), 1)
    mean = np.where(is_present, speed, 0.0).sum(axis=1) / count
    beginning = is_present[:, :MAX_RAMP_S].astype(np.float64)
    centred = beginning * (speed[:, :MAX_RAMP_S] - mean[:, None])
    lengths = np.arange(1, MAX_RAMP_S + 1)
    second = np.arange(beginning.shape[1])
    lines = np.clip(lengths - second[:, None], 0, None)  # (seconds, lengths)

    product = centred @ lines
    norm = beginning @ lines**2 - (beginning @ lines) ** 2 / count[:, None]
    norm = np.maximum(norm, 1e-12)
    best = (product**2 / norm).argmax(axis=1)
    run = np.arange(len(speed))
    span = np.abs(product[run, best]) / norm[run, best] * lengths[best]
    return np.where(span >= MIN_RAMP_M_S, lengths[best] + RAMP_MARGIN_S, 0)


def measure_wind_change(blocks: RunBlocks) -> FloatArray:
    """Return the distance of each block's wind vector from the run's median, in robust sd."""
    squares = np.zeros(blocks.inside.shape)
    for component in ("wind_x", "wind_y"):
        wind = blocks.block_means(component)
        median, sd = compute_robust_moments(wind, blocks.inside)
        squares += ((wind - median) / np.maximum(sd, WIND_SD_FLOOR_M_S)) ** 2
    return np.sqrt(squares)


def compute_robust_moments(
    values: FloatArray, is_present: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Return median and robust sd of each row, shape (runs, 1); 0 for an empty row."""
    median = compute_medians(values, is_present)
    return median, MAD_TO_SD * compute_medians(np.abs(values - median), is_present)


def compute_medians(values: FloatArray, is_present: BoolArray) -> FloatArray:
    """Return the median of the present values of each row, shape (runs, 1); 0 for an empty row."""
    count = is_present.sum(axis=1, keepdims=True)
    ordered = np.sort(np.where(is_present, values, np.inf), axis=1)
    middle = np.hstack([np.maximum(count - 1, 0) // 2, count // 2])
    median = np.take_along_axis(ordered, middle, axis=1).mean(axis=1, keepdims=True)
    return np.where(count > 0, median, 0.0)


def widen(values: FloatArray) -> FloatArray:
    """Return the largest value among each block and its neighbours within `PEAK_MARGIN_S`."""
    return np.asarray(
        scipy.ndimage.maximum_filter1d(values, 2 * PEAK_MARGIN_S + 1, axis=1, mode="nearest")
    )


# Sums over windows


def compute_running_sum(values: FloatArray) -> FloatArray:
    """Return sums of each row up to every place, beginning with 0: one column more.

    They are stored by column, so that the differences over spans of a size are quick.
    """
    return np.asfortranarray(np.pad(np.cumsum(values, axis=1), ((0, 0), (1, 0))))


def compute_span_sum(running: FloatArray, size: int) -> FloatArray:
    """Return sums over every span of `size` blocks, from a running sum."""
    return np.asarray(running[:, size:] - running[:, :-size])


def compute_ends_difference(ends: FloatArray, size: int) -> FloatArray:
    """Return the mean of the last less that of the first `END_SECONDS` of every span."""
    n_spans = ends.shape[1] - size + END_SECONDS
    return np.asarray(ends[:, size - END_SECONDS :][:, :n_spans] - ends[:, :n_spans])
