"""What is remembered of runs is what would be found anew, whatever was asked before."""

import pytest
from polars.testing import assert_frame_equal

from herijk.simulate import WorldSettings
from pipeline.recompute.recompute import recompute
from pipeline.recompute.run_cache import RunCache
from tests.pipeline.methods import method
from tests.worlds import measure

CHANGES = (
    {},
    {"window": '{ rule = "steady" }'},
    {"run_point": '{ estimator = "ratio_of_means" }'},
    {"run_point": '{ estimator = "ratio_of_means", inertia = "end_speeds" }'},
    {"run_point": '{ estimator = "ratio_of_robust_means" }'},
    {"wind": '{ model = "head" }'},
    {"wind": '{ model = "oblique", averaging_s = 5 }'},
)
"""Every option that windows or means depend on."""


@pytest.fixture(scope="module")
def world():
    return measure(WorldSettings((2012, 2016), 4, 20, 11))


def test_windows_and_means_are_those_found_anew(world):
    cache = RunCache()
    for change in CHANGES:
        chosen = method(**change)
        anew = recompute(chosen, world.tows, world.blocks, with_bands=False).run_points
        for _ in range(2):  # the second time it is remembered
            held = recompute(chosen, world.tows, world.blocks, cache, with_bands=False).run_points
            assert_frame_equal(held, anew, check_exact=True)
