"""Intervals hold the truth as often as they say, and are not wider than that: a small part of
`make accuracy`, on seasons with dGPS, where the errors of tows are their own."""

import numpy as np
import polars as pl
import pytest

from benchmarks.accuracy.foreign import reading, runs
from herijk.simulate import WorldSettings
from pipeline.method.reading import read_shipped_method
from pipeline.recompute.recompute import recompute
from pipeline.recompute.results import Recomputed
from pipeline.season_log.priors import PRIORS
from pipeline.uncertainty.propagation import Assumed
from tests.worlds import Measured, measure

SEASONS = (2014, 2015, 2016, 2017, 2018)


@pytest.fixture(scope="module")
def world() -> Measured:
    """History, so with boats that were altered and nobody said so."""
    return measure(WorldSettings(SEASONS, 24, 10, 34))


@pytest.fixture(scope="module")
def made(world) -> Recomputed:
    return recompute(read_shipped_method("rebased"), world.tows, world.blocks)


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


def with_what_is_assumed(world: Measured, rng: np.random.Generator) -> Measured:
    """The same world with what the budget assumes and the simulator does not draw.

    Standards of force and mass, the formula for temperature, the load cell of each season, the
    calibration of each tow, and what else differs from tow to tow.
    """
    assumed, listed = Assumed(), runs(world)
    shared_by = {
        "tow": (PRIORS.tow_sd, assumed.temperature_formula_ratio, assumed.mass_standard_ratio),
        "season": (PRIORS.force_sd,),
    }
    ln_force = assumed.force_standard_ratio * rng.standard_normal()
    for whose, sizes in shared_by.items():
        place = listed[whose].rank("dense").to_numpy() - 1
        drawn = rng.standard_normal(place.max() + 1)[place]
        ln_force = ln_force + np.sqrt(np.square(sizes).sum()) * drawn
    ln_gps = PRIORS.calibration_sd * rng.standard_normal(world.tows.height)[listed["tow"]]
    return reading(world, force=np.exp(ln_force), gps=np.exp(ln_gps))


def test_errors_are_as_large_as_the_budget_says(world):
    """Where they are drawn as it assumes them: without, the budget cannot but be too large."""
    squares = []
    for seed in range(8):
        drawn = with_what_is_assumed(world, np.random.default_rng(seed))
        made = recompute(read_shipped_method("rebased"), drawn.tows, drawn.blocks, with_bands=False)
        of_tow = made.uncertainty_budget.group_by("tow_id")
        variance = of_tow.agg((pl.col("u_ratio") ** 2).sum().alias("variance"))
        held = made.curves.join(world.truth, on="tow_id").join(variance, on="tow_id")
        error = (held["cw_kg_m"] / held["cw_at_15c_kg_m"]).log()
        squares.append((error**2 / held["variance"]).mean())
    error_of_mean = np.std(squares, ddof=1) / np.sqrt(len(squares))
    assert np.mean(squares) == pytest.approx(1.0, abs=4 * error_of_mean)


def test_intervals_of_b_hold_the_truth(tows):
    found = tows.drop_nulls("b_lo_m_s")
    upper = found["b_hi_m_s"].fill_null(float("inf"))
    inside = found["true_b_m_s"].is_between(found["b_lo_m_s"], upper)
    assert inside.mean() >= least_share(found.height)
