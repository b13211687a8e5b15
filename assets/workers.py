"""Where the heavy work runs: processes of this machine, or a Dask cluster."""

import atexit
import multiprocessing
import os
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import Executor, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from functools import cache
from typing import Final, TypeVar

from pipeline.errors import MissingKnowledgeError, UnavailableError

T = TypeVar("T")
R = TypeVar("R")

CORES: Final = os.cpu_count() or 1


@cache
def executor(scheduler: str | None) -> Executor:
    """Processes of this machine, or a Dask cluster that sees the same folders by the same paths.

    Raises:
        MissingKnowledgeError: the library for clusters is not installed.
        UnavailableError: there is no scheduler there.
    """
    if scheduler is None:
        afresh = multiprocessing.get_context("spawn")  # a fork of Polars hangs
        return ProcessPoolExecutor(max(1, CORES - 1), mp_context=afresh, initializer=begin)
    try:
        from distributed import Client  # noqa: PLC0415 - needs the extra dask

        return Client(scheduler).get_executor()  # type: ignore[no-untyped-call,no-any-return]
    except ImportError as error:
        raise MissingKnowledgeError(
            "to work on {} install the library for it: pip install 'herijk[dask]'", scheduler
        ) from error
    except OSError as error:
        raise UnavailableError("there is no Dask scheduler at {}: {}", scheduler, error) from error


def side_by_side(
    work: Callable[[T], R], tasks: Iterable[T], scheduler: str | None = None
) -> list[R]:
    """As `map`, in no order: helpers begin at one end, this process at the other.

    Raises:
        UnavailableError: a helper was killed, as by a machine short of memory.
    """
    asked = [(task, executor(scheduler).submit(work, task)) for task in tasks]
    try:
        here = [work(task) for task, future in reversed(asked) if not scheduler and future.cancel()]
        return here + [future.result() for _, future in asked if not future.cancelled()]
    except BrokenProcessPool as error:
        executor.cache_clear()
        raise UnavailableError(
            "a worker process of the rebuild was killed, perhaps because memory ran out. Run it "
            "again: what was finished is kept"
        ) from error
    finally:
        wait([future for _, future in asked if not future.cancel()])


def begin() -> None:
    """Ends with the process that is helped: without it, it would write on without the right to."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    atexit.register(os._exit, 0)


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
