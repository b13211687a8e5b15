"""Shows on a terminal how far a command is; keeps quiet elsewhere."""

import logging
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import Progress

from pipeline.messages import tell


class _OnStderr(logging.Handler):
    """What the logger `herijk` says, on a line each."""

    def emit(self, record: logging.LogRecord) -> None:
        """Writes a line, in the language of the command where it has one."""
        print(tell(record.msg), file=sys.stderr)  # noqa: T201 - a terminal


@contextmanager
def log_shown() -> Iterator[None]:
    """Inside, a terminal shows what a rebuild is doing."""
    log, handler = logging.getLogger("herijk"), _OnStderr(logging.INFO)
    if sys.stderr.isatty():
        log.setLevel(logging.INFO)
        log.addHandler(handler)
    try:
        yield
    finally:
        log.removeHandler(handler)


@contextmanager
def tows_counted() -> Iterator[Callable[[int, int], None]]:
    """Gives what shows a number of tows done, out of so many."""
    with Progress(console=Console(stderr=True), disable=not sys.stderr.isatty()) as bar:
        task = bar.add_task(tell("tows"))
        yield lambda done, total: bar.update(task, completed=done, total=total)
