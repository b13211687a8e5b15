"""Looking through an archive before a rebuild: every fault, by cause, with what would settle it.

Nothing is written. Judging every sample is the rebuild's; here every header is read, and one tow of
each season whole.
"""

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from pipeline.messages import innermost, spoken
from pipeline.tables.frames import frame_of
from pipeline.tables.lake import ListedTows
from warehouse.archive.check.headers_and_samples import faults_in_headers, faults_in_samples
from warehouse.archive.check.settings import settings_for
from warehouse.archive.faults import OF_A_HEADER, Fault
from warehouse.archive.files.finding import files_of
from warehouse.archive.files.names import PARTS, SAMPLES
from warehouse.archive.index.files import missing_lists, strangers
from warehouse.archive.index.index import ArchiveIndex, index_archive
from warehouse.archive.lists.races import read_races
from warehouse.archive.lists.registers import read_published_registers
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.profile.reading import read_profiles

SHOWN: Final = 3
"""Places of one cause."""
MOST_SETTINGS: Final = 20
"""Lines to fill in for one cause."""
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
        settings: lines of `archief.toml` to fill in, with the choices behind a `#`; empty where
            only a person can mend it.
    """

    reason_code: str
    number: int
    sentence: str
    cells: list[str]
    places: list[Place]
    settings: list[str]


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

    A list with a column that nobody knows is looked at again without that column, so that what is
    wrong in its rows comes out in the same round.

    Raises:
        MissingKnowledgeError: there is no archive, or `archief.toml` cannot be understood.
    """
    profiles = read_profiles(root)
    index, faults = _faults(root, profiles)
    unknown = _unknown_columns(faults)
    tows = _readable(index, faults)
    if unknown:
        told = {fault.path for fault in faults if fault.reason_code in OF_A_HEADER}
        index, again = _faults(root, profiles.ignoring(unknown))
        faults += (f for f in again if f.reason_code not in OF_A_HEADER or f.path not in told)
    seasons = _seasons(root, profiles, index)
    boats = index.boats["name"].to_list() if index else []
    causes = [
        _report(same, _settings(same, seasons, boats), language)
        for same in _by_cause(dict.fromkeys(faults))
    ]
    return CheckReport(str(root), tows, causes)


def _unknown_columns(faults: Iterable[Fault]) -> list[str]:
    """The headers of lists that nobody knows."""
    values = (getattr(innermost(fault.message), "values", {}) for fault in faults)
    return [header for found in values for header, _ in found.get("near", ())]


def _readable(index: ArchiveIndex | None, faults: Iterable[Fault]) -> int:
    """How many listed tows have no fault that costs the tow."""
    costly = [fault for fault in faults if fault.lost is None]
    lost = {f.tow_id for f in costly} | {f.path for f in costly}
    tows = index.tows if index else frame_of(ListedTows, [])
    files = tows.select("tow_id", "samples_path", "second_path").iter_rows()
    return sum(
        lost.isdisjoint(f"{tow}{PARTS}{one}{PARTS}{two}".split(PARTS)) for tow, one, two in files
    )


def _faults(root: Path, profiles: Profiles) -> tuple[ArchiveIndex | None, list[Fault]]:
    """The lists, and what is wrong in them, in headers and in a tow of each season.

    Where a list is missing that all others need, it can be among the files that nobody reads.
    """
    files = files_of(root, profiles.files)
    lacking = missing_lists(root, files)
    if lacking:
        return None, [*strangers(root, files, profiles.ignore), *lacking]
    index = index_archive(root, quick_hash, profiles)
    _, in_races = read_races(root, profiles)
    _, in_registers = read_published_registers(root, profiles)
    unused = {fault.path for fault in index.faults if fault.reason_code == "samples_not_listed"}
    in_headers = list(faults_in_headers(root, index, unused))
    wrong = {fault.path for fault in in_headers}
    in_samples = list(faults_in_samples(root, index, wrong | unused))
    in_lists = [*index.faults, *index.more]
    return index, [*in_lists, *in_races, *in_registers, *in_headers, *in_samples]


def _seasons(root: Path, profiles: Profiles, index: ArchiveIndex | None) -> dict[str, int]:
    """The season of each samples file: of its folder, or of the row that names it."""
    files = files_of(root, profiles.files)
    return {file.path: file.season for file in files if file.kind == SAMPLES} | (
        index.seasons if index else {}
    )


def quick_hash(path: Path) -> str:
    """A hash of a file's size and ends: enough to find copies, and read in no time."""
    with path.open("rb") as file:
        start = file.read(_PIECE)
        size = path.stat().st_size
        file.seek(max(_PIECE, size - _PIECE))
        return hashlib.sha256(start + file.read(_PIECE) + str(size).encode()).hexdigest()


def _by_cause(faults: Iterable[Fault]) -> list[list[Fault]]:
    """The faults by cause, those with most first."""
    by_cause: dict[tuple[str, str], list[Fault]] = {}
    for fault in faults:
        by_cause.setdefault((fault.reason_code, fault.cause), []).append(fault)
    return sorted(by_cause.values(), key=len, reverse=True)


def _report(faults: Sequence[Fault], settings: list[str], language: str) -> CauseReport:
    said = [innermost(fault.message) for fault in faults]
    cells = [getattr(sentence, "values", {}).get("cell") for sentence in said]
    return CauseReport(
        reason_code=faults[0].reason_code,
        number=len(faults),
        sentence=spoken(said[0], language),
        cells=[str(cell) for cell in dict.fromkeys(cells) if cell is not None],
        places=[Place(f.path, f.line, f.tow_id) for f in faults[:SHOWN]],
        settings=settings,
    )


def _settings(
    faults: Iterable[Fault], seasons: Mapping[str, int], boats: Sequence[str]
) -> list[str]:
    """The first lines that settle faults of one cause, each once."""
    said = {(fault.path, innermost(fault.message)): fault for fault in faults}
    settings: dict[str, None] = {}
    for fault in said.values():
        season = seasons.get(fault.path.split(PARTS)[0], 0)
        settings |= dict.fromkeys(settings_for(fault, season, boats))
        if len(settings) >= MOST_SETTINGS:
            break
    return list(settings)
