"""Named worlds: each fault is what its name says, where it says, and nothing else."""

import csv
from collections import defaultdict
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from herijk.simulate import (
    simulate_tow,
    simulate_world,
    true_cw_kg_m,
    world_settings,
)
from herijk.simulate.delft import FROUDE, RESIDUARY
from tests.worlds import nearest_hyperbola

DELFT_FILE = Path(__file__).parents[2] / "data" / "uci_yacht_hydrodynamics.csv"
SEASONS = tuple(range(2009, 2019))


def world(name, **size):
    return simulate_world(world_settings(name, **{"tows_per_season": 12, "rate_hz": 20} | size))


def tow_of(name, season, number=0):
    found = world(name, seasons=(season,))
    return simulate_tow(found, found.tows[number])[0], found.tows[number]


@pytest.mark.parametrize(
    ("name", "season", "changed"),
    [
        ("force-scale-dgps", 2016, {"force_n"}),
        ("force-zero", 2016, {"force_n"}),
        ("anemometer", 2010, {"wind_speed_m_s"}),
        ("vane", 2010, {"wind_angle_deg"}),
        ("gps-scale", 2016, {"gps_m_s"}),
        ("gps-lag", 2016, {"gps_m_s"}),
        ("fouling", 2010, {"log1_m_s", "log2_m_s"}),
        ("force-scale-dgps", 2015, set()),
        ("temperatures", 2016, set()),
    ],
)
def test_a_fault_touches_its_own_channel_in_its_own_seasons(name, season, changed):
    (samples, _), (clean, _) = tow_of(name, season), tow_of("clean", season)
    assert {c for c in samples.columns if not samples[c].equals(clean[c])} == changed


def test_fouling_and_a_replaced_log_move_the_days_of_a_season():
    fouling = [t.truth for t in world("fouling", seasons=(2010,)).tows]
    change = np.log([t.log_factor_of_day / t.season_log_factor for t in fouling])
    assert (change[0], change[-1]) == pytest.approx((-0.02, 0.02))
    assert (np.diff(change) >= 0).all()
    replaced = [t.truth for t in world("log-replaced", seasons=(2010,)).tows]
    steps = np.log([t.log_factor_of_day / t.season_log_factor for t in replaced])
    assert set(steps.round(6)) == {0.0, -0.04}
    assert (np.diff(steps) <= 0).all()


def test_a_turning_tide_is_in_the_ground_speed_alone():
    (samples, _), (clean, _) = tow_of("tide", 2016), tow_of("clean", 2016)
    assert samples["log1_m_s"].equals(clean["log1_m_s"])
    runs = samples.with_columns(moved=pl.col("gps_m_s") - clean["gps_m_s"]).group_by("run")
    moved = runs.agg(pl.col("moved").mean()).sort("run")["moved"].to_numpy()
    stream = moved * np.array([1, 1, 1, -1, -1, -1])
    assert stream.min() < 0.0 < stream.max()
    assert (np.diff(stream) > 0).all() or (np.diff(stream) < 0).all()


def test_the_table_of_the_delft_series_is_the_published_one():
    published = defaultdict(list)
    with DELFT_FILE.open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            resistance = float(row["residuary_resistance_per_1000_displacement_weight"])
            published[row["hull_no"]].append((float(row["froude"]), resistance))
    del published["5"]
    assert [tuple(r for _, r in hull) for hull in published.values()] == list(RESIDUARY)
    assert all(tuple(f for f, _ in hull) == FROUDE for hull in published.values())


@pytest.mark.parametrize(("name", "low", "high"), [("delft", 0.4, 0.8), ("hump", 0.6, 1.1)])
def test_how_far_a_hyperbola_misses_such_hulls(name, low, high):
    found = world(name)
    misses = []
    for tow in found.tows:
        speeds = tow.declared_speed_m_s * np.array([0.9, 1.0, 1.1])
        true = true_cw_kg_m(tow.hull, speeds, 15.0, found.settings.air)
        a, b = nearest_hyperbola(tow.hull, tow.declared_speed_m_s, 15.0, found.settings.air)
        misses.append(100 * np.sqrt(np.mean((a / (1 - (speeds / b) ** 2) / true - 1) ** 2)))
    assert low < np.median(misses) < high


def test_dropouts_gaps_and_spikes_are_in_the_samples():
    found = world("dropouts", seasons=(2016,), tows_per_season=40)
    samples = pl.concat([simulate_tow(found, tow)[0] for tow in found.tows])
    assert 0 < (samples["log1_m_s"] == 0.0).sum() < 0.01 * samples.height
    assert 0 < samples["force_n"].is_nan().sum() < 0.01 * samples.height
    assert 0 < (samples["force_n"].fill_nan(0.0) > 4000.0).sum() < 20
