"""The ladder: factors multiply, each change shows where it was made."""

import polars as pl
import pytest

from herijk.simulate import WorldSettings
from pipeline.method.options import START, STEP_ORDER
from pipeline.method.reading import read_shipped_method
from pipeline.recompute.recompute import recompute
from pipeline.studies.ladder import ladder
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
