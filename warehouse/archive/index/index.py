"""Reading the lists of an archive, and finding the files of every tow.

Reading samples belongs to `samples`. A tow falls out at the first check that it does not pass.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import polars as pl

from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.errors import MissingKnowledgeError
from pipeline.tables.declare import dy
from pipeline.tables.frames import frame_of
from pipeline.tables.lake import ListedFiles, ListedRuns, ListedTows
from pipeline.tables.row import Row
from warehouse.archive.faults import Fault
from warehouse.archive.files.finding import list_sample_files
from warehouse.archive.index.comparisons import (
    fits_table,
    join_boat,
    keep,
    lost_cells,
    place_day,
    read_cells,
    unique_ids,
    unique_samples,
)
from warehouse.archive.index.hashed_files import Hashes, hash_files, hash_lists
from warehouse.archive.index.tow_files import (
    files_by_name,
    files_meant,
    find_files,
    names_of_files,
    not_listed,
)
from warehouse.archive.index.tow_rows import Entry, idle_settings, read_tow_lists
from warehouse.archive.index.unread_files import missing_lists, strangers
from warehouse.archive.lists.boats import read_boats
from warehouse.archive.lists.instruments import (
    lamp_seconds,
    load_cell_of,
    read_force_checks,
    read_lamps,
)
from warehouse.archive.lists.windows import read_windows
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.profile.reading import read_profiles


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


def index_archive(
    root: Path, hash_file: Callable[[Path], str], profiles: Profiles | None = None
) -> ArchiveIndex:
    """Reads the lists of an archive and finds the files of every tow.

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
    hashes = Hashes(hash_file)
    faults: list[Fault] = []
    unhashed = hash_lists(root, named, hashes)
    faults += strangers(root, profiles)
    boats = read_boats(root, profiles.wording)
    faults += boats.faults
    entries, unread_seasons = read_tow_lists(root, profiles, faults)
    sample_files = list_sample_files(root, named)
    faults += hash_files(sample_files, hashes)
    by_name = files_by_name(sample_files, entries)
    faults += not_listed(entries, sample_files, unread_seasons, by_name)
    faults += [] if unread_seasons else idle_settings(profiles, entries)
    more = list(boats.more)
    read_values = partial(read_cells, profiles=profiles)
    good = keep(unique_ids(entries), entries, faults)
    twice = {(entry.list_path, entry.row.line) for entry in entries}
    twice -= {(entry.list_path, entry.row.line) for entry in good}
    again = [entry for entry in entries if (entry.list_path, entry.row.line) in twice]
    keep(read_values, again, more, more)
    good = keep(read_values, good, faults, more)
    good = keep(lambda entry: find_files(entry, by_name, hashes), good, faults)
    good = keep(unique_samples(good), good, faults)
    good = keep(lambda entry: join_boat(entry, boats), good, faults)
    good = keep(lambda entry: place_day(entry, profiles), good, faults)
    good = keep(fits_table(good), good, faults)
    faults += [fault for entry in good for fault in lost_cells(entry)]
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
            for name in names_of_files(entry)
            for file in files_meant(name, entry.season, by_name)
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


def _add_instruments(
    root: Path,
    profiles: Profiles,
    entries: list[Entry],
    good: list[Entry],
    faults: list[Fault],
) -> None:
    """Puts what is known of the load cell and the warning lamps into the tows."""
    tow_ids = {entry.tow_id for entry in entries if entry.tow_id is not None}
    checks, unread = read_force_checks(root, profiles.wording)
    lamps, unread_lamps = read_lamps(root, profiles.wording, tow_ids)
    faults += [*unread, *unread_lamps]
    burned = lamp_seconds(lamps)
    for entry in good:
        seconds = burned.get(entry.tow["tow_id"])
        entry.tow |= load_cell_of(entry.tow, checks)
        entry.tow["lamp_ratio"] = None if seconds is None else seconds / entry.plan.seconds


def _runs(entry: Entry) -> list[Row]:
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
