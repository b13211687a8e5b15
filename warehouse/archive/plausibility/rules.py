"""The rules on a channel: what is measured of it, between which limits that lies, what is said.

A rule is a row. One of `RUN_RULES` costs the run, or of log 2 and the GPS that channel in it; one
of `TOW_RULES` costs the tow, or that channel in all of its runs.
"""

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from pipeline.messages import say
from warehouse.archive.faults import Fault
from warehouse.archive.plausibility.run import COLUMN_OF, SPARE, Run, second_means

GPS_MUST_MOVE_M_S: Final = 0.15
"""A GPS that holds one value is suspect only where the boat's speed differed more than this."""
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


@dataclass(frozen=True)
class Rule:
    """What can be true of a channel in a run.

    Attributes:
        measure: attribute of `Statistics`: a number, or one with the row where it begins.
        what: said where the measure is outside the limits: `{found}` is the measure, `{low}` and
            `{high}` are the limits, `{value}` is the sample with which it begins.
    """

    reason_code: str
    channel: str
    measure: str
    limits: Limits
    what: str


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

RUN_RULES: Final = (
    Rule("stuck_channel", "log1", "held", Limits(0, 5), _STUCK),
    Rule("stuck_channel", "log2", "held", Limits(0, 5), _STUCK),
    Rule("stuck_channel", "force", "held", Limits(0, 5), _STUCK),
    Rule("stuck_channel", "wind_speed", "held", Limits(0, 10), _STUCK),
    Rule("stuck_channel", "wind_angle", "held", Limits(0, 20), _STUCK),
    Rule("implausible_speed", "log1", "mean", USUAL["log1"], _MEAN),
    Rule("implausible_value", "log2", "mean", USUAL["log2"], _MEAN),
    Rule("implausible_value", "gps", "mean", USUAL["gps"], _MEAN),
    Rule("negative_force", "force", "mean", Limits(0, np.inf), _NEGATIVE),
    Rule("implausible_value", "force", "mean", USUAL["force"], _MEAN),
    Rule("implausible_value", "wind_speed", "mean", USUAL["wind_speed"], _MEAN),
    Rule("saturated_force", "force", "clipped_percent", Limits(0, 2), _CLIPPED),
)


def apply_rules(run: Run, faults: list[Fault]) -> Run | None:
    """The run without the spare channels that break a rule; None where another channel does."""
    for rule in RUN_RULES:
        if (broken := _broken(rule, run)) is None:
            continue
        what, row = broken
        if rule.channel not in SPARE:
            faults.append(run.fault(rule.reason_code, what, "run", row))
            return None
        faults.append(run.fault(rule.reason_code, what, "column", row))
        run = run.without(rule.channel)
    return run


def _broken(rule: Rule, run: Run) -> tuple[str, int] | None:
    """What is said of a rule that the run breaks, and its row; without numbers it breaks none."""
    statistics = run.statistics.get(rule.channel)
    if statistics is None or np.isnan(statistics.mean):
        return None
    measured = getattr(statistics, rule.measure)
    found, row = measured if isinstance(measured, tuple) else (measured, 0)
    low, high = rule.limits.times(run.intended_m_s, run.statistics["log1"].mean)
    if low <= found < high:
        return None
    value, column = run.channels[rule.channel][row], COLUMN_OF[rule.channel]
    return say(rule.what, column=column, value=value, found=found, low=low, high=high), row


def without_stuck_gps(runs: list[Run], faults: list[Fault]) -> list[Run]:
    """The runs without a GPS that holds one value while the speed changed, or at another speed.

    It has a fix a second in steps of 0.01 m/s, so of a steady boat it may well hold one value.
    """
    alike: dict[float, list[Run]] = {}
    for run in runs:
        gps = run.statistics.get("gps")
        if gps is not None and gps.held[0] == run.seconds:
            alike.setdefault(gps.extremes[1], []).append(run)
    stuck = {run.number for held in alike.values() if _speed_differs(held) for run in held}
    for run in runs:
        if run.number in stuck:
            what = say("gps holds {:.6g} throughout, at other speeds too", run.channels["gps"][0])
            faults.append(run.fault("stuck_channel", what, "column"))
    return [run.without("gps") if run.number in stuck else run for run in runs]


def _speed_differs(runs: list[Run]) -> bool:
    seconds = [second_means(run.channels["log1"], run.rate_hz) for run in runs]
    moved_m_s = max(np.nanmax(means) - np.nanmin(means) for means in seconds)
    return len({run.intended_m_s for run in runs}) > 1 or bool(moved_m_s > GPS_MUST_MOVE_M_S)
