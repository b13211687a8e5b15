"""What is remembered of runs is what would be found anew, whatever was asked before."""

from dataclasses import fields, is_dataclass

import numpy as np
import pytest

from herijk.simulate import WorldSettings
from pipeline.blocks.batch import Batch
from pipeline.recompute.run_cache import RunCache
from pipeline.steps.resistance import OverWindow, run_means
from pipeline.steps.window import steady_windows, whole_runs
from tests.pipeline.methods import method
from tests.worlds import measure

CHANGES = (
    {},
    {"window": '{ rule = "steady" }'},
    {"run_point": '{ estimator = "ratio_of_means" }'},
    {"run_point": '{ estimator = "ratio_of_means", inertia = "end_speeds" }'},
    {"wind": '{ model = "head" }'},
    {"wind": '{ model = "oblique", averaging_s = 5 }'},
)
"""Every option that windows or means depend on."""


@pytest.fixture(scope="module")
def batches():
    world = measure(WorldSettings((2012, 2016), 4, 20, 11))
    whole = Batch.of(world.tows, world.blocks)
    return [whole.part(whole.of_tow("season") == s) for s in (2012, 2016)]


def numbers(found):
    """Every array of windows or means, those of ends and air parts too."""
    parts = [getattr(found, field.name) for field in fields(found)]
    return [n for part in parts for n in (numbers(part) if is_dataclass(part) else [part])]


def test_means_and_windows_are_those_found_anew(batches):
    cache = RunCache()
    seen = []
    for _ in range(2):
        for change in CHANGES:
            steps = method(**change).for_season(2012)
            for batch in batches:
                alone = Batch.of(batch.tows, batch.blocks)
                choose = whole_runs if steps.window.rule == "all" else steady_windows
                windows = choose(alone.blocks)
                sums = OverWindow.of(alone.blocks, windows.mask)
                anew = [windows, run_means(alone, sums, steps)]
                held = [cache.windows(batch, steps), cache.means(batch, steps)]
                for mine, other in zip(held, anew, strict=True):
                    for a, b in zip(numbers(mine), numbers(other), strict=True):
                        assert np.asarray(a).tobytes() == np.asarray(b).tobytes()
                seen.append(held[1])
    assert len({id(means) for means in seen}) == len(batches) * len(CHANGES)


def test_a_log_factor_leaves_windows_and_means_as_they_are(batches):
    cache = RunCache()
    plain, corrected = (
        method(speed=f'{{ correction = "{correction}" }}').for_season(2012)
        for correction in ("none", "estimated")
    )
    found = cache.means(batches[0], plain)
    assert found is cache.means(batches[0], corrected)
    cache.let_go()
    assert found is cache.means(batches[0], plain)
    cache.clear()
    assert len(cache) == 0
