"""Writing files so that nothing half-written is ever visible: beside, sync, rename."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

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


def write_new(path: Path, text: str) -> None:
    """Writes a text file that was not there, whole or not at all.

    Raises:
        FileExistsError: there is one already; it is left as it is.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile("wb", prefix=TEMPORARY_PREFIX, dir=path.parent) as beside:
        beside.write(text.encode())
        beside.flush()
        os.fsync(beside.fileno())
        Path(beside.name).chmod(0o644)
        path.hardlink_to(beside.name)
    _sync(path.parent)


def _sync(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
