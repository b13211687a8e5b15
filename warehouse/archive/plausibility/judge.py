"""Judging the samples of a tow, one thing after the other."""

from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np
import polars as pl

from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.messages import say
from pipeline.tables.row import Row
from warehouse.archive.faults import Fault
from warehouse.archive.plausibility.judgement import CHANNELS, Cost, Judgement, Run
from warehouse.archive.plausibility.left_out import LEFT_OUT_S, leave_out, usual_resistance_kg_m
from warehouse.archive.plausibility.mix_ups import (
    check_mix_ups,
    leave_out_no_wind,
    leave_out_other_units,
)
from warehouse.archive.plausibility.rules import apply_rules, leave_out_stuck_gps
from warehouse.archive.samples.frame import run_starts
from warehouse.archive.samples.tow import Place

SHORTEST_RUN_RATIO: Final = 0.99
LONGEST_RUN_RATIO: Final = 1.8
"""Shares of the planned time. A rate that is wrong is usually half of the right one (inferred)."""


class Judged(NamedTuple):
    """What is left of a tow's samples.

    Attributes:
        samples: the given frame without the runs that are lost, NaN where a sample is left out.
        faults: what was lost: seconds and runs, in the order of the runs.
    """

    samples: pl.DataFrame
    faults: list[Fault]


def judge_samples(samples: pl.DataFrame, place: Place, tow: Row, runs: pl.DataFrame) -> Judged:
    """What of the selected runs of a tow can be used; runs that are not selected stay as they are.

    Args:
        samples: frame of `SAMPLE_SCHEMA`, as `read_tow_samples` returns it.
        place: where its rows stand.
        tow: a row of `ArchiveIndex.tows`.
        runs: `ArchiveIndex.runs`; rows of other tows are ignored.

    Raises:
        DefectiveFileError: the tow is lost: the most specific cause comes first.
    """
    judgement = Judgement(tow, place)
    _select_runs(judgement, samples, runs)
    _check_length(judgement)
    _leave_out_copies(judgement)
    judgement.check_left()
    leave_out_no_wind(judgement)
    leave_out_other_units(judgement)
    check_mix_ups(judgement)
    usual_kg_m = usual_resistance_kg_m(judgement.runs)
    for run in judgement.runs:
        leave_out(judgement, run, usual_kg_m)
        if run in judgement.runs:
            apply_rules(judgement, run)
    leave_out_stuck_gps(judgement)
    judgement.check_left()
    return Judged(_as_judged(samples, judgement), judgement.faults)


def _select_runs(judgement: Judgement, samples: pl.DataFrame, runs: pl.DataFrame) -> None:
    """Finds the selected runs; each that is not there leaves a fault."""
    tow, number = judgement.tow, samples["run"].to_numpy()
    bounds = [*run_starts(number).tolist(), len(number)]
    rows = {int(number[start]): slice(start, end) for start, end in pairwise(bounds)}
    channels = {
        key: samples[name].to_numpy()
        for key, name in CHANNELS.items()
        if samples[name].null_count() == 0
    }
    selected = runs.filter((pl.col("tow_id") == tow["tow_id"]) & pl.col("selected")).sort("run")
    judgement.wanted = selected.height
    for run, planned_s, ratio in selected["run", "planned_s", "target_speed_ratio"].iter_rows():
        if run not in rows:
            judgement.faults.append(_missing_run(run, tow, sorted(rows)))
            continue
        own = {key: values[rows[run]] for key, values in channels.items()}
        intended_m_s = tow["declared_speed_m_s"] * ratio
        facts = rows[run].start, tow["sample_rate_hz"], intended_m_s, planned_s, own
        judgement.runs.append(Run(run, *facts))


def _missing_run(run: int, tow: Row, present: list[int]) -> Fault:
    in_second = run > SECOND_FILE_OFFSET
    offset = SECOND_FILE_OFFSET if in_second else 0
    there = [str(n - offset) for n in present if (n > SECOND_FILE_OFFSET) == in_second]
    message = say(
        "Run {} is to be used but is not in the file; it holds runs {}.",
        run - offset,
        ", ".join(there),
    )
    path = tow["second_path" if in_second else "samples_path"]
    return Fault(path, tow["tow_id"], None, "missing_run", message, "run", run)


def _check_length(judgement: Judgement) -> None:
    """Takes the runs that are too short; says it where all last far longer than planned.

    That costs nothing: by a wrong rate, windows, averages and what accelerated the boat are taken
    over another time than is meant.
    """
    for run in judgement.runs:
        missing_s = run.planned_s - run.seconds
        if run.seconds < SHORTEST_RUN_RATIO * run.planned_s:
            what = say(
                "it lasts {:.2f} s at {} samples per second, {:.2f} s too short",
                run.seconds,
                run.rate_hz,
                missing_s,
            )
            cost: Cost = "run" if missing_s > LEFT_OUT_S else "seconds"
            judgement.lose(run, "short_run", what, cost, 0, missing_s)
    runs = judgement.runs
    if runs and all(run.seconds >= LONGEST_RUN_RATIO * run.planned_s for run in runs):
        message = say(
            "All runs last {:.0f} s or longer at {} samples per second, and {:.0f} s is planned: "
            "is the rate {:.0f}? Nothing is left out.",
            min(run.seconds for run in runs),
            runs[0].rate_hz,
            runs[0].planned_s,
            runs[0].rate_hz * runs[0].seconds / runs[0].planned_s,
        )
        judgement.lose_of_all("long_run", message)


def _leave_out_copies(judgement: Judgement) -> None:
    """Of runs with exactly the same samples, the one at its intended speed is what was measured."""
    first: dict[bytes, Run] = {}
    for run in sorted(judgement.runs, key=_off_target):
        content = run.channels["log1"].tobytes() + run.channels["force"].tobytes()
        is_unread = np.isnan([run.measured[key].lowest for key in ("log1", "force")]).all()
        other = first.setdefault(bytes([run.number]) if is_unread else content, run)
        if other is not run:
            what = say("it has exactly the samples of {}", other.name.lower())
            judgement.lose(run, "samples_listed_twice", what, "run")


def _off_target(run: Run) -> tuple[float, int]:
    ratio = run.measured["log1"].median / run.intended_m_s
    return float(np.nan_to_num(abs(ratio - 1.0), nan=np.inf)), run.number


def _as_judged(samples: pl.DataFrame, judgement: Judgement) -> pl.DataFrame:
    """The samples without lost runs, NaN where one is left out, null in channels of no run."""
    if not judgement.faults:
        return samples
    changed = []
    for key, name in CHANNELS.items():
        values = samples[name].to_numpy().copy()
        for run in judgement.runs:
            if key in run.channels:
                values[run.start : run.start + len(run.channels[key])] = run.channels[key]
        is_there = key in judgement.runs[0].channels
        changed.append(pl.Series(name, values if is_there else [None] * len(samples), pl.Float32))
    lost = [fault.run for fault in judgement.faults if fault.lost == "run"]
    return samples.with_columns(changed).filter(~pl.col("run").is_in(lost))
