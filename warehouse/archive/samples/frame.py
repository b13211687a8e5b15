"""The one frame of samples that the project works with: its channels, its runs and their times."""

from collections.abc import Callable
from typing import Final

import numpy as np
import polars as pl
from numpy.typing import NDArray

from pipeline.channels import MOST_RUNS, SAMPLE_SCHEMA
from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from warehouse.archive.faults import at_line

OUTPUT_NAMES: Final = {
    "run": "run",
    "log1": "log1_m_s",
    "log2": "log2_m_s",
    "gps": "gps_m_s",
    "force": "force_n",
    "wind_speed": "wind_speed_m_s",
    "wind_angle": "wind_angle_deg",
}
TIME_TOLERANCE: Final = 0.01
PAUSE_S: Final = 10.0
"""After so long without a sample a new run begins, where nothing else says so."""

LineOf = Callable[[int], int]
"""The line in a file of a row of samples, counted from 0; of the header where it is negative."""


def with_runs(raw: pl.DataFrame, run: int | None) -> pl.DataFrame:
    """The samples with a run: that of the file, or a new one where the time restarts."""
    if run is not None:
        return raw.with_columns(pl.lit(float(run)).alias("run"))
    if "run" in raw.columns:
        return raw
    step = pl.col("time").diff()
    begins = ((step < 0) | (step >= PAUSE_S)).fill_null(value=False)
    if "time" not in raw.columns or not raw.select(begins.any()).item():
        said = say(
            "Nothing says which run a row is of: there is no column 'run', the time does not start "
            "again, and the file is not one of several that end in a number.",
            keys=("run",),
        )
        raise DefectiveInputError("missing_column", said, line=1)
    return raw.with_columns((begins.cum_sum() + 1).cast(pl.Float64).alias("run"))


def to_schema(raw: pl.DataFrame, line_of: LineOf, wind_zero_deg: float) -> pl.DataFrame:
    """The frame of `SAMPLE_SCHEMA` from Float64 columns in SI units."""
    if raw["run"].is_nan().any():
        raw = _with_known_runs(raw)
    _check_run_numbers(raw["run"], line_of)
    absent = (key for key in OUTPUT_NAMES if key not in raw.columns)
    raw = raw.with_columns(pl.lit(None, pl.Float64).alias(key) for key in absent)
    angle = pl.col("wind_angle")
    turned = (angle - wind_zero_deg) % 360
    wrapped = pl.when(angle.is_between(-180, 360)).then(turned).otherwise(angle)
    samples = raw.with_columns(wrapped).select(
        pl.col(key).cast(SAMPLE_SCHEMA[name]).alias(name) for key, name in OUTPUT_NAMES.items()
    )
    # 359.99999999 rounds to 360 in 32 bits; the promise is [0, 360).
    below = pl.when(pl.col("wind_angle_deg") == 360).then(0.0).otherwise(pl.col("wind_angle_deg"))
    samples = samples.with_columns(below.cast(pl.Float32()).alias("wind_angle_deg"))
    # A number such as 1e39 is finite in 64 bits and not in 32.
    floats = pl.selectors.float()
    finite = pl.when(floats.is_infinite()).then(float("nan")).otherwise(floats)
    return samples.with_columns(finite.name.keep())


def _with_known_runs(raw: pl.DataFrame) -> pl.DataFrame:
    """The samples with every row in a run: one whose run cannot be read holds no numbers."""
    unread = raw["run"].is_nan()
    run = raw["run"].fill_nan(None).forward_fill().backward_fill()
    if run.null_count():
        raise DefectiveInputError("unreadable_file", say("No row has a number in column 'run'."))
    others = pl.exclude("run", "time")
    return raw.with_columns(run, pl.when(unread).then(float("nan")).otherwise(others).name.keep())


def _check_run_numbers(run: pl.Series, line_of: LineOf) -> None:
    known = run.is_in([float(number) for number in range(1, MOST_RUNS + 1)])
    if not known.all():
        row = int((~known).arg_max() or 0)
        what = say(
            "run {run:g} does not exist; runs are numbered 1 to {last}.",
            run=run[row],
            last=MOST_RUNS,
        )
        raise _at(line_of(row), "unknown_run", what)


def _at(line: int, reason_code: str, what: str) -> DefectiveInputError:
    return DefectiveInputError(reason_code, at_line(line, what), line)


def check_runs(run: pl.Series, line_of: LineOf) -> None:
    """Every run must be one piece."""
    starts = run_starts(run.to_numpy())
    numbers = run.to_numpy()[starts]
    for position, number in enumerate(numbers):
        if number in numbers[:position]:
            what = say("run {run} begins again; its rows must be together.", run=int(number))
            raise _at(line_of(int(starts[position])), "split_run", what)


def run_starts(run: NDArray[np.int8]) -> NDArray[np.intp]:
    """The row at which each run begins."""
    return np.flatnonzero(np.concatenate(([True], run[1:] != run[:-1])))


def turned_back(run: pl.Series, time_s: NDArray[np.float64]) -> NDArray[np.int8]:
    """Runs within which the clock jumps back, where it does not in most."""
    number = run.to_numpy()
    back = (np.diff(time_s) <= 0) & (number[1:] == number[:-1])
    turned = np.unique(number[1:][back])
    return turned if 2 * len(turned) < run.n_unique() else turned[:0]


def without_runs(samples: pl.DataFrame, runs: NDArray[np.int8]) -> pl.DataFrame:
    """The samples without the numbers of some runs.

    Nothing says whether the clock was wrong there, or rows are there twice.
    """
    if not len(runs):
        return samples
    lost, channel = pl.col("run").is_in(runs.tolist()), pl.selectors.float()
    nothing = pl.when(channel.is_not_null()).then(float("nan"))
    return samples.with_columns(pl.when(lost).then(nothing).otherwise(channel).name.keep())


def check_time(
    run: pl.Series,
    time_s: NDArray[np.float64],
    rate_hz: int | None,
    line_of: LineOf,
    turned: NDArray[np.int8],
) -> None:
    """Every run's time must rise at the rate, but of those that turn back (`turned`)."""
    starts = run_starts(run.to_numpy())
    ends = np.append(starts[1:], len(run))
    step = np.diff(time_s)
    step[starts[1:] - 1] = np.inf
    step[np.isin(run.to_numpy()[1:], turned)] = np.inf
    if (step <= 0).any():
        what = say("the time does not increase within the run.")
        raise _at(line_of(int(np.argmax(step <= 0)) + 1), "bad_time", what)
    if rate_hz is None:
        return
    for start, end in zip(starts, ends, strict=True):
        samples = int(end - start)
        if samples < 2 or run[int(start)] in turned:
            continue
        # The usual step: a gap costs its seconds, which `plausibility` counts.
        observed = 1.0 / float(np.nanmedian(step[start : end - 1]))
        if abs(observed / rate_hz - 1) > TIME_TOLERANCE:
            said = say(
                "Run {run}: by its times it has {observed:g} samples per second, by the list or "
                "the profile {rate}; they may differ by {most:.0%}.",
                run=run[int(start)],
                observed=observed,
                rate=rate_hz,
                most=TIME_TOLERANCE,
            )
            raise DefectiveInputError("bad_time", said, line=line_of(int(start)))
