"""What an archive says, but for the samples: boats, tows with their files, and the faults."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import polars as pl

from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say
from pipeline.tables.declare import dy
from pipeline.tables.frames import make_frame
from pipeline.tables.lake import ListedFiles, ListedRuns, ListedTows
from warehouse.archive.columns import fold
from warehouse.archive.faults import Fault, make_fault
from warehouse.archive.files import (
    SAMPLES,
    ArchiveFile,
    fold_file_name,
    hash_files,
    list_files,
    make_outside_archive_error,
)
from warehouse.archive.kinds import ACCEPTANCES, BOATS, FORCE_CHECKS, LAMPS, TOWS, ListKind
from warehouse.archive.list_rules import (
    check_hand_windows,
    find_recordings,
    read_acceptances,
    read_boats,
    read_force_checks,
    read_lamps,
    read_window_lists,
    read_within_border,
)
from warehouse.archive.lists import read_lists
from warehouse.archive.profile import PROFILE_FILE, Profiles, read_profiles
from warehouse.archive.tows import check_tows, index_samples, name_run_files, plan_runs


@dataclass(frozen=True)
class ArchiveIndex:
    """Everything an archive says, but for the samples themselves.

    Attributes:
        boats: one row per boat and crew (`ListedBoats`).
        tows: one row per tow that can be read.
        runs: one row per run of those tows; runs of a second file are 21 and on.
        windows: windows given by hand for those runs (`ListedWindows`), of which nobody knows yet
            whether they lie in their run.
        acceptances: tows that a person accepted (`ListedAcceptances`).
        faults: what is set aside, and why.
        files: every file that was looked at.
        profiles: `archief.toml`.
    """

    boats: pl.DataFrame
    tows: pl.DataFrame
    runs: dy.DataFrame[ListedRuns]
    windows: pl.DataFrame
    acceptances: pl.DataFrame
    faults: tuple[Fault, ...]
    files: dy.DataFrame[ListedFiles]
    profiles: Profiles


def index_archive(
    root: Path, hash_file: Callable[[Path], str], profiles: Profiles | None = None
) -> ArchiveIndex:
    """Read the lists of an archive and find the files of every tow; samples are only hashed.

    Args:
        root: folder of the archive.
        hash_file: gives the SHA-256 of a file; `FileHashes.hash_file` remembers them.
        profiles: `archief.toml`, where it is not the one in the archive.

    Raises:
        MissingKnowledgeError: there is no archive, or `archief.toml` cannot be understood.
    """
    profiles = profiles or read_profiles(root)
    files = list_archive_files(root, profiles)
    hashes, unread = hash_files(files, hash_file)
    boats = read_boats(files, profiles)
    rows = read_lists(files, TOWS, profiles)
    listed = rows.listed.select("season", "tow_id", "tow_date", "file", "second_file")
    checks, check_faults = read_within_border(
        FORCE_CHECKS, files, lambda own: read_force_checks(own, profiles)
    )
    burned, lamp_faults = read_within_border(
        LAMPS, files, lambda own: read_lamps(own, profiles, listed["tow_id"])
    )
    samples = index_samples(files, hashes)
    window_rows = read_window_lists(files, profiles, listed.select("season", "tow_id"))
    recordings = find_recordings(window_rows, profiles)
    selections = check_tows(rows, samples, boats, profiles, checks, burned, recordings)
    tows = rows.to_table(ListedTows)
    runs = plan_runs(tows, selections, profiles)
    windows = check_hand_windows(window_rows, runs)
    acceptances, acceptance_faults = read_within_border(
        ACCEPTANCES, files, lambda own: read_acceptances(own, profiles, listed, runs)
    )

    faults = boats.faults + rows.faults + check_faults + lamp_faults + window_rows.faults
    faults += acceptance_faults
    faults += _find_unread_files(files, profiles)
    faults += _find_unlisted_samples(files, listed, rows.unread, profiles)
    if not rows.unread:
        faults += _find_idle_settings(profiles, listed)
    told = {fault.path for fault in faults if fault.reason_code == "unreadable_file"}
    faults += [make_fault(error, error.path) for error in unread if error.path not in told]
    kinds = {file.path: _name_kind(file) for file in files}
    file_rows = [
        (path, kinds[path], sha256, size) for path, (sha256, size) in sorted(hashes.items())
    ]
    return ArchiveIndex(
        boats=boats.listed,
        tows=tows,
        runs=runs,
        windows=windows,
        acceptances=acceptances,
        faults=tuple(sorted(faults, key=lambda f: (f.path, f.line or 0, f.tow_id or ""))),
        files=make_frame(ListedFiles, file_rows),
        profiles=profiles,
    )


def list_archive_files(root: Path, profiles: Profiles | None = None) -> list[ArchiveFile]:
    """Return the files of an archive, which has at least a list of boats and one of tows.

    Raises:
        MissingKnowledgeError: there is no archive, or one of these lists is missing.
    """
    if not root.is_dir():
        raise MissingKnowledgeError(
            "There is no archive at {}: expected a folder with {}, sleeplijsten/ and "
            "meetdata_<jaar>/.",
            root,
            _name_file(BOATS, Profiles()),
        )
    known = profiles or read_profiles(root)
    files = list_files(root, known)
    kinds = [file.kind for file in files]
    missing = None
    if BOATS not in kinds:
        missing = say(
            "there is no list of boats: {path} is expected.", path=_name_file(BOATS, known)
        )
    elif TOWS not in kinds:
        path = _name_file(TOWS, known)
        missing = say("there is no list of tows: {path} is expected.", path=path)
    if missing is not None:
        raise MissingKnowledgeError("The archive at {} cannot be read: {}", root, missing)
    return files


def _name_kind(file: ArchiveFile) -> str:
    """Return what a file is: a kind of list by its name, samples, or the profile."""
    if isinstance(file.kind, ListKind):
        return file.kind.name
    return "profile" if file.kind == PROFILE_FILE else file.kind


def _name_file(kind: ListKind, profiles: Profiles) -> str:
    """Return where a list is looked for, as people read it."""
    return profiles.find_place(kind).replace("{year}", "<jaar>") + ".csv"


def _find_unread_files(files: Iterable[ArchiveFile], profiles: Profiles) -> list[Fault]:
    """Return a fault for each file of the archive that is not read."""
    text = say(
        "'{path}' is not read: it has another name than the archive's files. Rename it, or put it "
        "under ignore in archief.toml."
    )
    faults = []
    for file in files:
        if not file.kind and fold(file.path) not in profiles.ignore:
            said = say(text, path=file.path)
            faults.append(Fault(path=file.path, reason_code="unrecognised_file", message=said))
    return faults


def _find_unlisted_samples(
    files: Iterable[ArchiveFile],
    listed: pl.DataFrame,
    unread_lists: set[str],
    profiles: Profiles,
) -> list[Fault]:
    """Return the samples that no row names, in seasons whose list could be read."""
    unread_seasons = {file.season for file in files if file.path in unread_lists}
    named = set()
    names = listed.select("tow_id", "season", "file", "second_file")
    for tow_id, season, first, second in names.iter_rows():
        plan, profile = profiles.find_plan(tow_id or "", season), profiles.find(season)
        for cell in (first, second):
            if cell:
                named.add(fold_file_name(cell))
                named.update(name_run_files(cell, profile, plan).values())
    message = say("No row of a tow list names this file.")
    faults = []
    for file in files:
        is_named = fold_file_name(file.full_path.name) in named
        if file.kind != SAMPLES or is_named or file.season in unread_seasons:
            continue
        if file.inside:
            fault = Fault(path=file.path, reason_code="samples_not_listed", message=message)
            faults.append(fault)
        else:
            faults.append(make_fault(make_outside_archive_error(file.path), file.path))
    return faults


def _find_idle_settings(profiles: Profiles, listed: pl.DataFrame) -> list[Fault]:
    """Return a fault for each day, season or tow of `archief.toml` that no list has."""
    days = set(listed["tow_date"])
    seasons = set(listed["season"])
    tows = set(listed["tow_id"])

    faults = []

    def add(table: str, what: object, *, is_idle: bool) -> None:
        if is_idle:
            text = say("[[{table}]] is for {what}, and no tow list has that: is it mistyped?")
            said = say(text, table=table, what=str(what))
            faults.append(Fault(path=PROFILE_FILE, reason_code="idle_setting", message=said))

    def has_season(bounds: tuple[int, int]) -> bool:
        return not seasons.isdisjoint(range(bounds[0], bounds[1] + 1))

    for one in profiles.set_aside:
        add("set_aside", one.date, is_idle=one.date not in days)
    for replaced in profiles.log_replaced:
        add("log_replaced", replaced.date, is_idle=replaced.date.year not in seasons)
    for table in profiles.profile:
        add("profile", table.seasons, is_idle=not has_season(table.seasons))
    for plan in profiles.plan:
        for tow_id in plan.tows:
            add("plan", tow_id, is_idle=tow_id not in tows)
        if plan.seasons:
            add("plan", plan.seasons, is_idle=not has_season(plan.seasons))
    return faults
