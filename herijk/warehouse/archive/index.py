"""What is in an archive: its boats, its tows with their files, and what is set aside.

Reads the lists and hashes the files; reading samples belongs to `samples`. Rows, boats and files
are compared with each other here, one check after the other; a tow falls out at the first.
"""

import datetime as dt
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import polars as pl

from herijk.pipeline.channels import SECOND_FILE_OFFSET
from herijk.pipeline.errors import DefectiveInputError, MissingKnowledgeError
from herijk.tables.declare import dy
from herijk.tables.frames import frame_of
from herijk.tables.lake import ListedFiles, ListedRuns, ListedTows
from herijk.tables.row import Row
from herijk.warehouse.archive import tows as tow_list
from herijk.warehouse.archive.boats import Boats, read_boats
from herijk.warehouse.archive.faults import DefectiveFileError, Fault, fault_from
from herijk.warehouse.archive.files import (
    BOATS_FILE,
    PACKED,
    PARTS,
    PROFILE_FILE,
    SAMPLES,
    ArchiveFile,
    as_one_run,
    can_hold_data,
    find_boats_file,
    hash_of_parts,
    list_files,
    list_misnamed,
    list_sample_files,
    list_strangers,
    match_key,
    outside_archive,
)
from herijk.warehouse.archive.instruments import (
    lamp_seconds,
    load_cell_of,
    read_force_checks,
    read_lamps,
)
from herijk.warehouse.archive.kinds import LIST_KINDS, TOWS
from herijk.warehouse.archive.lists import (
    ROWS_ARE_EQUAL,
    ROWS_DIFFER,
    DefectiveRowError,
    ListRow,
    Wording,
    all_of,
    others_of,
    read_list,
)
from herijk.warehouse.archive.misfits import misfits
from herijk.warehouse.archive.profile import Plan, Profiles, read_profiles
from herijk.warehouse.archive.recognise import guessed, recognised
from herijk.warehouse.archive.sheets import SPREADSHEETS
from herijk.warehouse.archive.text import fold, fold_word, shorten
from herijk.warehouse.archive.windows import read_windows
from herijk.words import say

_FilesByName = dict[tuple[int, str], list["SamplesFile"]]
"""Samples files by season and the name they answer to."""


@dataclass(frozen=True)
class ArchiveIndex:
    """Everything an archive says, but for the samples themselves.

    Attributes:
        boats: one row per boat (`ListedBoats`).
        tows: one row per tow that can be read.
        runs: one row per run of those tows; runs of a second file are 21 and on.
        windows: windows given by hand for those runs (`ListedWindows`), of which nobody knows yet
            whether they lie in their run.
        faults: what is set aside, and why.
        files: every file that was looked at.
        profiles: `archief.toml`.
        seasons: season of each samples file that a row names, whatever is wrong with the row.
        more: what else is wrong in rows that are set aside; a row is set aside once.
    """

    boats: pl.DataFrame
    tows: dy.DataFrame[ListedTows]
    runs: dy.DataFrame[ListedRuns]
    windows: pl.DataFrame
    faults: tuple[Fault, ...]
    files: dy.DataFrame[ListedFiles]
    profiles: Profiles
    seasons: dict[str, int]
    more: tuple[Fault, ...] = ()


@dataclass(frozen=True)
class SamplesFile:
    """The samples that a name in a list stands for: a file, or one for every run.

    Attributes:
        parts: the files, in the order of their runs.
    """

    parts: tuple[ArchiveFile, ...]

    @property
    def path(self) -> str:
        """Path relative to the archive; of several files with `PARTS` between them."""
        return PARTS.join(part.path for part in self.parts)


@dataclass
class _Entry:
    """A row of a tow list on its way to becoming a tow."""

    row: ListRow
    list_path: str
    season: int
    profiles: Profiles
    files: list[SamplesFile] = field(default_factory=list)
    tow: Row = field(default_factory=dict)
    selection: frozenset[int] = frozenset()
    lost_cells: list[DefectiveInputError] = field(default_factory=list)

    @property
    def tow_id(self) -> str | None:
        return self.row.optional_text("tow_id")

    @property
    def plan(self) -> Plan:
        return self.profiles.plan_of(self.tow_id or "", self.season)

    @property
    def where(self) -> str:
        return say("line {line} of {path}", line=self.row.line, path=self.list_path)


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
                    "unreadable_file",
                    say(
                        "'{name}' cannot be read or unpacked: {error}.",
                        name=path,
                        error=error.strerror,
                    ),
                    None,
                    path,
                ) from error
        return self.rows[path][0]

    def add_samples(self, file: SamplesFile) -> str:
        """Return the hash of samples, of several files one of their hashes."""
        sha256 = hash_of_parts([self.add(part.path, part.full_path) for part in file.parts])
        self.rows[file.path] = (sha256, sum(self.rows[part.path][1] for part in file.parts))
        return sha256

    def frame(self) -> dy.DataFrame[ListedFiles]:
        rows = [(path, *self.rows[path]) for path in sorted(self.rows)]
        return frame_of(ListedFiles, rows)


def index_archive(
    root: Path, hash_file: Callable[[Path], str], profiles: Profiles | None = None
) -> ArchiveIndex:
    """Read the lists of an archive and find the files of every tow.

    Args:
        root: folder of the archive.
        hash_file: gives the SHA-256 of a file; `FileHashes.hash_file` remembers them.
        profiles: `archief.toml`, where it is not the one in the archive.

    Returns:
        The index. The samples have not been opened, only hashed.

    Raises:
        MissingKnowledgeError: there is no archive, or `archief.toml` cannot be understood.
    """
    profiles = profiles or read_profiles(root)
    _check_present(root, profiles)
    named = profiles.wording.files
    hashes = _Hashes(hash_file)
    faults: list[Fault] = []
    unhashed = _hash_lists(root, named, hashes)
    faults += strangers(root, profiles)
    boats = _read_boats(root, profiles.wording)
    faults += boats.faults
    entries, unread_seasons = _read_tow_lists(root, profiles, faults)
    sample_files = list_sample_files(root, named)
    faults += _hash_files(sample_files, hashes)
    by_name = _by_name(sample_files, entries)
    faults += _not_listed(entries, sample_files, unread_seasons, by_name)
    faults += [] if unread_seasons else _idle(profiles, entries)
    more = list(boats.more)
    read_values = partial(_read_values, profiles=profiles)
    good = _keep(_unique_ids(entries), entries, faults)
    unique = set(map(id, good))
    _keep(read_values, [entry for entry in entries if id(entry) not in unique], more, more)
    good = _keep(read_values, good, faults, more)
    good = _keep(lambda entry: _find_files(entry, by_name, hashes), good, faults)
    good = _keep(_unique_samples(good), good, faults)
    good = _keep(lambda entry: _join_boat(entry, boats), good, faults)
    good = _keep(lambda entry: _place_day(entry, profiles), good, faults)
    good = _keep(_fits_table(good), good, faults)
    faults += [fault for entry in good for fault in _lost_cells(entry)]
    _add_instruments(root, profiles, entries, good, faults)
    runs = [run for entry in good for run in _runs(entry)]
    runs_of = {(entry.season, entry.tow_id): set[int]() for entry in entries}
    runs_of |= {(e.season, e.tow_id): {run["run"] for run in _runs(e)} for e in good}
    windows, faulty = read_windows(root, profiles.wording, runs_of)
    faults += faulty
    told = {fault.path for fault in faults if fault.reason_code == "unreadable_file"}
    faults += [fault for fault in unhashed if fault.path not in told]
    return ArchiveIndex(
        boats=boats.frame(),
        tows=frame_of(ListedTows, [entry.tow for entry in good]),
        runs=frame_of(ListedRuns, runs),
        windows=windows,
        faults=tuple(sorted(faults, key=_fault_order)),
        files=hashes.frame(),
        profiles=profiles,
        seasons={
            part.path: entry.season
            for entry in entries
            for name in _names_of_files(entry)
            for file in _candidates(name, entry.season, by_name)
            for part in file.parts
        },
        more=tuple(more),
    )


def _fault_order(fault: Fault) -> tuple[str, int, str]:
    return fault.path, fault.line or 0, fault.tow_id or ""


def _check_present(root: Path, profiles: Profiles) -> None:
    lacking = missing_lists(root, profiles)
    if lacking:
        raise MissingKnowledgeError(
            "The archive at {} cannot be read: {}", root, lacking[0].message
        )


def missing_lists(root: Path, profiles: Profiles) -> list[Fault]:
    """Return what is not there of that without which nothing can be read.

    Raises:
        MissingKnowledgeError: there is no archive.
    """
    if not root.is_dir():
        raise MissingKnowledgeError(
            "There is no archive at {}: expected a folder with {}, sleeplijsten/ and "
            "meetdata_<jaar>/.",
            root,
            BOATS_FILE,
        )
    named = profiles.wording.files
    lacking = []
    if find_boats_file(root, named) is None:
        lacking.append(
            (BOATS_FILE, say("there is no list of boats: {path} is expected.", path=BOATS_FILE))
        )
    if not list_files(root, TOWS, named):
        path = "sleeplijsten/sleeplijst_<jaar>.csv"
        lacking.append((path, say("there is no list of tows: {path} is expected.", path=path)))
    return [Fault(path, None, None, "missing_list", said) for path, said in lacking]


# Lists


def _read_boats(root: Path, wording: Wording) -> Boats:
    path = find_boats_file(root, wording.files) or BOATS_FILE
    try:
        return read_boats(root, path, wording)
    except DefectiveInputError as error:
        return Boats({}, (), {}, (fault_from(error, path),))


def strangers(root: Path, profiles: Profiles) -> list[Fault]:
    """Return what lies in the archive and is not read; what it can be, where that can be told."""
    is_lacking = root.is_dir() and bool(missing_lists(root, profiles))
    message = "The name of '{name}' has letters that cannot be read; give it another name."
    misnamed = [
        Fault(path, None, None, "unrecognised_file", say(message, name=path))
        for path in list_misnamed(root)
    ]
    return misnamed + [
        Fault(path, None, None, "unrecognised_file", _about_stranger(root, path, is_lacking))
        for path in list_strangers(root, profiles.wording.files)
        if fold(path) not in profiles.wording.ignore
    ]


def _about_stranger(root: Path, path: str, is_lacking: bool) -> str:
    """Return the sentence about what is not read; while a list is lacking it can be anything."""
    kind = Path(path)
    if kind.suffix.lower() in PACKED:
        return say("'{path}' is not read: it is packed. Unpack it in its folder.", path=path)
    if kind.suffix.lower() in SPREADSHEETS and kind.parts[0].casefold().startswith(SAMPLES):
        message = "'{path}' is not read: samples are read from text. Save the sheet as CSV."
        return say(message, path=path)
    can_be = dict(recognised(root, path))
    if not can_be:
        guesses = tuple(sorted(guessed(root, path)))
        return say(
            "'{path}' is not read: it is not recognised.",
            path=path,
            guesses=guesses,
            is_other=not guesses
            and not ((is_lacking or (root / path).is_dir()) and can_hold_data(root / path)),
        )
    return say(
        "'{path}' is not read: it has another name than the archive's files. It can be {kinds}; "
        "say so under [files] in archief.toml.",
        path=path,
        kinds=", ".join(sorted(set(can_be.values()))),
        can_be=tuple(sorted(can_be.items())),
    )


def _read_tow_lists(
    root: Path, profiles: Profiles, faults: list[Fault]
) -> tuple[list[_Entry], set[int]]:
    """Return the rows of all tow lists, and the seasons of lists that cannot be read."""
    entries: list[_Entry] = []
    unread_seasons: set[int] = set()
    for file in list_files(root, TOWS, profiles.wording.files):
        try:
            rows = read_list(root, TOWS, file.path, profiles.wording)
        except DefectiveInputError as error:
            faults.append(fault_from(error, file.path))
            unread_seasons.add(file.season)
            continue
        entries += [
            _Entry(row, file.path, file.season or _year_of(row), profiles)
            for row in tow_list.per_tow(rows)
        ]
    return entries, unread_seasons


def _year_of(row: ListRow) -> int:
    """Return the season of a row in a list of all years; 0 where its date cannot be read."""
    day = _day_of(row)
    return 0 if day is None else day.year


def _day_of(row: ListRow) -> dt.date | None:
    try:
        return row.date("tow_date")
    except DefectiveInputError:
        return None


def _idle(profiles: Profiles, entries: list[_Entry]) -> list[Fault]:
    """Return what `archief.toml` says of days, seasons or tows that no list has: mistyped ones."""
    days = {_day_of(entry.row) for entry in entries}
    seasons = {entry.season for entry in entries}
    tows = {entry.tow_id for entry in entries}
    idle = [
        *(("set_aside", str(one.date)) for one in profiles.set_aside if one.date not in days),
        *(
            ("log_replaced", str(one.date))
            for one in profiles.log_replaced
            if one.date.year not in seasons
        ),
        *(("plan", tow) for plan in profiles.plan for tow in plan.tows if tow not in tows),
        *(
            (name, f"{first}:{last}")
            for name, (first, last) in profiles.season_ranges
            if not any(first <= season <= last for season in seasons)
        ),
    ]
    message = "[[{table}]] is for {what}, and no tow list has that: is it mistyped?"
    return [
        Fault(PROFILE_FILE, None, None, "idle_setting", say(message, table=table, what=what))
        for table, what in idle
    ]


def _add_instruments(
    root: Path,
    profiles: Profiles,
    entries: list[_Entry],
    good: list[_Entry],
    faults: list[Fault],
) -> None:
    """Put what is known of the load cell and the warning lamps into the tows."""
    tow_ids = {entry.tow_id for entry in entries if entry.tow_id is not None}
    checks, unread = read_force_checks(root, profiles.wording)
    lamps, unread_lamps = read_lamps(root, profiles.wording, tow_ids)
    faults += [*unread, *unread_lamps]
    burned = lamp_seconds(lamps)
    for entry in good:
        seconds = burned.get(entry.tow["tow_id"])
        entry.tow |= load_cell_of(entry.tow, checks)
        entry.tow["lamp_ratio"] = None if seconds is None else seconds / entry.plan.seconds


# Files


def _hash_lists(root: Path, named: Mapping[str, str], hashes: _Hashes) -> list[Fault]:
    """Hash the profile and every list; return a fault for each that cannot be read."""
    if (root / PROFILE_FILE).is_file():
        hashes.add(PROFILE_FILE, root / PROFILE_FILE)
    lists = (file for kind in LIST_KINDS for file in list_files(root, kind, named))
    return list(_hash_files(lists, hashes))


def _hash_files(files: Iterable[ArchiveFile], hashes: _Hashes) -> Iterator[Fault]:
    """Hash the files that lie inside the archive; give a fault for each that cannot be read."""
    for file in files:
        try:
            if file.inside:
                hashes.add(file.path, file.full_path)
        except DefectiveInputError as error:
            yield fault_from(error, file.path)


def _names(entry: _Entry) -> list[str]:
    """Return the names of the files in a row; of a file per run with `PARTS` between them."""
    cells = (entry.row.optional_text(key) for key in ("file", "second_file"))
    return [_without_own_folder(cell, entry.season) for cell in cells if cell is not None]


def _without_own_folder(name: str, season: int) -> str:
    r"""Return `snol 8h 2014` of `E:\slepen\meetdata_2014\snol 8h 2014` in the list of 2014.

    So the federation's tool shows a file (presentation 2015, "Meetfile"). Other paths stay.
    """
    folder, _, own = name.replace("\\", "/").rpartition("/")
    return own if fold(folder.rpartition("/")[2]) == fold(f"{SAMPLES}_{season}") else name


def _names_of_files(entry: _Entry) -> Iterator[str]:
    for name in _names(entry):
        yield from name.split(PARTS)


def _by_name(sample_files: Iterable[ArchiveFile], entries: Iterable[_Entry]) -> _FilesByName:
    """Return the samples by season and the name they answer to.

    Files that are a run each answer together to what their names have in common, unless a row
    names one of them by itself.
    """
    named = {
        (entry.season, match_key(name)) for entry in entries for name in _names_of_files(entry)
    }
    by_name: _FilesByName = defaultdict(list)
    by_run: dict[tuple[int, str], dict[int, list[ArchiveFile]]] = defaultdict(dict)
    for file in sample_files:
        key = (file.season, match_key(file.full_path.name))
        by_name[key].append(SamplesFile((file,)))
        run = as_one_run(file.full_path.name)
        if run is not None and key not in named:
            tow = run[0] or fold_word(file.full_path.parent.name)
            by_run[file.season, tow].setdefault(run[1], []).append(file)
    for key, runs in by_run.items():
        if key not in by_name and all(len(files) == 1 for files in runs.values()):
            by_name[key].append(SamplesFile(tuple(runs[run][0] for run in sorted(runs))))
    return by_name


def _candidates(name: str, season: int, by_name: _FilesByName) -> list[SamplesFile]:
    """Return the files a name in a list can mean; a name with its extension is more precise."""
    key = match_key(name)
    alike = by_name.get((season, key)) or by_name.get((0, key), [])
    exact = [file for file in alike if fold_word(file.parts[0].full_path.name) == fold_word(name)]
    return exact if len(exact) == 1 else alike


def _not_listed(
    entries: Iterable[_Entry],
    sample_files: list[ArchiveFile],
    unread_seasons: set[int],
    by_name: _FilesByName,
) -> list[Fault]:
    """Return a fault for each samples file no row names, in seasons whose list could be read.

    Rows that are set aside for another reason name their files all the same.
    """
    named = {
        part.path
        for entry in entries
        for name in _names_of_files(entry)
        for season in (entry.season, 0)
        for file in by_name.get((season, match_key(name)), [])
        for part in file.parts
    }
    faults = []
    for file in sample_files:
        if file.path in named:
            continue
        if not file.inside:
            faults.append(fault_from(outside_archive(file.path), file.path))
        elif not unread_seasons & {file.season, 0} and (file.season or not unread_seasons):
            message = say("No row of a tow list names this file.")
            faults.append(Fault(file.path, None, None, "samples_not_listed", message))
    return faults


# Rows, boats and files compared with each other


def _keep(
    check: Callable[[_Entry], None],
    entries: list[_Entry],
    faults: list[Fault],
    more: list[Fault] | None = None,
) -> list[_Entry]:
    """Return the entries that pass a check; the others leave a fault, and `more` of a row."""
    passed = []
    for entry in entries:
        try:
            check(entry)
        except DefectiveInputError as error:
            faults.append(fault_from(error, entry.list_path, entry.tow_id))
            if more is not None:
                more += [fault_from(e, entry.list_path, entry.tow_id) for e in others_of(error)]
        else:
            passed.append(entry)
    return passed


def _unique_ids(entries: Iterable[_Entry]) -> Callable[[_Entry], None]:
    """Return the check that a row's `sleep_id` is its own."""
    by_id: dict[str, list[_Entry]] = defaultdict(list)
    for entry in entries:
        if entry.tow_id is not None:
            by_id[entry.tow_id].append(entry)

    def check(entry: _Entry) -> None:
        same = by_id[entry.tow_id] if entry.tow_id is not None else [entry]
        if len(same) == 1:
            return
        identical = all(other.row.cells == entry.row.cells for other in same)
        if identical and entry is same[0]:
            return
        other = next(other for other in same if other is not entry)
        message = say(
            "sleep_id {tow} is also on {where}; {ending}",
            tow=shorten(entry.tow_id or ""),
            where=other.where,
            ending=ROWS_ARE_EQUAL if identical else ROWS_DIFFER,
        )
        raise entry.row.fault(message, "duplicate_tow_id")

    return check


def _read_values(entry: _Entry, profiles: Profiles) -> None:
    entry.row.check_whole()
    rate_hz = profiles.for_season(entry.season).sample_rate_hz
    read = all_of(
        {
            "tow": partial(tow_list.read_tow, entry.row, entry.season, rate_hz),
            "selection": partial(tow_list.read_selection, entry.row, entry.plan),
            "file": partial(entry.row.text, "file"),
        }
    )
    (entry.tow, entry.lost_cells), entry.selection = read["tow"], read["selection"]
    day = entry.tow["tow_date"]
    entry.row.check_year(day, entry.season, "date_outside_season")


def _lost_cells(entry: _Entry) -> Iterator[Fault]:
    """Return a fault for each cell that the tow does without."""
    for error in entry.lost_cells:
        fault = fault_from(error, entry.list_path, entry.tow_id)
        message = say("{what} The cell counts as empty.", what=fault.message)
        yield replace(fault, message=message, lost="cell")


def _find_files(entry: _Entry, by_name: _FilesByName, hashes: _Hashes) -> None:
    entry.files = [_find_files_of(entry, names, by_name) for names in _names(entry)]
    first, second = entry.files[0], entry.files[1] if len(entry.files) > 1 else None
    entry.tow |= {
        "samples_path": first.path,
        "samples_sha256": hashes.add_samples(first),
        "second_path": second.path if second else None,
        "second_sha256": hashes.add_samples(second) if second else None,
        "list_path": entry.list_path,
        "list_line": entry.row.line,
    }


def _find_files_of(entry: _Entry, names: str, by_name: _FilesByName) -> SamplesFile:
    """Return the samples of a cell: of one name, or of one for each run."""
    files = [_find_file(entry, name, by_name) for name in names.split(PARTS)]
    return SamplesFile(tuple(part for file in files for part in file.parts))


def _find_file(entry: _Entry, name: str, by_name: _FilesByName) -> SamplesFile:
    values = {"name": shorten(name), "folder": f"meetdata_{entry.season}/"}
    if "/" in name or "\\" in name or name.startswith(".."):
        message = "'{name}' is a path; only the name of a file in {folder} can stand here."
        raise entry.row.fault(say(message, **values), "path_outside_archive")
    candidates = _candidates(name, entry.season, by_name)
    if not candidates:
        message = say("there is no file '{name}' in {folder}.", **values)
        raise entry.row.fault(message, "samples_missing")
    if len(candidates) > 1:
        names = ", ".join(f"'{file.parts[0].full_path.name}'" for file in candidates)
        message = say("'{name}' can be any of {found}.", name=shorten(name), found=names)
        raise entry.row.fault(message, "ambiguous_file")
    outside = [part for part in candidates[0].parts if not part.inside]
    if outside:
        raise outside_archive(outside[0].path)
    return candidates[0]


def _fits_table(entries: Iterable[_Entry]) -> Callable[[_Entry], None]:
    """Return the check that a tow lies within the limits of the table `tows`."""
    frame = frame_of(ListedTows, [entry.tow for entry in entries])
    why = {row["tow_id"]: sentence for row, sentence in misfits(ListedTows, frame)}

    def check(entry: _Entry) -> None:
        if entry.tow_id in why:
            raise entry.row.fault(why[entry.tow_id], "bad_list_row")

    return check


def _unique_samples(entries: Iterable[_Entry]) -> Callable[[_Entry], None]:
    """Return the check that a row's samples are its own, by content.

    A first file may be the second file of another tow of the same boat: that is how two tows are
    combined.
    """
    first: dict[str, list[_Entry]] = defaultdict(list)
    users: dict[str, list[_Entry]] = defaultdict(list)
    for entry in entries:
        first[entry.tow["samples_sha256"]].append(entry)
        for sha256 in _contents(entry):
            users[sha256].append(entry)

    def check(entry: _Entry) -> None:
        sha256 = entry.tow["samples_sha256"]
        if sha256 == entry.tow["second_sha256"]:
            message = say("meetfile and meetfile2 hold the same samples.")
            raise entry.row.fault(message, "samples_listed_twice")
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
            message = say(
                "'{path}' holds the samples that {where} uses already for {boat}.",
                path=entry.tow["samples_path"],
                where=earliest.where,
                boat=boat,
            )
            raise entry.row.fault(message, "duplicate_tow")

    return check


def _contents(entry: _Entry) -> list[str]:
    hashes = (entry.tow["samples_sha256"], entry.tow["second_sha256"])
    return [sha256 for sha256 in hashes if sha256 is not None]


def _crew(entry: _Entry) -> tuple[int, str]:
    return entry.tow["rowers"], entry.tow["crew_class"]


def _listed_twice(entry: _Entry, other: _Entry) -> DefectiveInputError:
    boat, crew = other.tow["fsn_no"], f"{other.tow['rowers']}{other.tow['crew_class']}"
    message = say(
        "the samples are also used for {boat} {crew} on {where}; nobody can know whose they are.",
        boat=boat,
        crew=crew,
        where=other.where,
    )
    return entry.row.fault(message, "samples_listed_twice")


def _join_boat(entry: _Entry, boats: Boats) -> None:
    fsn_no = entry.tow["fsn_no"]
    why = boats.bad.get(fsn_no)
    if why is not None:
        message = say(
            "boat {boat} cannot be used, see {path}: {why}",
            boat=fsn_no,
            path=why.path,
            why=why.message,
        )
        raise entry.row.fault(message, why.reason_code)
    boat = boats.find(fsn_no)
    if boat is None:
        message = say("boat {boat} is not in the boat list.", boat=shorten(fsn_no))
        raise entry.row.fault(message, "unknown_boat")
    apart = tow_list.unlike_boat(entry.tow, boat, entry.row)
    weight = [apart.pop(key) for key in ("weight_kg",) if key in apart]
    if apart:
        raise DefectiveRowError([*apart.values(), *weight])
    entry.lost_cells = [*entry.lost_cells, *weight]
    entry.tow |= {"weight_kg": None} if weight else {}
    has_wind = "wind" not in entry.profiles.for_season(entry.season).absent
    filled = tow_list.fill_dimensions(entry.tow, boat, entry.row, has_wind)
    entry.tow = filled | {"fsn_no": boat["fsn_no"]}


def _place_day(entry: _Entry, profiles: Profiles) -> None:
    """Note which logs were on board that day, unless it is set aside."""
    day = entry.tow["tow_date"]
    reason = profiles.reason_set_aside(day)
    if reason is not None:
        message = say("{day} is set aside in archief.toml: {reason}.", day=day, reason=reason)
        raise entry.row.fault(message, "day_set_aside")
    absent = profiles.for_season(entry.season).absent
    entry.tow |= {f"{channel}_measured": channel not in absent for channel in ("wind", "log2")}
    for log in ("log1", "log2"):
        entry.tow[f"{log}_part"] = profiles.part_of_log(log, day)


def _runs(entry: _Entry) -> list[Row]:
    plan = entry.plan
    ways_of = {0: plan.directions, SECOND_FILE_OFFSET: plan.second_directions or plan.directions}
    files = list(ways_of.items())[: len(entry.files)]
    return [
        {
            "tow_id": entry.tow["tow_id"],
            "run": offset + number,
            "direction": ways[number - 1],
            "target_speed_ratio": plan.targets[number - 1],
            "selected": offset + number in entry.selection,
            "planned_s": plan.seconds,
        }
        for offset, ways in files
        for number in plan.runs
    ]
