"""Who helps with the heavy work, without importing Dagster: a process here, or a Dask cluster."""

import atexit
import multiprocessing
import os
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from functools import cache
from typing import TypeVar

from pipeline.errors import MissingKnowledgeError, UnavailableError
from warehouse.derive.graph import STEPS
from warehouse.derive.inputs import Scope

T = TypeVar("T")
R = TypeVar("R")


@cache
def workers(scheduler: str | None) -> Executor:
    """Where heavy work runs beside this process; the only place that knows of a cluster.

    Args:
        scheduler: of a Dask cluster whose machines see the same folders under the same paths.

    Raises:
        MissingKnowledgeError: the library for clusters is not installed.
        UnavailableError: there is no scheduler there.
    """
    if scheduler is None:
        afresh = multiprocessing.get_context("spawn")  # a fork of Polars hangs
        return ProcessPoolExecutor(1, mp_context=afresh, initializer=begin)
    try:
        from distributed import Client  # noqa: PLC0415 - needs the extra dask
    except ImportError as error:
        raise MissingKnowledgeError(
            "to work on {} a library is needed that is not there; install it "
            "with: pip install 'herijk[dask]'",
            scheduler,
        ) from error
    try:
        return Client(scheduler).get_executor()  # type: ignore[no-untyped-call,no-any-return]
    except OSError as error:
        raise UnavailableError("there is no Dask scheduler at {}: {}", scheduler, error) from error


def get_ready(scheduler: str | None) -> None:
    """Has the helping process import what it needs, while this one imports Dagster."""
    if scheduler is None:
        workers(scheduler).submit(os.getpid)


def in_parallel(
    work: Callable[[T], R], tasks: Sequence[T], scheduler: str | None = None
) -> Iterator[tuple[T, R]]:
    """Each task with what came of it; the helping process begins at one end, this one at the other.

    A single task is done here, and none where a cluster works. Where something goes wrong, none
    that is left is begun, and those that run are waited for.

    Raises:
        UnavailableError: a process was ended from outside, as by a machine short of memory.
    """
    if len(tasks) == 1 and scheduler is None:
        yield tasks[0], work(tasks[0])
        return
    asked = [(task, workers(scheduler).submit(work, task)) for task in tasks]
    try:
        for task, future in reversed(asked):
            if scheduler is None and future.cancel():
                yield task, work(task)
        for task, future in asked:
            if not future.cancelled():
                yield task, future.result()
    except BrokenProcessPool as error:
        workers.cache_clear()
        raise UnavailableError(
            "a worker process of the rebuild was killed, perhaps because memory ran out. Run it "
            "again: what was finished is kept"
        ) from error
    finally:
        wait([future for _, future in asked if not future.cancel()])


def make_step(name: str, scope: Scope) -> None:
    """Makes a step by its name: another process has steps of its own."""
    next(step for step in STEPS if step.name == name).make(scope)


def begin() -> None:
    """Ends with the process that is helped; what is worked with was imported with this module."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    # At once: taken apart around that thread, DuckDB's binding writes that it leaks.
    atexit.register(os._exit, 0)


def _end_with_parent() -> None:
    """Without its parent it would write on without the right to."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
