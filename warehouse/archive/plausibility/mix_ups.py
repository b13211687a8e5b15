"""Mix-ups of whole columns: in another unit, turned round, or exchanged.

Seen by what a typical run looks like: medians over the runs, which a fault in one does not move.
"""

from collections.abc import Mapping
from dataclasses import replace
from itertools import combinations
from typing import Final

import numpy as np

from pipeline.messages import say
from warehouse.archive.faults import DefectiveFileError, Fault
from warehouse.archive.plausibility.rules import EXTREMES, USUAL, Limits
from warehouse.archive.plausibility.run import (
    COLUMN_OF,
    HEADER,
    SPARE,
    SPEEDS,
    Run,
    fault_of_all,
    what_it_holds,
)

MOVES_AS_A_LOG_HZ: Final = 5.0
HELD_AS_A_FIX_HZ: Final = (0.1, 2.0)
"""Changes of value a second, at least of a log and of a receiver of one fix a second."""
KM_H_RATIO: Final = (3.0, 4.2)
"""Log 1 over the intended speed where it looks like km/h."""
FOLLOWS_RATIO: Final = 0.1
"""Spread over the runs of a log or GPS over log 1; wind out and back differs far more."""
STANDS_RATIO: Final = 0.1
"""A log or GPS that is less than so many times log 1 has dropped out."""
UNITS: Final = {"km/h": 3.6, "kn": 1.9438}
"""Other units of speed in which people have a log or GPS, times m/s."""
Typical = tuple[float, float, float]
"""Median, lowest and highest value of a channel in a typical run."""


def without_wind(runs: list[Run], faults: list[Fault]) -> list[Run]:
    """The runs without a wind speed that in all of them is empty, or one that cannot be.

    So people write that there was no anemometer: 999 everywhere. The tow goes on as one without.
    """
    if not all(map(_is_no_wind, runs)):
        return runs
    message = say(
        "column '{column}' {} in all runs, which is not wind; the tow goes on without wind.",
        what_it_holds(runs[0].channels["wind_speed"][0]),
        column=COLUMN_OF["wind_speed"],
    )
    faults.append(fault_of_all(runs, "implausible_value", message))
    other = [key for key in runs[0].channels if key not in EXTREMES]
    return [replace(run, channels={key: run.channels[key] for key in other}) for run in runs]


def _is_no_wind(run: Run) -> bool:
    wind, (least, most) = run.statistics.get("wind_speed"), EXTREMES["wind_speed"]
    return wind is not None and bool(
        np.isnan(wind.mean) or (wind.changes_hz == 0 and not least <= wind.mean <= most)
    )


def without_other_units(runs: list[Run], faults: list[Fault]) -> tuple[list[Run], list[str]]:
    """The runs without a log 2 or GPS in another unit of speed, and which of the two that is.

    Nothing is said of them where log 1 cannot be right.
    """
    log1 = _typical(runs, "log1")
    if _implausible({"log1": log1}, _intended_m_s(runs)):
        return runs, []
    gone = [key for key in SPARE if key in runs[0].channels and _is_in_another_unit(runs, key)]
    for key in gone:
        other = _typical(runs, key)[0]
        units = (unit for unit, usual in UNITS.items() if 0.9 < other / log1[0] / usual < 1.1)
        message = say(
            "column '{column}' holds {:.3g} in a typical run and log1 {:.3g}, so it looks like "
            "{unit}; the tow goes on without this column.",
            other,
            log1[0],
            column=COLUMN_OF[key],
            unit=next(units, say("another unit")),
        )
        faults.append(replace(fault_of_all(runs, "implausible_value", message), line=HEADER))
    return [run.without(*gone) for run in runs], gone


def _is_in_another_unit(runs: list[Run], key: str) -> bool:
    """Whether a column is the same times log 1 in every run, and too many times to be right."""
    each = np.array([(run.statistics[key].median, run.statistics["log1"].median) for run in runs])
    if not (each > 0).all():
        return False
    ratio = each[:, 0] / each[:, 1]
    median, usual = np.median(ratio), USUAL[key]
    is_usual = usual.low <= median <= usual.high or median < STANDS_RATIO
    return bool(not is_usual and np.ptp(ratio) <= FOLLOWS_RATIO * median)


def check_mix_ups(runs: list[Run]) -> None:
    """Raises where a tow can only be right with its force turned, or columns or a unit changed.

    Raises:
        DefectiveFileError: `negative_force`, `swapped_columns` or `speed_unit`.
    """
    typical = {key: _typical(runs, key) for key in runs[0].statistics}
    intended_m_s = _intended_m_s(runs)
    wrong = _implausible(typical, intended_m_s)
    if (force := typical["force"][0]) < 0 and not _implausible(
        {**typical, "force": (-force, 0, 0)}, intended_m_s
    ):
        said = say(
            "The force is {:.0f} N in a typical run; it must be positive.", force, turned=True
        )
        raise DefectiveFileError("negative_force", said, runs[0].first_line, runs[0].path)
    for one, other in combinations(typical, 2):
        exchanged = {**typical, one: typical[other], other: typical[one]}
        if {one, other} & wrong and not _implausible(exchanged, intended_m_s):
            what = say("typically they hold {:.4g} and {:.4g}", typical[one][0], typical[other][0])
            raise _exchanged(one, other, what, runs[0].path)
    _check_log2_and_gps(runs)
    (low, high), ratio = KM_H_RATIO, typical["log1"][0] / intended_m_s
    if low <= ratio <= high:
        said = say(
            "The speed by log1 is {:.2f} times the intended one; between {:g} and {:g} times it "
            "looks like km/h under another header.",
            ratio,
            *KM_H_RATIO,
        )
        raise DefectiveFileError("speed_unit", said, HEADER, runs[0].path)


def _intended_m_s(runs: list[Run]) -> float:
    return float(np.median([run.intended_m_s for run in runs]))


def _typical(runs: list[Run], key: str) -> Typical:
    each = [run.statistics[key] for run in runs]
    median, lowest, highest = np.median([(s.median, *s.extremes) for s in each], axis=0)
    return float(median), float(lowest), float(highest)


def _implausible(typical: Mapping[str, Typical], intended_m_s: float) -> set[str]:
    """The channels whose typical values cannot be what their header says."""
    wrong = set()
    for key, (median, lowest, highest) in typical.items():
        low, high = USUAL.get(key, Limits(-np.inf, np.inf)).times(intended_m_s, typical["log1"][0])
        least, most = EXTREMES.get(key, (-np.inf, np.inf))
        if not (low <= median <= high and least <= lowest and highest <= most):
            wrong.add(key)
    return wrong


def _exchanged(one: str, other: str, seen: str, path: str) -> DefectiveFileError:
    said = say(
        "Columns '{}' and '{}' seem to be exchanged: {seen}.",
        COLUMN_OF[one],
        COLUMN_OF[other],
        seen=seen,
    )
    return DefectiveFileError("swapped_columns", said, HEADER, path)


def _check_log2_and_gps(runs: list[Run]) -> None:
    """A receiver gives a fix a second, held in between; a log moves as log 1 does."""
    if not {*SPARE} <= runs[0].statistics.keys():
        return
    log1, log2, gps = (np.median([run.statistics[k].changes_hz for run in runs]) for k in SPEEDS)
    least, most = HELD_AS_A_FIX_HZ
    if min(log1, gps) > MOVES_AS_A_LOG_HZ and least < log2 < most:
        what = say("the first changes {:.1f} times a second, the second {:.0f} times", log2, gps)
        raise _exchanged("log2", "gps", what, runs[0].path)
