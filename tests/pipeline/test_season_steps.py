"""Log error and force error told apart through a whole archive: from samples to `season_steps`."""

from dataclasses import replace
from functools import cache, partial

import pytest

from herijk.simulate import Defects, WorldSettings
from pipeline.method.definition import shipped_method
from pipeline.recompute.recompute import recompute
from tests.worlds import measure, with_force_error

SEASONS = (2010, 2013, 2014, 2015, 2017, 2018)
LOG_ERROR, FORCE_ERROR = 1.06, 1.16
"""Both raise the Cw of a season by about 16 %."""


def defects(factor_of_2010, season):
    factor = factor_of_2010 if season == 2010 else 1.0
    return replace(Defects.clean(season), log_season_factor=(factor, factor))


@cache
def archive(factor_of_2010):
    return measure(WorldSettings(SEASONS, 24, 10, 1, partial(defects, factor_of_2010)))


def causes(world):
    steps = recompute(shipped_method("rebased"), world.tows, world.blocks, with_bands=False)
    return dict(steps.season_steps.select("season", "cause").rows())


def test_a_wrong_log_is_named():
    assert causes(archive(LOG_ERROR)) == dict.fromkeys(SEASONS, "none") | {2010: "log"}


@pytest.mark.parametrize("season", [2010, 2014])
def test_a_wrong_load_cell_is_named(season):
    found = causes(with_force_error(archive(1.0), season, FORCE_ERROR))
    assert found[season] == "force"
    assert "log" not in found.values()
