"""Windows and means of runs that were found before: half of the time of a recompute goes into them.

Most changes of a method leave them as they are: they depend on few of its options. Only those
belong here that do not depend on a log factor or on other tows.
"""

from dataclasses import dataclass, field
from typing import TypeAlias

from herijk.pipeline.blocks.batch import Batch
from herijk.pipeline.method.definition import RunPoint, Steps, Window
from herijk.pipeline.steps.resistance import RunMeans, run_means
from herijk.pipeline.steps.window import Windows, choose_windows

Tows: TypeAlias = tuple[str, ...]


@dataclass(frozen=True)
class RunCache:
    """Windows and means of the tows of each batch by the options that they depend on.

    Of one set of blocks; another needs a cache of its own.
    """

    _windows: dict[tuple[Tows, Window], Windows] = field(default_factory=dict)
    _means: dict[tuple[Tows, Window, str, RunPoint, str, int], RunMeans] = field(
        default_factory=dict
    )

    def windows(self, batch: Batch, steps: Steps) -> Windows:
        """The window of every run of a batch."""
        key = (batch.key, steps.window)
        if key not in self._windows:
            self._windows[key] = choose_windows(batch.blocks, steps.window)
        return self._windows[key]

    def means(self, batch: Batch, steps: Steps) -> RunMeans:
        """The means of every run of a batch over its window: coefficients are not in them yet."""
        of_wind = (steps.wind.model, steps.wind.averaging_s)
        key = (batch.key, steps.window, steps.speed.source, steps.run_point, *of_wind)
        if key not in self._means:
            self._means[key] = run_means(batch, self.windows(batch, steps).mask, steps)
        return self._means[key]

    def __len__(self) -> int:
        """Entries held."""
        return len(self._windows) + len(self._means)

    def clear(self) -> None:
        """Forgets everything."""
        self._windows.clear()
        self._means.clear()
