"""Looking through an archive before a rebuild: every fault, by cause, with what would mend it.

What a profile can settle is tried on the way: a proposed word or column is taken as given, so that
the faults behind it come out in the same round. Nothing is written. Judging every sample is the
rebuild's; here every header is read, and one tow of each season whole.
"""

import hashlib
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import polars as pl

from herijk.pipeline.channels import FEWEST_RUNS, MOST_RUNS, SECOND_FILE_OFFSET
from herijk.pipeline.errors import DefectiveInputError
from herijk.tables.frames import frame_of
from herijk.tables.lake import ListedTows
from herijk.tables.row import Row
from herijk.warehouse.archive.faults import Fault, fault_from
from herijk.warehouse.archive.files import (
    PARTS,
    ArchiveFile,
    as_one_run,
    kind_of,
    list_sample_files,
    path_inside,
)
from herijk.warehouse.archive.index import ArchiveIndex, index_archive, missing_lists, strangers
from herijk.warehouse.archive.plausibility import judge_in_files
from herijk.warehouse.archive.profile import (
    STANDARD,
    Profiles,
    SeasonProfile,
    parse_profiles,
    profile_text,
)
from herijk.warehouse.archive.proposals import Proposal, merged, propose
from herijk.warehouse.archive.published import read_published_registers, read_races
from herijk.warehouse.archive.samples import (
    TIME_TOLERANCE,
    check_header,
    columns_of_runs,
    rate_in_times,
    read_samples,
    read_tow_samples,
)
from herijk.warehouse.archive.text import split_header
from herijk.words import Sentence, innermost, say, spoken

ROUNDS: Final = 8
"""So often what was proposed is tried, at most."""

SHOWN: Final = 3
_PIECE: Final = 1 << 16


@dataclass(frozen=True)
class Cause:
    """One thing that is wrong, wherever it is.

    Attributes:
        reason_code: short stable code.
        faults: where, in order.
        proposals: what in `archief.toml` would settle it; empty where only a person can.
    """

    reason_code: str
    faults: tuple[Fault, ...]
    proposals: tuple[Proposal, ...]


@dataclass(frozen=True)
class Checked:
    """What a check found.

    Attributes:
        tows: tows that would be read as the archive is, or with the proposals.
        causes: what is wrong, the most frequent first.
        profile: `archief.toml` with the proposals; None where there are none.
    """

    tows: int
    causes: tuple[Cause, ...]
    profile: str | None


@dataclass(frozen=True)
class Place:
    """Where a fault is."""

    path: str
    line: int | None
    tow_id: str | None


@dataclass(frozen=True)
class CauseReport:
    """One thing that is wrong, as it is told.

    Attributes:
        reason_code: short stable code.
        number: of places.
        sentence: of the first of them.
        cells: what the cells say that have it.
        places: the first of them.
        proposals: the fields of each `Proposal`, with its `line`.
    """

    reason_code: str
    number: int
    sentence: str
    cells: list[str]
    places: list[Place]
    proposals: list[Row]


@dataclass(frozen=True)
class CheckReport:
    """A check in a language."""

    archive: str
    tows: int
    causes: list[CauseReport]
    profile: str | None


def check_archive(root: Path) -> Checked:
    """Look through an archive.

    Raises:
        MissingKnowledgeError: there is no archive, or `archief.toml` cannot be understood.
    """
    written = profile_text(root)
    text = written
    seen: dict[Fault, tuple[Proposal, ...]] = {}
    proposals: dict[Proposal, None] = {}
    for _ in range(ROUNDS):
        profiles = parse_profiles(text)
        index, faults = _faults(root, profiles)
        new: dict[Proposal, None] = {}
        for fault in faults:
            offered = propose(fault, profiles.wording.files, index.seasons if index else {})
            seen[fault] = seen.get(fault) or offered
            new |= dict.fromkeys(p for p in offered if p not in proposals)
        if not new:
            break
        proposals |= new
        text = merged(written, (replace(p, is_active=True) for p in proposals))
    tows = index.tows if index else frame_of(ListedTows, [])
    profile = merged(written, _doubted(proposals, seen.values(), tows)) if proposals else None
    return Checked(tows.height, _grouped(seen), profile)


def _doubted(
    proposals: Mapping[Proposal, None],
    seen: Iterable[Sequence[Proposal]],
    listed: pl.DataFrame,
) -> Iterator[Proposal]:
    """Give the proposals; what only some files of a season lack is not to be declared absent.

    A rate that the files say themselves leaves no question about it.
    """
    lacking = Counter(p for offered in seen for p in offered if p.section == "absent")
    named = {split_header(p.key)[0] for p in proposals if p.section == "headers"}
    known = {p.season for p in proposals if p.section == "sample_rate_hz" and p.is_active}
    for proposal in proposals:
        is_rate = proposal.section == "sample_rate_hz"
        if is_rate and not proposal.is_active and proposal.season in known:
            continue
        if proposal.section == "ignore" and split_header(proposal.value)[0] in named:
            continue  # another list has it
        tows = listed.filter(season=proposal.season).height
        is_sure = proposal.section != "absent" or lacking[proposal] >= tows
        yield replace(proposal, is_active=proposal.is_active and is_sure)


def _faults(root: Path, profiles: Profiles) -> tuple[ArchiveIndex | None, list[Fault]]:
    """Return the lists, and what is wrong in them, in headers and in a tow of each season.

    Files that nobody reads come first, and alone: they can be the lists.
    """
    unread = strangers(root, profiles)
    if any(propose(fault, profiles.wording.files, {}) for fault in unread):
        return None, unread
    lacking = missing_lists(root, profiles)
    if lacking:
        return None, lacking
    index = index_archive(root, quick_hash, profiles)
    _, in_races = read_races(root, profiles.wording)
    _, in_registers = read_published_registers(root, profiles.wording)
    unused = {fault.path for fault in index.faults if fault.reason_code == "samples_not_listed"}
    in_headers = list(_in_headers(root, index, unused))
    wrong = {fault.path for fault in in_headers}
    in_samples = list(_in_samples(root, index, wrong | unused))
    in_lists = [*index.faults, *index.more]
    return index, [*in_lists, *in_races, *in_registers, *in_headers, *in_samples]


def quick_hash(path: Path) -> str:
    """Return a hash of a file's size and ends: enough to find copies, and read in no time."""
    with path.open("rb") as file:
        start = file.read(_PIECE)
        size = path.stat().st_size
        file.seek(max(_PIECE, size - _PIECE))
        return hashlib.sha256(start + file.read(_PIECE) + str(size).encode()).hexdigest()


def _in_headers(root: Path, index: ArchiveIndex, unused: Collection[str]) -> Iterator[Fault]:
    """Read the header of every samples file, whatever is wrong with the row that names it.

    Files that lists which can be read do not name say nothing of their season.
    """
    for file in list_sample_files(root, index.profiles.wording.files):
        if file.path in unused:
            continue
        season = index.seasons.get(file.path, file.season)
        try:
            check_header(path_inside(root, file.path), index.profiles.for_season(season))
        except DefectiveInputError as error:
            yield fault_from(error, file.path)


def _in_samples(root: Path, index: ArchiveIndex, wrong: set[str]) -> Iterator[Fault]:
    """Read the first tow of each season and kind of file whose header is good.

    Where no tow of a season can be read, a file of it is read without judging its content.
    """
    done = set()
    rates: dict[int, float] = {}
    for tow in index.tows.iter_rows(named=True):
        paths = tow["samples_path"].split(PARTS)
        key = (tow["season"], kind_of(Path(paths[0])))
        if wrong.intersection(paths):
            continue
        profile = index.profiles.for_season(tow["season"])
        rate = rate_in_times(path_inside(root, paths[0]), profile)
        usual = rates.setdefault(tow["season"], rate) if rate else None
        if rate and usual and _differ(rate, usual) and _differ(rate, tow["sample_rate_hz"]):
            yield _rate_of_its_own(tow, rate)
            continue
        if key in done:
            continue
        done.add(key)
        try:
            samples = read_tow_samples(root, tow, profile)
            others = (_other_rate(samples, tow, index), _other_plan(samples, tow, index))
            of_all = [fault for fault in others if fault is not None]
            yield from of_all or judge_in_files(samples, tow, index.runs, root, profile).faults
        except DefectiveInputError as error:
            fault = fault_from(error, tow["samples_path"], tow["tow_id"])
            yield _with_columns_of_runs(fault, root, profile)
    for file in list_sample_files(root, index.profiles.wording.files):
        season = index.seasons.get(file.path, file.season)
        key = (season, kind_of(file.full_path))
        if key not in done and file.path not in wrong:
            done.add(key)
            yield from _in_form(root, file, index.profiles, season)


def _in_form(root: Path, file: ArchiveFile, profiles: Profiles, season: int) -> Iterator[Fault]:
    """Read a samples file that no sound row names, and look which runs are in it.

    Its rate is that of its times: what a list says that cannot be read yet is not known.
    """
    profile = profiles.for_season(season)
    named = as_one_run(file.full_path.name)
    path = path_inside(root, file.path)
    try:
        samples = read_samples(
            path,
            profile,
            sample_rate_hz=round(rate_in_times(path, profile) or profile.sample_rate_hz),
            run=named[1] if named else None,
        )
    except DefectiveInputError as error:
        yield _with_columns_of_runs(fault_from(error, file.path), root, profile)
        return
    planned = list(profiles.plan_of("", season).runs)
    in_file = _mean_speeds(samples)
    if season and named is None and in_file["run"].to_list() != planned:
        yield _not_planned(file.path, in_file, planned, in_file["log1_m_s"].mean())


def _differ(one: float, other: float) -> bool:
    return abs(one / other - 1) > TIME_TOLERANCE


def _rate_of_its_own(tow: Row, rate: float) -> Fault:
    """Return that a tow was sampled at another rate than the first of its season."""
    said = say(
        "By its times it has {own:g} samples per second, other than the first tow of its "
        "season: write that into the tow list, in a column 'meetfrequentie [Hz]'.",
        own=rate,
    )
    return Fault(tow["samples_path"], tow["tow_id"], None, "bad_time", said)


def _with_columns_of_runs(fault: Fault, root: Path, profile: SeasonProfile) -> Fault:
    """Return a fault with the columns that can be that of the runs, where only that is missing."""
    what = innermost(fault.message)
    if not isinstance(what, Sentence) or what.values.get("keys") != ("run",):
        return fault
    columns = columns_of_runs(path_inside(root, fault.path), profile)
    return replace(fault, message=say(what.template, **{**what.values, "header": columns}))


def _other_rate(samples: pl.DataFrame, tow: Row, index: ArchiveIndex) -> Fault | None:
    """Return that the rate cannot be right: at it all runs last half as long as planned, or less.

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
    """Return that the file has other runs than are planned, with what their targets can be."""
    in_file = _mean_speeds(samples)
    runs = index.runs.filter(tow_id=tow["tow_id"])
    present = set(in_file["run"])
    lacking = set(runs.filter("selected")["run"]) - present
    if not (lacking or present - set(runs["run"])):
        return None
    first = pl.col("run") < SECOND_FILE_OFFSET
    planned, speed = runs.filter(first)["run"], tow["declared_speed_m_s"]
    in_two = tow["second_path"] is not None
    lasts = float(in_file["rows"].min() or 0) / tow["sample_rate_hz"]  # type: ignore[arg-type]
    return _not_planned(tow["samples_path"], in_file.filter(first), planned, speed, in_two, lasts)


def _mean_speeds(samples: pl.DataFrame) -> pl.DataFrame:
    return (
        samples.group_by("run", maintain_order=True)
        .agg(pl.col("log1_m_s").mean(), rows=pl.len())
        .sort("run")
    )


def _not_planned(
    path: str,
    in_file: pl.DataFrame,
    planned: Iterable[int],
    speed: object,
    in_two: bool = False,
    lasts: float = STANDARD.seconds,
) -> Fault:
    """The fault of other runs than are planned.

    Args:
        path: the file.
        in_file: its runs and their speeds.
        planned: runs of one file.
        speed: that of a target of 1.
        in_two: the tow has a second file.
        lasts: seconds of the shortest run.
    """
    present = in_file["run"].to_list()
    ratios = in_file["log1_m_s"] / speed
    said = say(
        "Runs {present} are in the file and runs {planned} are planned. Give the targets and "
        "directions of all runs under [[plan]] in archief.toml.",
        present=", ".join(map(str, present)),
        planned=", ".join(map(str, planned)),
        targets=tuple(round(20 * ratio) / 20 for ratio in ratios) if is_plan(present) else (),
        in_two=in_two,
        seconds=int(lasts),
    )
    return Fault(path, None, None, "run_not_planned", said)


def is_plan(runs: Sequence[int]) -> bool:
    """Whether these can be all the runs of a plan: 1, 2, 3 and on."""
    return FEWEST_RUNS <= len(runs) <= MOST_RUNS and list(runs) == list(range(1, len(runs) + 1))


def _grouped(seen: Mapping[Fault, Sequence[Proposal]]) -> tuple[Cause, ...]:
    """Return the faults by cause, those with most first."""
    by_cause: dict[tuple[str, str], list[Fault]] = {}
    for fault in seen:
        by_cause.setdefault((fault.reason_code, fault.cause), []).append(fault)
    causes = (
        Cause(code, tuple(faults), tuple(dict.fromkeys(p for f in faults for p in seen[f])))
        for (code, _), faults in by_cause.items()
    )
    return tuple(sorted(causes, key=lambda cause: -len(cause.faults)))


def check_report(root: Path, checked: Checked, language: str) -> CheckReport:
    """Return a check of an archive with its sentences in `en` or `nl`."""
    causes = [_cause_report(cause, language) for cause in checked.causes]
    return CheckReport(str(root), checked.tows, causes, checked.profile)


def _cause_report(cause: Cause, language: str) -> CauseReport:
    first = innermost(cause.faults[0].message)
    cells = [getattr(innermost(f.message), "values", {}).get("cell") for f in cause.faults]
    return CauseReport(
        reason_code=cause.reason_code,
        number=len(cause.faults),
        sentence=spoken(first, language),
        cells=[str(cell) for cell in dict.fromkeys(cells) if cell is not None],
        places=[Place(f.path, f.line, f.tow_id) for f in cause.faults[:SHOWN]],
        proposals=[vars(p) | {"line": p.line} for p in cause.proposals],
    )
