"""Whether the samples of a tow can be true: missing pieces, dead or stuck instruments, mix-ups.

Only gross faults that make a tow useless as it stands. Judging a good tow (steady windows,
agreement of out and back) is measuring method and belongs to `pipeline`.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any, Final

import numpy as np
import polars as pl
from numpy.typing import NDArray

from herijk.pipeline.channels import SECOND_FILE_OFFSET
from herijk.warehouse.archive.faults import DefectiveFileError
from herijk.warehouse.archive.samples import OUTPUT_NAMES, run_starts

SHORTEST_RUN_RATIO: Final = 0.99
"""Of what is planned."""
DROPOUT_M_S: Final = 0.1
SPEED_RATIO: Final = (0.5, 1.6)
KM_H_RATIO: Final = (3.0, 4.2)
SPEED_SPIKE_RATIO: Final = 3.0
SPEEDS_AGREE_RATIO: Final = (0.6, 1.4)
RESISTANCE_KG_M: Final = (2.0, 500.0)
"""Mean force over intended speed squared; sloops lie between 15 and 60."""
FORCE_SPIKE_RATIO: Final = (-3.0, 20.0)
"""Of the median. A tow line cannot push: what a slack one reads is noise about zero."""
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
    """One selected run: its channels, and where its first row stands in the file."""

    number: int
    first_line: int
    rate_hz: int
    intended_m_s: float
    planned_s: float
    channels: Mapping[str, Array]

    @property
    def name(self) -> str:
        if self.number > SECOND_FILE_OFFSET:
            return f"Run b{self.number - SECOND_FILE_OFFSET}"
        return f"Run {self.number}"


@dataclass(frozen=True)
class _Typical:
    """What one channel does in a typical run of the tow (medians over the runs)."""

    median: float
    highest: float
    lowest: float


def check_samples(samples: pl.DataFrame, tow: Mapping[str, Any], runs: pl.DataFrame) -> None:
    """Check that the selected runs of a tow can be used; the most specific cause comes first.

    Args:
        samples: frame of `SAMPLE_SCHEMA`, as `read_tow_samples` returns it.
        tow: a row of `ArchiveIndex.tows`.
        runs: `ArchiveIndex.runs`; rows of other tows are ignored.

    Raises:
        DefectiveFileError: the first fault, with the file and the line where it begins.
    """
    selected = list(_selected_runs(samples, tow, runs))
    for check in (
        _check_length,
        _check_mix_ups,
        _check_speed_unit,
        _check_dropouts,
        _check_stuck,
        _check_gps_stuck,
        _check_speed,
        _check_spikes,
        _check_force,
        _check_ranges,
    ):
        check(selected, tow)


def _selected_runs(
    samples: pl.DataFrame, tow: Mapping[str, Any], runs: pl.DataFrame
) -> Iterator[_Run]:
    number = samples["run"].to_numpy()
    starts = run_starts(number)
    bounds = dict(
        zip(
            number[starts].tolist(),
            zip(starts, [*starts[1:], len(number)], strict=True),
            strict=True,
        )
    )
    second = next(
        (int(starts[i]) for i, n in enumerate(number[starts]) if n > SECOND_FILE_OFFSET), 0
    )
    channels = {
        key: samples[name].to_numpy()
        for key, name in _CHANNELS.items()
        if samples[name].null_count() == 0
    }
    wanted = runs.filter((pl.col("tow_id") == tow["tow_id"]) & pl.col("selected"))
    for row in wanted.sort("run").iter_rows(named=True):
        if row["run"] not in bounds:
            raise _missing_run(row["run"], tow, sorted(bounds))
        start, end = bounds[row["run"]]
        offset = second if row["run"] > SECOND_FILE_OFFSET else 0
        yield _Run(
            row["run"],
            int(start) - offset + 2,
            tow["sample_rate_hz"],
            tow["declared_speed_m_s"] * row["target_speed_ratio"],
            row["planned_s"],
            {key: values[start:end] for key, values in channels.items()},
        )


def _missing_run(run: int, tow: Mapping[str, Any], present: list[int]) -> DefectiveFileError:
    in_second = run > SECOND_FILE_OFFSET
    offset = SECOND_FILE_OFFSET if in_second else 0
    there = [str(n - offset) for n in present if (n > SECOND_FILE_OFFSET) == in_second]
    return DefectiveFileError(
        "missing_run",
        f"Run {run - offset} is to be used but is not in the file; it holds runs "
        f"{', '.join(there)}.",
        None,
        tow["second_path"] if in_second else tow["samples_path"],
    )


def _fault(
    reason_code: str, message: str, run: _Run, tow: Mapping[str, Any], row: int | None = None
) -> DefectiveFileError:
    """Return the error for a fault in a run; `row` counts from the start of the run."""
    path = tow["second_path"] if run.number > SECOND_FILE_OFFSET else tow["samples_path"]
    line = None if row is None else run.first_line + row
    return DefectiveFileError(reason_code, message, line, path)


def _check_length(runs: list[_Run], tow: Mapping[str, Any]) -> None:
    for run in runs:
        seconds = len(run.channels["log1"]) / run.rate_hz
        shortest = SHORTEST_RUN_RATIO * run.planned_s
        if seconds < shortest:
            raise _fault(
                "short_run",
                f"{run.name} lasts {seconds:.2f} s at {run.rate_hz} samples a second; "
                f"at least {shortest:g} s is needed.",
                run,
                tow,
                0,
            )


# What a typical run looks like: mix-ups of whole columns


def _typical(runs: list[_Run]) -> dict[str, _Typical]:
    """Return what each channel does typically, relative to the intended speed where it is one.

    Medians over runs of medians, so that a fault in one run does not pass for a mix-up.
    """
    return {
        key: _Typical(
            *(
                float(np.median([measure(run.channels[key]) for run in runs]))
                for measure in (_median, np.max, np.min)
            )
        )
        for key in runs[0].channels
    }


def _median(values: Array) -> float:
    """Median of every tenth sample: only gross faults are looked for, and all of them take long."""
    return float(np.median(values[::10]))


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


def _check_mix_ups(runs: list[_Run], tow: Mapping[str, Any]) -> None:
    """A force that is right but for its sign is a sign error; after that come swapped columns."""
    typical = _typical(runs)
    intended = float(np.median([run.intended_m_s for run in runs]))
    wrong = _implausible(typical, intended)
    if not wrong:
        return
    force = typical["force"].median
    turned = {**typical, "force": _Typical(-force, 0, 0)}
    if force < 0 and not _implausible(turned, intended):
        raise _fault(
            "negative_force",
            f"The force is {force:.0f} N in a typical run; it must be positive.",
            runs[0],
            tow,
            0,
        )
    for one, other in combinations(typical, 2):
        exchanged = {**typical, one: typical[other], other: typical[one]}
        if (one in wrong or other in wrong) and not _implausible(exchanged, intended):
            raise _fault(
                "swapped_columns",
                f"Columns '{_WORDS[one]}' and '{_WORDS[other]}' seem to be exchanged: typically "
                f"they hold {typical[one].median:.4g} and {typical[other].median:.4g}, and only "
                "the other way round can that be right.",
                runs[0],
                tow,
                1 - runs[0].first_line,
            )


def _speed_ratio(runs: list[_Run]) -> float:
    means = [run.channels["log1"].mean(dtype=np.float64) / run.intended_m_s for run in runs]
    return float(np.median(means))


def _check_speed_unit(runs: list[_Run], tow: Mapping[str, Any]) -> None:
    ratio = _speed_ratio(runs)
    if _within(ratio, KM_H_RATIO):
        raise _fault(
            "speed_unit",
            f"The speed by log1 is {ratio:.2f} times the intended one; between {KM_H_RATIO[0]:g} "
            f"and {KM_H_RATIO[1]:g} times it looks like km/h under another header.",
            runs[0],
            tow,
            1 - runs[0].first_line,
        )


# Dead and stuck instruments


def _check_dropouts(runs: list[_Run], tow: Mapping[str, Any]) -> None:
    for run in runs:
        for key in ("log1", "log2", "gps"):
            if key in run.channels and run.channels[key].min() <= DROPOUT_M_S:
                low = run.channels[key] <= DROPOUT_M_S
                row = int(low.argmax())
                raise _fault(
                    "gps_dropout" if key == "gps" else "log_dropout",
                    f"{run.name}: {key} drops to {run.channels[key][row]:.3g} m/s, for "
                    f"{low.sum() / run.rate_hz:.3g} s in all; it must stay above "
                    f"{DROPOUT_M_S} m/s.",
                    run,
                    tow,
                    row,
                )


def _longest_hold(values: Array, counts: NDArray[np.bool_] | None = None) -> tuple[int, int]:
    """Return (first row, length) of the longest stretch of one value in which `counts` holds."""
    change = values[1:] != values[:-1]
    if counts is not None:
        change |= counts[1:] != counts[:-1]
    starts = np.concatenate(([0], np.flatnonzero(change) + 1))
    lengths = np.diff(starts, append=len(values))
    if counts is not None:
        lengths = lengths * counts[starts]
    longest = int(lengths.argmax())
    return int(starts[longest]), int(lengths[longest])


def _may_hold(values: Array, samples: int) -> bool:
    """Whether a value may stand for so many samples, two or more: sees two of each such stretch."""
    seen = values[:: max(samples // 2, 1)]
    return bool((seen[1:] == seen[:-1]).any())


def _check_stuck(runs: list[_Run], tow: Mapping[str, Any]) -> None:
    for run in runs:
        wind = run.channels.get("wind_speed", np.zeros(1, np.float32))
        for key, limit_s, counts in (
            ("log1", STUCK_S, None),
            ("log2", STUCK_S, None),
            ("force", STUCK_S, None),
            ("wind_speed", STUCK_WIND_SPEED_S, wind != 0),  # cups may stand still
            ("wind_angle", STUCK_VANE_S, wind > VANE_TURNS_M_S),  # a vane needs wind
        ):
            if key not in run.channels:
                continue
            if not _may_hold(run.channels[key], int(limit_s * run.rate_hz)):
                continue
            row, length = _longest_hold(run.channels[key], counts)
            if length >= limit_s * run.rate_hz:
                raise _fault(
                    "stuck_channel",
                    f"{run.name}: column '{_WORDS[key]}' holds {run.channels[key][row]:.6g} for "
                    f"{length / run.rate_hz:.3g} s; less than {limit_s:g} s is normal.",
                    run,
                    tow,
                    row,
                )


def _check_gps_stuck(runs: list[_Run], tow: Mapping[str, Any]) -> None:
    """GPS has one fix a second in steps of 0.01 m/s, so a steady boat may well hold one value."""
    held: dict[float, _Run] = {}
    for run in runs:
        gps = run.channels.get("gps")
        if gps is None or gps.min() != gps.max():
            continue
        speed = float(gps[0])
        seconds = _second_means(run.channels["log1"], run.rate_hz)
        span = float(seconds.max() - seconds.min())
        before = held.setdefault(speed, run)
        if span > GPS_MUST_MOVE_M_S:
            why = f"while log1 changed by {span:.2f} m/s"
        elif before.intended_m_s != run.intended_m_s:
            why = f"and so in {before.name.lower()}, at another speed"
        else:
            continue
        raise _fault(
            "stuck_channel", f"{run.name}: gps holds {speed:.6g} throughout, {why}.", run, tow, 0
        )


def _second_means(values: Array, rate_hz: int) -> NDArray[np.float64]:
    """Return the mean of every whole second."""
    seconds = len(values) // rate_hz
    means: NDArray[np.float64] = (
        values[: seconds * rate_hz].reshape(seconds, rate_hz).mean(axis=1, dtype=np.float64)
    )
    return means


# Values


def _check_speed(runs: list[_Run], tow: Mapping[str, Any]) -> None:
    for run in runs:
        mean = float(run.channels["log1"].mean(dtype=np.float64))
        if not _within(mean / run.intended_m_s, SPEED_RATIO):
            raise _fault(
                "implausible_speed",
                f"{run.name}: the mean speed by log1 is {mean:.3g} m/s, "
                f"{mean / run.intended_m_s:.2f} times the intended {run.intended_m_s:.3g} m/s; "
                f"{SPEED_RATIO[0]:g} to {SPEED_RATIO[1]:g} times can be right.",
                run,
                tow,
                0,
            )


def _check_spikes(runs: list[_Run], tow: Mapping[str, Any]) -> None:
    for run in runs:
        # The median, as a large spike lifts the mean it is compared with.
        median = abs(_median(run.channels["force"]))
        force = (FORCE_SPIKE_RATIO[0] * median, FORCE_SPIKE_RATIO[1] * median)
        fastest = SPEED_SPIKE_RATIO * run.intended_m_s
        speed = (-fastest, fastest)
        for key, limits, unit in (
            ("force", force, "N"),
            ("log1", speed, "m/s"),
            ("log2", speed, "m/s"),
            ("gps", speed, "m/s"),
        ):
            if key in run.channels:
                _check_within(run, tow, key, limits, unit)


def _check_within(
    run: _Run, tow: Mapping[str, Any], key: str, limits: tuple[float, float], unit: str
) -> None:
    values = run.channels[key]
    if values.min() >= limits[0] and values.max() <= limits[1]:
        return
    row = int(((values < limits[0]) | (values > limits[1])).argmax())
    raise _fault(
        "implausible_value",
        f"{run.name}: column '{_WORDS[key]}' holds {values[row]:.6g} {unit}; "
        f"{limits[0]:.4g} to {limits[1]:.4g} can be right.",
        run,
        tow,
        row,
    )


def _check_force(runs: list[_Run], tow: Mapping[str, Any]) -> None:
    """Single negative samples are the surge of the tow line; a negative second is a fault."""
    for run in runs:
        force = run.channels["force"]
        mean = float(force.mean(dtype=np.float64))
        if mean <= 0:
            raise _fault(
                "negative_force", f"{run.name}: the mean force is {mean:.1f} N.", run, tow, 0
            )
        seconds = _second_means(force, run.rate_hz)
        if seconds.min() < 0:
            second = int((seconds < 0).argmax())
            raise _fault(
                "negative_force",
                f"{run.name}: in second {second + 1} the mean force is {seconds[second]:.1f} N; "
                "it must be positive in every second.",
                run,
                tow,
                second * run.rate_hz,
            )


def _check_ranges(runs: list[_Run], tow: Mapping[str, Any]) -> None:
    for run in runs:
        mean = _means(run)
        force_n = tuple(limit * run.intended_m_s**2 for limit in RESISTANCE_KG_M)
        near_log1 = tuple(limit * mean("log1") for limit in SPEEDS_AGREE_RATIO)
        for key, limits, unit in (
            ("log2", near_log1, "m/s"),
            ("gps", near_log1, "m/s"),
            ("force", force_n, "N"),
            ("wind_speed", (0.0, WIND_MEAN_M_S), "m/s"),
        ):
            if key in run.channels and not _within(mean(key), (limits[0], limits[1])):
                raise _fault(
                    "implausible_value",
                    f"{run.name}: the mean of column '{_WORDS[key]}' is {mean(key):.4g} {unit}; "
                    f"{limits[0]:.3g} to {limits[1]:.3g} {unit} can be right.",
                    run,
                    tow,
                    0,
                )
        for key, limits, unit in (
            ("wind_speed", WIND_SPEED_M_S, "m/s"),
            ("wind_angle", WIND_ANGLE_DEG, "degrees"),
        ):
            if key in run.channels:
                _check_within(run, tow, key, limits, unit)


def _means(run: _Run) -> Callable[[str], float]:
    return lambda key: float(run.channels[key].mean(dtype=np.float64))
