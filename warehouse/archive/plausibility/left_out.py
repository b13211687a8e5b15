"""Samples that are left out: no number, dropped out, or further off than can be."""

from collections.abc import Collection
from dataclasses import replace
from typing import Final

import numpy as np
import scipy
from numpy.typing import NDArray

from pipeline.arrays import BoolArray
from pipeline.messages import say
from warehouse.archive.faults import Fault, Lost
from warehouse.archive.plausibility.run import (
    COLUMN_OF,
    LEFT_OUT_S,
    SPARE,
    SPEEDS,
    WIND_ANGLE_DEG,
    WIND_SPEED_M_S,
    Array,
    Run,
    known_of,
    median_of,
    second_means,
    stretches,
    what_it_holds,
    what_then,
)
from warehouse.archive.plausibility.whole_runs import judge_whole

DROPOUT_M_S: Final = 0.1
SPEED_SPIKE_RATIO: Final = 0.3
"""Share of the speed around it: a boat and its crew weigh a ton, and change no faster."""
GPS_JUMP_RATIO: Final = 0.1
"""The same of a GPS, which has no noise of samples: such a jump is the receiver's (inferred)."""
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

_NOT_IN_THIS_RUN: Final = say("over {:g} s, so the run goes on without this column", LEFT_OUT_S)


def usual_resistance_kg_m(runs: list[Run]) -> float:
    """Force / speed squared of a typical run, which a fault over most of one does not move."""
    each = [median_of(run.channels["force"]) / run.intended_m_s**2 for run in runs]
    return abs(known_of(np.nanmedian, np.asarray(each)))


def judge_run(run: Run, usual_kg_m: float, gone: Collection[str]) -> tuple[Run | None, list[Fault]]:
    """The run without the samples that cannot be, or None where too much or all of it is wrong.

    Channels that are `gone` were told before.
    """
    wrong = _wrong_samples(run, usual_kg_m * run.intended_m_s**2)
    wrong = {key: mask for key, mask in wrong.items() if key not in gone}
    no_row = np.logical_and.reduce([~np.isfinite(values) for values in run.channels.values()])
    needed = np.logical_or.reduce([mask for key, mask in wrong.items() if key not in SPARE])
    most = LEFT_OUT_S * run.rate_hz
    lost: Lost = "run" if needed.sum() > most else "seconds"
    faults = [_of_rows(run, no_row, lost)] if no_row.any() else []
    wrong = {key: mask & ~no_row for key, mask in wrong.items() if (mask & ~no_row).any()}
    channels = dict(run.channels)
    for key, mask in wrong.items():
        cost = "seconds" if key in SPARE else lost
        is_gone = key in SPARE and mask.sum() > most
        then = _NOT_IN_THIS_RUN if is_gone else what_then(cost)
        faults.append(_of_samples(run, key, mask, cost, then))
        channels[key] = np.where(mask | is_gone, np.float32(np.nan), channels[key])
    if lost == "run":
        return None, [fault for fault in faults if fault.lost == "run"]
    return judge_whole(replace(run, channels=channels), faults)


def _of_rows(run: Run, mask: BoolArray, lost: Lost) -> Fault:
    """The fault of rows of which nothing can be read."""
    seconds = float(mask.sum()) / run.rate_hz
    message = say(
        "{}: rows do not have their fields, {:.3g} s in all; {}.",
        run.name,
        seconds,
        what_then(lost),
    )
    if mask.all():
        message = say(
            "{}: no row can be used, as fields are missing or the times jump back; the run is left "
            "out.",
            run.name,
        )
    return run.fault("broken_row", message, int(mask.argmax()), lost, seconds)


def _of_samples(run: Run, key: str, mask: BoolArray, lost: Lost, then: str) -> Fault:
    """The fault of samples of one channel, named by the first of them."""
    row = int(mask.argmax())
    seconds = float(mask.sum()) / run.rate_hz
    message = say(
        "{}: column '{column}' {} and is wrong for {:.3g} s in all; {}.",
        run.name,
        what_it_holds(run.channels[key][row]),
        seconds,
        then,
        column=COLUMN_OF[key],
    )
    return run.fault(_reason(run, key, row), message, row, lost, seconds)


def _reason(run: Run, key: str, row: int) -> str:
    value = run.channels[key][row]
    if not np.isfinite(value):
        return "bad_number"
    if key in SPEEDS and value <= DROPOUT_M_S:
        return "gps_dropout" if key == "gps" else "log_dropout"
    pushes = FORCE_SPIKE_RATIO[0] * abs(median_of(run.channels["force"]))
    return "negative_force" if key == "force" and pushes <= value < 0 else "implausible_value"


def _wrong_samples(run: Run, usual_n: float) -> dict[str, BoolArray]:
    """Samples that are no number, have dropped out or cannot be, by channel."""
    wrong = {}
    for key, values in run.channels.items():
        if key in SPEEDS:
            spike = GPS_JUMP_RATIO if key == "gps" else SPEED_SPIKE_RATIO
            wrong[key] = _wrong_speed(values, run.rate_hz, spike)
        elif key == "force":
            wrong[key] = _wrong_force(values, usual_n, run.rate_hz)
        elif key == "wind_speed":
            most = GUST_RATIO * abs(median_of(values)) + GUST_M_S
            wrong[key] = _outside(values, WIND_SPEED_M_S[0], min(WIND_SPEED_M_S[1], most))
        else:
            wrong[key] = _outside(values, *WIND_ANGLE_DEG)
    return wrong


def _outside(values: Array, lowest: float, highest: float) -> BoolArray:
    """Samples that are not between two limits, or no number."""
    return np.asarray(~((values >= lowest) & (values <= highest)))


def _wrong_speed(values: Array, rate_hz: int, spike_ratio: float) -> BoolArray:
    median = median_of(values)
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


def _wrong_force(values: Array, usual_n: float, rate_hz: int) -> BoolArray:
    low, high = (ratio * usual_n for ratio in FORCE_SPIKE_RATIO)
    wrong = _outside(values, low, high)
    if (np.abs(values) <= FORCE_DEAD_RATIO * usual_n).any():
        wrong |= _dead(values, FORCE_DEAD_RATIO * usual_n, max(int(FORCE_DEAD_S * rate_hz), 3))
    means = second_means(np.where(wrong, np.float32(np.nan), values), rate_hz)
    if (means < 0).any():  # single negative samples are the surge of the tow line
        second = np.minimum(np.arange(len(values)) // rate_hz, len(means) - 1)
        wrong |= (means < 0)[second]
    return wrong


def _dead(values: Array, most: float, samples: int) -> BoolArray:
    """Stretches of at least so many equal samples near zero."""
    starts, lengths = stretches(values[1:] != values[:-1])
    dead = (lengths >= samples) & (np.abs(values[starts]) <= most)
    return np.asarray(np.repeat(dead, lengths))
