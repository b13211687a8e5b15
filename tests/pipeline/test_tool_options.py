"""The ticks of the tool of 2015: every combination is the method with those options."""

import itertools

import numpy as np
import polars as pl
import pytest

from herijk.simulate import WorldSettings
from pipeline.hull import hull_speed_m_s
from pipeline.method.reading import parse_method, read_shipped_method
from pipeline.recompute.recompute import recompute
from pipeline.recompute.run_cache import RunCache
from pipeline.studies.options import TICKS, cross_ticks, option_curves
from tests.worlds import measure

SPEEDS = {2010: {"as_read", "multiply", "divide"}, 2013: {"as_read"}, 2016: {"as_read", "dgps"}}


@pytest.fixture(scope="module")
def world():
    return measure(WorldSettings((2010, 2013, 2016), 3, 20, 12))


@pytest.fixture(scope="module")
def curves(world):
    method = read_shipped_method("rebased-2015")
    links = recompute(method, world.tows, world.blocks).tow_instruments
    return option_curves(method, world.tows, world.blocks, links, RunCache())


def test_sixteen_combinations_at_each_speed_that_the_season_knows(world, curves):
    for tow_id, season in world.tows.select("tow_id", "season").rows():
        of_tow = curves.filter(tow_id=tow_id)
        assert set(of_tow["speed"]) == SPEEDS[season]
        for _, of_speed in of_tow.group_by("speed"):
            found = set(of_speed.select(TICKS.keys()).rows())
            assert found == set(itertools.product((False, True), repeat=4))


def test_a_combination_is_the_method_with_those_options(world, curves):
    text = (
        'name = "x"\ntitle = "x"\nextends = "rebased-2015"\n[steps]\n'
        'window = { rule = "all" }\nwind = { coefficients = "per_run", averaging_s = 3 }\n'
        'speed = { factor = 1.0638297872340425 }\ncurve = { b = "free" }\n'
        '[[overrides]]\nrange = "2009:2011"\nspeed = { factor = 1.0638297872340425 }\n'
    )
    own = recompute(parse_method(text, "x.toml"), world.tows, world.blocks).curves
    ticked = {"optimisation": True, "trimming": False, "vane": True, "b_from_length": False}
    best = pl.col("speed").is_in(["divide", "dgps"])
    one = curves.filter(best | pl.col("tow_id").str.starts_with("2013"), **ticked)
    both = one.join(own.select("tow_id", own="cw_kg_m"), on="tow_id")
    assert both.height == world.tows.height
    assert both["cw_kg_m"].to_numpy() == pytest.approx(both["own"].to_numpy(), rel=1e-12)


def test_b_from_length_is_hull_speed(world, curves):
    ticked = curves.filter("b_from_length").join(world.tows, on="tow_id")
    hull = hull_speed_m_s(ticked["waterline_length_m"].to_numpy())
    assert ticked["b_m_s"].to_numpy() == pytest.approx(hull)


def test_the_speed_correction_is_the_largest_effect_and_dividing_takes_more(world, curves):
    effects = cross_ticks(curves).join(world.tows.select("tow_id", "season"), on="tow_id")
    old = effects.filter(season=2010)
    # 6 % of speed at elasticities of 2 to 5; 1 / 0.94 against 1.06 is 0.36 %.
    ln = {name: rows["cw_effect_ratio"].log() for (name,), rows in old.group_by("option")}
    assert ln["correction"].is_between(-5 * np.log(1.06), -2 * np.log(1.06)).all()
    step = np.log(1 / 0.94 / 1.06)
    assert ln["operation"].is_between(-5 * step, -2 * step).all()
    assert "correction" not in effects.filter(season=2016)["option"].to_list()
