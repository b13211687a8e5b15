"""The command `herijk rebuild`: one run of the job `rebuild`, unless nothing has changed.

Whether anything has is one question: are the archive, the rules of people, our code and our own
files those of the last whole rebuild? It is answered without Dagster, whose import takes a second.
"""

from collections.abc import Collection, Sequence
from pathlib import Path

from assets.report import Report, failed_checks, read_report
from assets.settings import FILE_NAME
from pipeline.errors import MissingKnowledgeError
from warehouse.intake.lake import ArchiveChangedError
from warehouse.intake.seasons import listing
from warehouse.store.code import code_hash
from warehouse.store.files import written_beside
from warehouse.store.store import DamagedFileError, Store, fingerprint

EVERYTHING = ("pipeline", "warehouse", "dashboards", "assets")
OURS = ("lake/tables", "site", "methods", "editions")
OUR_FILES = ("warehouse.duckdb", "warehouse.duckdb.wal", "besluiten.toml", FILE_NAME)
ATTEMPTS = 3


def rebuild(
    archive: Path, data: Path, methods: Sequence[str], seasons: Collection[int] | None = None
) -> Report:
    """Brings the data folder up to date with the archive, and reports what that changed.

    A damaged file of ours is removed where it is found; so it begins again, as it does where the
    archive changed meanwhile.

    Raises:
        HerijkError: there is no archive, a promise was broken, or another rebuild is at work.
    """
    check_apart(archive, data)
    store, asked = Store(data), fingerprint(sorted(methods), sorted(seasons or ()))
    if stamp_path(store).exists() and stamp_path(store).read_text() == stamp(store, archive, asked):
        return read_report(store, nothing_changed=True)
    from assets.run import run_job  # noqa: PLC0415 - see above

    for attempt in range(ATTEMPTS):
        try:
            made, checks = run_job(archive, data, methods, sorted(seasons or ()))
            break
        except (DamagedFileError, ArchiveChangedError):
            if attempt == ATTEMPTS - 1:
                raise
    if not failed_checks(checks):
        with written_beside(stamp_path(store)) as beside:
            beside.write_text(stamp(store, archive, asked))
    return read_report(store, checks, nothing_changed="report" not in made, made=made)


def stamp_path(store: Store) -> Path:
    """Holds the fingerprint of the last rebuild that was whole."""
    return store.lake / "whole.txt"


def stamp(store: Store, archive: Path, asked: str) -> str:
    """Fingerprint of all that a rebuild reads and leaves behind, by size and time of each file."""
    files = [f for name in OURS for f in (store.root / name).rglob("*") if f.is_file()]
    files += [f for name in OUR_FILES if (f := store.root / name).exists()]
    ours = sorted((str(f), f.stat().st_size, f.stat().st_mtime_ns) for f in files)
    where = str(archive.resolve())
    return fingerprint(asked, where, listing(archive), ours, code_hash(*EVERYTHING))


def check_apart(archive: Path, data: Path) -> None:
    """Refuses an archive in the data folder: a rebuild would write among what it reads.

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
