"""Writing files so that nothing half-written is ever visible: beside, sync, rename; and hashes."""

import ctypes
import hashlib
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

TEMPORARY_PREFIX = ".herijk-"
"""Begins the name of every file that is still being written."""

AT_FDCWD, RENAME_EXCHANGE = -100, 2
"""Arguments of `renameat2(2)`: paths are relative to where we are; exchange the two."""


@contextmanager
def written_beside(path: Path) -> Iterator[Path]:
    """Gives a temporary path in the same folder and, if all went well, renames it to `path`.

    The content is synced before the rename, and the rename replaces an older file at once; after
    an error or a kill the older file is still there, whole.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(prefix=TEMPORARY_PREFIX, suffix=path.suffix, dir=path.parent)
    os.close(handle)
    beside = Path(name)
    try:
        yield beside
        sync(beside)
        beside.chmod(0o644)
        beside.replace(path)
        sync(path.parent)
    finally:
        beside.unlink(missing_ok=True)


@contextmanager
def folder_written_beside(target: Path) -> Iterator[Path]:
    """Gives a temporary folder and, if all went well, puts it in the place of `target` at once."""
    target.parent.mkdir(parents=True, exist_ok=True)
    beside = Path(tempfile.mkdtemp(prefix=TEMPORARY_PREFIX, dir=target.parent))
    try:
        yield beside
        beside.chmod(0o755)
        put_in_place(beside, target)
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def file_sha256(path: Path) -> str:
    """SHA-256 of a file's content, in hex."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def write_new(path: Path, text: str) -> None:
    """Writes a text file that was not there; raises FileExistsError where there is one."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("xb") as file:
        file.write(text.encode())


def put_in_place(beside: Path, target: Path) -> None:
    """Puts a folder under the name of another at once; the older one is `beside` after that.

    All files are synced first. Linux exchanges two names in one step, so that a reader finds the
    old folder or the new one, never none. Elsewhere the older folder is renamed first, and for a
    moment there is none.
    """
    for path in (beside, *beside.rglob("*")):
        sync(path)
    if not target.exists():
        beside.rename(target)
    elif not _exchange(beside, target):
        old = beside.with_name(f"{beside.name}-old")
        target.rename(old)
        beside.rename(target)
        old.rename(beside)
    sync(target.parent)


def _exchange(one: Path, other: Path) -> bool:
    """Exchanges two names in one step; False where system or file system cannot."""
    renameat2 = getattr(ctypes.CDLL(None, use_errno=True), "renameat2", None)
    if renameat2 is None:
        return False
    failed = renameat2(AT_FDCWD, os.fsencode(one), AT_FDCWD, os.fsencode(other), RENAME_EXCHANGE)
    return not failed


def sync(path: Path) -> None:
    """Has the system write a file, or the names in a folder, to disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
