"""Seasons and steps that do not depend on each other, in two processes: this one and a helper.

Samples are read and tables made by code that holds Python's lock most of the time, so threads would
not do. Which process does it changes nothing in what is made.
"""

import atexit
import multiprocessing
import os
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import polars as pl

from herijk.pipeline.errors import UnavailableError
from herijk.warehouse.build.graph import STEPS
from herijk.warehouse.build.step import Made, Step
from herijk.warehouse.intake import seasons as intake
from herijk.warehouse.intake.lake import Report
from herijk.warehouse.store.methods import KnownMethods
from herijk.warehouse.store.store import Store

T = TypeVar("T")
M = TypeVar("M")


@dataclass(frozen=True)
class Read:
    """What reading a season gave.

    Attributes:
        index: where each listed tow's samples and blocks lie, or its fault.
        blocks: rows of the season's table of blocks.
    """

    index: pl.DataFrame
    blocks: int


@dataclass(frozen=True)
class Reading:
    """A season to be read from an archive into a data folder."""

    archive: Path
    data: Path
    season: int

    def do(self, report: Report = lambda *_: None) -> Read:
        """Reads it; someone may be told of each tow."""
        store = Store(self.data)
        index = intake.read_season(store, self.archive, self.season, report)
        return Read(index, intake.collect_blocks(store, self.season).height)


@dataclass(frozen=True)
class Task:
    """A step to be made, for some methods, in a data folder."""

    data: Path
    step: str
    methods: tuple[str, ...]

    @property
    def made_by(self) -> Step:
        """The step itself."""
        return next(step for step in STEPS if step.name == self.step)

    @property
    def method(self) -> str | None:
        """The method, where the step is made once for each."""
        return self.methods[0] if self.made_by.per_method else None

    def do(self) -> Made:
        """Makes the tables."""
        store = Store(self.data)
        known = KnownMethods.of(store)
        return self.made_by.make(store, [known.get(name) for name in self.methods])


@contextmanager
def helper() -> Iterator[Executor]:
    """A second process, which begins at once to import what it needs.

    Raises:
        UnavailableError: it was ended from outside, as by a machine short of memory.
    """
    afresh = multiprocessing.get_context("spawn")  # a copy of this one would lack its threads
    try:
        with ProcessPoolExecutor(1, mp_context=afresh, initializer=_begin) as process:
            process.submit(stages, ())  # the process begins with its first task
            yield process
    except BrokenProcessPool as error:
        raise UnavailableError(
            "a process that helped with the rebuild was ended, perhaps as memory ran out. Run it "
            "again: what was finished is kept"
        ) from error


def _begin() -> None:
    """Imports what tables and pages are made with: three seconds that nobody has to wait for."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    # At once: taken apart around that thread, DuckDB's binding writes that it leaks.
    atexit.register(os._exit, 0)
    import herijk.dashboards.site.render  # noqa: F401, PLC0415


def _end_with_parent() -> None:
    """Ends this process with the one it helps: it would write on without the right to."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


Join = Callable[[Callable[[T], M]], list[M]]
"""Does, in this process, the tasks that are left; gives what all of them made, in their order."""


@contextmanager
def shared(
    tasks: Sequence[T],
    other: Executor,
    do: Callable[[T], M],
    came: Callable[[M], None] = lambda _: None,
) -> Iterator[Join[T, M]]:
    """The other process begins with tasks; this one joins in when it is ready.

    Each process takes the next task when it has done one. Where something goes wrong, none that is
    left is begun.

    Args:
        tasks: what to do.
        other: the other process.
        do: does a task there.
        came: is told what the other process made.
    """
    made: dict[int, M] = {}
    queue = iter(enumerate(tasks))

    def there(task: T) -> M:
        result = other.submit(do, task).result()
        came(result)
        return result

    def make(do_next: Callable[[T], M]) -> None:
        made.update((place, do_next(task)) for place, task in queue)

    with ThreadPoolExecutor(1) as waiting:
        done = waiting.submit(make, there)

        def join(here: Callable[[T], M]) -> list[M]:
            make(here)
            done.result()
            return [made[place] for place in range(len(tasks))]

        try:
            yield join
        finally:
            deque(queue, maxlen=0)


def side_by_side(tasks: Sequence[T], other: Executor, do: Callable[[T], M]) -> list[M]:
    """What the tasks make, in their order; the first is done here, so a single one is."""
    if not tasks:
        return []
    first, *rest = tasks
    with shared(rest, other, do) as join:
        return [do(first), *join(do)]


def stages(steps: Sequence[Step]) -> list[list[Step]]:
    """The steps in their order, together where none reads what another of them makes."""
    in_order: list[list[Step]] = []
    for step in steps:
        last = in_order[-1] if in_order else []
        if last and not any(set(step.inputs) & set(other.outputs) for other in last):
            last.append(step)
        else:
            in_order.append([step])
    return in_order
