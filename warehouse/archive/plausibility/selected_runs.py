"""The selected runs of a tow: that they are there, last as planned, and are no copies."""

from itertools import pairwise
from typing import Final

import numpy as np
import polars as pl

from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.messages import say
from pipeline.tables.row import Row
from warehouse.archive.faults import Fault
from warehouse.archive.plausibility.left_out import LEFT_OUT_S
from warehouse.archive.plausibility.run import CHANNELS, Run, fault_of_all, path_of
from warehouse.archive.samples.frame import run_starts

SHORTEST_RUN_RATIO: Final = 0.99
LONGEST_RUN_RATIO: Final = 1.8
"""Shares of the planned time. A rate that is wrong is usually half of the right one (inferred)."""


def selected_runs(
    samples: pl.DataFrame, tow: Row, runs: pl.DataFrame, faults: list[Fault]
) -> list[Run]:
    """The selected runs that are there; each that is not leaves a fault."""
    number = samples["run"].to_numpy()
    bounds = [*run_starts(number).tolist(), len(number)]
    rows = {int(number[start]): (start, end) for start, end in pairwise(bounds)}
    channels = {
        key: samples[name].to_numpy()
        for key, name in CHANNELS.items()
        if samples[name].null_count() == 0
    }
    wanted = runs.filter((pl.col("tow_id") == tow["tow_id"]) & pl.col("selected"))
    selected = []
    for row in wanted.sort("run").iter_rows(named=True):
        if row["run"] not in rows:
            faults.append(_missing_run(row["run"], tow, sorted(rows)))
            continue
        start, end = rows[row["run"]]
        intended_m_s = tow["declared_speed_m_s"] * row["target_speed_ratio"]
        own = {key: values[start:end] for key, values in channels.items()}
        selected.append(Run(tow, row["run"], start, intended_m_s, row["planned_s"], own))
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
    return Fault(path_of(tow, run), tow["tow_id"], None, "missing_run", message, "run", run)


def lasts(run: Run, faults: list[Fault]) -> bool:
    """Whether a run is long enough; one that is too short leaves a fault."""
    if run.seconds >= SHORTEST_RUN_RATIO * run.planned_s:
        return True
    missing_s = run.planned_s - run.seconds
    what = say(
        "it lasts {:.2f} s at {} samples per second, {:.2f} s too short",
        run.seconds,
        run.rate_hz,
        missing_s,
    )
    is_lost = missing_s > LEFT_OUT_S
    faults.append(run.fault("short_run", what, "run" if is_lost else "seconds", 0, missing_s))
    return not is_lost


def check_not_long(runs: list[Run], faults: list[Fault]) -> None:
    """A fault that costs nothing where all runs last far longer than planned, as by a wrong rate.

    Windows, averages and what accelerated the boat are then taken over another time than is meant.
    """
    if not runs or any(run.seconds < LONGEST_RUN_RATIO * run.planned_s for run in runs):
        return
    first = runs[0]
    message = say(
        "All runs last {:.0f} s or longer at {} samples per second, and {:.0f} s is planned: is "
        "the rate {:.0f}? Nothing is left out.",
        min(run.seconds for run in runs),
        first.rate_hz,
        first.planned_s,
        first.rate_hz * first.seconds / first.planned_s,
    )
    faults.append(fault_of_all(runs, "long_run", message, 0.0))


def without_copies(runs: list[Run], faults: list[Fault]) -> list[Run]:
    """Of runs with exactly the same samples, the one at its intended speed is what was measured."""
    kept: dict[bytes, Run] = {}
    for run in sorted(runs, key=_off_target):
        content = run.channels["log1"].tobytes() + run.channels["force"].tobytes()
        is_unread = np.isnan([run.statistics[key].mean for key in ("log1", "force")]).all()
        other = kept.setdefault(bytes([run.number]) if is_unread else content, run)
        if other is not run:
            what = say("it has exactly the samples of {}", other.name.lower())
            faults.append(run.fault("samples_listed_twice", what, "run"))
    return sorted(kept.values(), key=lambda run: run.number)


def _off_target(run: Run) -> tuple[float, int]:
    ratio = run.statistics["log1"].median / run.intended_m_s
    return float(np.nan_to_num(abs(ratio - 1.0), nan=np.inf)), run.number
