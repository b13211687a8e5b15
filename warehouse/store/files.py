"""Writing files so that nothing half-written is ever visible: beside, sync, rename; and hashes."""

import hashlib
import os
import shutil
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

TEMPORARY_PREFIX = ".herijk-"
"""Begins the name of every file that is still being written."""


@contextmanager
def write_beside(path: Path, mode: int = 0o644) -> Iterator[Path]:
    """Yield a temporary path in the same folder; rename it to `path` if all went well.

    The content is synced before the rename, and the rename replaces an older file at once; after
    an error or a kill the older file is still there, whole.

    Args:
        path: the file to write.
        mode: who may read and write it.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(prefix=TEMPORARY_PREFIX, suffix=path.suffix, dir=path.parent)
    os.close(handle)
    beside = Path(name)
    try:
        yield beside
        sync(beside)
        beside.chmod(mode)
        beside.replace(path)
        sync(path.parent)
    finally:
        beside.unlink(missing_ok=True)


@contextmanager
def write_folder_beside(target: Path) -> Iterator[Path]:
    """Yield a temporary folder; put it in the place of `target` if all went well.

    All files are synced first. The older folder is renamed before, so for a moment there is none.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    beside = Path(tempfile.mkdtemp(prefix=TEMPORARY_PREFIX, dir=target.parent))
    old = beside.with_name(f"{beside.name}-old")
    try:
        yield beside
        beside.chmod(0o755)
        with ThreadPoolExecutor() as threads:  # a site has a thousand files
            list(threads.map(sync, [beside] + list(beside.rglob("*"))))
        if target.exists():
            target.rename(old)
        beside.rename(target)
        sync(target.parent)
    finally:
        shutil.rmtree(beside, ignore_errors=True)
        if target.exists():
            shutil.rmtree(old, ignore_errors=True)


def file_sha256(path: Path) -> str:
    """Return the SHA-256 of a file's content, in hex."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def write_new(path: Path, text: str) -> None:
    """Write a text file that was not there; raise FileExistsError where there is one."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("xb") as file:
        file.write(text.encode())


def sync(path: Path) -> None:
    """Make the system write a file, or the names in a folder, to disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
