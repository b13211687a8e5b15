"""Looking through an archive before a rebuild: what is wrong, by cause, and what to do.

Nothing is written. Judging every sample is the rebuild's; here every header is read, and one tow of
each season whole.
"""

import hashlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import polars as pl

from pipeline.messages import find_innermost, say, write_in_language
from pipeline.tables.row import Row
from warehouse.archive.faults import OF_A_HEADER, Fault, make_fault
from warehouse.archive.files import PARTS, SAMPLES, list_files
from warehouse.archive.index import ArchiveIndex, index_archive
from warehouse.archive.list_rules import read_published_registers, read_races
from warehouse.archive.plausibility import judge_samples
from warehouse.archive.profile import read_profiles
from warehouse.archive.remedies import REMEDIES
from warehouse.archive.sample_files import check_header
from warehouse.archive.samples import read_tow_samples

SHOWN: Final = 3
"""Places of one cause."""
_PIECE: Final = 1 << 16


@dataclass(frozen=True)
class Place:
    """Where a fault is."""

    path: str
    line: int | None
    tow_id: str | None


@dataclass(frozen=True)
class CauseReport:
    """One thing that is wrong, wherever it is.

    Attributes:
        reason_code: short stable code.
        number: of places.
        tows: tows that cannot be used because of it, as far as is known before a rebuild.
        sentence: of the first of them.
        remedy: what to do.
        cells: what the cells say that have it.
        places: the first of them.
        ask: lines of `archief.toml` that would settle it, with `?` for the answer, each below the
            lines of its heading.
    """

    reason_code: str
    number: int
    tows: int
    sentence: str
    remedy: str
    cells: list[str]
    places: list[Place]
    ask: list[str]


@dataclass(frozen=True)
class CheckReport:
    """What a check found, in a language.

    Attributes:
        archive: its folder.
        tows: tows in which nothing was found that costs them; most samples are judged by the
            rebuild only.
        causes: what is wrong, what costs most tows first.
    """

    archive: str
    tows: int
    causes: list[CauseReport]


def check_archive(root: Path, language: str = "en") -> CheckReport:
    """Look through an archive, and say what is wrong in `en` or `nl`.

    Raises:
        MissingKnowledgeError: there is no archive, or `archief.toml` cannot be understood.
    """
    profiles = read_profiles(root)
    index = index_archive(root, _hash_ends, profiles)
    _, race_faults = read_races(root, profiles)
    _, register_faults = read_published_registers(root, profiles)
    header_faults = list(_check_headers(root, index))
    faults = list(index.faults) + race_faults + register_faults + header_faults
    faults += _check_first_tows(root, index, {fault.path for fault in header_faults})
    names_of = {tow["tow_id"]: _name_tow(tow) for tow in index.tows.iter_rows(named=True)}
    costly = {fault.tow_id or fault.path for fault in faults if fault.lost is None}
    n_sound = sum(costly.isdisjoint(names) for names in names_of.values())
    return CheckReport(str(root), n_sound, _report_causes(faults, names_of, language))


def _name_tow(tow: Row) -> set[str]:
    """Return the id and the files of a tow."""
    names = {tow["tow_id"]}
    for path in (tow["samples_path"], tow["second_path"]):
        if path:
            names.update(path.split(PARTS))
    return names


def _hash_ends(path: Path) -> str:
    """Return a hash of a file's size and ends: enough to find copies, and read in no time."""
    with path.open("rb") as file:
        start = file.read(_PIECE)
        size = path.stat().st_size
        file.seek(max(_PIECE, size - _PIECE))
        return hashlib.sha256(start + file.read(_PIECE) + str(size).encode()).hexdigest()


def _check_headers(root: Path, index: ArchiveIndex) -> Iterator[Fault]:
    """Read the header of every samples file that a list names; yield what is wrong in it."""
    not_listed = {f.path for f in index.faults if f.reason_code == "samples_not_listed"}
    of_one_run: set[str] = set()
    for paths in index.tows.filter(pl.col("samples_runs").is_not_null())["samples_path"]:
        of_one_run.update(paths.split(PARTS))
    for paths in index.tows.filter(pl.col("second_runs").is_not_null())["second_path"]:
        of_one_run.update(paths.split(PARTS))
    for file in list_files(root, index.profiles):
        if file.kind != SAMPLES or not file.inside or file.path in not_listed:
            continue
        profile = index.profiles.find(file.season)
        if file.path in of_one_run or profile.runs != "column":
            profile = profile.make_run_optional()
        try:
            check_header(file.full_path, profile)
        except BaseException as error:
            yield make_fault(error, file.path)


def _check_first_tows(root: Path, index: ArchiveIndex, wrong: set[str]) -> Iterator[Fault]:
    """Read the first tow of each season whose header is good; yield what is wrong in it."""
    done = set()
    for tow in index.tows.iter_rows(named=True):
        season, tow_id = tow["season"], tow["tow_id"]
        if season in done or not wrong.isdisjoint(_name_tow(tow)):
            continue
        done.add(season)
        try:
            samples, place, defects = read_tow_samples(root, tow, index.profiles.find(season))
            present = samples["run"].unique().sort()
            planned = index.runs.filter(tow_id=tow_id)["run"]
            if not set(present) <= set(planned):
                heading = f'[[plan]]\nseasons = "{season}"\n'
                yield Fault(
                    path=tow["samples_path"].split(PARTS)[0],
                    reason_code="run_not_planned",
                    message=say(
                        "Runs {present} are in the file and runs {planned} are planned. Give the "
                        "targets and directions of all runs under [[plan]] in archief.toml.",
                        present=", ".join(map(str, present)),
                        planned=", ".join(map(str, planned)),
                    ),
                    ask=(heading + 'targets = ["?"]', heading + 'directions = ["?"]'),
                )
            yield from judge_samples(samples, place, tow, index.runs, defects).faults
        except BaseException as error:
            yield make_fault(error, tow["samples_path"], tow_id)


def _report_causes(
    faults: Iterable[Fault], names_of: Mapping[str, set[str]], language: str
) -> list[CauseReport]:
    """Return a report of each cause, those that cost most tows first."""
    by_cause: dict[tuple[str, str], list[Fault]] = {}
    for fault in dict.fromkeys(faults):
        by_cause.setdefault((fault.reason_code, fault.cause), []).append(fault)
    reports = []
    for (reason_code, _), same in by_cause.items():
        cells: list[str] = []
        ask: list[str] = []
        for fault in same:
            cell = getattr(find_innermost(fault.message), "values", {}).get("cell")
            if cell is not None:
                cells.append(str(cell))
            ask += fault.ask
        report = CauseReport(
            reason_code=reason_code,
            number=len(same),
            tows=_count_tows(same, names_of),
            sentence=write_in_language(find_innermost(same[0].message), language),
            remedy=write_in_language(REMEDIES[reason_code], language),
            cells=list(dict.fromkeys(cells)),
            places=[Place(fault.path, fault.line, fault.tow_id) for fault in same[:SHOWN]],
            ask=list(dict.fromkeys(ask)),
        )
        reports.append(report)
    return sorted(reports, key=lambda report: (-report.tows, -report.number))


def _count_tows(faults: Iterable[Fault], names_of: Mapping[str, set[str]]) -> int:
    """Return how many tows these faults cost, as far as is known before a rebuild."""
    tow_ids: set[str] = set()
    paths: set[str] = set()
    for fault in faults:
        if fault.lost is not None:
            continue
        if fault.tow_id:
            tow_ids.add(fault.tow_id)
        is_about_file = not fault.tow_id and fault.line is None
        if is_about_file or fault.reason_code in OF_A_HEADER:
            paths.add(fault.path)
    for tow_id, names in names_of.items():
        if not paths.isdisjoint(names):
            tow_ids.add(tow_id)
    return len(tow_ids)
