"""Intervals hold the truth as often as they say, and are not wider than that: a small version of
`make accuracy-parts`, on seasons with dGPS, where the errors of tows are their own."""

import numpy as np
import polars as pl
import pytest

from herijk.pipeline.method.definition import shipped_method
from herijk.pipeline.recompute.recompute import recompute
from herijk.pipeline.recompute.results import Recomputed
from herijk.simulate import WorldSettings
from tests.worlds import Measured, measure

SEASONS = (2014, 2015, 2016, 2017, 2018)


@pytest.fixture(scope="module")
def world() -> Measured:
    """History, so with boats that were altered and nobody said so."""
    return measure(WorldSettings(SEASONS, 24, 20, 34))


@pytest.fixture(scope="module")
def made(world) -> Recomputed:
    return recompute(shipped_method("rebased"), world.tows, world.blocks)


@pytest.fixture(scope="module")
def tows(world, made) -> pl.DataFrame:
    """Curves with their truth."""
    nearest = pl.DataFrame(
        {"tow_id": list(world.nearest_b_m_s), "true_b_m_s": list(world.nearest_b_m_s.values())}
    )
    return (
        made.curves.join(world.truth.drop("season"), on="tow_id")
        .join(nearest, on="tow_id")
        .drop_nulls("cw_kg_m")
    )


def least_share(number: int) -> float:
    """95 % less four standard errors of a share of so many."""
    return 0.95 - 4 * np.sqrt(0.95 * 0.05 / number)


def test_intervals_of_cw_hold_the_truth(tows):
    inside = tows["cw_at_15c_kg_m"].is_between(tows["cw_lo_kg_m"], tows["cw_hi_kg_m"])
    assert inside.mean() >= least_share(tows.height)


@pytest.mark.xfail(
    strict=True,
    reason="errors are 0.7 of what the budget says in archives of this size (docs/accuracy.md)",
)
def test_intervals_of_cw_are_no_wider_than_they_must(tows, made):
    error = (tows["cw_kg_m"] / tows["cw_at_15c_kg_m"]).log()
    # The standards of force and mass are without error in a simulated world.
    standards = pl.col("component").is_in(["force", "mass"])
    of_tow = made.uncertainty_budget.filter(~standards).group_by("tow_id")
    sizes = of_tow.agg((pl.col("u_ratio") ** 2).sum().sqrt().alias("sd"))
    sd = tows.join(sizes, on="tow_id", how="left", maintain_order="left")["sd"]
    size = np.sqrt(((error / sd) ** 2).mean())
    # Four standard errors of a standard deviation from so many.
    assert size == pytest.approx(1.0, abs=4 / np.sqrt(2 * tows.height))


def test_intervals_of_b_hold_the_truth(tows):
    found = tows.drop_nulls("b_lo_m_s")
    upper = found["b_hi_m_s"].fill_null(float("inf"))
    inside = found["true_b_m_s"].is_between(found["b_lo_m_s"], upper)
    assert inside.mean() >= least_share(found.height)


def test_run_points_scatter_about_their_curves_as_the_unrest_within_the_runs_says(made):
    """Each season's two estimates within a factor of two: the first also has in it what differs
    from run to run (stream, helm), the second what is taken off (wind, inertia)."""
    used = made.run_points.filter("used").with_columns(
        pl.col("tow_id").str.head(4).alias("season"),
        (pl.col("cw_kg_m") / pl.col("fitted_cw_kg_m") - 1.0).alias("residual"),
    )
    dof = pl.len() - 2 * pl.col("tow_id").n_unique()
    seasons = used.group_by("season").agg(
        ((pl.col("residual") ** 2).sum() / dof).sqrt().alias("scatter"),
        (pl.col("u_ratio") ** 2).mean().sqrt().alias("within"),
    )
    assert seasons.height == len(SEASONS)
    assert (seasons["scatter"] / seasons["within"]).is_between(0.5, 2.0).all()
