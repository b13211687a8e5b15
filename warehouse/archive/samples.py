"""Reading the samples of a tow: from its files to one frame of `SAMPLE_SCHEMA`.

    files -> tables of numbers -> runs -> SI units, angles, absent channels

The runs are told by a column `run`, by a file for each, or by their begin and end in one recording.
Form only: whether they can be true is the business of `plausibility`.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
import polars as pl
from numpy.typing import NDArray

from pipeline.arrays import IntArray
from pipeline.channels import MOST_RUNS, SAMPLE_SCHEMA, SECOND_FILE_OFFSET
from pipeline.errors import DefectiveInputError
from pipeline.messages import Sentence, say
from pipeline.tables.row import Row
from warehouse.archive.columns import DefectiveHeaderError
from warehouse.archive.faults import DefectiveFileError, say_at_line
from warehouse.archive.files import PARTS, resolve_inside
from warehouse.archive.profile import SeasonProfile
from warehouse.archive.sample_files import SampleTable, read_table

OUTPUT_NAMES: Final = {
    "run": "run",
    "log1": "log1_m_s",
    "log2": "log2_m_s",
    "gps": "gps_m_s",
    "force": "force_n",
    "wind_speed": "wind_speed_m_s",
    "wind_angle": "wind_angle_deg",
}
RATE_TOLERANCE: Final = 0.01
"""Relative difference between the rate by the times and the one that is declared."""
MAX_GAP_S: Final = 1.5
"""A longer step between two times is a gap, which says nothing of the rate."""
DAY_S: Final = 86_400
HIGHEST_ANGLE_DEG: Final = 359.999
"""Above it an angle can become 360 in 32 bits."""
ENOUGH_FOR_STEPS: Final = 10_000
"""Samples that are enough to see in which steps a channel is written."""
FEWEST_FOR_STEPS: Final = 3
"""Values that differ."""

Place = Callable[[int], tuple[str, int]]
"""The file of a row of a tow's samples and the line in it; of the header where it is negative."""
LineOf = Callable[[int], int]
"""The line of a row of one file; of the header where it is negative."""
Windows = dict[int, tuple[float, float]]
"""Begin and end of each run in a recording [s]."""


class RunDefect(NamedTuple):
    """What is wrong with the times of a run, and in which row of the samples."""

    reason_code: str
    message: Sentence
    row: int


RunDefects = dict[int, RunDefect]
"""What costs a run, by the number of the run."""


def read_tow_samples(
    root: Path, tow: Row, profile: SeasonProfile
) -> tuple[pl.DataFrame, Place, RunDefects]:
    """Read the samples of a tow, those of a second file behind those of the first.

    Args:
        root: the archive.
        tow: a row of `ArchiveIndex.tows`.
        profile: the profile of its season.

    Returns:
        The frame, as `read_samples`; runs of the second file are numbered 21 and on. Where its
        rows stand, and what costs a run.

    Raises:
        DefectiveFileError: the first fault, with the file it is in.
    """
    files: list[str] = []
    frames: list[pl.DataFrame] = []
    lines: list[LineOf] = []
    ends: list[int] = []
    defects: RunDefects = {}
    windows = read_windows_text(tow.get("run_windows"))
    for name, numbers, offset in (
        ("samples_path", "samples_runs", 0),
        ("second_path", "second_runs", SECOND_FILE_OFFSET),
    ):
        paths = tow[name].split(PARTS) if tow[name] else []
        runs = tow.get(numbers)
        run_of = list(map(int, runs.split(","))) if runs else [None] * len(paths)
        own: Windows = {}
        for run, window in windows.items():
            if offset < run <= offset + MOST_RUNS:
                own[run - offset] = window
        for path, run_of_file in zip(paths, run_of, strict=True):
            try:
                samples, line_of, found = read_samples(
                    resolve_inside(root, path), profile, tow["sample_rate_hz"], run_of_file, own
                )
            except DefectiveInputError as error:
                ask = error.ask if isinstance(error, DefectiveHeaderError) else ()
                raise DefectiveFileError(
                    error.reason_code, error.message, error.line, path, ask
                ) from error
            before = ends[-1] if ends else 0
            for number, defect in found.items():
                defects[number + offset] = defect._replace(row=before + defect.row)
            files.append(path)
            frames.append(samples.with_columns(pl.col("run") + pl.lit(offset, pl.Int8)))
            lines.append(line_of)
            ends.append(before + samples.height)

    def find_place(row: int) -> tuple[str, int]:
        part = int(np.searchsorted(ends, row, "right")) if row >= 0 else 0
        before = ends[part - 1] if part else 0
        return files[part], lines[part](row - before if row >= 0 else row)

    return pl.concat(frames), find_place, defects


def read_windows_text(text: str | None) -> Windows:
    """Read the begin and end of runs as `write_windows_text` writes them."""
    windows = {}
    for part in text.split(";") if text else ():
        run, _, seconds = part.partition(":")
        start, _, end = seconds.partition("-")
        windows[int(run)] = float(start), float(end)
    return windows


def write_windows_text(windows: Windows) -> str:
    """Write the begin and end of runs as one text: `1:12.0-62.0;2:70.0-120.0`."""
    return ";".join(f"{run}:{start!r}-{end!r}" for run, (start, end) in sorted(windows.items()))


def read_samples(
    path: Path,
    profile: SeasonProfile,
    sample_rate_hz: float | None = None,
    run: int | None = None,
    windows: Windows | None = None,
) -> tuple[pl.DataFrame, LineOf, RunDefects]:
    """Read one samples file.

    Args:
        path: text, packed or not, Parquet or TDMS.
        profile: how the files of that season are written.
        sample_rate_hz: rate that a time column must agree with; not checked when None.
        run: the run that the file is, where there is a file for each.
        windows: begin and end of each run, where the file is one recording.

    Returns:
        A frame with the columns of `SAMPLE_SCHEMA`, one row per sample in the order of the file,
        the line of each of its rows, and what costs a run. What was not measured is null
        throughout: a GPS that is absent or empty, and what the profile declares absent. Wind angles
        are brought to [0, 360); one outside -180..360 cannot be an angle and is left as it is, for
        `judge_samples` to find.

    Raises:
        DefectiveInputError: the first fault that costs the whole file, with its line.
    """
    has_run_column = run is None and profile.runs != "windows"
    table = read_table(path, profile if has_run_column else profile.make_run_optional())
    row_of: IntArray | None = None
    if has_run_column:
        raw = _fill_runs(table.frame)
    elif run is not None:
        raw = _assign_run(table, run)
    else:
        raw, row_of = _cut_recording(table, profile, windows or {}, sample_rate_hz)

    def find_line(row: int) -> int:
        if row < 0:
            return table.header_line
        return table.first_line + (row if row_of is None else int(row_of[row]))

    scaled = [key for key in raw.columns if key not in ("run", "time")]
    raw = raw.with_columns(table.columns[key].to_si(pl.col(key)) for key in scaled)
    _check_runs(raw["run"], find_line)
    defects: RunDefects = {}
    if "time" in raw.columns and sample_rate_hz:
        defects = _check_times(raw, sample_rate_hz, profile, find_line)
    return _to_schema(raw, profile.wind_zero_deg), find_line, defects


# Runs and times


def _assign_run(table: SampleTable, run: int) -> pl.DataFrame:
    """Return the samples of a file that is one run; a column `run` in it must say the same."""
    told = table.frame["run"].drop_nans().unique() if "run" in table.frame.columns else pl.Series()
    others = [number for number in told if number != run]
    if others:
        text = say("This is the file of run {run}, and its column 'run' says {other:g}.")
        raise DefectiveInputError("unknown_run", say(text, run=run, other=others[0]))
    return table.frame.with_columns(run=pl.lit(float(run)))


def _cut_recording(
    table: SampleTable, profile: SeasonProfile, windows: Windows, rate_hz: float | None
) -> tuple[pl.DataFrame, IntArray]:
    """Return the runs of one recording, and the row of the file that each of their rows is.

    A window counts from the first sample, by the time column where there is one.

    Raises:
        DefectiveInputError: no run is given, none is in the recording, or its times jump back.
    """
    if not windows:
        text = say(
            "Nobody says where the runs are in this recording: give begin and end of each in "
            "sleeplijsten/vensters_{season}.csv."
        )
        raise DefectiveInputError("missing_run", say(text, season=profile.season))
    rows = np.arange(table.frame.height)
    if "time" in table.frame.columns:
        seconds = _count_seconds(table, profile)
    else:
        seconds = rows / (rate_hz or 1.0)
    number = np.zeros(len(rows))
    for run, (start, end) in windows.items():
        number[(seconds >= start - 1e-9) & (seconds < end - 1e-9)] = run
    is_in_run = number > 0
    kept = rows[is_in_run]
    if not len(kept):
        said = say("The recording lasts {seconds:.1f} s, and no run begins in it.",
                   seconds=float(seconds.max()))  # fmt: skip
        raise DefectiveInputError("missing_run", said)
    frame = table.frame.with_columns(run=pl.Series(number)).filter(pl.Series(is_in_run))
    return frame, kept


def _count_seconds(table: SampleTable, profile: SeasonProfile) -> NDArray[np.float64]:
    """Return the time of each row of a recording since the first; -1 where it cannot be read."""
    times = table.frame["time"].to_numpy()
    read = np.flatnonzero(np.isfinite(times))
    steps = np.diff(times[read])
    steps = np.where(steps < -DAY_S / 2, steps + DAY_S, steps)  # a clock begins again at midnight
    if (steps < 0).any():
        turn = int(np.argmax(steps < 0))
        text = say(
            "the times of the recording jump back by {seconds:.6g} s, so that begin and end of the "
            "runs cannot be found. If its samples follow each other without a gap, say that times "
            'do not count: absent = ["time"] under [[profile]] in archief.toml.'
        )
        line = table.first_line + int(read[turn + 1])
        said = say_at_line(line, say(text, seconds=-steps[turn]))
        raise DefectiveHeaderError("bad_time", said, line, (profile.ask("absent", '["?"]'),))
    seconds = np.full(len(times), -1.0)
    seconds[read] = np.concatenate(([0.0], np.cumsum(steps)))
    return seconds


def _fill_runs(raw: pl.DataFrame) -> pl.DataFrame:
    """Return the samples with every row in a run; one whose run cannot be read holds no numbers."""
    unread = raw["run"].is_nan()
    if not unread.any():
        return raw
    run = raw["run"].fill_nan(None).forward_fill().backward_fill()
    if run.null_count():
        raise DefectiveInputError("unreadable_file", say("No row has a number in column 'run'."))
    others = pl.exclude("run", "time")
    return raw.with_columns(run, pl.when(unread).then(float("nan")).otherwise(others).name.keep())


def _check_runs(run: pl.Series, line_of: LineOf) -> None:
    """Raise where a run has a number that does not exist, or is not one piece."""
    starts = find_run_starts(run.to_numpy())
    for row in starts.tolist():
        if run[row] not in range(1, MOST_RUNS + 1):
            text = say("run {run:g} does not exist; runs are numbered 1 to {last}.")
            raise _error_at(line_of(row), "unknown_run", say(text, run=run[row], last=MOST_RUNS))
    again = starts[(~run.gather(starts).is_first_distinct()).to_numpy()]
    if len(again):
        row = int(again[0])
        text = say("run {run:g} begins again; its rows must be together.")
        raise _error_at(line_of(row), "split_run", say(text, run=run[row]))


def _error_at(line: int, code: str, what: str) -> DefectiveInputError:
    return DefectiveInputError(code, say_at_line(line, what), line)


def find_run_starts(run: NDArray[np.generic]) -> NDArray[np.intp]:
    """Return the row at which each run begins."""
    return np.flatnonzero(np.concatenate(([True], run[1:] != run[:-1])))


def _check_times(
    raw: pl.DataFrame, rate_hz: float, profile: SeasonProfile, line_of: LineOf
) -> RunDefects:
    """Return the runs whose times jump back, or rise at another rate than is declared.

    Raises:
        DefectiveHeaderError: `bad_time`, where the times of all runs rise at another rate.
    """
    step_s = pl.col("time").diff()
    # A clock begins again at midnight.
    step_s = pl.when(step_s < -DAY_S / 2).then(step_s + DAY_S).otherwise(step_s).fill_nan(None)
    frame = raw.with_row_index("row").with_columns(step=step_s.over("run"))
    step = pl.col("step")
    runs = frame.group_by("run", maintain_order=True).agg(
        pl.col("row").first(),
        turn=pl.col("row").filter(step < 0).first(),
        back_s=-step.filter(step < 0).first(),
        # Times may be rounded, so that some are equal; and seconds may be missing between two.
        usual_hz=1 / step.median(),
        average_hz=1 / step.filter(step < MAX_GAP_S).mean(),
    )
    is_near = (pl.col("usual_hz", "average_hz") / rate_hz - 1).abs() <= RATE_TOLERANCE
    runs = runs.with_columns(
        observed_hz=pl.coalesce("average_hz", "usual_hz", 0.0),
        has_rate=pl.any_horizontal(is_near.fill_null(value=False)),
    )
    defects: RunDefects = {}
    for found in runs.iter_rows(named=True):
        number = int(found["run"])
        if found["turn"] is not None:
            said = say("its times jump back by {seconds:.6g} s", seconds=found["back_s"])
            defects[number] = RunDefect("bad_time", said, found["turn"])
        elif not found["has_rate"]:
            text = say("it has {observed:.6g} samples per second by its times, and not {rate:.6g}")
            said = say(text, observed=found["observed_hz"], rate=rate_hz)
            defects[number] = RunDefect("bad_time", said, found["row"])
    is_other_rate = runs["turn"].is_null().all()
    if is_other_rate and len(defects) == runs.height:
        text = say(
            "run {run:g} has {observed:.6g} samples per second by its times; by the list or the "
            "profile it is {rate:.6g}. Correct 'meetfrequentie' in the tow list or, where that is "
            "empty, sample_rate_hz under [[profile]]; or units.time, where the times have another "
            "unit."
        )
        first = runs.row(0, named=True)
        said = say(text, run=first["run"], observed=first["observed_hz"], rate=rate_hz)
        line = line_of(first["row"])
        ask = (profile.ask("sample_rate_hz"), profile.ask("units.time"))
        raise DefectiveHeaderError("bad_time", say_at_line(line, said), line, ask)
    return defects


def _to_schema(raw: pl.DataFrame, wind_zero_deg: float) -> pl.DataFrame:
    """Return the frame of `SAMPLE_SCHEMA` from Float64 columns in SI units."""
    absent = [key for key in OUTPUT_NAMES if key not in raw.columns]
    raw = raw.with_columns(pl.lit(None, pl.Float64).alias(key) for key in absent)
    angle = pl.col("wind_angle")
    lowest, highest = raw["wind_angle"].min(), raw["wind_angle"].max()
    is_within = isinstance(lowest, float) and isinstance(highest, float)
    if wind_zero_deg or not (is_within and lowest >= 0 and highest < HIGHEST_ANGLE_DEG):  # type: ignore[operator]
        turned = ((angle - wind_zero_deg) % 360).cast(pl.Float32)
        turned = pl.when(turned == 360).then(0.0).otherwise(turned)
        wrapped = pl.when(angle.is_between(-180, 360)).then(turned).otherwise(angle)
        raw = raw.with_columns(wrapped.alias("wind_angle"))
    samples = raw.rename(OUTPUT_NAMES).select(SAMPLE_SCHEMA.keys()).cast(pl.Schema(SAMPLE_SCHEMA))
    # A number such as 1e39 is finite in 64 bits and not in 32.
    floats = pl.selectors.float()
    is_infinite = floats.is_infinite()
    if not samples.select(pl.any_horizontal(is_infinite.any())).item():
        return samples
    return samples.with_columns(pl.when(is_infinite).then(float("nan")).otherwise(floats))


def measure_steps(samples: pl.DataFrame) -> dict[str, float | None]:
    """Return in which steps GPS and force are written: the least difference between two readings.

    Coarse steps do no harm where readings are rounded, as the unrest of a run is larger. Nothing in
    the samples tells whether they were rounded or cut off, which makes all half a step too small.

    Returns:
        `gps_step_m_s` and `force_step_n`; None where a channel has too few values to tell.
    """
    steps: dict[str, float | None] = {}
    for name, channel in (
        ("gps_step_m_s", samples["gps_m_s"]),
        ("force_step_n", samples["force_n"]),
    ):
        values = channel.drop_nulls().to_numpy()[:: max(len(channel) // ENOUGH_FOR_STEPS, 1)]
        distinct = np.unique(values[np.isfinite(values)].astype(np.float64))
        is_enough = len(distinct) >= FEWEST_FOR_STEPS
        steps[name] = float(np.diff(distinct).min()) if is_enough else None
    return steps
