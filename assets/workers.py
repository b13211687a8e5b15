"""Where heavy work runs: in this process and helpers beside it, or on a Dask cluster.

Either is a `concurrent.futures.Executor`, so the assets need not know which.
"""

import atexit
import multiprocessing
import os
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed, wait
from concurrent.futures.process import BrokenProcessPool
from functools import cache
from typing import Final, TypeVar

from pipeline.errors import MissingKnowledgeError, UnavailableError

T = TypeVar("T")
R = TypeVar("R")

CORES: Final = os.cpu_count() or 1


@cache
def get_executor(scheduler: str | None) -> Executor:
    """Return helper processes on this machine, or a Dask cluster.

    The helpers are started once per process: starting them takes seconds. Workers of a cluster must
    see the archive and the data folder under the same absolute paths.

    Args:
        scheduler: address of a Dask scheduler; None for this machine.

    Raises:
        MissingKnowledgeError: the library for clusters is not installed.
        UnavailableError: there is no scheduler at that address.
    """
    if scheduler is None:
        context = multiprocessing.get_context("spawn")  # a forked Polars hangs
        n_helpers = max(1, CORES - 1)
        return ProcessPoolExecutor(n_helpers, mp_context=context, initializer=watch_parent)
    try:
        from distributed import Client  # noqa: PLC0415 - needs the extra dask

        return Client(scheduler).get_executor()  # type: ignore[no-untyped-call,no-any-return]
    except ImportError as error:
        raise MissingKnowledgeError(
            "to work on {} install the library for it: pip install 'herijk[dask]'", scheduler
        ) from error
    except OSError as error:
        raise UnavailableError("there is no Dask scheduler at {}: {}", scheduler, error) from error


def map_in_parallel(
    work: Callable[[T], R],
    tasks: Sequence[T],
    scheduler: str | None = None,
    on_progress: Callable[[int], object] = lambda _: None,
) -> list[R]:
    """Return the results of `work` on each task, in their order.

    Helpers begin at the first task; without a cluster, this process begins at the last.

    Args:
        work: a function that can be pickled.
        tasks: its arguments.
        scheduler: see `get_executor`.
        on_progress: called with the number of tasks done.

    Raises:
        UnavailableError: a helper was killed, as happens when memory runs out.
    """
    executor = get_executor(scheduler)
    futures = [executor.submit(work, task) for task in tasks]
    made_here: dict[int, R] = {}
    try:
        if scheduler is None:
            for number in reversed(range(len(tasks))):
                if futures[number].cancel():  # no helper has begun it
                    made_here[number] = work(tasks[number])
                    n_done = len(made_here) + sum(f.done() and not f.cancelled() for f in futures)
                    on_progress(n_done)
        pending = [future for future in futures if not future.cancelled()]
        n_before = len(made_here)
        for n_finished, _ in enumerate(as_completed(pending), start=1):
            on_progress(n_before + n_finished)
        results = []
        for number, future in enumerate(futures):
            results.append(made_here[number] if number in made_here else future.result())
        return results
    except BrokenProcessPool as error:
        get_executor.cache_clear()
        raise UnavailableError(
            "a worker process of the rebuild was killed, perhaps because memory ran out. Run it "
            "again: what was finished is kept"
        ) from error
    finally:
        wait([future for future in futures if not future.cancel()])


def watch_parent() -> None:
    """Exit this helper when its parent exits, because only the parent holds the write lock."""
    threading.Thread(target=_exit_with_parent, daemon=True).start()
    atexit.register(os._exit, 0)


def _exit_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
