"""One writer at a time in a data folder, and clearing up after writers that were killed.

The lock is the operating system's and dies with its owner, however that ends. Readers need none:
what they read is replaced whole. Publishing an edition has a lock of its own, in `editions`.
"""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from filelock import FileLock, Timeout

from pipeline.errors import UnavailableError
from warehouse.store.files import TEMPORARY_PREFIX

LOCK_FILE: Final = "rebuild.lock"
_NOT_OURS: Final = {"audit", "dagster", "editions"}
"""Folders of the data folder in which others write, without the lock."""


@contextmanager
def hold_write_lock(root: Path, wait: bool = False) -> Iterator[None]:
    """Keep other writers out of a data folder; what dead ones left half-written is removed.

    Args:
        root: the data folder; made if it is not there.
        wait: wait for another writer to end, instead of giving up.

    Raises:
        UnavailableError: another writer is at work.
    """
    root.mkdir(parents=True, exist_ok=True)
    folder = root.resolve()
    # One lock for this process: a step inside a rebuild takes that of the rebuild again.
    lock = FileLock(folder / LOCK_FILE, thread_local=False, is_singleton=True)
    try:
        lock.acquire(blocking=wait)
    except Timeout as error:
        raise UnavailableError(
            "{} is being rebuilt already. Wait until that is done, or stop that process; its lock "
            "goes with it",
            folder,
        ) from error
    try:
        if lock.lock_counter == 1:
            _remove_leftovers(folder)
        yield
    finally:
        lock.release()


def _remove_leftovers(root: Path) -> None:
    """Remove what was still being written; the caller holds the lock, so nobody else writes."""
    pattern = f"{TEMPORARY_PREFIX}*"
    leftovers = list(root.glob(pattern))
    for folder in root.iterdir():
        if folder.is_dir() and folder.name not in _NOT_OURS:
            leftovers += folder.rglob(pattern)
    for left in leftovers:
        if left.is_dir() and not left.is_symlink():
            shutil.rmtree(left, ignore_errors=True)
        else:
            left.unlink(missing_ok=True)
