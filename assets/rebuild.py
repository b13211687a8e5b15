"""The command `herijk rebuild`: one run of the job `rebuild`, unless nothing has changed.

Whether anything has is one question: are the archive, the rules of people, our code and our own
files those of the last whole rebuild? It is answered without Dagster, whose import takes a second.
"""

import datetime as dt
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Final

from assets.report import Done, Report, confirm_report, failed_checks, read_report, record_failure
from assets.settings import FILE_NAME
from pipeline.errors import HerijkError, MissingKnowledgeError, NoTowsYetError
from warehouse.archive import list_archive_files
from warehouse.intake.lake import ArchiveChangedError
from warehouse.intake.seasons import listing
from warehouse.store.code import hash_code
from warehouse.store.files import write_beside
from warehouse.store.lock import hold_write_lock
from warehouse.store.machine_faults import explain_machine_faults
from warehouse.store.store import DamagedFileError, Store, fingerprint

EVERYTHING: Final = ("pipeline", "warehouse", "dashboards", "assets")
"""Packages of which a changed byte may make any table or page stale."""

OUR_FOLDERS: Final = ("lake/samples", "lake/blocks", "lake/tables", "site", "methods", "editions")
OUR_FILES: Final = ("warehouse.duckdb", "warehouse.duckdb.wal", "besluiten.toml", FILE_NAME)
"""What of a data folder a rebuild reads or leaves behind."""

MAX_ATTEMPTS: Final = 3


def rebuild(
    archive: Path,
    data: Path,
    methods: Sequence[str],
    seasons: Collection[int] | None = None,
    selection: Collection[str] | None = None,
) -> Report:
    """Bring the data folder up to date with the archive; report what that changed.

    A damaged file of the data folder is removed where it is met. The run then begins again and
    makes it anew, as it does where the archive changed meanwhile.

    Args:
        archive: the archive folder.
        data: the data folder; made if it is not there.
        methods: names of methods; the others are compared with the first.
        seasons: seasons of which changed files are read; None for all.
        selection: names of the assets to make; None for all.

    Raises:
        HerijkError: there is no archive, a promise was broken, or another rebuild is at work.
    """
    check_apart(archive, data)
    if not data.exists():
        list_archive_files(archive)  # a first rebuild that is refused leaves no folder
    store = Store(data.resolve())
    asked = fingerprint(sorted(methods), sorted(seasons or ()))
    with explain_machine_faults(data), hold_write_lock(data):
        if _is_unchanged(store, archive, asked):
            return confirm_report(store, dt.datetime.now().astimezone())
        try:
            list_archive_files(archive)  # refuses what is no archive, before Dagster is imported
            with explain_machine_faults(data):
                done = _run_until_sound(archive, data, methods, sorted(seasons or ()), selection)
        except NoTowsYetError:
            raise
        except HerijkError as error:
            record_failure(store, dt.datetime.now().astimezone(), str(error))
            raise
        report = read_report(store, done)
        if selection is None and not failed_checks(report.checks):
            with write_beside(_stamp_path(store)) as beside:
                beside.write_text(compute_stamp(store, archive, asked))
    return report


def _run_until_sound(
    archive: Path,
    data: Path,
    methods: Sequence[str],
    seasons: Sequence[int],
    selection: Collection[str] | None,
) -> Done:
    """Run the job; again where a damaged file was removed or the archive changed meanwhile."""
    from assets.run import run_job  # noqa: PLC0415 - it imports Dagster

    for _ in range(MAX_ATTEMPTS - 1):
        try:
            return run_job(archive, data, methods, seasons, selection)
        except (DamagedFileError, ArchiveChangedError):
            continue
    return run_job(archive, data, methods, seasons, selection)


def compute_stamp(store: Store, archive: Path, asked: str) -> str:
    """Return a fingerprint of all that a rebuild reads and leaves behind.

    Files count by size and time of their last change.

    Args:
        store: the data folder.
        archive: the archive.
        asked: fingerprint of what the command was asked to do.
    """
    files = []
    for name in OUR_FOLDERS:
        files += [file for file in (store.root / name).rglob("*") if file.is_file()]
    for name in OUR_FILES:
        if (store.root / name).exists():
            files.append(store.root / name)
    ours = []
    for file in sorted(files):
        stat = file.stat()
        ours.append((str(file.relative_to(store.root)), stat.st_size, stat.st_mtime_ns))
    place = str(archive.resolve())
    return fingerprint(asked, place, listing(archive), ours, hash_code(*EVERYTHING))


def _is_unchanged(store: Store, archive: Path, asked: str) -> bool:
    """Return whether everything is as the last whole rebuild left it."""
    path = _stamp_path(store)
    if not path.exists():
        return False
    try:
        return path.read_text(encoding="utf-8") == compute_stamp(store, archive, asked)
    except MissingKnowledgeError:  # the archive is gone: the run says so
        return False


def _stamp_path(store: Store) -> Path:
    return store.lake / "whole.txt"


def check_apart(archive: Path, data: Path) -> None:
    """Refuse an archive in the data folder: a rebuild would write among what it reads.

    Raises:
        MissingKnowledgeError: the archive is the data folder, or lies in it.
    """
    if archive.resolve().is_relative_to(data.resolve()):
        raise MissingKnowledgeError(
            "the archive {} lies in the data folder {}, or is the same; name a data "
            "folder outside the archive with --data",
            archive,
            data,
        )
