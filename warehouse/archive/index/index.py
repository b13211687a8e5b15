"""Reading the lists of an archive, and finding the files of every tow.

Reading samples belongs to `samples`. A tow falls out at the first check that it does not pass.
"""

import datetime as dt
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import polars as pl

from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say
from pipeline.tables.declare import dy
from pipeline.tables.lake import ListedFiles
from warehouse.archive.faults import Fault
from warehouse.archive.files.finding import list_files, list_sample_files
from warehouse.archive.files.list_kinds import TOWS
from warehouse.archive.files.names import PROFILE_FILE
from warehouse.archive.index.hashed_files import Hashes, hash_files, hash_lists
from warehouse.archive.index.tow_files import (
    files_by_name,
    files_meant,
    names_of_files,
    not_listed,
)
from warehouse.archive.index.tows import Known, usable_tows
from warehouse.archive.index.unread_files import missing_lists, strangers
from warehouse.archive.lists.boats import read_boats
from warehouse.archive.lists.instruments import lamp_seconds, read_force_checks, read_lamps
from warehouse.archive.lists.tows import with_ids
from warehouse.archive.lists.windows import read_windows
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.profile.reading import read_profiles
from warehouse.archive.sheets.reading import read_lists
from warehouse.archive.spelling.wording import Wording


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
    tows: pl.DataFrame
    runs: pl.DataFrame
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
    wording = profiles.wording
    hashes = Hashes(hash_file)
    unhashed = hash_lists(root, wording.files, hashes)
    boats = read_boats(root, wording)
    rows, problems, faults = read_lists(root, TOWS, wording)
    unread = _unread_seasons(root, wording, faults)
    year = pl.col("tow_date").dt.year().fill_null(0)
    season = pl.when(pl.col("season") == 0).then(year).otherwise("season")
    rows = rows.with_columns(season=season.cast(pl.Int64))
    faults += [*strangers(root, profiles), *boats.faults]
    sample_files = list_sample_files(root, wording.files)
    faults += hash_files(sample_files, hashes)
    names = names_of_files(rows)
    by_name = files_by_name(sample_files, names)
    faults += not_listed(names, sample_files, unread, by_name)
    tows_listed = with_ids(rows).select("season", "tow_id", "tow_date")
    faults += [] if unread else _idle_settings(profiles, *map(set, tows_listed))
    checks, of_checks = read_force_checks(root, wording)
    lamps, of_lamps = read_lamps(root, wording, tows_listed["tow_id"].drop_nulls())
    known = Known(problems, profiles, by_name, hashes, boats, checks, lamp_seconds(lamps))
    usable = usable_tows(rows, known)
    windows, of_windows = read_windows(
        root, wording, tows_listed.select("season", "tow_id"), usable.runs
    )
    faults += [*usable.faults, *of_checks, *of_lamps, *of_windows]
    told = {fault.path for fault in faults if fault.reason_code == "unreadable_file"}
    faults += [fault for fault in unhashed if fault.path not in told]
    return ArchiveIndex(
        boats=boats.listed,
        tows=usable.tows,
        runs=usable.runs,
        windows=windows,
        faults=tuple(sorted(faults, key=_fault_order)),
        files=hashes.frame(),
        profiles=profiles,
        seasons={
            part.path: season
            for season, name in names
            for file in files_meant(name, season, by_name)
            for part in file.parts
        },
        more=(*boats.more, *usable.more),
    )


def _unread_seasons(root: Path, wording: Wording, faults: Iterable[Fault]) -> set[int]:
    """The seasons of tow lists that cannot be read."""
    unread = {fault.path for fault in faults}
    return {file.season for file in list_files(root, TOWS, wording.files) if file.path in unread}


def _fault_order(fault: Fault) -> tuple[str, int, str]:
    return fault.path, fault.line or 0, fault.tow_id or ""


def _check_present(root: Path, profiles: Profiles) -> None:
    lacking = missing_lists(root, profiles)
    if lacking:
        raise MissingKnowledgeError(
            "The archive at {} cannot be read: {}", root, lacking[0].message
        )


def _idle_settings(
    profiles: Profiles, seasons: set[int], tows: set[str], days: set[dt.date]
) -> list[Fault]:
    """What `archief.toml` says of days, seasons or tows that no list has: mistyped ones."""
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
    message = say("[[{table}]] is for {what}, and no tow list has that: is it mistyped?")
    return [
        Fault(PROFILE_FILE, None, None, "idle_setting", say(message, table=table, what=what))
        for table, what in idle
    ]
