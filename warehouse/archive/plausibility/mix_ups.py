"""Mix-ups of whole columns: in another unit, turned round, or exchanged.

Seen by what a typical run looks like: medians over the runs, which a fault in one does not move.
"""

from collections.abc import Collection, Mapping
from itertools import combinations
from typing import Final

import numpy as np

from pipeline.messages import Sentence, say
from warehouse.archive.plausibility.judgement import (
    COLUMN_OF,
    HEADER,
    SPARE,
    SPEEDS,
    Judgement,
    Measured,
    what_it_holds,
)
from warehouse.archive.plausibility.rules import EXTREMES, USUAL, Limits

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


def leave_out_no_wind(judgement: Judgement) -> None:
    """Takes a wind speed that in all runs is empty, or one that cannot be.

    So people write that there was no anemometer: 999 everywhere. The tow goes on as one without.
    """
    if not all(_is_no_wind(run.measured.get("wind_speed")) for run in judgement.runs):
        return
    first = judgement.runs[0].channels["wind_speed"][0]
    message = say(
        "column '{column}' {} in all runs, which is not wind; the tow goes on without wind.",
        what_it_holds(first),
        column=COLUMN_OF["wind_speed"],
    )
    judgement.lose_of_all("implausible_value", message, *EXTREMES)


def _is_no_wind(wind: Measured | None) -> bool:
    if wind is None or np.isnan(wind.lowest):
        return wind is not None
    least, most = EXTREMES["wind_speed"]
    return wind.changes_hz == 0 and not least <= wind.lowest <= most


def leave_out_other_units(judgement: Judgement) -> None:
    """Takes a log 2 or GPS in another unit: too many times log 1, and the same in every run.

    Nothing is said of them where log 1 cannot be right.
    """
    typical, intended_m_s = _typical(judgement)
    if "log1" in _implausible(typical, intended_m_s):
        return
    medians = {
        key: np.array([run.measured[key].median for run in judgement.runs]) for key in typical
    }
    for key in SPARE:
        if key not in typical or not ((medians[key] > 0) & (medians["log1"] > 0)).all():
            continue
        ratios = medians[key] / medians["log1"]
        ratio, usual = np.median(ratios), USUAL[key]
        is_usual = usual.low <= ratio <= usual.high or ratio < STANDS_RATIO
        if is_usual or np.ptp(ratios) > FOLLOWS_RATIO * ratio:
            continue
        other, log1 = typical[key].median, typical["log1"].median
        units = (unit for unit, times in UNITS.items() if 0.9 < other / log1 / times < 1.1)
        message = say(
            "column '{column}' holds {:.3g} in a typical run and log1 {:.3g}, so it looks like "
            "{unit}; the tow goes on without this column.",
            other,
            log1,
            column=COLUMN_OF[key],
            unit=next(units, say("another unit")),
        )
        judgement.lose_of_all("implausible_value", message, key, row=HEADER)


def check_mix_ups(judgement: Judgement) -> None:
    """Raises where a tow can only be right with its force turned, or columns or a unit changed.

    Raises:
        DefectiveFileError: `negative_force`, `swapped_columns` or `speed_unit`.
    """
    typical, intended_m_s = _typical(judgement)
    typical = {key: typical[key] for key in judgement.runs[0].channels}
    wrong = _implausible(typical, intended_m_s)
    force_n = typical["force"].median
    turned = {**typical, "force": typical["force"]._replace(median=-force_n)}
    if force_n < 0 and not _implausible(turned, intended_m_s):
        said = say(
            "The force is {:.0f} N in a typical run; it must be positive.", force_n, turned=True
        )
        raise judgement.lost("negative_force", said, judgement.runs[0].start)
    if exchanged := _exchanged(typical, wrong, intended_m_s):
        one, other, seen = exchanged
        said = say(
            "Columns '{}' and '{}' seem to be exchanged: {seen}.",
            COLUMN_OF[one],
            COLUMN_OF[other],
            seen=seen,
        )
        raise judgement.lost("swapped_columns", said)
    (low, high), ratio = KM_H_RATIO, typical["log1"].median / intended_m_s
    if low <= ratio <= high:
        said = say(
            "The speed by log1 is {:.2f} times the intended one; between {:g} and {:g} times it "
            "looks like km/h under another header.",
            ratio,
            *KM_H_RATIO,
        )
        raise judgement.lost("speed_unit", said)


def _exchanged(
    typical: Mapping[str, Measured], wrong: Collection[str], intended_m_s: float
) -> tuple[str, str, Sentence] | None:
    """Two channels that are right the other way round, and what is seen of that."""
    for one, other in combinations(typical, 2):
        exchanged = {**typical, one: typical[other], other: typical[one]}
        if {one, other} & {*wrong} and not _implausible(exchanged, intended_m_s):
            medians = typical[one].median, typical[other].median
            return one, other, say("typically they hold {:.4g} and {:.4g}", *medians)
    if not {*SPARE} <= typical.keys():
        return None
    # A receiver gives a fix a second, held in between; a log moves as log 1 does.
    log1_hz, log2_hz, gps_hz = (typical[key].changes_hz for key in SPEEDS)
    least, most = HELD_AS_A_FIX_HZ
    if min(log1_hz, gps_hz) > MOVES_AS_A_LOG_HZ and least < log2_hz < most:
        seen = say(
            "the first changes {:.1f} times a second, the second {:.0f} times", log2_hz, gps_hz
        )
        return "log2", "gps", seen
    return None


def _typical(judgement: Judgement) -> tuple[dict[str, Measured], float]:
    """What each channel holds in a typical run, and the intended speed in m/s of one."""
    runs = judgement.runs
    each = {key: [run.measured[key] for run in runs] for key in runs[0].measured}
    typical = {key: Measured(*np.median(found, axis=0).tolist()) for key, found in each.items()}
    return typical, float(np.median([run.intended_m_s for run in runs]))


def _implausible(typical: Mapping[str, Measured], intended_m_s: float) -> set[str]:
    """The channels whose typical values cannot be what their header says."""
    wrong = set()
    for key, found in typical.items():
        usual = USUAL.get(key, Limits(-np.inf, np.inf))
        low, high = usual.times(intended_m_s, typical["log1"].median)
        least, most = EXTREMES.get(key, (-np.inf, np.inf))
        is_usual = low <= found.median <= high
        if not (is_usual and least <= found.lowest and found.highest <= most):
            wrong.add(key)
    return wrong
