"""Intervals over a curve's valid speeds: at the declared speed the curve's own, wider elsewhere."""

from dataclasses import replace

import numpy as np
import polars as pl
import pytest

from herijk.simulate import WorldSettings, world_settings
from pipeline.method.definition import shipped_method
from pipeline.recompute.recompute import recompute
from pipeline.recompute.results import Recomputed
from tests.worlds import measure


@pytest.fixture(scope="module", params=["rebased", "rebased-2015"])
def made(request) -> Recomputed:
    world = measure(WorldSettings((2010, 2014), 12, 20, 4))
    return recompute(shipped_method(request.param), world.tows, world.blocks)


@pytest.fixture(scope="module")
def points(made) -> pl.DataFrame:
    declared = made.curves.select("tow_id", "declared_speed_m_s")
    ratio = pl.col("speed_m_s") / pl.col("declared_speed_m_s")
    return made.curve_points.join(declared, on="tow_id").with_columns(
        ratio.round(3).alias("ratio"),
        (pl.col("cw_hi_kg_m") / pl.col("cw_lo_kg_m")).log().alias("width"),
    )


def test_at_the_declared_speed_it_is_the_curve_s_own_interval(made, points):
    own = made.curves.drop_nulls("cw_kg_m")
    both = points.filter(pl.col("ratio") == 1.0).join(own, on="tow_id", suffix="_own")
    assert both.height == own.height > 0
    for name in ("cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m"):
        assert (both[name] / both[f"{name}_own"] - 1.0).abs().max() < 1e-12


def test_points_cover_the_valid_range_and_lie_on_the_curve(made, points):
    assert points["ratio"].min() == 0.85
    assert points["ratio"].max() == 1.15
    with_b = points.join(made.curves.drop_nulls("b_m_s"), on="tow_id", suffix="_own")
    hyperbola = pl.col("a_kg_m") / (1.0 - (pl.col("speed_m_s") / pl.col("b_m_s")) ** 2)
    off = with_b.select((hyperbola / pl.col("cw_kg_m") - 1.0).abs().max()).item()
    assert off < 1e-12


def test_the_interval_is_widest_at_an_end(points):
    """Not at both: a tow whose log read low was towed faster than its declared speed."""
    wide = points.pivot("ratio", index="tow_id", values="width").drop_nulls()
    assert wide.height > 0
    ends = wide.select(pl.max_horizontal("0.85", "1.15")).to_series()
    assert (ends >= wide.select(pl.max_horizontal(pl.exclude("tow_id"))).to_series()).all()


def test_two_files_with_logs_that_differ_widen_the_interval_where_nothing_calibrates_them():
    world = measure(
        world_settings("two-files", seasons=(2010, 2014), tows_per_season=8, rate_hz=10, seed=3)
    )
    made = recompute(shipped_method("rebased"), world.tows, world.blocks, with_bands=False)
    by_log = made.uncertainty_budget.filter(component="calibration").join(world.truth, on="tow_id")
    two, old = pl.col("second_log_factor").is_not_null(), pl.col("season") == 2010
    u = [by_log.filter(two == files, old)["u_ratio"].mean() for files in (True, False)]
    assert u[0] > u[1] + 0.01
    assert by_log.filter(~old)["u_ratio"].max() < u[0]


@pytest.mark.parametrize(("share", "no_curve"), [(0.07, []), (0.02, ["2014-003"])])
def test_a_tow_of_next_to_no_force_stops_no_other_and_decides_nothing(share, no_curve):
    """So it is with a force in kgf once the wind is taken off: of the water there is no part."""
    world = measure(WorldSettings((2012, 2014), 6, 10, 4))
    mine = world.blocks.runs["tow_id"].eq("2014-003").to_numpy()[:, None]
    sums = {
        name: np.where(mine & (name == "force" or name.endswith("_cw")), share, 1.0) * values
        for name, values in world.blocks.sums.items()
    }
    blocks = replace(world.blocks, sums=sums)
    method = shipped_method("rebased")
    made = recompute(method, world.tows, blocks, with_bands=False)
    assert made.curves.filter(pl.col("cw_kg_m").is_null())["tow_id"].to_list() == no_curve
    sound = world.tows.filter(pl.col("tow_id") != "2014-003")
    without = recompute(method, sound, world.blocks, with_bands=False)
    found, expected = (one.run_points["wind_coefficient_ahead"][0] for one in (made, without))
    assert found == pytest.approx(expected, rel=0.01)
