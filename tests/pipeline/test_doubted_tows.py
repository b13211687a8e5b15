"""Tows that the rest of the archive rules out: what is estimated of them, and of the others."""

import math
from dataclasses import replace

import numpy as np
import polars as pl
import pytest
from polars.testing import assert_frame_equal

from herijk.simulate import WorldSettings
from pipeline.method.reading import read_shipped_method
from pipeline.recompute.recompute import recompute
from tests.worlds import Measured, measure, with_force_ratio

BEST = ("cw_best_kg_m", "cw_best_lo_kg_m", "cw_best_hi_kg_m")


@pytest.fixture(scope="module")
def world() -> Measured:
    return measure(WorldSettings((2010, 2012, 2015, 2016), 12, 10, 3))


def doubt(world: Measured, names: list[str], ratio: float) -> Measured:
    """The world with the force of some tows read x ratio, and found not plausible."""
    marked = world.tows["tow_id"].is_in(names)
    changed = with_force_ratio(world, marked.to_numpy(), ratio)
    none = pl.lit([], pl.List(pl.String))
    doubts = pl.when(marked).then(pl.lit(["force_not_plausible"])).otherwise(none)
    return replace(changed, tows=world.tows.with_columns(doubts=doubts))


def curves(world: Measured) -> pl.DataFrame:
    made = recompute(read_shipped_method("rebased"), world.tows, world.blocks).curves
    return made.join(world.truth.drop("season"), on="tow_id").sort("tow_id")


def repeated(world: Measured, season: int) -> str:
    """A tow of a season whose boat was towed in others, with the same crew."""
    line = ["fsn_no", "rowers", "crew_class"]
    tows = world.tows.filter(pl.len().over(line) >= 2, season=season)
    return str(tows.sort("tow_id")["tow_id"][0])


@pytest.mark.parametrize(("season", "ratio"), [(2010, 0.5), (2010, 4.4482), (2015, 1.4)])
def test_the_best_estimate_of_a_doubted_tow_is_that_of_the_boats_other_tows(world, season, ratio):
    tow = repeated(world, season)
    row = curves(doubt(world, [tow], ratio)).row(by_predicate=pl.col("tow_id") == tow, named=True)
    truth = row["cw_at_15c_kg_m"]
    best, lo, hi = (row[name] for name in BEST)
    assert abs(math.log(row["cw_kg_m"] / truth)) > 0.9 * abs(math.log(ratio))
    assert lo < truth < hi
    assert hi / lo < 1.15
    assert lo < best < hi


def test_what_a_doubted_tow_reads_moves_no_other_number(world):
    tow = repeated(world, 2010)
    small, large = (curves(doubt(world, [tow], ratio)) for ratio in (1.4, 4.4482))
    numbers = pl.col("tow_id", "cw_kg_m", "cw_best_kg_m")
    others = (one.filter(pl.col("tow_id") != tow).select(numbers) for one in (small, large))
    assert_frame_equal(*others, rel_tol=1e-6)


def test_a_boat_of_which_every_tow_is_doubted_stays_as_measured(world):
    tow = repeated(world, 2010)
    (boat,) = world.tows.filter(tow_id=tow)["fsn_no"]
    found = curves(doubt(world, world.tows.filter(fsn_no=boat)["tow_id"].to_list(), 1.4))
    own = found.filter(fsn_no=boat)
    assert np.allclose(own["cw_best_kg_m"], own["cw_kg_m"], rtol=1e-12)
