"""A GPS that is late is found by the unrest of the runs, and taken off."""

from dataclasses import replace

import numpy as np
import pytest

from herijk.simulate import world_settings
from pipeline.method.definition import shipped_method
from pipeline.recompute.recompute import recompute
from pipeline.steps.fix_delay import fix_delay_s, fixes_in_time
from tests.worlds import Measured, measure

SEASONS = (2014, 2015)
LATE_S = 5
OWN_S = 3
"""What the simulated receiver smooths is about 2 s late by itself."""


def late(world: Measured, season: int, seconds: int) -> Measured:
    """The same world with a GPS that tells in one season what it should have told before."""
    of = world.tows.select("tow_id", "season")
    mine = world.blocks.runs.join(of, on="tow_id", maintain_order="left")["season"] == season
    sums = dict(world.blocks.sums)
    for name in ("gps", "gps_n"):
        before = np.concatenate([sums[name][:, :1]] * seconds + [sums[name][:, :-seconds]], axis=1)
        sums[name] = np.where(mine.to_numpy()[:, None], before, sums[name])
    return replace(world, blocks=replace(world.blocks, sums=sums))


@pytest.fixture(scope="module")
def world() -> Measured:
    return measure(world_settings("clean", seasons=SEASONS, tows_per_season=12, rate_hz=10, seed=3))


def seasons_of(world: Measured) -> np.ndarray:
    of = world.tows.select("tow_id", "season")
    return world.blocks.runs.join(of, on="tow_id", maintain_order="left")["season"].to_numpy()


def test_the_delay_of_a_season_is_found_beside_what_there_was(world: Measured) -> None:
    season = seasons_of(world)
    usual = fix_delay_s(world.blocks, season)
    found = fix_delay_s(late(world, 2015, LATE_S).blocks, season)
    assert (usual <= OWN_S).all()
    assert (found[season == 2014] == usual[season == 2014]).all()
    assert ((found >= LATE_S) & (found <= LATE_S + OWN_S))[season == 2015].all()


def test_a_gps_of_noise_alone_is_not_late(world: Measured) -> None:
    rng = np.random.default_rng(1)
    n = world.blocks["gps_n"]
    noise = n * (2.5 + 0.05 * rng.standard_normal(n.shape))
    blocks = replace(world.blocks, sums={**world.blocks.sums, "gps": noise})
    assert not fix_delay_s(blocks, seasons_of(world)).any()


def test_fixes_come_back_to_their_second(world: Measured) -> None:
    delay = np.where(seasons_of(world) == 2015, LATE_S, 0)
    moved = late(world, 2015, LATE_S).blocks
    back = fixes_in_time(moved, delay)
    for name, values in back.items():
        kept = np.where(delay > 0, moved.seconds - LATE_S, moved.seconds)
        there = np.arange(moved.seconds) < kept[:, None]
        assert np.array_equal(values[there], world.blocks[name][there])
        assert not values[~there].any()


def test_a_late_gps_leaves_the_calibration_as_it_was(world: Measured) -> None:
    """Without the option a boat that gains speed is calibrated wrongly."""
    rising = rising_speed(world)
    method = shipped_method("rebased")
    factor = {
        name: recompute(method, one.tows, one.blocks, with_bands=False).curves["calibration_factor"]
        for name, one in {"in time": rising, "late": late(rising, 2015, LATE_S)}.items()
    }
    apart = (factor["late"] / factor["in time"] - 1).abs()
    assert apart.max() < 0.002


def rising_speed(world: Measured) -> Measured:
    """The same world with a boat that gains 0.05 m/s in every run, by log and GPS."""
    sums, n = dict(world.blocks.sums), world.blocks.n
    rise = np.linspace(0.0, 0.05, n.shape[1])
    for name, count in (("gps", sums["gps_n"]), *((f"{s}_v", n) for s in ("log1", "log2", "mean"))):
        sums[name] = sums[name] + count * rise
    return replace(world, blocks=replace(world.blocks, sums=sums))
