"""Writing files so that nothing half-written is ever visible: beside, sync, rename; and hashes."""

import ctypes
import hashlib
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

TEMPORARY_PREFIX = ".herijk-"
"""Begins the name of every file that is still being written."""


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
        _sync(beside)
        beside.chmod(0o644)
        beside.replace(path)
        _sync(path.parent)
    finally:
        beside.unlink(missing_ok=True)


def file_sha256(path: Path) -> str:
    """SHA-256 of a file's content, in hex."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


_EXCHANGE: Final = 2
_FROM_HERE: Final = -100
"""RENAME_EXCHANGE and AT_FDCWD of Linux."""


def swap_folder(beside: Path, target: Path) -> None:
    """Puts a folder in place of another, in one step where the system can (Linux).

    Elsewhere it takes two renames, and for a moment there is no such folder.
    """
    if not target.exists():
        beside.rename(target)
    elif not _exchange(beside, target):
        old = beside.with_name(beside.name + "-old")
        target.rename(old)
        beside.rename(target)
        beside = old
    _sync(target.parent)
    shutil.rmtree(beside, ignore_errors=True)


def _exchange(one: Path, other: Path) -> bool:
    """Lets two paths change names; False where the system or the disk cannot."""
    rename = getattr(ctypes.CDLL(None), "renameat2", None)
    if rename is None:
        return False
    paths = (os.fsencode(one), os.fsencode(other))
    return bool(rename(_FROM_HERE, paths[0], _FROM_HERE, paths[1], _EXCHANGE) == 0)


def _sync(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
