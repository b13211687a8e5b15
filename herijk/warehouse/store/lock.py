"""One writer at a time in a data folder, and clearing up after writers that were killed.

The lock is the operating system's and dies with its owner, however that ends. Readers need none:
what they read is replaced whole. Publishing an edition has a lock of its own, in `editions`.
"""

import datetime as dt
import fcntl
import json
import os
import shutil
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from herijk.pipeline.errors import UnavailableError
from herijk.warehouse.store.files import TEMPORARY_PREFIX

LOCK_FILE: Final = "rebuild.lock"
SERVER_LOCK_FILE: Final = "serve.lock"
_NOT_OURS: Final = {"audit", "dagster", "editions", "outbox"}
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
    with (folder / LOCK_FILE).open("a+", encoding="utf-8") as lock:
        _take(lock.fileno(), folder, wait)
        _held.add(folder)
        try:
            _sign(lock.fileno())
            remove_leftovers(folder)
            yield
        finally:
            _held.discard(folder)
            os.ftruncate(lock.fileno(), 0)


@contextmanager
def only_server(root: Path) -> Iterator[None]:
    """Keeps a second `herijk serve` off a data folder.

    Raises:
        UnavailableError: there is one already; the message says which.
    """
    root.mkdir(parents=True, exist_ok=True)
    with (root.resolve() / SERVER_LOCK_FILE).open("a+", encoding="utf-8") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise UnavailableError(
                f"{root} is served already, by {_owner(lock.fileno())}. Stop that one first"
            ) from error
        _sign(lock.fileno())
        yield


def nobody_writes(root: Path) -> bool:
    """Whether no rebuild is at work in a data folder just now."""
    try:
        with only_writer(root):
            return True
    except UnavailableError:
        return False


def _take(handle: int, folder: Path, wait: bool) -> None:
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except BlockingIOError as error:
        raise UnavailableError(
            f"{folder} is being rebuilt already, by {_owner(handle)}. Wait until that is done, or "
            "stop that process; its lock goes with it"
        ) from error


def _sign(handle: int) -> None:
    """Says who holds the lock."""
    since = dt.datetime.now().astimezone().isoformat(timespec="seconds")
    owner = {"pid": os.getpid(), "host": socket.gethostname(), "since": since}
    os.ftruncate(handle, 0)
    os.write(handle, json.dumps(owner).encode())


def _owner(handle: int) -> str:
    """Who holds the lock, in words; it may have just begun and not have signed yet."""
    try:
        owner: dict[str, Any] = json.loads(os.pread(handle, 1000, 0))
        return f"process {owner['pid']} on {owner['host']} since {owner['since']}"
    except (ValueError, KeyError, TypeError):
        return "a process that has just begun"


def remove_leftovers(root: Path) -> None:
    """Removes what was still being written; the caller holds the lock, so nobody else writes."""
    for folder in (root, *(f for f in root.iterdir() if f.is_dir() and f.name not in _NOT_OURS)):
        pattern = f"{TEMPORARY_PREFIX}*"
        for left in list(folder.glob(pattern) if folder == root else folder.rglob(pattern)):
            if left.is_dir() and not left.is_symlink():
                shutil.rmtree(left)
            else:
                left.unlink(missing_ok=True)
