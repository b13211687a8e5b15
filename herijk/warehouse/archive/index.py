"""What is in an archive: its boats, its tows with their files, and what is set aside.

Reads the lists and hashes the files; reading samples belongs to `samples`. Rows, boats and files
are held against each other here, one question after the other; a tow falls out at the first.
"""

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import polars as pl

from herijk.pipeline.channels import RUNS_PER_FILE, SECOND_FILE_OFFSET, TARGET_SPEED_RATIOS
from herijk.pipeline.errors import DefectiveInputError, MissingKnowledgeError
from herijk.warehouse.archive import boats as boat_list
from herijk.warehouse.archive import tows as tow_list
from herijk.warehouse.archive import windows as window_list
from herijk.warehouse.archive.boats import Boats
from herijk.warehouse.archive.faults import DefectiveFileError, Fault, fault_from
from herijk.warehouse.archive.files import (
    BOATS_FILE,
    RACES_PATTERN,
    REGISTER_PATTERN,
    TOW_LIST_PATTERN,
    WINDOWS_PATTERN,
    ArchiveFile,
    list_files,
    list_sample_files,
    list_strangers,
    match_key,
    outside_archive,
    path_inside,
    read_bytes,
)
from herijk.warehouse.archive.limits import LIST_MAX_BYTES
from herijk.warehouse.archive.lists import ListRow, read_rows
from herijk.warehouse.archive.profile import PROFILE_FILE, Profiles, read_profiles
from herijk.warehouse.archive.text import fold_name, shorten

FILES_SCHEMA: Final[dict[str, pl.DataType]] = {
    "path": pl.String(),
    "sha256": pl.String(),
    "size_bytes": pl.Int64(),
}

_FilesByName = dict[tuple[int, str], list[ArchiveFile]]
"""Samples files by season and the name they answer to."""


@dataclass(frozen=True)
class ArchiveIndex:
    """Everything an archive says, but for the samples themselves.

    Attributes:
        boats: one row a boat (`boats.SCHEMA`).
        tows: one row a tow that can be read (`tows.SCHEMA`).
        runs: one row a run of those tows (`tows.RUNS_SCHEMA`); runs of a second file are 11-16.
        windows: windows given by hand for those runs (`windows.SCHEMA`), of which nobody knows yet
            whether they lie in their run.
        faults: what is set aside, and why.
        files: every file that was looked at: path, sha256, size_bytes.
        profiles: `archief.toml`.
    """

    boats: pl.DataFrame
    tows: pl.DataFrame
    runs: pl.DataFrame
    windows: pl.DataFrame
    faults: tuple[Fault, ...]
    files: pl.DataFrame
    profiles: Profiles


@dataclass
class _Entry:
    """A row of a tow list on its way to becoming a tow."""

    row: ListRow
    list_path: str
    season: int
    files: list[ArchiveFile] = field(default_factory=list)
    tow: dict[str, Any] = field(default_factory=dict)
    selection: frozenset[int] = frozenset()

    @property
    def tow_id(self) -> str | None:
        return self.row.optional_text("tow_id")

    @property
    def where(self) -> str:
        return f"line {self.row.line} of {self.list_path}"

    def fault(self, reason_code: str, message: str) -> DefectiveInputError:
        return DefectiveInputError(reason_code, f"Line {self.row.line}: {message}", self.row.line)


class _Hashes:
    """The hashes of the files looked at, each file once."""

    def __init__(self, hash_file: Callable[[Path], str]) -> None:
        self._hash_file = hash_file
        self.rows: dict[str, tuple[str, int]] = {}

    def add(self, path: str, full_path: Path) -> str:
        """Return the hash of a file and remember that it was looked at.

        Raises:
            DefectiveInputError: `unreadable_file`.
        """
        if path not in self.rows:
            try:
                self.rows[path] = (self._hash_file(full_path), full_path.stat().st_size)
            except OSError as error:
                raise DefectiveFileError(
                    "unreadable_file", f"'{path}' cannot be read: {error.strerror}.", None, path
                ) from error
        return self.rows[path][0]

    def frame(self) -> pl.DataFrame:
        rows = [(path, *self.rows[path]) for path in sorted(self.rows)]
        return pl.DataFrame(rows, schema=FILES_SCHEMA, orient="row")


def index_archive(root: Path, hash_file: Callable[[Path], str]) -> ArchiveIndex:
    """Read the lists of an archive and find the files of every tow.

    Args:
        root: folder of the archive.
        hash_file: gives the SHA-256 of a file; `FileHashes.hash_file` remembers them.

    Returns:
        The index. The samples have not been opened, only hashed.

    Raises:
        MissingKnowledgeError: there is no archive, or `archief.toml` cannot be understood.
    """
    _check_present(root)
    profiles = read_profiles(root)
    hashes = _Hashes(hash_file)
    faults: list[Fault] = []
    _hash_others(root, hashes, faults)
    boats = _read_boats(root, hashes, faults)
    entries, unread_seasons = _read_tow_lists(root, hashes, faults)
    sample_files = list_sample_files(root)
    _hash_files(sample_files, hashes, faults)
    faults += _not_listed(entries, sample_files, unread_seasons)
    by_name = _by_name(sample_files)
    good = _keep(_unique_ids(entries), entries, faults)
    good = _keep(lambda entry: _read_values(entry, profiles), good, faults)
    good = _keep(lambda entry: _find_files(entry, by_name, hashes), good, faults)
    good = _keep(_unique_samples(good), good, faults)
    good = _keep(lambda entry: _join_boat(entry, boats), good, faults)
    good = _keep(lambda entry: _place_day(entry, profiles), good, faults)
    runs = [run for entry in good for run in _runs(entry, profiles)]
    windows = _read_windows(root, hashes, entries, runs, faults)
    return ArchiveIndex(
        boats=boats.frame(),
        tows=pl.DataFrame([entry.tow for entry in good], schema=tow_list.SCHEMA),
        runs=pl.DataFrame(runs, schema=tow_list.RUNS_SCHEMA),
        windows=pl.DataFrame(windows, schema=window_list.SCHEMA),
        faults=tuple(sorted(faults, key=_fault_order)),
        files=hashes.frame(),
        profiles=profiles,
    )


def _fault_order(fault: Fault) -> tuple[str, int, str]:
    return fault.path, fault.line or 0, fault.tow_id or ""


def _check_present(root: Path) -> None:
    if not root.is_dir():
        raise MissingKnowledgeError(
            f"There is no archive at {root}: expected a folder with {BOATS_FILE}, "
            "sleeplijsten/ and meetdata_<jaar>/."
        )
    if not (root / BOATS_FILE).is_file():
        raise MissingKnowledgeError(
            f"The archive at {root} has no {BOATS_FILE}: expected the list of boats there."
        )
    if not list_files(root, "sleeplijsten", TOW_LIST_PATTERN):
        raise MissingKnowledgeError(
            f"The archive at {root} has no tow lists: expected at least one "
            "sleeplijsten/sleeplijst_<jaar>.csv."
        )


# Lists


def _read_list(root: Path, path: str, hashes: _Hashes) -> bytes:
    full_path = path_inside(root, path)
    hashes.add(path, full_path)
    return read_bytes(full_path, LIST_MAX_BYTES)


def _read_boats(root: Path, hashes: _Hashes, faults: list[Fault]) -> Boats:
    try:
        boats = boat_list.read_boats(_read_list(root, BOATS_FILE, hashes))
    except DefectiveInputError as error:
        boats = Boats({}, {}, (fault_from(error, BOATS_FILE),))
    faults += boats.faults
    return boats


def _read_tow_lists(
    root: Path, hashes: _Hashes, faults: list[Fault]
) -> tuple[list[_Entry], set[int]]:
    """Return the rows of all tow lists, and the seasons of lists that cannot be read."""
    entries: list[_Entry] = []
    unread_seasons: set[int] = set()
    for path in list_strangers(root, "sleeplijsten", f"{TOW_LIST_PATTERN}|{WINDOWS_PATTERN}"):
        message = f"'{path}' is not read, as it is not named like sleeplijst_2014.csv."
        faults.append(Fault(path, None, None, "unrecognised_file", message))
    for file in list_files(root, "sleeplijsten", TOW_LIST_PATTERN):
        try:
            rows = read_rows(_read_list(root, file.path, hashes), tow_list.COLUMNS, "bad_list_row")
        except DefectiveInputError as error:
            faults.append(fault_from(error, file.path))
            unread_seasons.add(file.season)
            continue
        entries += [_Entry(row, file.path, file.season) for row in rows]
    return entries, unread_seasons


def _read_windows(
    root: Path,
    hashes: _Hashes,
    entries: list[_Entry],
    runs: list[Mapping[str, Any]],
    faults: list[Fault],
) -> list[window_list.Window]:
    """Return the windows given by hand, of all years."""
    windows: list[window_list.Window] = []
    runs_of: dict[str, set[int]] = defaultdict(set)
    for run in runs:
        runs_of[run["tow_id"]].add(run["run"])
    for file in list_files(root, "sleeplijsten", WINDOWS_PATTERN):
        tow_ids = {e.tow_id for e in entries if e.season == file.season and e.tow_id is not None}
        listed = window_list.Listed(tow_ids, runs_of)
        try:
            data = _read_list(root, file.path, hashes)
            found, faulty = window_list.read_windows(data, file.path, listed)
        except DefectiveInputError as error:
            faults.append(fault_from(error, file.path))
            continue
        windows += found
        faults += faulty
    return windows


# Files


def _hash_others(root: Path, hashes: _Hashes, faults: list[Fault]) -> None:
    """Hash what is read from elsewhere: the profile, published registers, race results."""
    if (root / PROFILE_FILE).is_file():
        hashes.add(PROFILE_FILE, root / PROFILE_FILE)
    published = list_files(root, "sloepregister", REGISTER_PATTERN)
    races = list_files(root, "wedstrijden", RACES_PATTERN)
    _hash_files([*published, *races], hashes, faults)


def _hash_files(files: Iterable[ArchiveFile], hashes: _Hashes, faults: list[Fault]) -> None:
    """Hash the files that lie inside the archive."""
    for file in files:
        try:
            if file.inside:
                hashes.add(file.path, file.full_path)
        except DefectiveInputError as error:
            faults.append(fault_from(error, file.path))


def _names(row: ListRow) -> list[str]:
    cells = (row.optional_text("file"), row.optional_text("second_file"))
    return [cell for cell in cells if cell is not None]


def _by_name(sample_files: Iterable[ArchiveFile]) -> _FilesByName:
    by_name: _FilesByName = defaultdict(list)
    for file in sample_files:
        by_name[file.season, match_key(file.full_path.name)].append(file)
    return by_name


def _candidates(name: str, season: int, by_name: _FilesByName) -> list[ArchiveFile]:
    """Return the files a name in a list can mean; a name with its extension is more precise."""
    alike = by_name.get((season, match_key(name)), [])
    exact = [file for file in alike if fold_name(file.full_path.name) == fold_name(name)]
    return exact if len(exact) == 1 else alike


def _not_listed(
    entries: Iterable[_Entry], sample_files: list[ArchiveFile], unread_seasons: set[int]
) -> list[Fault]:
    """Return a fault for each samples file no row names, in seasons whose list could be read.

    Rows that are set aside for another reason name their files all the same.
    """
    named = {(entry.season, match_key(name)) for entry in entries for name in _names(entry.row)}
    faults = []
    for file in sample_files:
        if (file.season, match_key(file.full_path.name)) in named:
            continue
        if not file.inside:
            faults.append(fault_from(outside_archive(file.path), file.path))
        elif file.season not in unread_seasons:
            message = f"No row of the tow list of {file.season} names this file."
            faults.append(Fault(file.path, None, None, "samples_not_listed", message))
    return faults


# Rows, boats and files held against each other


def _keep(
    question: Callable[[_Entry], None], entries: list[_Entry], faults: list[Fault]
) -> list[_Entry]:
    """Return the entries that pass a question; the others leave a fault."""
    passed = []
    for entry in entries:
        try:
            question(entry)
        except DefectiveInputError as error:
            faults.append(fault_from(error, entry.list_path, entry.tow_id))
        else:
            passed.append(entry)
    return passed


def _unique_ids(entries: Iterable[_Entry]) -> Callable[[_Entry], None]:
    """Return the question whether a row's `sleep_id` is its own."""
    by_id: dict[str, list[_Entry]] = defaultdict(list)
    for entry in entries:
        if entry.tow_id is not None:
            by_id[entry.tow_id].append(entry)

    def question(entry: _Entry) -> None:
        same = by_id[entry.tow_id] if entry.tow_id is not None else [entry]
        if len(same) == 1:
            return
        identical = all(other.row.cells == entry.row.cells for other in same)
        if identical and entry is same[0]:
            return
        other = next(other for other in same if other is not entry)
        ending = (
            "the rows are equal and the first counts."
            if identical
            else "the rows differ, so neither counts."
        )
        raise entry.fault(
            "duplicate_tow_id",
            f"sleep_id {shorten(entry.tow_id or '')} stands also on {other.where}; {ending}",
        )

    return question


def _read_values(entry: _Entry, profiles: Profiles) -> None:
    rate_hz = profiles.for_season(entry.season).sample_rate_hz
    entry.tow = tow_list.read_tow(entry.row, entry.season, rate_hz)
    entry.selection = tow_list.read_selection(entry.row)
    entry.row.text("file")
    day = entry.tow["tow_date"]
    if day.year != entry.season:
        raise entry.fault(
            "date_outside_season",
            f"the date {day} is not in {entry.season}, the year of the list.",
        )


def _find_files(entry: _Entry, by_name: _FilesByName, hashes: _Hashes) -> None:
    entry.files = [_find_file(entry, name, by_name) for name in _names(entry.row)]
    first, second = entry.files[0], entry.files[1] if len(entry.files) > 1 else None
    entry.tow |= {
        "samples_path": first.path,
        "samples_sha256": hashes.add(first.path, first.full_path),
        "second_path": second.path if second else None,
        "second_sha256": hashes.add(second.path, second.full_path) if second else None,
        "list_path": entry.list_path,
        "list_line": entry.row.line,
    }


def _find_file(entry: _Entry, name: str, by_name: _FilesByName) -> ArchiveFile:
    if "/" in name or "\\" in name or name.startswith(".."):
        raise entry.fault(
            "path_outside_archive",
            f"'{shorten(name)}' is a path; only the name of a file in "
            f"meetdata_{entry.season}/ can stand here.",
        )
    candidates = _candidates(name, entry.season, by_name)
    if not candidates:
        raise entry.fault(
            "samples_missing", f"there is no file '{shorten(name)}' in meetdata_{entry.season}/."
        )
    if len(candidates) > 1:
        found = ", ".join(f"'{file.full_path.name}'" for file in candidates)
        raise entry.fault("ambiguous_file", f"'{shorten(name)}' can be any of {found}.")
    if not candidates[0].inside:
        raise outside_archive(candidates[0].path)
    return candidates[0]


def _unique_samples(entries: Iterable[_Entry]) -> Callable[[_Entry], None]:
    """Return the question whether a row's samples are its own, by content.

    A first file may be the second file of another tow of the same boat: that is how two tows are
    combined.
    """
    first: dict[str, list[_Entry]] = defaultdict(list)
    users: dict[str, list[_Entry]] = defaultdict(list)
    for entry in entries:
        first[entry.tow["samples_sha256"]].append(entry)
        for sha256 in _contents(entry):
            users[sha256].append(entry)

    def question(entry: _Entry) -> None:
        sha256 = entry.tow["samples_sha256"]
        if sha256 == entry.tow["second_sha256"]:
            raise entry.fault(
                "samples_listed_twice", "meetfile and meetfile2 hold the same samples."
            )
        boat, crew = entry.tow["fsn_no"], _crew(entry)
        strangers = [
            other
            for used in _contents(entry)
            for other in users[used]
            if other.tow["fsn_no"] != boat
        ] + [other for other in first[sha256] if _crew(other) != crew]
        if strangers:
            raise _listed_twice(entry, strangers[0])
        earliest = first[sha256][0]
        if entry is not earliest:
            raise entry.fault(
                "duplicate_tow",
                f"'{entry.tow['samples_path']}' holds the samples that {earliest.where} uses "
                f"already for {boat}.",
            )

    return question


def _contents(entry: _Entry) -> list[str]:
    hashes = (entry.tow["samples_sha256"], entry.tow["second_sha256"])
    return [sha256 for sha256 in hashes if sha256 is not None]


def _crew(entry: _Entry) -> tuple[int, str]:
    return entry.tow["rowers"], entry.tow["crew_class"]


def _listed_twice(entry: _Entry, other: _Entry) -> DefectiveInputError:
    boat, crew = other.tow["fsn_no"], f"{other.tow['rowers']}{other.tow['crew_class']}"
    return entry.fault(
        "samples_listed_twice",
        f"the samples are also used for {boat} {crew} on {other.where}; nobody can know whose "
        "they are.",
    )


def _join_boat(entry: _Entry, boats: Boats) -> None:
    fsn_no = entry.tow["fsn_no"]
    why = boats.bad.get(fsn_no)
    if why is not None:
        raise entry.fault(
            why.reason_code,
            f"boat {fsn_no} cannot be used, see {why.path}: {why.message}",
        )
    boat = boats.good.get(fsn_no)
    if boat is None:
        raise entry.fault("unknown_boat", f"boat {shorten(fsn_no)} is not in {BOATS_FILE}.")
    entry.tow = tow_list.fill_dimensions(entry.tow, boat, entry.row)


def _place_day(entry: _Entry, profiles: Profiles) -> None:
    """Note which logs were on board that day, unless it is set aside."""
    day = entry.tow["tow_date"]
    reason = profiles.reason_set_aside(day)
    if reason is not None:
        raise entry.fault("day_set_aside", f"{day} is set aside in {PROFILE_FILE}: {reason}.")
    for log in ("log1", "log2"):
        entry.tow[f"{log}_part"] = profiles.part_of_log(log, day)


def _runs(entry: _Entry, profiles: Profiles) -> list[Mapping[str, Any]]:
    directions = profiles.for_season(entry.season).directions
    targets = TARGET_SPEED_RATIOS * (RUNS_PER_FILE // len(TARGET_SPEED_RATIOS))
    offsets = (0, SECOND_FILE_OFFSET)[: len(entry.files)]
    return [
        {
            "tow_id": entry.tow["tow_id"],
            "run": offset + number,
            "direction": directions[number - 1],
            "target_speed_ratio": targets[number - 1],
            "selected": offset + number in entry.selection,
        }
        for offset in offsets
        for number in range(1, RUNS_PER_FILE + 1)
    ]
