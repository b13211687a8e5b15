"""Intervals over a curve's valid speeds: at the declared speed the curve's own, wider elsewhere."""

from dataclasses import replace

import numpy as np
import polars as pl
import pytest

from herijk.simulate import Defects, WorldSettings, world_settings
from pipeline.method.reading import parse_method, read_shipped_method
from pipeline.recompute.recompute import recompute
from pipeline.recompute.results import Recomputed
from tests.worlds import measure


@pytest.fixture(scope="module", params=["rebased", "rebased-2015"])
def made(request) -> Recomputed:
    world = measure(WorldSettings((2010, 2014), 12, 20, 4))
    return recompute(read_shipped_method(request.param), world.tows, world.blocks)


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
    made = recompute(read_shipped_method("rebased"), world.tows, world.blocks, with_bands=False)
    by_log = made.uncertainty_budget.filter(component="calibration").join(world.truth, on="tow_id")
    two, old = pl.col("second_log_factor").is_not_null(), pl.col("season") == 2010
    u = [by_log.filter(two == files, old)["u_ratio"].mean() for files in (True, False)]
    assert u[0] > u[1] + 0.01
    assert by_log.filter(~old)["u_ratio"].max() < u[0]


def test_a_hull_off_its_hyperbola_does_not_count_as_scatter():
    """Only 100 % of the declared speed reads 1.5 % more force: a shape, and no noise."""
    world = measure(WorldSettings((2014, 2015), 8, 10, 4))
    at_declared = (world.blocks.runs["target_speed_ratio"] == 1.0).to_numpy()[:, None]
    factor = np.where(at_declared, 1.015, 1.0)
    humped = dict(world.blocks.sums)
    for name, power in {"force": 1, "log1_cw": 1, "log1_cw2": 2}.items():
        humped[name] = humped[name] * factor**power
    parts = {}
    for name, sums in {"plain": world.blocks.sums, "humped": humped}.items():
        blocks = replace(world.blocks, sums=sums)
        made = recompute(read_shipped_method("rebased"), world.tows, blocks, with_bands=False)
        budget = made.uncertainty_budget.group_by("component").agg(pl.col("u_ratio").mean())
        parts[name] = dict(budget.rows())
    assert parts["humped"]["random"] == pytest.approx(parts["plain"]["random"], rel=0.05)
    assert parts["humped"]["misfit"] > 2.0 * parts["plain"]["misfit"]


def test_out_and_back_show_how_far_the_drag_coefficient_may_be_off():
    """The prescribed coefficient is right, or 0.15 too large."""
    windy = Defects(wind_m_s=5.0)
    world = measure(WorldSettings((2014, 2015), 12, 10, 4, defects=lambda season: windy))
    by_wind = []
    for drag in (0.5, 0.65):
        text = (
            'name = "draft"\ntitle = "Test"\nextends = "rebased"\n[steps]\n'
            f"wind = {{ ahead = {drag}, behind = {drag} }}\n"
        )
        method = parse_method(text, "draft.toml")
        made = recompute(method, world.tows, world.blocks, with_bands=False)
        by_wind.append(made.uncertainty_budget.filter(component="wind")["u_ratio"].mean())
    assert by_wind[1] > 5.0 * by_wind[0] > 0.0
