"""What a look into the samples files shows: every header, and one tow of each season whole."""

from collections.abc import Collection, Iterable, Iterator
from pathlib import Path

import polars as pl

from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from pipeline.tables.row import Row
from warehouse.archive.faults import Fault, fault_from
from warehouse.archive.files.finding import ArchiveFile, files_of, path_inside
from warehouse.archive.files.names import PARTS, SAMPLES, as_one_run, kind_of, split_sheet
from warehouse.archive.index.index import ArchiveIndex
from warehouse.archive.plausibility.judge import judge_samples
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.samples.file import check_header, read_samples
from warehouse.archive.samples.tow import read_tow_samples


def faults_in_headers(root: Path, index: ArchiveIndex, unused: Collection[str]) -> Iterator[Fault]:
    """Reads the header of every samples file, whatever is wrong with the row that names it.

    Files that lists which can be read do not name say nothing of their season.
    """
    for file in _sample_files(root, index.profiles):
        if file.path in unused:
            continue
        sheets = [path for path in index.seasons if split_sheet(path)[0] == file.path]
        for path in sheets or [file.path]:
            season = index.seasons.get(path, file.season)
            try:
                check_header(path_inside(root, path), index.profiles.for_season(season))
            except DefectiveInputError as error:
                yield fault_from(error, path)


def _sample_files(root: Path, profiles: Profiles) -> list[ArchiveFile]:
    return [file for file in files_of(root, profiles.files) if file.kind == SAMPLES]


def faults_in_samples(root: Path, index: ArchiveIndex, wrong: set[str]) -> Iterator[Fault]:
    """Reads the first tow of each season and kind of file whose header is good.

    Where no tow of a season can be read, a file of it is read without judging its content.
    """
    done = set()
    for tow in index.tows.iter_rows(named=True):
        paths = tow["samples_path"].split(PARTS)
        key = (tow["season"], kind_of(Path(paths[0])))
        if key in done or wrong.intersection(paths):
            continue
        done.add(key)
        profile = index.profiles.for_season(tow["season"])
        try:
            samples, place = read_tow_samples(root, tow, profile)
            others = (_other_rate(samples, tow, index), _other_plan(samples, tow, index))
            of_all = [fault for fault in others if fault is not None]
            yield from of_all or judge_samples(samples, place, tow, index.runs).faults
        except DefectiveInputError as error:
            yield fault_from(error, tow["samples_path"], tow["tow_id"])
    for file in _sample_files(root, index.profiles):
        season = index.seasons.get(file.path, file.season)
        key = (season, kind_of(file.full_path))
        if key not in done and file.path not in wrong:
            done.add(key)
            yield from _in_form(root, file, index.profiles, season)


def _in_form(root: Path, file: ArchiveFile, profiles: Profiles, season: int) -> Iterator[Fault]:
    """Reads a samples file that no sound row names, and looks which runs are in it.

    What a list says of its rate cannot be read yet, so its times need agree with none.
    """
    named = as_one_run(file.full_path.name)
    path = path_inside(root, file.path)
    try:
        samples, _ = read_samples(
            path, profiles.for_season(season), run=named[1] if named else None
        )
    except DefectiveInputError as error:
        yield fault_from(error, file.path)
        return
    planned = list(profiles.plan_of("", season).runs)
    if season and named is None and samples["run"].unique().sort().to_list() != planned:
        yield _not_planned(file.path, samples, planned)


def _other_rate(samples: pl.DataFrame, tow: Row, index: ArchiveIndex) -> Fault | None:
    """That the rate cannot be right: at it all runs last half as long as planned, or less.

    Files with times say their rate themselves.
    """
    planned = index.runs.filter(tow_id=tow["tow_id"])["planned_s"].max()
    assert isinstance(planned, float)  # noqa: S101 - a tow has runs
    rate = tow["sample_rate_hz"]
    lasts = float(samples.group_by("run", maintain_order=True).len()["len"].max() or 0) / rate  # type: ignore[arg-type]
    if lasts >= planned / 2:
        return None
    said = say(
        "No run lasts longer than {lasts:.1f} s at {rate} samples a second, and {planned:.0f} s is "
        "planned: is the rate {observed:.0f}?",
        lasts=lasts,
        rate=rate,
        planned=planned,
        observed=float(f"{rate * lasts / planned:.1g}"),
    )
    return Fault(tow["samples_path"], tow["tow_id"], None, "short_run", said)


def _other_plan(samples: pl.DataFrame, tow: Row, index: ArchiveIndex) -> Fault | None:
    """That the file has other runs than are planned."""
    runs, present = index.runs.filter(tow_id=tow["tow_id"]), set(samples["run"])
    lacking = set(runs.filter("selected")["run"]) - present
    if not (lacking or present - set(runs["run"])):
        return None
    first = pl.col("run") < SECOND_FILE_OFFSET
    return _not_planned(tow["samples_path"], samples.filter(first), runs.filter(first)["run"])


def _not_planned(path: str, samples: pl.DataFrame, planned: Iterable[int]) -> Fault:
    """The fault of other runs in a file than are planned."""
    said = say(
        "Runs {present} are in the file and runs {planned} are planned. Give the targets and "
        "directions of all runs under [[plan]] in archief.toml.",
        present=", ".join(map(str, samples["run"].unique().sort())),
        planned=", ".join(map(str, planned)),
    )
    return Fault(path, None, None, "run_not_planned", said)
