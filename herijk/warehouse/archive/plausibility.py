"""Whether the samples of a tow can be true: missing pieces, dead or stuck instruments, mix-ups.

A fault costs what it touches. Up to `LEFT_OUT_S` of a run may be no number, drop out or spike:
those samples become NaN, and no sum counts them. Longer faults cost the run; of log 2 and the GPS,
which only check and calibrate, the channel in that run. What makes every run doubtful (columns
exchanged, a wrong unit, another boat's samples) costs the tow. Judging a good tow (steady windows,
agreement of out and back) is measuring method and belongs to `pipeline`.
"""

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations, pairwise
from pathlib import Path
from typing import Final

import numpy as np
import polars as pl
import scipy
from numpy.typing import NDArray

from herijk.pipeline.arrays import BoolArray
from herijk.pipeline.channels import SECOND_FILE_OFFSET
from herijk.tables.row import Row
from herijk.warehouse.archive.faults import DefectiveFileError, Fault, Lost
from herijk.warehouse.archive.profile import SeasonProfile
from herijk.warehouse.archive.samples import OUTPUT_NAMES, place_in_file, run_starts
from herijk.words import say

SHORTEST_RUN_RATIO: Final = 0.99
"""Of what is planned."""
LONGEST_RUN_RATIO: Final = 1.8
"""Of what is planned: a rate that is wrong is usually half of the right one (inferred)."""
LEFT_OUT_S: Final = 2.0
"""Longest time in all of a run in which what the run point needs may be left out; as long again for
log 2 and the GPS each."""
DROPOUT_M_S: Final = 0.1
SPEED_RATIO: Final = (0.5, 1.6)
KM_H_RATIO: Final = (3.0, 4.2)
SPEED_SPIKE_RATIO: Final = 0.3
"""Of the speed around it: a boat and its crew weigh a ton, and cannot change so much in seconds."""
GPS_JUMP_RATIO: Final = 0.1
"""The same of a GPS, which has no noise of samples: such a jump is the receiver's (inferred)."""
AROUND_S: Final = 11
"""The speed around a sample: the median over so many seconds of each one's median."""
SPEEDS_AGREE_RATIO: Final = (0.6, 1.4)
FOLLOWS_RATIO: Final = 0.1
"""Spread over the runs of what a log or GPS is times log 1; wind out and back differs far more."""
MOVES_AS_A_LOG_HZ: Final = 5.0
HELD_AS_A_FIX_HZ: Final = 2.0
"""Changes of value a second, at least of a log and at most of a receiver of one fix a second."""
SATURATED_SHARE: Final = 0.02
SATURATED_TIMES: Final = 3.0
"""Samples of a force at its highest value: of all, and times those at the next value below it."""
RESISTANCE_KG_M: Final = (2.0, 500.0)
"""Mean force over intended speed squared; sloops lie between 15 and 60."""
FORCE_SPIKE_RATIO: Final = (-3.0, 5.0)
"""Of the usual force. A tow line cannot push: what a slack one reads is noise about zero."""
FORCE_DEAD_RATIO: Final = 0.05
FORCE_DEAD_S: Final = 0.1
"""A force that stays at one value so near zero, for so long, is no force."""
GUST_RATIO: Final = 2.5
GUST_M_S: Final = 4.0
"""Wind over so many times the run's median and so much more is no gust that cups can follow."""
WIND_SPEED_M_S: Final = (0.0, 40.0)
WIND_MEAN_M_S: Final = 20.0
WIND_ANGLE_DEG: Final = (-180.0, 360.0)
STUCK_S: Final = 5.0
STUCK_WIND_SPEED_S: Final = 10.0
STUCK_VANE_S: Final = 20.0
VANE_TURNS_M_S: Final = 0.5
GPS_MUST_MOVE_M_S: Final = 0.15
"""A held GPS fix is suspect only when the boat's speed changed more than this meanwhile."""

Array = NDArray[np.float32]
_CHANNELS: Final = {key: name for key, name in OUTPUT_NAMES.items() if key != "run"}
_WORDS: Final = {
    "log1": "log1",
    "log2": "log2",
    "gps": "gps",
    "force": "kracht",
    "wind_speed": "wind [m/s]",
    "wind_angle": "wind [gra]",
}
"""What a volunteer calls a channel: the header of its column."""


@dataclass(frozen=True)
class _Run:
    """One selected run.

    Attributes:
        number: 21 and on are those of the second file.
        path: its file, or the files that are a run each.
        first_line: of its first row, counted over the rows of that file.
    """

    tow_id: str
    number: int
    path: str
    first_line: int
    rate_hz: int
    intended_m_s: float
    planned_s: float
    channels: Mapping[str, Array]

    @property
    def seconds(self) -> float:
        return len(self.channels["log1"]) / self.rate_hz

    @property
    def name(self) -> str:
        if self.number > SECOND_FILE_OFFSET:
            return say("Run b{}", self.number - SECOND_FILE_OFFSET)
        return say("Run {}", self.number)

    def fault(
        self, reason_code: str, message: str, row: int, lost: Lost, lost_s: float | None = None
    ) -> Fault:
        """What is lost of this run; `row` counts from its start."""
        line = self.first_line + row
        lost_s = self.seconds if lost_s is None else lost_s
        return Fault(self.path, self.tow_id, line, reason_code, message, lost, self.number, lost_s)

    def without(self, *keys: str) -> "_Run":
        """The run with NaN for all samples of some channels."""
        gone = {key: np.full_like(self.channels[key], np.nan) for key in keys}
        return replace(self, channels={**self.channels, **gone})


@dataclass(frozen=True)
class _Typical:
    """What one channel does in a typical run of the tow (medians over the runs)."""

    median: float
    highest: float
    lowest: float


@dataclass(frozen=True)
class Judged:
    """What is left of a tow's samples.

    Attributes:
        samples: the given frame without the runs that are lost, NaN where a sample is left out.
        faults: what was lost: seconds and runs, in the order of the runs.
    """

    samples: pl.DataFrame
    faults: tuple[Fault, ...]


def judge_in_files(
    samples: pl.DataFrame,
    tow: Row,
    runs: pl.DataFrame,
    root: Path,
    profile: SeasonProfile,
) -> Judged:
    """As `judge_samples`, and each fault names the file of the archive and the line in it.

    The files are looked at again for that, and only where there is a fault.
    """

    def place(path: str, line: int | None) -> tuple[str, int | None]:
        if line is None:
            return path, None
        return place_in_file(root, tow, profile, samples["run"], path, line - FIRST_ROW)

    try:
        judged = judge_samples(samples, tow, runs)
    except DefectiveFileError as error:
        path, line = place(error.path, error.line)
        raise DefectiveFileError(error.reason_code, error.message, line, path) from error
    placed = ((fault, place(fault.path, fault.line)) for fault in judged.faults)
    faults = tuple(replace(fault, path=path, line=line) for fault, (path, line) in placed)
    return replace(judged, faults=faults)


HEADER: Final = 1
FIRST_ROW: Final = 2
"""Line of the first row of a tow's samples where nothing but a header stands above it."""


def judge_samples(samples: pl.DataFrame, tow: Row, runs: pl.DataFrame) -> Judged:
    """What of the selected runs of a tow can be used; runs that are not selected stay as they are.

    Args:
        samples: frame of `SAMPLE_SCHEMA`, as `read_tow_samples` returns it.
        tow: a row of `ArchiveIndex.tows`.
        runs: `ArchiveIndex.runs`; rows of other tows are ignored.

    Returns:
        Lines of faults are counted over the rows of the tow, the first in line `FIRST_ROW`.

    Raises:
        DefectiveFileError: the tow is lost: the most specific cause comes first.
    """
    faults: list[Fault] = []
    selected = _selected_runs(samples, tow, runs, faults)
    number = len(selected) + len(faults)
    whole = [run for run in selected if _lasts(run, faults)]
    faults += _long(whole)
    whole = _without_copies(whole, faults)
    _check_left(whole, number, faults)
    if all(map(_is_no_wind, whole)):
        faults.append(_no_wind(whole))
        nothing = (pl.lit(None, pl.Float32).alias(_CHANNELS[key]) for key in _WIND)
        samples, whole = samples.with_columns(nothing), [_without_wind(run) for run in whole]
    _check_mix_ups(whole)
    _check_log2_and_gps(whole)
    _check_speed_unit(whole)
    whole, gone = _without_other_units(whole, faults)
    usual_kg_m = _usual_resistance_kg_m(whole)
    judged = [_judge_run(run, usual_kg_m, gone) for run in whole]
    faults += [fault for _, of_run in judged for fault in of_run]
    kept = _without_stuck_gps([run for run, _ in judged if run is not None], faults)
    _check_left(kept, number, faults)
    return Judged(_with_changes(samples, kept, faults), tuple(faults))


def _without_copies(runs: list[_Run], faults: list[Fault]) -> list[_Run]:
    """Of runs with the very same samples, the one at its intended speed is what was measured."""
    kept: dict[bytes, _Run] = {}
    for run in sorted(runs, key=_off_target):
        both = [run.channels[key] for key in ("log1", "force")]
        unread = not any(np.isfinite(channel).any() for channel in both)
        content = bytes([run.number]) if unread else b"".join(x.tobytes() for x in both)
        other = kept.setdefault(content, run)
        if other is not run:
            message = say(
                "{} has the very samples of {}; the run is left out.", run.name, other.name.lower()
            )
            faults.append(run.fault("samples_listed_twice", message, 0, "run"))
    return sorted(kept.values(), key=lambda run: run.number)


def _no_wind(runs: list[_Run]) -> Fault:
    """The fault of a wind that in every run is empty or one impossible value.

    So people write that there was no anemometer: 999 throughout. The tow goes on as one without.
    """
    message = say(
        "column '{column}' {} in all runs, which is no wind; the tow goes on without wind.",
        _seen(runs[0].channels["wind_speed"][0]),
        column=_WORDS["wind_speed"],
    )
    return _of_all(runs, "implausible_value", message, runs[0].first_line)


_WIND: Final = ("wind_speed", "wind_angle")


def _is_no_wind(run: _Run) -> bool:
    values = run.channels.get("wind_speed")
    if values is None:
        return False
    is_one_value = (values == values[0]).all() and not _within(values[0], WIND_SPEED_M_S)
    return bool(np.isnan(values).all() or is_one_value)


def _without_wind(run: _Run) -> _Run:
    return replace(run, channels={k: v for k, v in run.channels.items() if k not in _WIND})


def _of_all(runs: list[_Run], reason_code: str, message: str, line: int) -> Fault:
    """The fault of a channel that all runs of the tow lose."""
    lost_s = sum(run.seconds for run in runs)
    first = runs[0]
    return Fault(first.path, first.tow_id, line, reason_code, message, "seconds", None, lost_s)


def _off_target(run: _Run) -> tuple[float, int]:
    speed = _median(run.channels["log1"])
    return abs(speed / run.intended_m_s - 1.0) if np.isfinite(speed) else np.inf, run.number


def _check_left(kept: list[_Run], selected: int, faults: list[Fault]) -> None:
    """A tow of which half of the runs or more are lost is lost itself, for the first reason."""
    if 2 * len(kept) > selected:
        return
    first = next(fault for fault in faults if fault.lost == "run")
    raise DefectiveFileError(first.reason_code, first.message, first.line, first.path)


def _with_changes(samples: pl.DataFrame, kept: list[_Run], faults: list[Fault]) -> pl.DataFrame:
    """The samples without lost runs, with NaN where a sample of the others was left out."""
    if not faults:
        return samples
    number = samples["run"].to_numpy()
    changed = []
    for key, name in _measured(samples).items():
        values = samples[name].to_numpy().copy()
        for run in kept:
            values[number == run.number] = run.channels[key]
        changed.append(pl.Series(name, values))
    lost = [fault.run for fault in faults if fault.lost == "run"]
    return samples.with_columns(changed).filter(~pl.col("run").is_in(lost))


def _measured(samples: pl.DataFrame) -> dict[str, str]:
    """The channels that were measured, with the names of their columns."""
    return {key: name for key, name in _CHANNELS.items() if samples[name].null_count() == 0}


def _selected_runs(
    samples: pl.DataFrame, tow: Row, runs: pl.DataFrame, faults: list[Fault]
) -> list[_Run]:
    """The selected runs that are there; each that is not leaves a fault."""
    number = samples["run"].to_numpy()
    bounds = [*run_starts(number).tolist(), len(number)]
    rows = {int(number[start]): (start, end) for start, end in pairwise(bounds)}
    second_file = int(np.argmax(number > SECOND_FILE_OFFSET))
    channels = {key: samples[name].to_numpy() for key, name in _measured(samples).items()}
    wanted = runs.filter((pl.col("tow_id") == tow["tow_id"]) & pl.col("selected"))
    selected = []
    for row in wanted.sort("run").iter_rows(named=True):
        if row["run"] not in rows:
            faults.append(_missing_run(row["run"], tow, sorted(rows)))
            continue
        start, end = rows[row["run"]]
        in_second = row["run"] > SECOND_FILE_OFFSET
        selected.append(
            _Run(
                tow["tow_id"],
                row["run"],
                tow["second_path"] if in_second else tow["samples_path"],
                start - (second_file if in_second else 0) + FIRST_ROW,
                tow["sample_rate_hz"],
                tow["declared_speed_m_s"] * row["target_speed_ratio"],
                row["planned_s"],
                {key: values[start:end] for key, values in channels.items()},
            )
        )
    return selected


def _missing_run(run: int, tow: Row, present: list[int]) -> Fault:
    in_second = run > SECOND_FILE_OFFSET
    offset = SECOND_FILE_OFFSET if in_second else 0
    there = [str(n - offset) for n in present if (n > SECOND_FILE_OFFSET) == in_second]
    message = say(
        "Run {} is to be used but is not in the file; it holds runs {}.",
        run - offset,
        ", ".join(there),
    )
    path = tow["second_path"] if in_second else tow["samples_path"]
    return Fault(path, tow["tow_id"], None, "missing_run", message, "run", run)


def _lasts(run: _Run, faults: list[Fault]) -> bool:
    """Whether a run is long enough; one that is too short leaves a fault."""
    missing_s = run.planned_s - run.seconds
    if run.seconds >= SHORTEST_RUN_RATIO * run.planned_s:
        return True
    lost: Lost = "run" if missing_s > LEFT_OUT_S else "seconds"
    message = say(
        "{} lasts {:.2f} s at {} samples per second, {:.2f} s too short; {}.",
        run.name,
        run.seconds,
        run.rate_hz,
        missing_s,
        _what_then(lost),
    )
    faults.append(run.fault("short_run", message, 0, lost, missing_s))
    return lost == "seconds"


def _long(runs: list[_Run]) -> list[Fault]:
    """A fault that costs nothing where all runs last far longer than planned, as by a wrong rate.

    Windows, averages and what accelerated the boat are then taken over another time than is meant.
    """
    if not runs or any(run.seconds < LONGEST_RUN_RATIO * run.planned_s for run in runs):
        return []
    first = runs[0]
    message = say(
        "All runs last {:.0f} s or longer at {} samples per second, and {:.0f} s is planned: is "
        "the rate {:.0f}? Nothing is left out.",
        min(run.seconds for run in runs),
        first.rate_hz,
        first.planned_s,
        first.rate_hz * first.seconds / first.planned_s,
    )
    return [replace(first.fault("long_run", message, 0, "seconds", 0.0), run=None)]


def _what_then(lost: Lost) -> str:
    if lost == "run":
        return say("up to {:g} s may be missing, so the run is left out", LEFT_OUT_S)
    return "the run goes on without them"


# What a typical run looks like: mix-ups of whole columns


def _typical(runs: list[_Run]) -> dict[str, _Typical]:
    """Return what each channel does typically, relative to the intended speed where it is one.

    Medians over runs of medians, so that a fault in one run does not pass for a mix-up.
    """
    return {
        key: _Typical(
            *(
                float(np.median([_known(measure, run.channels[key]) for run in runs]))
                for measure in (_median, np.nanmax, np.nanmin)
            )
        )
        for key in runs[0].channels
    }


def _known(measure: Callable[[Array], float], values: Array) -> float:
    """A measure of the samples that are numbers; NaN without any."""
    return float(measure(values)) if np.isfinite(values).any() else np.nan


def _mean(values: Array) -> float:
    return float(np.nanmean(values, dtype=np.float64))


def _median(values: Array) -> float:
    """Median of every tenth sample: only gross faults are looked for, and all of them take long."""
    return _known(np.nanmedian, values[::10])


def _implausible(channels: Mapping[str, _Typical], intended_m_s: float) -> list[str]:
    """Return the channels whose typical values cannot be what their header says."""
    log1 = channels["log1"].median
    others = [key for key in ("log2", "gps") if key in channels]
    plausible = {
        "log1": _within(log1 / intended_m_s, SPEED_RATIO),
        **{key: _within(channels[key].median, SPEEDS_AGREE_RATIO, abs(log1)) for key in others},
        "force": _within(channels["force"].median, RESISTANCE_KG_M, intended_m_s**2),
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


def _within(value: float, limits: tuple[float, float], unit: float = 1.0) -> bool:
    return limits[0] * unit <= value <= limits[1] * unit


def _check_mix_ups(runs: list[_Run]) -> None:
    """A force that is right but for its sign is a sign error; after that come swapped columns."""
    typical = _typical(runs)
    intended = float(np.median([run.intended_m_s for run in runs]))
    wrong = _implausible(typical, intended)
    if not wrong:
        return
    force = typical["force"].median
    turned = {**typical, "force": _Typical(-force, 0, 0)}
    if force < 0 and not _implausible(turned, intended):
        message = "The force is {:.0f} N in a typical run; it must be positive."
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
                _WORDS[one],
                _WORDS[other],
                typical[one].median,
                typical[other].median,
            )
            raise DefectiveFileError("swapped_columns", said, HEADER, runs[0].path)


def _follows_log(runs: list[_Run], key: str) -> bool:
    """Whether a column is the same times log 1 in every run."""
    ratio = [_median(run.channels[key]) / _median(run.channels["log1"]) for run in runs]
    return bool(np.ptp(ratio) <= FOLLOWS_RATIO * abs(np.median(ratio)))


def _check_log2_and_gps(runs: list[_Run]) -> None:
    """A receiver gives a fix a second, held in between; a log moves as log 1 does."""
    if not {*SPARE} <= set(runs[0].channels):
        return
    log1, log2, gps = (
        np.median([np.count_nonzero(np.diff(run.channels[key])) / run.seconds for run in runs])
        for key in _SPEEDS
    )
    if min(log1, gps) > MOVES_AS_A_LOG_HZ and 0.1 < log2 < HELD_AS_A_FIX_HZ:
        said = say(
            "Columns '{}' and '{}' seem to be exchanged: the second moves {:.0f} times a second, "
            "as log1 does, and the first {:.1f} times, as a receiver does.",
            _WORDS["log2"],
            _WORDS["gps"],
            gps,
            log2,
        )
        raise DefectiveFileError("swapped_columns", said, HEADER, runs[0].path)


def _check_speed_unit(runs: list[_Run]) -> None:
    means = [_known(_mean, run.channels["log1"]) / run.intended_m_s for run in runs]
    ratio = float(np.median(means))
    if _within(ratio, KM_H_RATIO):
        said = say(
            "The speed by log1 is {:.2f} times the intended one; between {:g} and {:g} times it "
            "looks like km/h under another header.",
            ratio,
            *KM_H_RATIO,
        )
        raise DefectiveFileError("speed_unit", said, HEADER, runs[0].path)


def _without_other_units(
    runs: list[_Run], faults: list[Fault]
) -> tuple[list[_Run], Collection[str]]:
    """The runs without a log 2 or GPS in another unit of speed, and which of the two that is."""
    typical = {
        key: float(np.median([_median(run.channels[key]) for run in runs]))
        for key in _SPEEDS
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
            column=_WORDS[key],
            unit=units[0],
        )
        faults.append(_of_all(runs, "implausible_value", message, HEADER))
        gone.append(key)
    return [run.without(*gone) for run in runs], gone


_SPEED_UNITS: Final = {"km/h": 3.6, "kn": 1.9438}
"""Other units of speed in which people have a log or GPS, times m/s."""

# Samples that are left out


def _usual_resistance_kg_m(runs: list[_Run]) -> float:
    """Force / speed squared of a typical run, which a fault over most of one does not move."""
    each = [_median(run.channels["force"]) / run.intended_m_s**2 for run in runs]
    return abs(_known(np.nanmedian, np.asarray(each)))


def _judge_run(
    run: _Run, usual_kg_m: float, gone: Collection[str]
) -> tuple[_Run | None, list[Fault]]:
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
        then = _NOT_IN_THIS_RUN if is_gone else _what_then(cost)
        faults.append(_of_samples(run, key, mask, cost, then))
        channels[key] = np.where(mask | is_gone, np.float32(np.nan), channels[key])
    if lost == "run":
        return None, [fault for fault in faults if fault.lost == "run"]
    return _judge_whole(replace(run, channels=channels), faults)


SPARE: Final = ("log2", "gps")
"""Channels without which a run goes on."""

_NOT_IN_THIS_RUN: Final = say("over {:g} s, so the run goes on without this column", LEFT_OUT_S)


def _of_rows(run: _Run, mask: BoolArray, lost: Lost) -> Fault:
    """The fault of rows of which nothing can be read."""
    seconds = float(mask.sum()) / run.rate_hz
    message = say(
        "{}: rows do not have their fields, {:.3g} s in all; {}.",
        run.name,
        seconds,
        _what_then(lost),
    )
    if mask.all():
        message = say(
            "{}: no row can be used, as fields are missing or the times jump back; the run is left "
            "out.",
            run.name,
        )
    return run.fault("broken_row", message, int(mask.argmax()), lost, seconds)


def _of_samples(run: _Run, key: str, mask: BoolArray, lost: Lost, then: str) -> Fault:
    """The fault of samples of one channel, named by the first of them."""
    row = int(mask.argmax())
    seconds = float(mask.sum()) / run.rate_hz
    message = say(
        "{}: column '{column}' {} and is wrong for {:.3g} s in all; {}.",
        run.name,
        _seen(run.channels[key][row]),
        seconds,
        then,
        column=_WORDS[key],
    )
    return run.fault(_reason(run, key, row), message, row, lost, seconds)


def _seen(value: float) -> str:
    return say("holds {:.6g}", value) if np.isfinite(value) else "holds no ordinary number"


def _reason(run: _Run, key: str, row: int) -> str:
    value = run.channels[key][row]
    if not np.isfinite(value):
        return "bad_number"
    if key in _SPEEDS and value <= DROPOUT_M_S:
        return "gps_dropout" if key == "gps" else "log_dropout"
    pushes = FORCE_SPIKE_RATIO[0] * abs(_median(run.channels["force"]))
    return "negative_force" if key == "force" and pushes <= value < 0 else "implausible_value"


_SPEEDS: Final = ("log1", "log2", "gps")


def _wrong_samples(run: _Run, usual_n: float) -> dict[str, BoolArray]:
    """Samples that are no number, have dropped out or cannot be, by channel."""
    wrong = {}
    for key, values in run.channels.items():
        if key in _SPEEDS:
            spike = GPS_JUMP_RATIO if key == "gps" else SPEED_SPIKE_RATIO
            wrong[key] = _wrong_speed(values, run.rate_hz, spike)
        elif key == "force":
            wrong[key] = _wrong_force(values, usual_n, run.rate_hz)
        elif key == "wind_speed":
            most = GUST_RATIO * abs(_median(values)) + GUST_M_S
            wrong[key] = _outside(values, WIND_SPEED_M_S[0], min(WIND_SPEED_M_S[1], most))
        else:
            wrong[key] = _outside(values, *WIND_ANGLE_DEG)
    return wrong


def _outside(values: Array, lowest: float, highest: float) -> BoolArray:
    """Samples that are not between two limits, or no number."""
    return np.asarray(~((values >= lowest) & (values <= highest)))


def _wrong_speed(values: Array, rate_hz: int, spike_ratio: float) -> BoolArray:
    median = _median(values)
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
    means = _second_means(np.where(wrong, np.float32(np.nan), values), rate_hz)
    if (means < 0).any():  # single negative samples are the surge of the tow line
        second = np.minimum(np.arange(len(values)) // rate_hz, len(means) - 1)
        wrong |= (means < 0)[second]
    return wrong


def _dead(values: Array, most: float, samples: int) -> BoolArray:
    """Stretches of at least so many equal samples near zero."""
    starts, lengths = _stretches(values[1:] != values[:-1])
    dead = (lengths >= samples) & (np.abs(values[starts]) <= most)
    return np.asarray(np.repeat(dead, lengths))


def _stretches(changes: BoolArray) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """First rows and lengths of stretches, given whether each sample differs from that before."""
    starts = np.concatenate(([0], np.flatnonzero(changes) + 1))
    return starts, np.diff(starts, append=len(changes) + 1)


# What is wrong for longer


def _judge_whole(run: _Run, faults: list[Fault]) -> tuple[_Run | None, list[Fault]]:
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
    """Return (first row, length) of the longest stretch of one value in which `counts` holds."""
    if counts is None:
        counts = np.ones(len(values), dtype=bool)
    starts, lengths = _stretches((values[1:] != values[:-1]) | (counts[1:] != counts[:-1]))
    counted = lengths * counts[starts]
    longest = int(counted.argmax())
    return int(starts[longest]), int(counted[longest])


def _may_hold(values: Array, samples: int) -> bool:
    """Whether a value may stand for so many samples, two or more: sees two of each such stretch."""
    seen = values[:: max(samples // 2, 1)]
    return bool((seen[1:] == seen[:-1]).any())


_STUCK_LIMIT_S: Final = {
    **dict.fromkeys(("log1", "log2", "force"), STUCK_S),
    "wind_speed": STUCK_WIND_SPEED_S,
    "wind_angle": STUCK_VANE_S,
}

Said = tuple[str, str, int]
"""Reason code, what is wrong, and the row where it begins."""


def _stuck(run: _Run, key: str) -> Said | None:
    """A channel that holds one value for too long; the GPS is judged over all runs."""
    limit_s = _STUCK_LIMIT_S.get(key)
    values = run.channels[key]
    if limit_s is None or not _may_hold(values, int(limit_s * run.rate_hz)):
        return None
    counts = None
    if key in _WIND:  # cups may stand still, and a vane needs wind
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
        column=_WORDS[key],
    )
    return "stuck_channel", what, row


def _unlikely_mean(run: _Run, key: str) -> Said | None:
    """A mean that cannot be; of the vane there is none."""
    if key == "wind_angle":
        return None
    mean, log1 = (_mean(run.channels[k]) for k in (key, "log1"))
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
        column=_WORDS[key],
    )
    return reason_code, what, 0


def _saturated(run: _Run, key: str) -> Said | None:
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
        column=_WORDS[key],
    )
    return "saturated_force", what, int(at_end.argmax())


def _without_stuck_gps(runs: list[_Run], faults: list[Fault]) -> list[_Run]:
    """GPS has one fix a second in steps of 0.01 m/s, so a steady boat may well hold one value."""
    by_value: dict[float, list[_Run]] = {}
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


def _stuck_gps(runs: list[_Run]) -> Iterator[tuple[_Run, str]]:
    """Runs that hold one value where it is stuck, and why: one of them, or two, cannot be right."""
    moved = {run.number: _span(_second_means(run.channels["log1"], run.rate_hz)) for run in runs}
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


def _second_means(values: Array, rate_hz: int) -> NDArray[np.float64]:
    """Return the mean of every whole second, NaN where one of its samples is none."""
    seconds = len(values) // rate_hz
    means: NDArray[np.float64] = (
        values[: seconds * rate_hz].reshape(seconds, rate_hz).mean(axis=1, dtype=np.float64)
    )
    return means
