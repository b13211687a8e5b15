"""Windows of runs and means over them, kept between recomputes: they take half of their time.

Most changes of a method leave them as they are: they depend on few of its options, and not on log
factors or other tows. They are made of all tows together, however a method parts them.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any, TypeVar

from pipeline.arrays import FloatArray, IntArray
from pipeline.blocks.batch import Batch
from pipeline.method.definition import Steps
from pipeline.steps.resistance import RunMeans, run_means, window_means
from pipeline.steps.window import Windows, steady_windows, whole_runs

T = TypeVar("T")


@dataclass(frozen=True)
class RunCache:
    """Windows and means of the runs of whole batches by the options that they depend on.

    Of one set of blocks; another needs a cache of its own.
    """

    _found: dict[tuple[object, ...], Any] = field(default_factory=dict)

    def windows(self, batch: Batch, steps: Steps) -> Windows:
        """The window of every run of a batch."""
        choose = whole_runs if steps.window.rule == "all" else steady_windows
        return self._of_part(batch, (steps.window.rule,), lambda whole: choose(whole.blocks))

    def means(self, batch: Batch, steps: Steps) -> RunMeans:
        """The means of every run of a batch over its window: coefficients are not in them yet."""
        averaging_s = steps.wind.averaging_s

        def over_windows(whole: Batch) -> dict[str, FloatArray]:
            return window_means(whole.blocks, self.windows(whole, steps), averaging_s)

        over = self._of_part(batch, (steps.window.rule, averaging_s), over_windows)
        return run_means(batch, self.windows(batch, steps), over, steps)

    def _of_part(self, batch: Batch, options: tuple[object, ...], find: Callable[[Batch], T]) -> T:
        """What is found of the whole that a batch is part of, the rows of its runs."""
        whole, rows = batch.whole
        key = whole.key, *options
        if key not in self._found:
            self._found[key] = find(whole)
        found: T = self._found[key]
        return found if whole is batch else _rows(found, rows)


def _rows(of_whole: Any, rows: IntArray) -> Any:
    """The rows of some runs of all arrays of windows, or of means by name."""
    if is_dataclass(of_whole) and not isinstance(of_whole, type):
        parts = {f.name: _rows(getattr(of_whole, f.name), rows) for f in fields(of_whole)}
        return replace(of_whole, **parts)
    if isinstance(of_whole, dict):
        return {name: values[rows] for name, values in of_whole.items()}
    if isinstance(of_whole, tuple):
        return tuple(of_whole[row] for row in rows)
    return of_whole[rows]
