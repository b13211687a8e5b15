"""Judging the samples of a tow, one thing after the other."""

from dataclasses import dataclass, replace
from pathlib import Path

import polars as pl

from pipeline.tables.row import Row
from warehouse.archive.faults import DefectiveFileError, Fault
from warehouse.archive.plausibility.left_out import judge_run, usual_resistance_kg_m
from warehouse.archive.plausibility.mix_ups import (
    check_mix_ups,
    without_other_units,
    without_wind,
)
from warehouse.archive.plausibility.rules import without_stuck_gps
from warehouse.archive.plausibility.run import CHANNELS, FIRST_ROW, Run
from warehouse.archive.plausibility.selected_runs import (
    check_not_long,
    lasts,
    selected_runs,
    without_copies,
)
from warehouse.archive.profile.season import SeasonProfile
from warehouse.archive.samples.tow import place_in_file


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
        return place_in_file(root, tow, profile, samples["run"], line - FIRST_ROW)

    try:
        judged = judge_samples(samples, tow, runs)
    except DefectiveFileError as error:
        path, line = place(error.path, error.line)
        raise DefectiveFileError(error.reason_code, error.message, line, path) from error
    placed = ((fault, place(fault.path, fault.line)) for fault in judged.faults)
    faults = tuple(replace(fault, path=path, line=line) for fault, (path, line) in placed)
    return replace(judged, faults=faults)


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
    selected = selected_runs(samples, tow, runs, faults)
    number = len(selected) + len(faults)
    whole = [run for run in selected if lasts(run, faults)]
    check_not_long(whole, faults)
    whole = without_copies(whole, faults)
    _check_left(whole, number, faults)
    whole = without_wind(whole, faults)
    whole, gone = without_other_units(whole, faults)
    check_mix_ups(whole)
    usual_kg_m = usual_resistance_kg_m(whole)
    judged = (judge_run(run, usual_kg_m, gone, faults) for run in whole)
    kept = without_stuck_gps([run for run in judged if run is not None], faults)
    _check_left(kept, number, faults)
    return Judged(_with_changes(samples, kept, faults), tuple(faults))


def _check_left(kept: list[Run], selected: int, faults: list[Fault]) -> None:
    """A tow of which half of the runs or more are lost is lost itself, for the first reason."""
    if 2 * len(kept) > selected:
        return
    first = next(fault for fault in faults if fault.lost == "run")
    raise DefectiveFileError(first.reason_code, first.message, first.line, first.path)


def _with_changes(samples: pl.DataFrame, kept: list[Run], faults: list[Fault]) -> pl.DataFrame:
    """The samples without lost runs, with NaN where a sample of the others was left out."""
    if not faults:
        return samples
    changed = []
    for key, name in CHANNELS.items():
        if key not in kept[0].channels:
            changed.append(pl.Series(name, [None] * len(samples), pl.Float32))
            continue
        values = samples[name].to_numpy().copy()
        for run in kept:
            own = run.channels[key]
            values[run.start : run.start + len(own)] = own
        changed.append(pl.Series(name, values))
    lost = pl.col("run").is_in([fault.run for fault in faults if fault.lost == "run"])
    return samples.with_columns(changed).filter(~lost)
