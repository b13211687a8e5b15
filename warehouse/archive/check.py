"""Looking through an archive before a rebuild: what is wrong, by cause.

Nothing is written. Judging every sample is the rebuild's; here every header is read, and one tow of
each season whole.
"""

import hashlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import polars as pl

from pipeline.errors import DefectiveInputError
from pipeline.messages import innermost, say, spoken
from pipeline.tables.row import Row
from warehouse.archive.faults import OF_A_HEADER, Fault, fault_from
from warehouse.archive.files import SAMPLES, files_of
from warehouse.archive.index import ArchiveIndex, index_archive
from warehouse.archive.list_rules import read_published_registers, read_races
from warehouse.archive.plausibility import judge_samples
from warehouse.archive.profile import read_profiles
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
        sentence: of the first of them.
        cells: what the cells say that have it.
        places: the first of them.
    """

    reason_code: str
    number: int
    sentence: str
    cells: list[str]
    places: list[Place]


@dataclass(frozen=True)
class CheckReport:
    """What a check found, in a language.

    Attributes:
        archive: its folder.
        tows: tows in which nothing was found that costs them; most samples are judged by the
            rebuild only.
        causes: what is wrong, the most frequent first.
    """

    archive: str
    tows: int
    causes: list[CauseReport]


def check_archive(root: Path, language: str = "en") -> CheckReport:
    """Looks through an archive, and says what is wrong in `en` or `nl`.

    Raises:
        MissingKnowledgeError: there is no archive, or `archief.toml` cannot be understood.
    """
    profiles = read_profiles(root)
    index = index_archive(root, _quick_hash, profiles)
    faults = [*index.faults]
    for _, found in (read_races(root, profiles), read_published_registers(root, profiles)):
        faults += found
    faults += _faults_in_headers(root, index)
    wrong = {fault.path for fault in faults if fault.reason_code in OF_A_HEADER}
    faults += _faults_in_samples(root, index, wrong)
    costly = {fault.tow_id or fault.path for fault in faults if fault.lost is None}
    sound = [tow for tow in index.tows.iter_rows(named=True) if costly.isdisjoint(_names(tow))]
    return CheckReport(str(root), len(sound), _causes(faults, language))


def _names(tow: Row) -> set[str]:
    """The id and the files of a tow."""
    return {tow["tow_id"], tow["samples_path"], tow["second_path"]}


def _quick_hash(path: Path) -> str:
    """A hash of a file's size and ends: enough to find copies, and read in no time."""
    with path.open("rb") as file:
        start = file.read(_PIECE)
        size = path.stat().st_size
        file.seek(max(_PIECE, size - _PIECE))
        return hashlib.sha256(start + file.read(_PIECE) + str(size).encode()).hexdigest()


def _faults_in_headers(root: Path, index: ArchiveIndex) -> Iterator[Fault]:
    """Reads the header of every samples file that a list names."""
    not_listed = {f.path for f in index.faults if f.reason_code == "samples_not_listed"}
    for file in files_of(root):
        if file.kind == SAMPLES and file.inside and file.path not in not_listed:
            try:
                check_header(file.full_path, index.profiles.for_season(file.season))
            except DefectiveInputError as error:
                yield fault_from(error, file.path)


def _faults_in_samples(root: Path, index: ArchiveIndex, wrong: set[str]) -> Iterator[Fault]:
    """Reads the first tow of each season whose header is good."""
    done = set()
    for tow in index.tows.iter_rows(named=True):
        if tow["season"] in done or not wrong.isdisjoint(_names(tow)):
            continue
        done.add(tow["season"])
        try:
            profile = index.profiles.for_season(tow["season"])
            samples, place = read_tow_samples(root, tow, profile)
            planned = index.runs.filter(tow_id=tow["tow_id"])["run"]
            if not {*samples["run"].unique()} <= {*planned}:
                yield _not_planned(tow, samples, planned)
            yield from judge_samples(samples, place, tow, index.runs).faults
        except DefectiveInputError as error:
            yield fault_from(error, tow["samples_path"], tow["tow_id"])


def _not_planned(tow: Row, samples: pl.DataFrame, planned: pl.Series) -> Fault:
    """The fault of other runs in a file than are planned."""
    said = say(
        "Runs {present} are in the file and runs {planned} are planned. Give the targets and "
        "directions of all runs under [[plan]] in archief.toml.",
        present=", ".join(map(str, samples["run"].unique().sort())),
        planned=", ".join(map(str, planned)),
    )
    return Fault(tow["samples_path"], None, None, "run_not_planned", said)


def _causes(faults: Iterable[Fault], language: str) -> list[CauseReport]:
    """The faults by cause, those with most places first."""
    by_cause: dict[tuple[str, str], list[Fault]] = {}
    for fault in dict.fromkeys(faults):
        by_cause.setdefault((fault.reason_code, fault.cause), []).append(fault)
    return [_report(same, language) for same in sorted(by_cause.values(), key=len, reverse=True)]


def _report(faults: list[Fault], language: str) -> CauseReport:
    said = [innermost(fault.message) for fault in faults]
    cells = dict.fromkeys(getattr(sentence, "values", {}).get("cell") for sentence in said)
    return CauseReport(
        reason_code=faults[0].reason_code,
        number=len(faults),
        sentence=spoken(said[0], language),
        cells=[str(cell) for cell in cells if cell is not None],
        places=[Place(f.path, f.line, f.tow_id) for f in faults[:SHOWN]],
    )
