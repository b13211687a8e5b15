"""What is wrong of a run for longer: instruments that are stuck, and means that cannot be."""

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from pipeline.arrays import BoolArray
from pipeline.messages import say
from warehouse.archive.faults import Fault
from warehouse.archive.plausibility.run import (
    COLUMN_OF,
    RESISTANCE_KG_M,
    SPARE,
    SPEED_RATIO,
    SPEEDS_AGREE_RATIO,
    WIND,
    WIND_MEAN_M_S,
    Array,
    Run,
    mean_of,
    second_means,
    stretches,
)

SATURATED_SHARE: Final = 0.02
SATURATED_TIMES: Final = 3.0
"""Samples of a force at its highest value: of all, and times those at the next value below it."""
STUCK_S: Final = 5.0
STUCK_WIND_SPEED_S: Final = 10.0
STUCK_VANE_S: Final = 20.0
VANE_TURNS_M_S: Final = 0.5
GPS_MUST_MOVE_M_S: Final = 0.15
"""A held GPS fix is suspect only when the boat's speed changed more than this meanwhile."""

_STUCK_LIMIT_S: Final = {
    **dict.fromkeys(("log1", "log2", "force"), STUCK_S),
    "wind_speed": STUCK_WIND_SPEED_S,
    "wind_angle": STUCK_VANE_S,
}

Said = tuple[str, str, int]
"""Reason code, what is wrong, and the row where it begins."""


def judge_whole(run: Run, faults: list[Fault]) -> tuple[Run | None, list[Fault]]:
    """Stuck instruments and means that cannot be: they cost the run, or a spare channel in it."""
    for judge in (_stuck, _unlikely_mean, _saturated):
        for key in tuple(run.channels):
            if not np.isfinite(run.channels[key]).any():
                continue
            said = judge(run, key)
            if said is None:
                continue
            reason_code, what, row = said
            if key not in SPARE:
                message = say("{}: {what}; the run is left out.", run.name, what=what)
                return None, [run.fault(reason_code, message, row, "run")]
            message = say("{}: {what}; the run goes on without this column.", run.name, what=what)
            faults.append(run.fault(reason_code, message, row, "seconds"))
            run = run.without(key)
    return run, faults


def _longest_hold(values: Array, counts: BoolArray | None = None) -> tuple[int, int]:
    """(first row, length) of the longest stretch of one value in which `counts` holds."""
    if counts is None:
        counts = np.ones(len(values), dtype=bool)
    starts, lengths = stretches((values[1:] != values[:-1]) | (counts[1:] != counts[:-1]))
    counted = lengths * counts[starts]
    longest = int(counted.argmax())
    return int(starts[longest]), int(counted[longest])


def _may_hold(values: Array, samples: int) -> bool:
    """Whether a value may last for so many samples, two or more: sees two of each such stretch."""
    seen = values[:: max(samples // 2, 1)]
    return bool((seen[1:] == seen[:-1]).any())


def _stuck(run: Run, key: str) -> Said | None:
    """A channel that holds one value for too long; the GPS is judged over all runs."""
    limit_s = _STUCK_LIMIT_S.get(key)
    values = run.channels[key]
    if limit_s is None or not _may_hold(values, int(limit_s * run.rate_hz)):
        return None
    counts = None
    if key in WIND:  # cups may stand still, and a vane needs wind
        wind = run.channels["wind_speed"]
        counts = wind > (0.0 if key == "wind_speed" else VANE_TURNS_M_S)
    row, length = _longest_hold(values, counts)
    if length < limit_s * run.rate_hz:
        return None
    what = say(
        "column '{column}' holds {:.6g} for {:.3g} s; less than {:g} s is normal",
        values[row],
        length / run.rate_hz,
        limit_s,
        column=COLUMN_OF[key],
    )
    return "stuck_channel", what, row


def _unlikely_mean(run: Run, key: str) -> Said | None:
    """A mean that cannot be; of the vane there is none."""
    if key == "wind_angle":
        return None
    mean, log1 = (mean_of(run.channels[k]) for k in (key, "log1"))
    if key == "log1":
        low, high = (ratio * run.intended_m_s for ratio in SPEED_RATIO)
        reason_code = "implausible_speed"
    else:
        reason_code = "implausible_value"
        unit = {"force": run.intended_m_s**2, "wind_speed": WIND_MEAN_M_S}.get(key, log1)
        ratios = {"force": RESISTANCE_KG_M, "wind_speed": (0.0, 1.0)}.get(key, SPEEDS_AGREE_RATIO)
        low, high = (ratio * unit for ratio in ratios)
    if low <= mean <= high:
        return None
    if key == "force" and mean <= 0:
        reason_code = "negative_force"
    what = say(
        "the mean of column '{column}' is {:.4g}; {:.3g} to {:.3g} can be right",
        mean,
        low,
        high,
        column=COLUMN_OF[key],
    )
    return reason_code, what, 0


def _saturated(run: Run, key: str) -> Said | None:
    """A force that stays at its highest value: the load cell was at the end of its range."""
    values = run.channels[key]
    if key != "force":
        return None
    highest = np.nanmax(values)
    at_end = values == highest
    share = at_end.sum() / len(values)
    if share < SATURATED_SHARE:
        return None
    next_below = values == np.nanmax(values, where=~at_end & np.isfinite(values), initial=-np.inf)
    if at_end.sum() <= SATURATED_TIMES * next_below.sum():
        return None  # written in coarse steps
    what = say(
        "column '{column}' is at its highest value, {:.6g}, in {:.0f} % of the samples, as a load "
        "cell at the end of its range",
        highest,
        100.0 * share,
        column=COLUMN_OF[key],
    )
    return "saturated_force", what, int(at_end.argmax())


def without_stuck_gps(runs: list[Run], faults: list[Fault]) -> list[Run]:
    """GPS has one fix a second in steps of 0.01 m/s, so a steady boat may well hold one value."""
    by_value: dict[float, list[Run]] = {}
    for run in runs:
        gps = run.channels.get("gps")
        if gps is not None and gps.min() == gps.max():  # NaN differs from itself
            by_value.setdefault(float(gps[0]), []).append(run)
    why = {run.number: said for alike in by_value.values() for run, said in _stuck_gps(alike)}
    for run in runs:
        if run.number in why:
            message = say(
                "{}: gps holds {:.6g} throughout, {}; the run goes on without this column.",
                run.name,
                run.channels["gps"][0],
                why[run.number],
            )
            faults.append(run.fault("stuck_channel", message, 0, "seconds"))
    return [run.without("gps") if run.number in why else run for run in runs]


def _stuck_gps(runs: list[Run]) -> Iterator[tuple[Run, str]]:
    """Runs that hold one value where it is stuck, and why: one of them, or two, cannot be right."""
    moved = {run.number: _span(second_means(run.channels["log1"], run.rate_hz)) for run in runs}
    is_stuck = max(moved.values()) > GPS_MUST_MOVE_M_S
    for run in runs:
        other = next((r for r in runs if r.intended_m_s != run.intended_m_s), None)
        if moved[run.number] > GPS_MUST_MOVE_M_S:
            yield run, say("while log1 changed by {:.2f} m/s", moved[run.number])
        elif other is not None:
            yield run, say("and so in {}, at another speed", other.name.lower())
        elif is_stuck:
            yield run, say("and so in a run in which log1 changed")


def _span(values: NDArray[np.float64]) -> float:
    return float(np.nanmax(values) - np.nanmin(values))
