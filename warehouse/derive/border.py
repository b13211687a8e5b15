"""Which tow it is that makes a step fail: found by halving, as many are computed at once."""

import traceback
from collections.abc import Callable, Sequence
from typing import Final

from warehouse.store.unforeseen import FailedTowsError, in_short, is_unforeseen, traced

Compute = Callable[[Sequence[str]], object]
"""Does the work of a step for some tows."""

LARGEST_SHARE: Final = 0.1
"""Where more of the tows fail, it is no tow that fails (inferred)."""


def failed_tows(
    compute: Compute, tows: Sequence[str], error: BaseException
) -> FailedTowsError | None:
    """The tows that make a step fail as it did, each by itself; None where it is no tow."""
    most = max(1, int(LARGEST_SHARE * len(tows)))

    def failing(chosen: Sequence[str], found: int) -> list[str]:
        if not chosen or found > most or not _fails(compute, chosen, error):
            return []
        if len(chosen) == 1:
            return list(chosen)
        half = len(chosen) // 2
        first = failing(chosen[:half], found)
        return first + failing(chosen[half:], found + len(first))

    alone = failing(tows, 0) if len(tows) > 1 else []
    if not 0 < len(alone) <= most:
        return None
    return FailedTowsError(tuple(alone), in_short(error), traced(error))


def _fails(compute: Compute, tows: Sequence[str], as_before: BaseException) -> bool:
    """Whether a step fails in the same place."""
    try:
        compute(tows)
    except BaseException as error:
        if not is_unforeseen(error):
            return False
        return _place(error) == _place(as_before)
    return False


def _place(error: BaseException) -> tuple[type[BaseException], str, str]:
    """Kind of error, and the module and function in which it arose."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    return type(error), last.filename, last.name
