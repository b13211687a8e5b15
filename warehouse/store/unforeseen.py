"""What Herijk itself failed on: a tow, a method, a page, a document.

It is set aside, and the rest goes on.

Each failure is a text file in the data folder, with its traceback, for whoever maintains Herijk.
Tows are remembered besides, until a list, samples or our code change: then they are tried again.
"""

import traceback
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Final

from pipeline.errors import BrokenPromiseError, HerijkError
from pipeline.messages import Sentence, say
from warehouse.store.files import write_beside
from warehouse.store.machine_faults import is_machine_fault

UNFORESEEN: Final = "unforeseen"
"""The reason code of a tow on which Herijk itself failed, and the folder of tracebacks."""
Border = Callable[[str], AbstractContextManager[object]]
"""What stands round the work of one thing, given what that is."""
_NOT_OURS: Final = (HerijkError, MemoryError, OSError, KeyboardInterrupt, SystemExit, GeneratorExit)


def is_unforeseen(error: BaseException) -> bool:
    """Return whether an error is a fault of Herijk: not of the input, and not of the machine.

    A panic of a library in Rust is no `Exception`, and one of ours all the same.
    """
    return not isinstance(error, _NOT_OURS) and not is_machine_fault(error)


def shorten_error(error: BaseException) -> str:
    """Return kind and first words of an error."""
    return f"{type(error).__name__}: {' '.join(str(error).split())[:200]}"


def format_traceback(error: BaseException) -> str:
    """Return the traceback as text."""
    return "".join(traceback.format_exception(error))


def sentence(tow_id: str, told: str) -> Sentence:
    """Return the message about a tow on which Herijk failed."""
    return say(
        "Herijk itself failed on this tow ({}). Its files may be sound. Please report this to the "
        "maintainer of Herijk, with unforeseen/{}.txt of the data folder.",
        told,
        _file_name(tow_id),
    )


def note(root: Path, what: str, trace: str) -> None:
    """Keep the traceback of a failure in the data folder."""
    with write_beside(_file(root, what)) as beside:
        beside.write_text(trace, encoding="utf-8")


@contextmanager
def border(root: Path, what: str, failed: list[str] | None = None) -> Iterator[None]:
    """Confine a fault of Herijk to the work on one thing, and keep its traceback.

    Args:
        root: the data folder.
        what: what the work is about, with its kind before it: `page types.html`.
        failed: is given what failed.
    """
    try:
        yield
    except BaseException as error:
        if not is_unforeseen(error):
            raise
        note(root, what, format_traceback(error))
        if failed is not None:
            failed.append(what)
    else:
        forget(root, what)


@contextmanager
def documents(root: Path, command: str) -> Iterator[Border]:
    """Confine faults of Herijk to the document they are in; name the failed ones at the end.

    What is kept of them has no blank in its name, so that no rebuild answers for it (`failures`).

    Raises:
        BrokenPromiseError: Herijk itself failed on some of them.
    """
    failed: list[str] = []

    def round_one(what: str) -> AbstractContextManager[None]:
        return border(root, what.replace(" ", "-"), failed)

    with round_one(command):
        yield round_one
    if failed:
        raise BrokenPromiseError(
            "Herijk itself failed on {}; all else was made. Please report this to the "
            "maintainer of Herijk, with what the folder unforeseen of the data folder has of it",
            ", ".join(failed),
        )


def forget(root: Path, what: str) -> None:
    """Remove what was kept of an earlier failure."""
    _file(root, what).unlink(missing_ok=True)


def _file(root: Path, what: str) -> Path:
    return root / UNFORESEEN / f"{_file_name(what)}.txt"


def _file_name(what: str) -> str:
    return "".join(letter if letter.isalnum() or letter in " -_." else "-" for letter in what)
