"""Samples that are left out: no number, dropped out, or further off than can be."""

from typing import Final

import numpy as np
import scipy
from numpy.typing import NDArray

from pipeline.arrays import BoolArray
from pipeline.messages import say
from warehouse.archive.plausibility.judgement import (
    COLUMN_OF,
    SPARE,
    SPEEDS,
    Array,
    Cost,
    Judgement,
    Run,
    stretches,
    what_it_holds,
)
from warehouse.archive.plausibility.rules import EXTREMES

LEFT_OUT_S: Final = 2.0
"""Longest time in all of a run in which what the run point needs may be left out; as long again for
log 2 and the GPS each."""
DROPOUT_M_S: Final = 0.1
SPIKE_RATIO: Final = {"log1": 0.3, "log2": 0.3, "gps": 0.1}
"""Share of the speed around it: a boat and its crew weigh a ton, and change no faster. A GPS has no
noise of samples: such a jump is the receiver's (inferred)."""
AROUND_S: Final = 11
"""The speed around a sample: the median over so many seconds of each one's median."""
FORCE_SPIKE_RATIO: Final = (-3.0, 5.0)
"""Share of the usual force. A tow line cannot push: what a slack one reads is noise about zero."""
FORCE_DEAD_RATIO: Final = 0.05
FORCE_DEAD_S: Final = 0.1
"""A force that stays at one value so near zero, for so long, is not one."""
GUST_RATIO: Final = 2.5
GUST_M_S: Final = 4.0
"""Wind so many times the run's median, and this much more, is not a gust that cups follow."""


def usual_resistance_kg_m(runs: list[Run]) -> float:
    """Force / speed squared of a typical run, which a fault over most of one does not move."""
    each = [run.measured["force"].median / run.intended_m_s**2 for run in runs]
    return abs(float(np.nanmedian(each))) if np.isfinite(each).any() else np.nan


def leave_out(judgement: Judgement, run: Run, usual_kg_m: float) -> None:
    """Takes the samples of a run that cannot be, and the run where that is too much of it.

    Args:
        judgement: what is left of the tow.
        run: as measured.
        usual_kg_m: usual force over speed squared.
    """
    usual_n = usual_kg_m * run.intended_m_s**2
    wrong = {key: _wrong(run, key, usual_n) for key in run.channels}
    needed = np.logical_or.reduce([mask for key, mask in wrong.items() if key not in SPARE])
    most = LEFT_OUT_S * run.rate_hz
    cost: Cost = "run" if needed.sum() > most else "seconds"
    no_row = np.logical_and.reduce([np.isnan(values) for values in run.channels.values()])
    if no_row.any():
        seconds = float(no_row.sum()) / run.rate_hz
        what = say("rows lack fields, or their times jump back, for {:.3g} s in all", seconds)
        judgement.lose(run, "broken_row", what, cost, int(no_row.argmax()), seconds)
    for key, mask in wrong.items():
        own = mask & ~no_row
        count = float(own.sum())
        if not count or (cost == "run" and key in SPARE):
            continue
        row, values = int(own.argmax()), run.channels[key]
        what = say(
            "column '{column}' {} and is wrong for {:.3g} s in all",
            what_it_holds(values[row]),
            count / run.rate_hz,
            column=COLUMN_OF[key],
        )
        is_gone = key in SPARE and count > most
        of_channel: Cost = "column" if is_gone else cost
        judgement.lose(run, _reason(run, key, row), what, of_channel, row, count / run.rate_hz)
        run.channels[key] = np.where(own | is_gone, np.float32(np.nan), values)


def _reason(run: Run, key: str, row: int) -> str:
    """The reason code of a channel, by the first of its wrong samples."""
    value = run.channels[key][row]
    if not np.isfinite(value):
        return "bad_number"
    if key in SPEEDS and value <= DROPOUT_M_S:
        return "gps_dropout" if key == "gps" else "log_dropout"
    pushes = FORCE_SPIKE_RATIO[0] * abs(run.measured["force"].median)
    return "negative_force" if key == "force" and pushes <= value < 0 else "implausible_value"


def _wrong(run: Run, key: str, usual_n: float) -> BoolArray:
    """Samples of a channel that are no number, have dropped out or cannot be."""
    values, median = run.channels[key], run.measured[key].median
    if key in SPEEDS:
        return _wrong_speed(values, median, run.rate_hz, SPIKE_RATIO[key])
    if key == "force":
        return _wrong_force(run, values, usual_n)
    least, most = EXTREMES[key]
    if key == "wind_speed":
        most = min(most, GUST_RATIO * abs(median) + GUST_M_S)
    return _outside(values, least, most)


def _outside(values: Array, lowest: float, highest: float) -> BoolArray:
    """Samples that are not between two limits, or no number."""
    return np.asarray(~((values >= lowest) & (values <= highest)))


def _wrong_speed(values: Array, median: float, rate_hz: int, spike_ratio: float) -> BoolArray:
    far = spike_ratio * abs(median)
    near = (values > DROPOUT_M_S) & (np.abs(values - median) <= far)
    if near.all():
        return np.zeros(len(values), dtype=bool)
    around = _around(values, rate_hz)
    steady = np.abs(values - around) <= spike_ratio * around
    return np.asarray(~((values > DROPOUT_M_S) & steady))


def _around(values: Array, rate_hz: int) -> NDArray[np.float64]:
    """The speed around each sample, which short faults do not move; 0 without any number."""
    length = max(len(values) // rate_hz, 1)
    second = np.minimum(np.arange(len(values)) // rate_hz, length - 1)
    padded = np.full((length, int(np.bincount(second).max())), np.nan)
    padded[second, np.arange(len(values)) - second * rate_hz] = values
    known = np.isfinite(padded).any(axis=1)
    if not known.any():
        return np.zeros(len(values))
    medians = np.nanmedian(padded[known], axis=1)
    filtered = scipy.ndimage.median_filter(medians, AROUND_S, mode="nearest")
    each = np.interp(np.arange(length), np.flatnonzero(known), filtered)
    return np.asarray(each[second], dtype=np.float64)


def _wrong_force(run: Run, values: Array, usual_n: float) -> BoolArray:
    low, high = (ratio * usual_n for ratio in FORCE_SPIKE_RATIO)
    wrong = _outside(values, low, high)
    near_zero = FORCE_DEAD_RATIO * usual_n
    if (np.abs(values) <= near_zero).any():
        starts, lengths = stretches(values[1:] != values[:-1])
        least = max(int(FORCE_DEAD_S * run.rate_hz), 3)
        wrong |= np.repeat((lengths >= least) & (np.abs(values[starts]) <= near_zero), lengths)
    means = run.second_means(np.where(wrong, np.float32(np.nan), values))
    if (means < 0).any():  # single negative samples are the surge of the tow line
        second = np.minimum(np.arange(len(values)) // run.rate_hz, len(means) - 1)
        wrong |= (means < 0)[second]
    return wrong
