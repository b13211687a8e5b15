"""The selected runs of a tow: that they are there, last long enough, and are no copies."""

from dataclasses import replace
from itertools import pairwise
from typing import Final

import numpy as np
import polars as pl

from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.messages import say
from pipeline.tables.row import Row
from warehouse.archive.faults import Fault, Lost
from warehouse.archive.plausibility.run import (
    CHANNELS,
    FIRST_ROW,
    LEFT_OUT_S,
    Run,
    median_of,
    what_then,
)
from warehouse.archive.samples.frame import run_starts

SHORTEST_RUN_RATIO: Final = 0.99
"""Share of the planned time."""
LONGEST_RUN_RATIO: Final = 1.8
"""The same: a rate that is wrong is usually half of the right one (inferred)."""


def measured(samples: pl.DataFrame) -> dict[str, str]:
    """The channels that were measured, with the names of their columns."""
    return {key: name for key, name in CHANNELS.items() if samples[name].null_count() == 0}


def selected_runs(
    samples: pl.DataFrame, tow: Row, runs: pl.DataFrame, faults: list[Fault]
) -> list[Run]:
    """The selected runs that are there; each that is not leaves a fault."""
    number = samples["run"].to_numpy()
    bounds = [*run_starts(number).tolist(), len(number)]
    rows = {int(number[start]): (start, end) for start, end in pairwise(bounds)}
    second_file = int(np.argmax(number > SECOND_FILE_OFFSET))
    channels = {key: samples[name].to_numpy() for key, name in measured(samples).items()}
    wanted = runs.filter((pl.col("tow_id") == tow["tow_id"]) & pl.col("selected"))
    selected = []
    for row in wanted.sort("run").iter_rows(named=True):
        if row["run"] not in rows:
            faults.append(_missing_run(row["run"], tow, sorted(rows)))
            continue
        start, end = rows[row["run"]]
        in_second = row["run"] > SECOND_FILE_OFFSET
        selected.append(
            Run(
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


def lasts(run: Run, faults: list[Fault]) -> bool:
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
        what_then(lost),
    )
    faults.append(run.fault("short_run", message, 0, lost, missing_s))
    return lost == "seconds"


def long_runs(runs: list[Run]) -> list[Fault]:
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


def without_copies(runs: list[Run], faults: list[Fault]) -> list[Run]:
    """Of runs with exactly the same samples, the one at its intended speed is what was measured."""
    kept: dict[bytes, Run] = {}
    for run in sorted(runs, key=_off_target):
        both = [run.channels[key] for key in ("log1", "force")]
        unread = not any(np.isfinite(channel).any() for channel in both)
        content = bytes([run.number]) if unread else b"".join(x.tobytes() for x in both)
        other = kept.setdefault(content, run)
        if other is not run:
            message = say(
                "{} has exactly the samples of {}; the run is left out.",
                run.name,
                other.name.lower(),
            )
            faults.append(run.fault("samples_listed_twice", message, 0, "run"))
    return sorted(kept.values(), key=lambda run: run.number)


def _off_target(run: Run) -> tuple[float, int]:
    speed = median_of(run.channels["log1"])
    return abs(speed / run.intended_m_s - 1.0) if np.isfinite(speed) else np.inf, run.number
