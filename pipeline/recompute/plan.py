"""Which steps each tow follows: those of its season, or what a method says of one without GPS."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
import polars as pl

from pipeline.arrays import IntArray
from pipeline.blocks.run_blocks import RunBlocks
from pipeline.blocks.tows import Tows
from pipeline.method.definition import Calibration, Method, Steps
from pipeline.recompute.facts import with_expected_mass, with_expected_water
from pipeline.recompute.run_cache import RunCache


@dataclass(frozen=True)
class Plan:
    """Tows with the steps that each follows.

    Attributes:
        steps: those that some tow follows, in the order of seasons, of a season with GPS first.
        which: (tows,) place of a tow's steps: tows that share them are alike in how they scatter.
        cache: what was found before of the same tows; added to.
    """

    tows: Tows
    steps: tuple[Steps, ...]
    which: IntArray
    cache: RunCache

    @classmethod
    def of(
        cls,
        method: Method,
        tows: pl.DataFrame,
        blocks: RunBlocks,
        cache: RunCache | None = None,
    ) -> Self:
        """All tows under a method.

        Raises:
            MissingKnowledgeError: the method says nothing about a season of `tows`.
        """
        known = Tows.of(with_expected_water(tows), blocks)
        known = replace(known, frame=with_expected_mass(known.frame))
        season, has_gps = known.frame["season"].to_list(), known.has_gps.tolist()
        groups: dict[tuple[Steps, Steps], int] = {}
        place = {}
        for year, gps in sorted({*zip(season, has_gps, strict=True)}, key=lambda s: (s[0], -s[1])):
            steps = method.for_season(year)
            own = steps if gps else without_gps(steps)
            place[year, gps] = groups.setdefault((steps, own), len(groups))
        which = [place[one] for one in zip(season, has_gps, strict=True)]
        own_steps = tuple(own for _, own in groups)
        return cls(known, own_steps, np.array(which, dtype=np.int64), cache or RunCache())

    def windows(self) -> dict[str, Any]:
        """Windows of the runs, and means over them, as `RunCache.of` gives them."""
        rule, averaging = self.of_runs("window.rule"), self.of_runs("wind.averaging_s")
        robust = self.of_runs("run_point.estimator") == "ratio_of_robust_means"
        asked = sorted({*zip(rule.tolist(), averaging.tolist(), robust.tolist(), strict=True)})
        first, *others = [self.cache.of(self.tows, *one) for one in asked or [("all", 0, False)]]
        here = [(rule == r) & (averaging == s) & (robust == h) for r, s, h in asked[1:]]
        return {
            name: np.select(here, [other[name] for other in others], values) if here else values
            for name, values in first.items()
        }

    def option(self, name: str) -> Any:
        """An option of each tow's steps, such as `speed.correction`, shape (tows,)."""
        step, option = name.split(".")
        return np.array([getattr(getattr(s, step), option) for s in self.steps])[self.which]

    def of_runs(self, name: str) -> Any:
        """The same of each run's tow, shape (runs,)."""
        return self.option(name)[self.tows.tow]

    def changed(self, change: Callable[[Steps], Steps]) -> Self:
        """The same tows with other steps."""
        return replace(self, steps=tuple(map(change, self.steps)))


def without_gps(steps: Steps) -> Steps:
    """The steps of a tow that has no GPS, where the method says what it then gets."""
    if not steps.estimates_without_gps:
        return steps
    speed = steps.speed.model_copy(update={"correction": "estimated"})
    calibration = Calibration(rule="none")
    return steps.model_copy(update={"speed": speed, "calibration": calibration})


def without_factor(steps: Steps) -> Steps:
    """The steps from which log factors are estimated: with the log as it reads."""
    if steps.speed.correction != "estimated":
        return steps
    speed = steps.speed.model_copy(update={"correction": "none"})
    return steps.model_copy(update={"speed": speed})
