"""What the machine can put in the way of a rebuild, each as a sentence with the way out.

Libraries wrap the system's errors in their own. What tells them is the system's error number,
anywhere in the chain of causes, or the few words by which SQLite, DuckDB and Polars pass one on.
"""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from errno import EACCES, EDQUOT, EFBIG, EIO, EMFILE, ENFILE, ENOMEM, ENOSPC, EPERM, EROFS
from pathlib import Path
from typing import Final, NamedTuple

from pipeline.errors import HerijkError, UnavailableError
from pipeline.messages import Sentence, say


class _Fault(NamedTuple):
    """A fault of the machine: what to say of it, and how it is known, by number or in words."""

    sentence: Sentence
    numbers: tuple[int, ...]
    words: tuple[str, ...]


_FULL: Final = _Fault(
    say(
        "there is no room left to write in {root}. Free some, or move the data folder; "
        "lake/samples in it is the largest part and is made again when needed"
    ),
    (ENOSPC, EDQUOT),
    ("no space left", "disk is full", "quota exceeded"),
)
_BROKEN_DISK: Final = _Fault(
    say("the disk under {root} gives errors. Look in the system's log, and replace it"),
    (EIO,),
    ("input/output error", "disk i/o error"),
)
_NO_MEMORY: Final = _Fault(
    say(
        "there is not enough memory. Allow more (ulimit -v unlimited; in systemd MemoryMax=), "
        "close other programs, or read fewer seasons at a time with --seasons"
    ),
    (ENOMEM,),
    # The last is Python's, where a library in C got no memory and did not say so.
    (
        "out of memory",
        "cannot allocate memory",
        "failed to map segment",
        "can't start new thread",
        "without setting an exception",
    ),
)
_FAULTS: Final = (
    _FULL,
    _Fault(
        say(
            "{path} cannot be read or written. Give the user who runs this the right to it, or "
            "name another"
        ),
        (EROFS, EACCES, EPERM),
        ("read-only file system", "readonly database", "permission denied"),
    ),
    _Fault(
        say(
            "this process may not open more files, or none as large as it needs. Allow more "
            "(ulimit -n 1024 -f unlimited; in systemd LimitNOFILE=1024, LimitFSIZE=infinity) and "
            "run it again"
        ),
        (EMFILE, ENFILE, EFBIG),
        # The last is of the library that draws, when it gets no file.
        (
            "too many open files",
            "unable to open database file",
            "file too large",
            "receiver is gone",
        ),
    ),
    _BROKEN_DISK,
    _NO_MEMORY,
    _Fault(
        say(
            "Dagster's records in {root}/dagster are damaged. Remove that folder: it holds no "
            "table, only the history of runs"
        ),
        (),
        ("file is not a database", "disk image is malformed", "no such table"),
    ),
)

_LITTLE: Final = 1 << 20
"""Bytes: with less a disk is full."""

REASSURANCE: Final = say("Earlier results are intact, and finished work is kept.")


@contextmanager
def explain_machine_faults(root: Path) -> Iterator[None]:
    """Replace errors of the machine by a message that says what to do; others propagate.

    Raises:
        UnavailableError: the disk is full, the folder cannot be written, and the like.
    """
    try:
        yield
    except (HerijkError, KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:  # a panic of a library in Rust is no Exception
        fault = _machine_fault(error)
        if fault is None:
            raise
        if fault is _BROKEN_DISK and shutil.disk_usage(root).free < _LITTLE:
            fault = _FULL  # SQLite calls that an error of the disk
        named = (e.filename for e in _causes(error) if isinstance(e, OSError) and e.filename)
        said = say(fault.sentence, root=root, path=next(named, root))
        raise UnavailableError("{}. {}", said, REASSURANCE) from error


def is_machine_fault(error: BaseException) -> bool:
    """Return whether an error comes from the machine (disk, memory), not from the file."""
    return _machine_fault(error) is not None


def _machine_fault(error: BaseException) -> _Fault | None:
    for one in _causes(error):
        if isinstance(one, MemoryError):
            return _NO_MEMORY
        number = one.errno if isinstance(one, OSError) else None
        text = str(one).casefold()
        for fault in _FAULTS:
            if number in fault.numbers or any(words in text for words in fault.words):
                return fault
    return None


def _causes(error: BaseException | None) -> Iterator[BaseException]:
    seen: set[int] = set()
    while error is not None and id(error) not in seen:
        seen.add(id(error))
        yield error
        error = error.__cause__ or error.__context__
