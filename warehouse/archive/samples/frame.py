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
ENOUGH_FOR_STEPS: Final = 10_000
"""Samples that are enough to see in which steps a channel is written."""
FEWEST_FOR_STEPS: Final = 3
"""Values that differ."""

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
    again = starts[(~run.gather(starts).is_first_distinct()).to_numpy()]
    if len(again):
        first = int(again[0])
        what = say("run {run} begins again; its rows must be together.", run=run[first])
        raise _at(line_of(first), "split_run", what)


def run_starts(run: NDArray[np.int8]) -> NDArray[np.intp]:
    """The row at which each run begins."""
    return np.flatnonzero(np.concatenate(([True], run[1:] != run[:-1])))


def with_checked_times(
    samples: pl.DataFrame, time_s: pl.Series, rate_hz: int | None, line_of: LineOf
) -> pl.DataFrame:
    """The samples without the numbers of runs in which the clock jumps back, where most do not.

    The usual step of every other run must be that of the rate; a gap costs its seconds elsewhere.
    Nothing says whether the clock was wrong there, or rows are there twice.

    Raises:
        DefectiveInputError: `bad_time`, where the time does not rise in half of the runs or more,
            or in one of the others at another rate.
    """
    step_s = pl.col("time").diff()
    stops = pl.col("row").filter(step_s <= 0)
    usual_s = step_s.fill_nan(None).median()
    runs = (
        pl.DataFrame({"run": samples["run"], "time": time_s})
        .with_row_index("row")
        .group_by("run", maintain_order=True)
        .agg(pl.col("row").first(), stop=stops.first(), hz=1 / usual_s)
    )
    turned = runs.drop_nulls("stop")
    if turned.height and 2 * turned.height >= runs.height:
        what = say("the time does not increase within the run.")
        raise _at(line_of(turned["stop"][0]), "bad_time", what)
    others = runs.filter(pl.col("stop").is_null())
    off = others.filter((pl.col("hz") / (rate_hz or pl.col("hz")) - 1).abs() > TIME_TOLERANCE)
    for run, row, _, hz in off.rows():
        said = say(
            "Run {run}: by its times it has {observed:g} samples per second, by the list or "
            "the profile {rate}; they may differ by {most:.0%}.",
            run=run,
            observed=hz,
            rate=rate_hz,
            most=TIME_TOLERANCE,
        )
        raise DefectiveInputError("bad_time", said, line=line_of(row))
    if turned.is_empty():
        return samples
    channel = pl.selectors.float()
    nothing = pl.when(channel.is_not_null()).then(float("nan"))
    is_turned = pl.col("run").is_in(turned["run"].implode())
    return samples.with_columns(pl.when(is_turned).then(nothing).otherwise(channel).name.keep())


def steps_of(samples: pl.DataFrame) -> dict[str, float | None]:
    """In which steps readings are written: the least difference between two of GPS and of force.

    Coarse steps do no harm where readings are rounded, as the unrest of a run is larger. Nothing in
    the samples tells whether they were rounded or cut off, which makes all half a step too small.

    Returns:
        `gps_step_m_s` and `force_step_n`; None where a channel has too few values to tell.
    """
    names = {"gps_step_m_s": "gps_m_s", "force_step_n": "force_n"}
    return {step: _least_step(samples[name]) for step, name in names.items()}


def _least_step(channel: pl.Series) -> float | None:
    values = channel.drop_nulls().to_numpy()[:: max(len(channel) // ENOUGH_FOR_STEPS, 1)]
    distinct = np.unique(values[np.isfinite(values)].astype(np.float64))
    return float(np.diff(distinct).min()) if len(distinct) >= FEWEST_FOR_STEPS else None
