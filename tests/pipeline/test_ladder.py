"""The ladder and the sensitivity study: factors multiply, each change shows where it was made."""

import numpy as np
import polars as pl
import pytest

from herijk.simulate import WorldSettings
from pipeline.method.options import START, STEP_ORDER
from pipeline.method.reading import read_shipped_method
from pipeline.recompute.recompute import recompute
from pipeline.recompute.run_cache import RunCache
from pipeline.studies.ladder import ladder
from pipeline.studies.options import CHOICES, option_effects
from tests.worlds import measure

OLD, NEW = read_shipped_method("as-published"), read_shipped_method("rebased-2015")


@pytest.fixture(scope="module")
def world():
    return measure(WorldSettings((2010, 2013, 2016), 4, 20, 11))


@pytest.fixture(scope="module")
def rungs(world):
    return ladder(OLD, NEW, world.tows, world.blocks)


def cw(method, world):
    curves = recompute(method, world.tows, world.blocks).curves
    return dict(curves.select("tow_id", "cw_kg_m").drop_nulls().rows())


def test_factors_multiply_from_one_method_to_the_other(world, rungs):
    old, new = cw(OLD, world), cw(NEW, world)
    totals = rungs.group_by("tow_id").agg(pl.col("factor").product())
    assert set(totals["tow_id"]) == old.keys() & new.keys()
    for tow_id, product in totals.rows():
        assert product == pytest.approx(new[tow_id] / old[tow_id], rel=1e-10)


def test_every_tow_has_every_step_in_order(rungs):
    for _, steps in rungs.group_by("tow_id"):
        assert steps["step"].to_list() == [START, *STEP_ORDER]
        assert steps["position"].to_list() == list(range(len(STEP_ORDER) + 1))


@pytest.fixture(scope="module")
def effects(world):
    links = recompute(NEW, world.tows, world.blocks).tow_instruments
    return option_effects(NEW, world.tows, world.blocks, links, RunCache())


def test_the_effect_of_a_choice_is_that_of_choosing_it(world, effects):
    old = effects.filter(option="speed.factor")
    prescribed = world.tows.filter(season=2010)["tow_id"]
    assert set(old["tow_id"]) == set(prescribed), "of other seasons it is no choice"
    # 1 / 0.94 against 1.06 is 0.36 % of speed, at the elasticities 2 to 5 of Cw.
    step = np.log(1 / 0.94 / 1.06)
    assert old["cw_effect_ratio"].log().is_between(-5 * step, -2 * step).all()


def test_a_tow_whose_log_is_estimated_has_no_effects(world):
    """Another option also moves the factor of its season, which stays that of the method here."""
    rebased = read_shipped_method("rebased")
    links = recompute(rebased, world.tows, world.blocks).tow_instruments
    effects = option_effects(rebased, world.tows, world.blocks, links, RunCache())
    calibrated = world.tows.filter(season=2016)["tow_id"]
    assert set(effects["tow_id"]) == set(calibrated)


def test_every_choice_has_its_effect(effects):
    assert set(effects["option"]) == set(CHOICES)
