"""Reading the lists of an archive, and finding the files of every tow.

Reading samples belongs to `samples`. A tow falls out at the first check that it does not pass.
"""

import datetime as dt
import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import polars as pl

from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say
from pipeline.tables.declare import dy
from pipeline.tables.lake import ListedFiles, ListedRuns, ListedTows
from warehouse.archive.faults import DefectiveFileError, Fault, fault_from
from warehouse.archive.files.finding import STRANGER, ArchiveFile, files_of
from warehouse.archive.files.list_kinds import TOWS
from warehouse.archive.files.names import PROFILE_FILE, SAMPLES
from warehouse.archive.index.files import (
    Hashes,
    as_files,
    files_by_name,
    files_meant,
    hash_files,
    missing_lists,
    names_of_files,
    not_listed,
    strangers,
)
from warehouse.archive.index.tows import (
    as_listed,
    lost_cells,
    of_days_in_use,
    of_one_row,
    runs_of,
    with_boat,
    with_files,
    with_instruments,
    with_own_samples,
    within_limits,
)
from warehouse.archive.lists.boats import Boats, read_boats
from warehouse.archive.lists.instruments import lamp_seconds, read_force_checks, read_lamps
from warehouse.archive.lists.tows import readable, with_ids
from warehouse.archive.lists.windows import read_windows
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.profile.reading import read_profiles
from warehouse.archive.sheets.reading import read_lists
from warehouse.archive.sheets.rows import Problem


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


@contextmanager
def _uncollected() -> Iterator[None]:
    """Pauses the search for reference cycles: among 400,000 faults it takes 5 of 14 s."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


@_uncollected()
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
    files = files_of(root, profiles.files)
    lacking = missing_lists(root, files)
    if lacking:
        raise MissingKnowledgeError(
            "The archive at {} cannot be read: {}", root, lacking[0].message
        )
    hashes = hash_files((file for file in files if file.kind != STRANGER), hash_file)
    rows, problems, faults = read_lists(files, TOWS, profiles)
    unread = {file.season for file in files if file.path in {fault.path for fault in faults}}
    year = pl.col("tow_date").dt.year().cast(pl.Int64).fill_null(0)
    rows = rows.with_columns(season=pl.when(pl.col("season") == 0).then(year).otherwise("season"))
    faults += strangers(root, files, profiles.ignore)
    read = _Read(profiles, files, hashes, read_boats(files, profiles), problems, unread)
    index, failures = _index_or_set_aside(rows, read)
    faults += [*failures, *read.boats.faults, *index.faults]
    told = {fault.path for fault in faults if fault.reason_code == "unreadable_file"}
    faults += [
        fault_from(found, path)
        for path, found in hashes.items()
        if isinstance(found, DefectiveFileError) and path not in told
    ]
    return replace(index, faults=tuple(sorted(faults, key=_fault_order)))


@dataclass(frozen=True)
class _Read:
    """What is read of an archive before its tows.

    Attributes:
        files: everything that lies in it.
        hashes: of its files.
        boats: the boat lists.
        problems: what is wrong in the cells of the tow lists.
        unread: the seasons of tow lists that cannot be read.
    """

    profiles: Profiles
    files: list[ArchiveFile]
    hashes: Hashes
    boats: Boats
    problems: list[Problem]
    unread: set[int]


def _index_or_set_aside(rows: pl.DataFrame, read: _Read) -> tuple[ArchiveIndex, list[Fault]]:
    """The index of the rows; one on which Herijk itself fails is set aside alone."""
    try:
        return _index(rows, read), []
    except BaseException as error:
        fault_from(error, "")  # raises what is no fault of Herijk
    failures = {}
    for row in rows.iter_slices(1):
        try:
            _index(row, read)
        except BaseException as error:
            of = row.row(0, named=True)
            failures[of["row"]] = fault_from(error, of["path"], of["cells"]["tow_id"])
    others = rows.filter(~pl.col("row").is_in([*failures]))
    return _index(others, read), [*failures.values()]


def _index(rows: pl.DataFrame, read: _Read) -> ArchiveIndex:
    """What rows of tow lists come to, with the faults that are about them."""
    profiles, files = read.profiles, read.files
    samples = [file for file in files if file.kind == SAMPLES]
    faults: list[Fault] = []
    more = [*read.boats.more]
    names = names_of_files(rows)
    by_name = files_by_name(samples, names)
    faults += not_listed(names, samples, read.unread, by_name)
    rows = with_ids(rows)
    listed = rows.select("season", "tow_id", "tow_date")
    faults += [] if read.unread else _idle_settings(profiles, *map(set, listed))
    checks, of_checks = read_force_checks(files, profiles)
    lamps, of_lamps = read_lamps(files, profiles, listed["tow_id"].drop_nulls())
    own = of_one_row(rows, faults)
    again = rows.join(own, on="row", how="anti", maintain_order="left")
    readable(again, read.problems, profiles, more, more)
    tows, selections, lost = readable(own, read.problems, profiles, faults, more)
    tows = with_files(tows, by_name, read.hashes, faults)
    tows = with_own_samples(tows, faults)
    tows = with_boat(tows, read.boats, profiles, faults, lost)
    tows = of_days_in_use(tows, profiles, faults)
    tows = with_instruments(tows, profiles, checks, lamp_seconds(lamps))
    tows = within_limits(tows, faults)
    runs = runs_of(tows, selections, profiles)
    windows, of_windows = read_windows(files, profiles, listed.select("season", "tow_id"), runs)
    faults += [*lost_cells(tows, lost), *of_checks, *of_lamps, *of_windows]
    return ArchiveIndex(
        boats=read.boats.listed,
        tows=as_listed(tows),
        runs=runs,
        windows=windows,
        faults=tuple(faults),
        files=as_files(read.hashes),
        profiles=profiles,
        seasons={
            part.path: season
            for season, name in names
            for file in files_meant(name, season, by_name)
            for part in file.parts
        },
        more=tuple(more),
    )


def _fault_order(fault: Fault) -> tuple[str, int, str]:
    return fault.path, fault.line or 0, fault.tow_id or ""


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
