"""What a rebuild mends by itself: damaged files, tows we fail on, an archive that changed."""

import traceback
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final, TypeVar

from warehouse.intake.lake import ArchiveChangedError
from warehouse.store.store import DamagedFileError, Store
from warehouse.store.unforeseen import (
    FailedTowsError,
    in_short,
    is_unforeseen,
    set_aside,
    traced,
)

T = TypeVar("T")

LARGEST_SHARE: Final = 0.1
"""Where more of the tows fail, it is no tow that fails (inferred)."""

ROUNDS: Final = 3
"""How often work begins at most, where the archive changes meanwhile."""


def mending(store: Store, work: Callable[[], T], again: Callable[[], object]) -> T:
    """Does work; does it again without what is damaged or fails, or where the archive changed.

    Args:
        store: the data folder.
        work: what to do.
        again: makes what the work reads, before it is done again.

    Raises:
        DamagedFileError, FailedTowsError: mended before, and it did not help.
        ArchiveChangedError: the archive does not stop changing.
    """
    damaged: set[Path] = set()
    rounds_left, is_first = ROUNDS, True
    while True:
        try:
            if not is_first:
                again()
            return work()
        except DamagedFileError as error:
            if error.path in damaged:
                raise
            damaged.add(error.path)
            error.path.unlink(missing_ok=True)
        except FailedTowsError as error:
            set_aside(store, error)
        except ArchiveChangedError:
            rounds_left -= 1
            if not rounds_left:
                raise
        is_first = False


def failed_tows(
    compute: Callable[[Sequence[str]], object], tows: Sequence[str], error: BaseException
) -> FailedTowsError | None:
    """The tows that make a step fail as it did, each by itself; None where it is no tow.

    They are found by halving, as many are computed at once.

    Args:
        compute: does the work of the step for some tows.
        tows: all of them.
        error: with which the step failed.
    """
    most, alone = max(1, int(LARGEST_SHARE * len(tows))), list[str]()
    left = [list(tows)] if len(tows) > 1 else []
    while left and len(alone) <= most:
        chosen = left.pop()
        if not _fails(compute, chosen, error):
            continue
        if len(chosen) == 1:
            alone += chosen
        else:
            half = len(chosen) // 2
            left += [chosen[half:], chosen[:half]]
    if not 0 < len(alone) <= most:
        return None
    return FailedTowsError(tuple(alone), in_short(error), traced(error))


def _fails(
    compute: Callable[[Sequence[str]], object], tows: Sequence[str], as_before: BaseException
) -> bool:
    """Whether a step fails in the same place."""
    try:
        compute(tows)
    except BaseException as error:
        return is_unforeseen(error) and _place(error) == _place(as_before)
    return False


def _place(error: BaseException) -> tuple[type[BaseException], str, str]:
    """Kind of error, and the module and function in which it arose."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    return type(error), last.filename, last.name
