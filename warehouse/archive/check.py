"""Looking through an archive before a rebuild: what is wrong, by cause, and what to do.

Nothing is written. Judging every sample is the rebuild's; here every header is read, and one tow of
each season whole.
"""

import hashlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import polars as pl

from pipeline.messages import innermost, say, spoken
from pipeline.tables.row import Row
from warehouse.archive.faults import OF_A_HEADER, Fault, fault_from
from warehouse.archive.files import PARTS, SAMPLES, list_files
from warehouse.archive.index import ArchiveIndex, index_archive
from warehouse.archive.list_rules import read_published_registers, read_races
from warehouse.archive.plausibility import judge_samples
from warehouse.archive.profile import read_profiles
from warehouse.archive.remedies import REMEDIES
from warehouse.archive.samples import check_header, read_tow_samples

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
    faults = list(index.faults)
    for _, found in (read_races(root, profiles), read_published_registers(root, profiles)):
        faults += found
    of_headers = list(_faults_in_headers(root, index))
    wrong = {fault.path for fault in of_headers}
    faults += [*of_headers, *_faults_in_samples(root, index, wrong)]
    names_of = {tow["tow_id"]: _name_tow(tow) for tow in index.tows.iter_rows(named=True)}
    costly = {fault.tow_id or fault.path for fault in faults if fault.lost is None}
    sound = [tow_id for tow_id, names in names_of.items() if costly.isdisjoint(names)]
    return CheckReport(str(root), len(sound), _group_causes(faults, names_of, language))


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


def _faults_in_headers(root: Path, index: ArchiveIndex) -> Iterator[Fault]:
    """Read the header of every samples file that a list names."""
    not_listed = {f.path for f in index.faults if f.reason_code == "samples_not_listed"}
    of_one_run: set[str] = set()
    for name, numbers in (("samples_path", "samples_runs"), ("second_path", "second_runs")):
        for path in index.tows.filter(pl.col(numbers).is_not_null())[name]:
            of_one_run.update(path.split(PARTS))
    for file in list_files(root):
        if file.kind != SAMPLES or not file.inside or file.path in not_listed:
            continue
        profile = index.profiles.find(file.season)
        if file.path in of_one_run or profile.runs != "column":
            profile = profile.make_run_optional()
        try:
            check_header(file.full_path, profile)
        except BaseException as error:
            yield fault_from(error, file.path)


def _faults_in_samples(root: Path, index: ArchiveIndex, wrong: set[str]) -> Iterator[Fault]:
    """Read the first tow of each season whose header is good."""
    done = set()
    for tow in index.tows.iter_rows(named=True):
        if tow["season"] in done or not wrong.isdisjoint(_name_tow(tow)):
            continue
        done.add(tow["season"])
        try:
            profile = index.profiles.find(tow["season"])
            samples, place, defects = read_tow_samples(root, tow, profile)
            planned = index.runs.filter(tow_id=tow["tow_id"])["run"]
            if not set(samples["run"].unique()) <= set(planned):
                yield _unplanned_fault(tow, samples, planned)
            yield from judge_samples(samples, place, tow, index.runs, defects).faults
        except BaseException as error:
            yield fault_from(error, tow["samples_path"], tow["tow_id"])


def _unplanned_fault(tow: Row, samples: pl.DataFrame, planned: pl.Series) -> Fault:
    """Return the fault of other runs in a file than are planned."""
    said = say(
        "Runs {present} are in the file and runs {planned} are planned. Give the targets and "
        "directions of all runs under [[plan]] in archief.toml.",
        present=", ".join(map(str, samples["run"].unique().sort())),
        planned=", ".join(map(str, planned)),
    )
    season = tow["season"]
    lines = tuple(
        f'[[plan]]\nseasons = "{season}"\n{key} = ["?"]' for key in ("targets", "directions")
    )
    path = tow["samples_path"].split(PARTS)[0]
    return Fault(path, None, None, "run_not_planned", said, ask=lines)


def _group_causes(
    faults: Iterable[Fault], names_of: dict[str, set[str]], language: str
) -> list[CauseReport]:
    """Return the faults by cause, those that cost most tows first."""
    by_cause: dict[tuple[str, str], list[Fault]] = {}
    for fault in dict.fromkeys(faults):
        by_cause.setdefault((fault.reason_code, fault.cause), []).append(fault)
    reports = [_report_cause(same, names_of, language) for same in by_cause.values()]
    return sorted(reports, key=lambda report: (-report.tows, -report.number))


def _report_cause(faults: list[Fault], names_of: dict[str, set[str]], language: str) -> CauseReport:
    said = [innermost(fault.message) for fault in faults]
    cells = dict.fromkeys(getattr(sentence, "values", {}).get("cell") for sentence in said)
    return CauseReport(
        reason_code=faults[0].reason_code,
        number=len(faults),
        tows=_count_tows(faults, names_of),
        sentence=spoken(said[0], language),
        remedy=spoken(REMEDIES[faults[0].reason_code], language),
        cells=[str(cell) for cell in cells if cell is not None],
        places=[Place(f.path, f.line, f.tow_id) for f in faults[:SHOWN]],
        ask=list(dict.fromkeys(line for fault in faults for line in fault.ask)),
    )


def _count_tows(faults: list[Fault], names_of: dict[str, set[str]]) -> int:
    """Return how many tows these faults cost, as far as is known before a rebuild."""
    costly = [fault for fault in faults if fault.lost is None]
    tow_ids = {fault.tow_id for fault in costly if fault.tow_id}
    paths = {fault.path for fault in costly if not fault.tow_id and fault.line is None}
    headers = {fault.path for fault in costly if fault.reason_code in OF_A_HEADER}
    tow_ids |= {tow for tow, names in names_of.items() if names & (paths | headers)}
    return len(tow_ids)
