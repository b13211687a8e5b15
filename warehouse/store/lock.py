"""One writer at a time in a data folder, and clearing up after writers that were killed.

The lock is the operating system's and dies with its owner, however that ends. Who holds it is
written in a file beside it, as Windows lets nobody read a locked file. Readers need no lock: what
they read is replaced whole. Publishing an edition has a lock of its own, in `editions`.
"""

import datetime as dt
import json
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
SERVER_LOCK_FILE: Final = "serve.lock"
OWNER_SUFFIX: Final = ".owner.json"
WAIT: Final = say("Wait until that is done, or stop that process; its lock goes with it")
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
    with _locked(folder / LOCK_FILE, wait, say("{} is being rebuilt already", folder), WAIT):
        _held.add(folder)
        try:
            remove_leftovers(folder)
            yield
        finally:
            _held.discard(folder)


@contextmanager
def only_server(root: Path) -> Iterator[None]:
    """Keeps a second `herijk serve` off a data folder.

    Raises:
        UnavailableError: there is one already; the message says which.
    """
    root.mkdir(parents=True, exist_ok=True)
    file = root.resolve() / SERVER_LOCK_FILE
    with _locked(
        file,
        wait=False,
        taken=say("{} is served already", root),
        way_out=say("Stop that one first"),
    ):
        yield


def nobody_writes(root: Path) -> bool:
    """Whether no rebuild is at work in a data folder just now."""
    try:
        with only_writer(root):
            return True
    except UnavailableError:
        return False


@contextmanager
def _locked(file: Path, wait: bool, taken: str, way_out: str) -> Iterator[None]:
    """Holds a lock, signed with its holder.

    Raises:
        UnavailableError: another process holds it; `taken` says what is, `way_out` what to do.
    """
    lock, signature = FileLock(file), file.with_suffix(OWNER_SUFFIX)
    try:
        lock.acquire(blocking=wait)
    except Timeout as error:
        raise UnavailableError("{}, by {}. {}", taken, _owner(signature), way_out) from error
    try:
        since = dt.datetime.now().astimezone().isoformat(timespec="seconds")
        owner = {"pid": os.getpid(), "host": socket.gethostname(), "since": since}
        signature.write_text(json.dumps(owner), encoding="utf-8")
        yield
    finally:
        signature.unlink(missing_ok=True)
        lock.release()


def _owner(signature: Path) -> str:
    """Who holds the lock, in words; it may have just begun and not have signed yet."""
    try:
        owner: dict[str, object] = json.loads(signature.read_text(encoding="utf-8"))
        return say("process {} on {} since {}", owner["pid"], owner["host"], owner["since"])
    except (OSError, ValueError, KeyError, TypeError):
        return say("a process that has just begun")


def remove_leftovers(root: Path) -> None:
    """Removes what was still being written; the caller holds the lock, so nobody else writes."""
    for folder in (root, *(f for f in root.iterdir() if f.is_dir() and f.name not in _NOT_OURS)):
        pattern = f"{TEMPORARY_PREFIX}*"
        for left in list(folder.glob(pattern) if folder == root else folder.rglob(pattern)):
            if left.is_dir() and not left.is_symlink():
                shutil.rmtree(left)
            else:
                left.unlink(missing_ok=True)
