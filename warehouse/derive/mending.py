"""What a rebuild mends by itself: damaged files, tows we fail on, an archive that changed."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final, TypeVar

from pipeline.method.definition import Method
from warehouse.derive.graph import STEPS
from warehouse.derive.step import Step
from warehouse.intake import seasons as intake
from warehouse.intake.lake import ArchiveChangedError
from warehouse.store.store import DamagedFileError, Store
from warehouse.store.unforeseen import FailedTowsError, set_aside

T = TypeVar("T")

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


def catch_up(store: Store, archive: Path, methods: Sequence[Method], step: Step) -> None:
    """Makes again what a step reads and what is not there as it should be."""
    intake.index(store, archive)
    for season in intake.damaged_seasons(store):
        intake.read_season(store, archive, season)
        intake.collect_blocks(store, season)
    for before in STEPS[: STEPS.index(step)]:
        for scope in before.stale(store, methods):
            before.make(scope)
