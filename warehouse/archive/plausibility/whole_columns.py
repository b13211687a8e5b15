"""Mix-ups of whole columns: exchanged, in another unit, turned round, or without anything.

Seen by what a typical run looks like.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Final

import numpy as np

from pipeline.messages import say
from warehouse.archive.faults import DefectiveFileError, Fault
from warehouse.archive.plausibility.run import (
    COLUMN_OF,
    HEADER,
    RESISTANCE_KG_M,
    SPARE,
    SPEED_RATIO,
    SPEEDS,
    SPEEDS_AGREE_RATIO,
    WIND,
    WIND_ANGLE_DEG,
    WIND_MEAN_M_S,
    WIND_SPEED_M_S,
    Run,
    known_of,
    mean_of,
    median_of,
    what_it_holds,
    within,
)

KM_H_RATIO: Final = (3.0, 4.2)
FOLLOWS_RATIO: Final = 0.1
"""Spread over the runs of what a log or GPS is times log 1; wind out and back differs far more."""
MOVES_AS_A_LOG_HZ: Final = 5.0
HELD_AS_A_FIX_HZ: Final = 2.0
"""Changes of value a second, at least of a log and at most of a receiver of one fix a second."""

_SPEED_UNITS: Final = {"km/h": 3.6, "kn": 1.9438}
"""Other units of speed in which people have a log or GPS, times m/s."""


@dataclass(frozen=True)
class _Typical:
    """What one channel does in a typical run of the tow (medians over the runs)."""

    median: float
    highest: float
    lowest: float


def _typical(runs: list[Run]) -> dict[str, _Typical]:
    """What each channel does typically, relative to the intended speed where it is one.

    Medians over runs of medians, so that a fault in one run does not pass for a mix-up.
    """
    return {
        key: _Typical(
            *(
                float(np.median([known_of(measure, run.channels[key]) for run in runs]))
                for measure in (median_of, np.nanmax, np.nanmin)
            )
        )
        for key in runs[0].channels
    }


def _implausible(channels: Mapping[str, _Typical], intended_m_s: float) -> list[str]:
    """The channels whose typical values cannot be what their header says."""
    log1 = channels["log1"].median
    others = [key for key in ("log2", "gps") if key in channels]
    plausible = {
        "log1": within(log1 / intended_m_s, SPEED_RATIO),
        **{key: within(channels[key].median, SPEEDS_AGREE_RATIO, abs(log1)) for key in others},
        "force": within(channels["force"].median, RESISTANCE_KG_M, intended_m_s**2),
        **_plausible_wind(channels),
    }
    return [key for key, good in plausible.items() if not good]


def _plausible_wind(channels: Mapping[str, _Typical]) -> dict[str, bool]:
    if "wind_speed" not in channels:
        return {}
    wind, angle = channels["wind_speed"], channels["wind_angle"]
    return {
        "wind_speed": wind.lowest >= WIND_SPEED_M_S[0]
        and wind.highest <= WIND_SPEED_M_S[1]
        and wind.median <= WIND_MEAN_M_S,
        "wind_angle": angle.lowest >= WIND_ANGLE_DEG[0] and angle.highest <= WIND_ANGLE_DEG[1],
    }


def is_no_wind(run: Run) -> bool:
    """Whether the wind speed is empty, or one value that cannot be."""
    values = run.channels.get("wind_speed")
    if values is None:
        return False
    is_one_value = (values == values[0]).all() and not within(values[0], WIND_SPEED_M_S)
    return bool(np.isnan(values).all() or is_one_value)


def no_wind(runs: list[Run]) -> Fault:
    """The fault of a wind that in every run is empty or one impossible value.

    So people write that there was no anemometer: 999 throughout. The tow goes on as one without.
    """
    message = say(
        "column '{column}' {} in all runs, which is not wind; the tow goes on without wind.",
        what_it_holds(runs[0].channels["wind_speed"][0]),
        column=COLUMN_OF["wind_speed"],
    )
    return _of_all(runs, "implausible_value", message, runs[0].first_line)


def without_wind(run: Run) -> Run:
    """The run without what an anemometer measures."""
    return replace(run, channels={k: v for k, v in run.channels.items() if k not in WIND})


def _of_all(runs: list[Run], reason_code: str, message: str, line: int) -> Fault:
    """The fault of a channel that all runs of the tow lose."""
    lost_s = sum(run.seconds for run in runs)
    first = runs[0]
    return Fault(first.path, first.tow_id, line, reason_code, message, "seconds", None, lost_s)


def check_mix_ups(runs: list[Run]) -> None:
    """A force that is right but for its sign is a sign error; after that come swapped columns."""
    typical = _typical(runs)
    intended = float(np.median([run.intended_m_s for run in runs]))
    wrong = _implausible(typical, intended)
    if not wrong:
        return
    force = typical["force"].median
    turned = {**typical, "force": _Typical(-force, 0, 0)}
    if force < 0 and not _implausible(turned, intended):
        message = say("The force is {:.0f} N in a typical run; it must be positive.")
        said = say(message, force, turned=True)
        raise DefectiveFileError("negative_force", said, runs[0].first_line, runs[0].path)
    follows = {key for key in SPARE if key in typical and _follows_log(runs, key)}
    for one, other in combinations(typical, 2):
        if other == "wind_speed" and one in follows:  # in another unit: no wind follows the boat
            continue
        exchanged = {**typical, one: typical[other], other: typical[one]}
        if (one in wrong or other in wrong) and not _implausible(exchanged, intended):
            said = say(
                "Columns '{}' and '{}' seem to be exchanged: typically they hold {:.4g} and "
                "{:.4g}, and only the other way round can that be right.",
                COLUMN_OF[one],
                COLUMN_OF[other],
                typical[one].median,
                typical[other].median,
            )
            raise DefectiveFileError("swapped_columns", said, HEADER, runs[0].path)


def _follows_log(runs: list[Run], key: str) -> bool:
    """Whether a column is the same times log 1 in every run; none is where log 1 stood still."""
    log1 = [median_of(run.channels["log1"]) for run in runs]
    if not all(log1):
        return False
    column = [median_of(run.channels[key]) for run in runs]
    ratio = np.divide(column, log1)
    return bool(np.ptp(ratio) <= FOLLOWS_RATIO * abs(np.median(ratio)))


def check_log2_and_gps(runs: list[Run]) -> None:
    """A receiver gives a fix a second, held in between; a log moves as log 1 does."""
    if not {*SPARE} <= set(runs[0].channels):
        return
    log1, log2, gps = (
        np.median([np.count_nonzero(np.diff(run.channels[key])) / run.seconds for run in runs])
        for key in SPEEDS
    )
    if min(log1, gps) > MOVES_AS_A_LOG_HZ and 0.1 < log2 < HELD_AS_A_FIX_HZ:
        said = say(
            "Columns '{}' and '{}' seem to be exchanged: the second moves {:.0f} times a second, "
            "as log1 does, and the first {:.1f} times, as a receiver does.",
            COLUMN_OF["log2"],
            COLUMN_OF["gps"],
            gps,
            log2,
        )
        raise DefectiveFileError("swapped_columns", said, HEADER, runs[0].path)


def check_speed_unit(runs: list[Run]) -> None:
    """Raises where log 1 looks like km/h."""
    means = [known_of(mean_of, run.channels["log1"]) / run.intended_m_s for run in runs]
    ratio = float(np.median(means))
    if within(ratio, KM_H_RATIO):
        said = say(
            "The speed by log1 is {:.2f} times the intended one; between {:g} and {:g} times it "
            "looks like km/h under another header.",
            ratio,
            *KM_H_RATIO,
        )
        raise DefectiveFileError("speed_unit", said, HEADER, runs[0].path)


def without_other_units(runs: list[Run], faults: list[Fault]) -> tuple[list[Run], Collection[str]]:
    """The runs without a log 2 or GPS in another unit of speed, and which of the two that is."""
    typical = {
        key: float(np.median([median_of(run.channels[key]) for run in runs]))
        for key in SPEEDS
        if key in runs[0].channels
    }
    gone = []
    for key in SPARE:
        ratio = typical.get(key, np.nan) / typical["log1"]
        units = [unit for unit, usual in _SPEED_UNITS.items() if 0.9 < ratio / usual < 1.1]
        if not units:
            continue
        message = say(
            "column '{column}' holds {:.3g} in a typical run and log1 {:.3g}, so it looks like "
            "{unit}; the tow goes on without this column.",
            typical[key],
            typical["log1"],
            column=COLUMN_OF[key],
            unit=units[0],
        )
        faults.append(_of_all(runs, "implausible_value", message, HEADER))
        gone.append(key)
    return [run.without(*gone) for run in runs], gone
