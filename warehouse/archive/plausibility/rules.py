"""The rules on a channel: what is measured of it, between which limits that lies, what is said.

A rule is a row of `RULES`. A run that breaks one is lost; of log 2 and the GPS, that channel in it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from pipeline.messages import Sentence, say
from warehouse.archive.plausibility.judgement import COLUMN_OF, SPARE, Judgement, Run, stretches

GPS_MUST_MOVE_M_S: Final = 0.15
"""A GPS that holds one value is suspect only where the boat's speed differed more than this."""
VANE_TURNS_M_S: Final = 0.5
CLIPPED_TIMES: Final = 3.0
"""Samples at the highest value, times those at the next one, where coarse steps explain them."""
EXTREMES: Final = {"wind_speed": (0.0, 40.0), "wind_angle": (-180.0, 360.0)}
"""Between which every sample lies."""

Unit = Literal["", "intended", "intended squared", "log1"]


@dataclass(frozen=True)
class Limits:
    """From `low` up to `high`, times 1, the intended speed in m/s or its square, or log 1."""

    low: float
    high: float
    unit: Unit = ""

    def times(self, intended_m_s: float, log1_m_s: float) -> tuple[float, float]:
        """The limits as they are for this speed."""
        units = {"intended": intended_m_s, "intended squared": intended_m_s**2, "log1": log1_m_s}
        return self.low * units.get(self.unit, 1.0), self.high * units.get(self.unit, 1.0)


USUAL: Final = {
    "log1": Limits(0.5, 1.6, "intended"),
    "log2": Limits(0.6, 1.4, "log1"),
    "gps": Limits(0.6, 1.4, "log1"),
    "force": Limits(2.0, 500.0, "intended squared"),  # sloops lie between 15 and 60 kg/m
    "wind_speed": Limits(0.0, 20.0),
}
"""Where the mean of a run lies, and the median of a typical one."""

Found = tuple[float, int]
"""What was measured, and the row of the run where it begins."""


def mean(run: Run, channel: str) -> Found:
    """Of the samples that are numbers."""
    return float(np.nanmean(run.channels[channel], dtype=np.float64)), 0


def held_s(run: Run, channel: str) -> Found:
    """The longest stretch of one value; cups may stand still, and a vane needs wind."""
    values = run.channels[channel]
    changes = values[1:] != values[:-1]
    least_wind_m_s = {"wind_speed": 0.0, "wind_angle": VANE_TURNS_M_S}.get(channel)
    if least_wind_m_s is None or "wind_speed" not in run.channels:
        starts, lengths = stretches(changes)
    else:
        moves = run.channels["wind_speed"] > least_wind_m_s
        starts, lengths = stretches(changes | np.diff(moves))
        lengths = lengths * moves[starts]
    longest = int(lengths.argmax())
    return float(lengths[longest]) / run.rate_hz, int(starts[longest])


def clipped_percent(run: Run, channel: str) -> Found:
    """Samples at the highest value, 0 where coarse steps explain them."""
    values = run.channels[channel]
    at_end = values == np.fmax.reduce(values)
    below = np.nanmax(values, where=~at_end & np.isfinite(values), initial=-np.inf)
    is_coarse = at_end.sum() <= CLIPPED_TIMES * (values == below).sum()
    return (0.0 if is_coarse else 100.0 * float(at_end.mean())), int(at_end.argmax())


@dataclass(frozen=True)
class Rule:
    """What can be true of a channel in a run.

    Attributes:
        measure: what is measured, and in which row of the run it begins.
        what: said where that is outside the limits: `{found}` is the measure, `{low}` and `{high}`
            are the limits, `{value}` is the sample with which it begins.
    """

    reason_code: str
    channel: str
    measure: Callable[[Run, str], Found]
    limits: Limits
    what: Sentence


_STUCK: Final = say(
    "column '{column}' holds {value:.6g} for {found:.3g} s; less than {high:g} s is normal"
)
_MEAN: Final = say(
    "the mean of column '{column}' is {found:.4g}; {low:.3g} to {high:.3g} can be right"
)
_NEGATIVE: Final = say("the mean of column '{column}' is {found:.4g}; it must be positive")
_CLIPPED: Final = say(
    "column '{column}' is at its highest value, {value:.6g}, in {found:.0f} % of the samples, as a "
    "load cell at the end of its range"
)

RULES: Final = (
    Rule("stuck_channel", "log1", held_s, Limits(0, 5), _STUCK),
    Rule("stuck_channel", "log2", held_s, Limits(0, 5), _STUCK),
    Rule("stuck_channel", "force", held_s, Limits(0, 5), _STUCK),
    Rule("stuck_channel", "wind_speed", held_s, Limits(0, 10), _STUCK),
    Rule("stuck_channel", "wind_angle", held_s, Limits(0, 20), _STUCK),
    Rule("implausible_speed", "log1", mean, USUAL["log1"], _MEAN),
    Rule("implausible_value", "log2", mean, USUAL["log2"], _MEAN),
    Rule("implausible_value", "gps", mean, USUAL["gps"], _MEAN),
    Rule("negative_force", "force", mean, Limits(0, np.inf), _NEGATIVE),
    Rule("implausible_value", "force", mean, USUAL["force"], _MEAN),
    Rule("implausible_value", "wind_speed", mean, USUAL["wind_speed"], _MEAN),
    Rule("saturated_force", "force", clipped_percent, Limits(0, 2), _CLIPPED),
)


def apply_rules(judgement: Judgement, run: Run) -> None:
    """Takes what breaks a rule: the run, or a spare channel; without numbers one breaks none."""
    log1_m_s, _ = mean(run, "log1")
    known = {key for key, values in run.channels.items() if np.isfinite(values).any()}
    for rule in RULES:
        if rule.channel not in known:
            continue
        found, row = rule.measure(run, rule.channel)
        low, high = rule.limits.times(run.intended_m_s, log1_m_s)
        if low <= found < high:
            continue
        value, column = run.channels[rule.channel][row], COLUMN_OF[rule.channel]
        what = say(rule.what, column=column, value=value, found=found, low=low, high=high)
        if rule.channel not in SPARE:
            judgement.lose(run, rule.reason_code, what, "run", row)
            return
        judgement.lose(run, rule.reason_code, what, "column", row)
        run.channels[rule.channel] = np.full_like(run.channels[rule.channel], np.nan)
        known.remove(rule.channel)


def leave_out_stuck_gps(judgement: Judgement) -> None:
    """Takes a GPS that holds one value while the speed changed, or at another speed.

    It has a fix a second in steps of 0.01 m/s, so of a steady boat it may well hold one value.
    """
    alike: dict[float, list[Run]] = {}
    for run in judgement.runs:
        gps = run.channels.get("gps")
        if gps is not None and (gps == gps[0]).all():
            alike.setdefault(float(gps[0]), []).append(run)
    for run in [run for held in alike.values() if _speed_differs(held) for run in held]:
        gps = run.channels["gps"]
        what = say("gps holds {:.6g} throughout, at other speeds too", gps[0])
        judgement.lose(run, "stuck_channel", what, "column")
        run.channels["gps"] = np.full_like(gps, np.nan)


def _speed_differs(runs: list[Run]) -> bool:
    seconds = [run.second_means(run.channels["log1"]) for run in runs]
    moved_m_s = max(np.nanmax(means) - np.nanmin(means) for means in seconds)
    return len({run.intended_m_s for run in runs}) > 1 or bool(moved_m_s > GPS_MUST_MOVE_M_S)
