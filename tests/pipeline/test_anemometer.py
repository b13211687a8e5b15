"""The scale of anemometers by the wind out and back."""

from dataclasses import replace

import numpy as np
import polars as pl
import pytest

from herijk.simulate import Defects, WorldSettings
from pipeline.blocks.run_blocks import AIR_SUMS
from pipeline.method.reading import read_shipped_method
from pipeline.recompute.anemometer import estimate_scales
from pipeline.recompute.recompute import recompute
from tests.worlds import measure

SEASONS = np.repeat([2010.0, 2012.0, 2014.0, 2016.0], 25)


def found(scale, vane_deg=0.0, shared_sd=0.0, seed=1):
    """Ln scale and sd of each season, of tows whose wind changes by 6 % between out and back."""
    rng = np.random.default_rng(seed)
    of_tow = np.asarray(scale)[np.unique(SEASONS, return_inverse=True)[1]]
    mean = [[np.cos(np.radians(vane_deg))], [np.sin(np.radians(vane_deg))]]
    ahead, abeam = of_tow * (mean + 0.06 * rng.standard_normal((2, len(SEASONS))))
    shared = shared_sd + 0.0 * SEASONS
    seen = {"season": SEASONS, "ahead": ahead, "abeam": abeam, "shared_sd": shared}
    return estimate_scales(pl.DataFrame(seen)).select("ln_scale", "sd").to_numpy().T


@pytest.mark.parametrize("vane_deg", [0.0, 20.0])
def test_one_season_off_stands_alone(vane_deg):
    true = np.log([1.0, 0.7, 1.0, 1.0])
    ln_scale, sd = found(np.exp(true), vane_deg)
    assert ln_scale == pytest.approx(true, abs=0.04)
    assert (np.abs(ln_scale - true) < 3 * sd).all()
    assert sd.max() < 0.02


def test_one_anemometer_for_all_seasons_is_known_from_all():
    ln_scale, sd = np.array([found(np.full(4, 0.8), seed=seed) for seed in range(40)]).swapaxes(
        0, 1
    )
    errors = ln_scale - np.log(0.8)
    assert sd.mean() < 0.06 / np.sqrt(25)
    assert np.abs(errors.mean()) < 0.005
    assert (np.abs(errors) < 1.96 * sd).mean() > 0.85


def test_a_log_that_is_not_known_says_little_of_the_wind():
    scale = [0.94, 1.0, 1.0, 1.0]
    sure, doubted = (found(scale, shared_sd=sd * (SEASONS == 2010))[0, 0] for sd in (0.0, 0.06))
    assert abs(doubted) < 0.5 * abs(sure)


def test_an_anemometer_that_reads_too_little_moves_no_curve():
    """What it reads is found, named and taken out: every curve is nearly the same.

    Not quite, as limits on gusts are in m/s and some windows differ. As it reads it would be 4 %.
    """
    measured = measure(WorldSettings((2014, 2016), 10, 10, 3, Defects.clean))
    power = {"wind_v": 1.0, "wind_x": 1.0, "wind_y": 1.0} | dict.fromkeys(AIR_SUMS, 2.0)
    power |= {f"log1_{name}": 2.0 for name in AIR_SUMS}
    sums = {
        name: values * 0.7 ** power.get(name, 0.0) for name, values in measured.blocks.sums.items()
    }
    faulty = replace(measured, blocks=replace(measured.blocks, sums=sums))
    method = read_shipped_method("rebased")
    sound, found = (
        recompute(method, w.tows, w.blocks, with_bands=False) for w in (measured, faulty)
    )
    ratio = (found.curves["cw_kg_m"] / sound.curves["cw_kg_m"]).to_numpy()
    assert ratio == pytest.approx(1.0, abs=0.005)
    assert ratio.mean() == pytest.approx(1.0, abs=5e-4)
    rows = found.season_diagnosis.filter(instrument="anemometer_scale")
    assert rows["verdict"].to_list() == ["alarm", "alarm"]
    assert rows.select(pl.lit(np.log(0.7)).is_between("lo", "hi")).to_series().all()
