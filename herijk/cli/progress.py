"""Show how far a command is, on stderr."""

import logging
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from pipeline.messages import tell

TOWS_READ: Final = "herijk.progress"
"""Logger of `assets.archive`: its records have the attributes `done` and `total`, in tows."""


class _RebuildHandler(logging.Handler):
    """Shows what the logger `herijk` says: a bar of the tows read, and a line for anything else."""

    def __init__(self, bar: Progress) -> None:
        super().__init__(logging.INFO)
        self._bar = bar
        self._task = bar.add_task(tell("tows"), total=None, visible=False)

    def emit(self, record: logging.LogRecord) -> None:
        """Move the bar, or print a line in the language of the command."""
        if record.name == TOWS_READ:
            done, total = vars(record)["done"], vars(record)["total"]
            self._bar.update(self._task, completed=done, total=total, visible=done < total)
        else:
            self._bar.console.print(tell(record.msg), markup=False, highlight=False)


@contextmanager
def rebuild_shown() -> Iterator[None]:
    """Inside, a rebuild shows a line per asset that it makes, and on a terminal a bar of tows."""
    log = logging.getLogger("herijk")
    with _open_bar() as bar:
        handler = _RebuildHandler(bar)
        log.setLevel(logging.INFO)
        log.addHandler(handler)
        try:
            yield
        finally:
            log.removeHandler(handler)


@contextmanager
def show_tow_count() -> Iterator[Callable[[int, int], None]]:
    """Give a function that shows a number of tows done, out of so many."""
    with _open_bar() as bar:
        task = bar.add_task(tell("tows"))
        yield lambda done, total: bar.update(task, completed=done, total=total)


def _open_bar() -> Progress:
    """Return a bar of tows with the time left; it is drawn on a terminal only."""
    columns = (
        TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(),
    )  # fmt: skip
    console = Console(stderr=True, soft_wrap=True)
    return Progress(*columns, console=console, disable=not sys.stderr.isatty(), transient=True)
