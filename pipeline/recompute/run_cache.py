"""Windows and means of runs, kept between recomputes, of which they take half of the time.

Most changes of a method leave them as they are: they depend on few of its options, and not on log
factors or other tows. They are made of all tows together, however a method parts them.
"""

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any, TypeAlias, TypeVar

from pipeline.arrays import IntArray
from pipeline.blocks.batch import Batch
from pipeline.blocks.run_blocks import RunBlocks
from pipeline.method.definition import Steps
from pipeline.steps.resistance import OverWindow, RunMeans, run_means
from pipeline.steps.window import Windows, steady_windows, whole_runs

Tows: TypeAlias = tuple[str, ...]
Options: TypeAlias = tuple[object, ...]
T = TypeVar("T")


@dataclass(frozen=True)
class RunCache:
    """Windows and means of the tows of each batch by the options that they depend on.

    Of one set of blocks; another needs a cache of its own.
    """

    _found: dict[tuple[Tows, Options], Any] = field(default_factory=dict)
    _sums: dict[tuple[Tows, Options], OverWindow] = field(default_factory=dict)
    _averaged: dict[Tows, dict[int, RunBlocks]] = field(default_factory=lambda: defaultdict(dict))

    def windows(self, batch: Batch, steps: Steps) -> Windows:
        """The window of every run of a batch."""
        rule = steps.window.rule
        choose = whole_runs if rule == "all" else steady_windows
        return self._of_part(batch, (rule,), lambda of: choose(of.blocks))

    def means(self, batch: Batch, steps: Steps) -> RunMeans:
        """The means of every run of a batch over its window: coefficients are not in them yet."""
        of_wind = (steps.wind.model, steps.wind.averaging_s)
        options = (steps.window.rule, steps.run_point, *of_wind)
        return self._of_part(batch, options, lambda of: run_means(of, self._over(of, steps), steps))

    def _over(self, batch: Batch, steps: Steps) -> OverWindow:
        key = batch.key, (steps.window.rule,)
        if key not in self._sums:
            window = self.windows(batch, steps).mask
            self._sums[key] = OverWindow.of(batch.blocks, window, self._averaged[batch.key])
        return self._sums[key]

    def _of_part(self, batch: Batch, options: Options, find: Callable[[Batch], T]) -> T:
        """Windows or means of a batch: its rows of those of the whole that it is part of."""
        key = batch.key, options
        if key not in self._found:
            whole, rows = batch.whole
            of_whole = find(batch) if whole is batch else self._of_part(whole, options, find)
            self._found[key] = of_whole if whole is batch else _rows(of_whole, rows)
        known: T = self._found[key]
        return known

    def __len__(self) -> int:
        """Number of entries."""
        return len(self._found) + len(self._sums)

    def let_go(self) -> None:
        """Lets go of the blocks, which take most of the memory; windows and means stay."""
        self._sums.clear()
        self._averaged.clear()

    def clear(self) -> None:
        """Forgets everything."""
        self._found.clear()
        self.let_go()


def _rows(of_whole: Any, rows: IntArray) -> Any:
    """The rows of some runs of all arrays of windows or means."""
    if is_dataclass(of_whole) and not isinstance(of_whole, type):
        parts = {f.name: _rows(getattr(of_whole, f.name), rows) for f in fields(of_whole)}
        return replace(of_whole, **parts)
    if isinstance(of_whole, tuple):
        return tuple(of_whole[row] for row in rows)
    return of_whole[rows]
