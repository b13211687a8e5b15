"""One writer at a time in a data folder, and clearing up after writers that were killed.

The lock is the operating system's and dies with its owner, however that ends; who holds it is in a
file beside it. Readers need no lock: what they read is replaced whole. Publishing an edition has a
lock of its own, in `editions`.
"""

import datetime as dt
import os
import shutil
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from filelock import FileLock, Timeout

from pipeline.errors import UnavailableError
from pipeline.messages import say
from warehouse.store.files import TEMPORARY_PREFIX

LOCK_FILE: Final = "rebuild.lock"
OWNER_FILE: Final = "rebuild.owner"
_NOT_OURS: Final = {"audit", "dagster", "editions"}
"""Folders of the data folder in which others write, without the lock."""

_held: set[Path] = set()
"""Folders this process writes in already: a step inside a rebuild needs no lock of its own."""


@contextmanager
def only_writer(root: Path, wait: bool = False) -> Iterator[None]:
    """Keeps other writers out of a data folder; what dead ones left half-written is removed.

    Args:
        root: the data folder; made if it is not there.
        wait: wait for another writer to end, instead of giving up.

    Raises:
        UnavailableError: another writer is at work; the message says which.
    """
    root.mkdir(parents=True, exist_ok=True)
    folder = root.resolve()
    if folder in _held:
        yield
        return
    lock, owner = FileLock(folder / LOCK_FILE), folder / OWNER_FILE
    try:
        lock.acquire(blocking=wait)
    except Timeout as error:
        raise UnavailableError(
            "{} is being rebuilt already, by {}. Wait until that is done, or stop that process; "
            "its lock goes with it",
            folder,
            _in_words(owner),
        ) from error
    try:
        since = dt.datetime.now().astimezone().isoformat(timespec="seconds")
        owner.write_text(f"{os.getpid()} {socket.gethostname()} {since}", encoding="utf-8")
        _held.add(folder)
        _remove_leftovers(folder)
        yield
    finally:
        _held.discard(folder)
        owner.unlink(missing_ok=True)
        lock.release()


def _in_words(owner: Path) -> str:
    """Who holds the lock; it may have just begun and not have signed yet."""
    try:
        return say("process {} on {} since {}", *owner.read_text(encoding="utf-8").split())
    except (OSError, LookupError):
        return say("a process that has just begun")


def _remove_leftovers(root: Path) -> None:
    """Removes what was still being written; the caller holds the lock, so nobody else writes."""
    pattern = f"{TEMPORARY_PREFIX}*"
    ours = [f for f in root.iterdir() if f.is_dir() and f.name not in _NOT_OURS]
    for left in [*root.glob(pattern), *(left for folder in ours for left in folder.rglob(pattern))]:
        if left.is_dir() and not left.is_symlink():
            shutil.rmtree(left, ignore_errors=True)
        else:
            left.unlink(missing_ok=True)
