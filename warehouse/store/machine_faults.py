"""What the machine can put in the way of a rebuild, each as a sentence with the way out.

Libraries wrap the system's errors in their own. What tells them is the system's error number,
anywhere in the chain of causes, or the few words by which SQLite, DuckDB and Polars pass one on.
"""

import errno
import importlib
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from pipeline.errors import HerijkError, UnavailableError
from pipeline.messages import say
from warehouse.store.files import WINDOWS

_FULL: Final = say(
    "there is no room left to write in {root}. Free some, or move the data folder; "
    "lake/samples in it is the largest part and is made again when needed"
)
_FORBIDDEN: Final = say(
    "{root} cannot be written. Give the user who runs this the right to write in all of it, or "
    "name another folder with --data"
)
_ELSEWHERE: Final = say(
    "{path} cannot be read or written. Give the user who runs this the right to it, or name another"
)
_HANDLES: Final = say(
    "this process may not open more files. Allow more (ulimit -n 1024; in systemd "
    "LimitNOFILE=1024) and run it again"
)
_BROKEN_DISK: Final = say(
    "the disk under {root} gives errors. Look in the system's log, and replace it"
)
_LIMITED: Final = say(
    "this process may not write files as large as it needs. Allow larger ones (ulimit -f "
    "unlimited; in systemd LimitFSIZE=infinity) and run it again"
)
_NO_MEMORY: Final = say(
    "there is not enough memory. Allow more (ulimit -v unlimited; in systemd MemoryMax=), close "
    "other programs, or read fewer seasons at a time with --seasons"
)

_DAMAGED_RECORDS: Final = say(
    "Dagster's records in {root}/dagster are damaged. Remove that folder: it holds no table, only "
    "the history of runs"
)

_CLOSED_RECORDS: Final = say(
    "Dagster's records in {root}/dagster cannot be opened: this process may not open more files "
    "(allow more: ulimit -n 1024; in systemd LimitNOFILE=1024), or has no right to that folder"
)

_NO_DRAWING: Final = say(
    "a figure could not be drawn: the drawing library stopped, usually because this process may "
    "not open more files (allow more: ulimit -n 1024; in systemd LimitNOFILE=1024)"
)

_BY_NUMBER: Final = {
    errno.ENOSPC: _FULL,
    errno.EDQUOT: _FULL,
    errno.EFBIG: _LIMITED,
    errno.EROFS: _FORBIDDEN,
    errno.EACCES: _FORBIDDEN,
    errno.EPERM: _FORBIDDEN,
    errno.EMFILE: _HANDLES,
    errno.ENFILE: _HANDLES,
    errno.EIO: _BROKEN_DISK,
    errno.ENOMEM: _NO_MEMORY,
}

_BY_WORDS: Final = {
    "no space left": _FULL,
    "disk is full": _FULL,
    "file too large": _LIMITED,
    "quota exceeded": _FULL,
    "read-only file system": _FORBIDDEN,
    "readonly database": _FORBIDDEN,
    "permission denied": _FORBIDDEN,
    "too many open files": _HANDLES,
    "unable to open database file": _CLOSED_RECORDS,
    "receiver is gone": _NO_DRAWING,
    "input/output error": _BROKEN_DISK,
    "disk i/o error": _BROKEN_DISK,
    "file is not a database": _DAMAGED_RECORDS,
    "disk image is malformed": _DAMAGED_RECORDS,
    "no such table": _DAMAGED_RECORDS,
    "out of memory": _NO_MEMORY,
    "cannot allocate memory": _NO_MEMORY,
    "failed to map segment": _NO_MEMORY,
    "can't start new thread": _NO_MEMORY,
}

_LITTLE: Final = 1 << 20
"""Bytes: with less a disk is full."""

REASSURANCE: Final = say("What was there before is whole, and what was finished is kept.")


@contextmanager
def machine_faults_explained(root: Path) -> Iterator[None]:
    """Turns an error of the machine into a sentence with the way out; others pass as they are.

    Raises:
        UnavailableError: the disk is full, the folder cannot be written, and the like.
    """
    try:
        yield
    except (HerijkError, KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:  # a panic of a library in Rust is no Exception
        explanation = _machine_fault(error)
        if explanation is None:
            raise
        said = _said(explanation, error, root)
        raise UnavailableError("{}. {}", said, REASSURANCE) from error


def _said(fault: str, error: BaseException, root: Path) -> str:
    """The sentence about a fault of the machine, with the path that it is about."""
    if fault == _FORBIDDEN:
        names = (str(e.filename) for e in _causes(error) if isinstance(e, OSError) and e.filename)
        path = next(names, None)
        if path is not None and not Path(path).absolute().is_relative_to(root.absolute()):
            return say(_ELSEWHERE, path=path)
    if fault == _BROKEN_DISK and _is_full(root):  # SQLite calls both an error of the disk
        fault = _FULL
    elif fault == _BROKEN_DISK and _is_limited():
        fault = _LIMITED
    return say(fault, root=root)


def _is_full(root: Path) -> bool:
    """Whether no room is left."""
    folder = next((p for p in (root, *root.absolute().parents) if p.is_dir()), None)
    return folder is not None and shutil.disk_usage(folder).free < _LITTLE


def _is_limited() -> bool:
    """Whether the system lets this process write files of some size only."""
    if WINDOWS:
        return False
    resource = importlib.import_module("resource")  # not every system has it
    return bool(resource.getrlimit(resource.RLIMIT_FSIZE)[0] != resource.RLIM_INFINITY)


def is_machine_fault(error: BaseException) -> bool:
    """Whether an error is the machine's, and says nothing about the file it concerns."""
    return _machine_fault(error) is not None


def _machine_fault(error: BaseException) -> str | None:
    for one in _causes(error):
        if isinstance(one, OSError) and one.errno in _BY_NUMBER:
            return _BY_NUMBER[one.errno]
        if isinstance(one, MemoryError):
            return _NO_MEMORY
        text = str(one).casefold()
        for words, fault in _BY_WORDS.items():
            if words in text:
                return fault
    return None


def _causes(error: BaseException | None) -> Iterator[BaseException]:
    seen: set[int] = set()
    while error is not None and id(error) not in seen:
        seen.add(id(error))
        yield error
        error = error.__cause__ or error.__context__
