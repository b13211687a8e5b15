"""Windows of runs and means over them, kept between recomputes: they take half of their time.

Most changes of a method leave them as they are: they depend on few of its options, and not on log
factors or other tows.
"""

from typing import Any

from pipeline.blocks.tows import Tows
from pipeline.steps.resistance import window_means
from pipeline.steps.window import Windows, find_steady_windows, take_whole_runs


class RunCache:
    """Windows and means of the runs of some tows by the options that they depend on.

    Of one set of blocks; another needs a cache of its own.
    """

    def __init__(self) -> None:
        self._windows: dict[tuple[object, ...], Windows] = {}
        self._means: dict[tuple[object, ...], dict[str, Any]] = {}

    def average(
        self, tows: Tows, is_trimmed: bool, averaging_s: int, is_robust: bool
    ) -> dict[str, Any]:
        """Return `Windows.columns_of_runs` and `window_means` by name, (runs,) each."""
        key = (tuple(tows.frame["tow_id"]), is_trimmed)
        if key not in self._windows:
            find = find_steady_windows if is_trimmed else take_whole_runs
            self._windows[key] = find(tows.blocks)
        windows = self._windows[key]
        averaged = key + (averaging_s, is_robust)
        if averaged not in self._means:
            means = window_means(tows.blocks, windows, averaging_s, is_robust)
            self._means[averaged] = windows.columns_of_runs | means
        return self._means[averaged]
