"""Which steps each tow follows: those of its season, or what a method says of one without GPS."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
import polars as pl

from pipeline.arrays import IntArray
from pipeline.blocks.run_blocks import RunBlocks
from pipeline.blocks.tows import Tows
from pipeline.method.definition import Method
from pipeline.method.options import Calibration, Steps
from pipeline.recompute.facts import add_expected_mass, add_expected_water
from pipeline.recompute.options import StepOptions
from pipeline.recompute.run_cache import RunCache


@dataclass(frozen=True)
class Plan:
    """Tows with the steps that each follows.

    Attributes:
        tows: the tows.
        steps: those that some tow follows, in the order of seasons, of a season with GPS first.
        which: (tows,) place of a tow's steps: tows that share them are alike in how they scatter.
        cache: windows and means that were found before of the same tows; added to.
    """

    tows: Tows
    steps: tuple[Steps, ...]
    which: IntArray
    cache: RunCache

    @classmethod
    def from_method(
        cls,
        method: Method,
        tows: pl.DataFrame,
        blocks: RunBlocks,
        cache: RunCache | None = None,
    ) -> Self:
        """Plan all tows under a method.

        Raises:
            MissingKnowledgeError: the method says nothing about a season of `tows`.
        """
        known = Tows.from_frames(add_expected_water(tows), blocks)
        known = replace(known, frame=add_expected_mass(known.frame))
        seasons = known.frame["season"].to_list()
        has_gps = known.has_gps.tolist()
        of_tows = list(zip(seasons, has_gps, strict=True))
        place_of_group: dict[tuple[Steps, Steps], int] = {}
        place: dict[tuple[int, bool], int] = {}
        for season, gps in sorted(set(of_tows), key=lambda one: (one[0], not one[1])):
            steps = method.get_steps(season)
            own = steps if gps else leave_out_gps(steps)
            place[season, gps] = place_of_group.setdefault((steps, own), len(place_of_group))
        return cls(
            tows=known,
            steps=tuple(own for _, own in place_of_group),
            which=np.array([place[one] for one in of_tows], dtype=np.int64),
            cache=cache or RunCache(),
        )

    @cached_property
    def options(self) -> StepOptions:
        """The options of each tow."""
        return StepOptions.from_steps(self.steps, self.which)

    @cached_property
    def run_options(self) -> StepOptions:
        """The options of each run: those of its tow."""
        return self.options.take(self.tows.tow)

    def average_windows(self) -> dict[str, Any]:
        """Return windows of the runs, and means over them, as `RunCache.average` gives them."""
        is_trimmed = self.run_options.run.is_trimmed
        is_robust = self.run_options.run.is_robust
        averaging_s = self.run_options.wind.averaging_s
        found: dict[str, Any] = {}
        of_runs = zip(is_trimmed.tolist(), averaging_s.tolist(), is_robust.tolist(), strict=True)
        for trimmed, seconds, robust in sorted(set(of_runs)) or [(False, 0, False)]:
            own = self.cache.average(self.tows, trimmed, seconds, robust)
            rows = (is_trimmed == trimmed) & (averaging_s == seconds) & (is_robust == robust)
            found = {name: np.where(rows, own[name], found.get(name, own[name])) for name in own}
        return found

    def replace_steps(self, change: Callable[[Steps], Steps]) -> Self:
        """Return a plan of the same tows with changed steps."""
        return replace(self, steps=tuple(change(steps) for steps in self.steps))


def leave_out_gps(steps: Steps) -> Steps:
    """Return the steps of a tow that has no GPS, where the method says what it then gets."""
    if not steps.estimates_without_gps:
        return steps
    speed = steps.speed.model_copy(update={"correction": "estimated"})
    calibration = Calibration(rule="none")
    return steps.model_copy(update={"speed": speed, "calibration": calibration})


def leave_out_factor(steps: Steps) -> Steps:
    """Return the steps from which log factors are estimated: with the log as it reads."""
    if steps.speed.correction != "estimated":
        return steps
    speed = steps.speed.model_copy(update={"correction": "none"})
    return steps.model_copy(update={"speed": speed})
