"""Shows on a terminal how far a rebuild is; keeps quiet elsewhere."""

import sys

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TaskID,
    TextColumn,
    TimeRemainingColumn,
)

from pipeline.messages import tell


class TerminalProgress:
    """Tows read and set aside, with the time left; a line per step. Writes to stderr."""

    def __init__(self) -> None:
        console = Console(stderr=True)
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn(tell("tows, {task.fields[set_aside]} set aside,")),
            TimeRemainingColumn(),
            TextColumn(tell("left")),
            console=console,
            disable=not sys.stderr.isatty(),
        )
        self._task: TaskID | None = None
        self._set_aside = 0

    def __enter__(self) -> "TerminalProgress":
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.stop()

    def expect(self, tows: int) -> None:
        """So many tows are going to be handled."""
        if tows:
            self._task = self._bar.add_task(tell("tows"), total=tows, set_aside=0)

    def tow_read(self, tow_id: str, set_aside: bool) -> None:
        """One tow is done."""
        self._set_aside += set_aside
        if self._task is not None:
            self._bar.update(self._task, advance=1, set_aside=self._set_aside, description=tow_id)

    def step(self, what: str) -> None:
        """A step begins."""
        if not self._bar.disable:
            self._bar.console.print(tell(what), style="dim")
