"""Samples of a tow: exact without defects, and each defect on its own channels only."""

from dataclasses import replace

import numpy as np
import polars as pl
import pytest

from herijk.simulate import (
    AirCoefficients,
    Defects,
    WorldSettings,
    simulate_tow,
    simulate_world,
    true_cw_kg_m,
)
from pipeline.channels import SAMPLE_SCHEMA

SEASON = 2016  # has a GPS
CHANNELS = ("log1_m_s", "log2_m_s", "gps_m_s", "force_n", "wind_speed_m_s", "wind_angle_deg")


def samples_with(rate_hz=20, number=0, season=SEASON, air=None, **sizes):
    """One tow with only the named defects."""
    world = simulate_world(
        WorldSettings(
            seasons=(season,),
            tows_per_season=3,
            rate_hz=rate_hz,
            defects=lambda s: replace(Defects(), **sizes),
            air=air or AirCoefficients(),
        )
    )
    tow = world.tows[number]
    frame, runs = simulate_tow(world, tow)
    return frame, runs, tow


def changed_channels(frame, clean):
    return {name for name in CHANNELS if not frame[name].equals(clean[name])}


@pytest.fixture(scope="module")
def clean():
    return samples_with()[0]


def test_frame_has_exactly_the_schema_and_six_runs(clean):
    assert dict(clean.schema) == SAMPLE_SCHEMA
    assert clean.height == 6 * 50 * 20
    assert clean["run"].unique(maintain_order=True).to_list() == [1, 2, 3, 4, 5, 6]
    assert clean.null_count().row(0) == (0,) * 7


def test_without_defects_force_is_the_true_curve_exactly():
    frame, runs, tow = samples_with()
    speed = frame["log1_m_s"].to_numpy().astype(float)
    cw = true_cw_kg_m(tow.hull, speed, tow.water_temperature_c, AirCoefficients())
    # Single precision is all that differs.
    np.testing.assert_allclose(frame["force_n"].to_numpy() / speed**2, cw, rtol=5e-7)
    np.testing.assert_allclose(frame["gps_m_s"], speed, rtol=1e-7)
    np.testing.assert_allclose(frame["log2_m_s"], speed, rtol=1e-7)
    np.testing.assert_allclose(frame["wind_speed_m_s"], speed, rtol=1e-7)
    assert frame["wind_angle_deg"].unique().to_list() == [0.0]
    means = frame.group_by("run", maintain_order=True).agg(pl.col("log1_m_s").mean())
    ratios = means["log1_m_s"].to_numpy() / tow.declared_speed_m_s
    np.testing.assert_allclose(ratios, [0.9, 1.0, 1.1] * 2, rtol=1e-6)
    assert all((r.undisturbed_start_s, r.undisturbed_end_s) == (0.0, 50.0) for r in runs)


LOGS = {"log1_m_s", "log2_m_s"}
WIND = {"wind_speed_m_s", "wind_angle_deg"}
MOTION = {*LOGS, "gps_m_s", "force_n", "wind_speed_m_s"}


@pytest.mark.parametrize(
    ("sizes", "channels"),
    [
        ({"log_season_factor": (1.05, 1.05)}, LOGS),
        ({"log_tow_sd": 0.01}, LOGS),
        ({"log_run_wander": 0.01}, LOGS),
        ({"log_noise_m_s": 0.03}, LOGS),
        ({"log2_ratio": (0.95, 0.95)}, {"log2_m_s"}),
        ({"gps_wander_m_s": 0.1}, {"gps_m_s"}),
        ({"gps_noise_m_s": 0.1}, {"gps_m_s"}),
        ({"water_temperature_c": (5.0, 5.0)}, {"force_n"}),
        ({"vane_jitter_deg": 10.0}, {"wind_angle_deg"}),
        ({"wind_m_s": 2.0}, {"force_n", *WIND}),
        ({"speed_miss": 0.01}, MOTION),
        ({"speed_wander_m_s": 0.02}, MOTION),
        ({"ramp_share": 1.0, "ramp_m_s": 0.2}, MOTION),
        ({"gust_share": 1.0, "gust_m_s": 2.0}, {"force_n", *WIND}),
        ({"steering_share": 1.0, "steering_force": 0.3}, {"force_n"}),
        ({"surge_force": 0.06}, {"force_n"}),
        ({"force_wander": 0.02}, {"force_n"}),
        ({"force_noise": 0.05}, {"force_n"}),
        ({"askew_share": 1.0, "askew_excess": (0.08, 0.08)}, {"force_n"}),
        ({"fast_run_share": 1.0}, MOTION),
        ({"log_flicker": 0.01}, LOGS),
        ({"steering_peaks": 2.0, "steering_peak_force": 0.3}, {"force_n"}),
        ({"surge_m_s": 0.01}, MOTION),
        ({"force_zero_tow_n": 2.0}, {"force_n"}),
        # Current moves the boat over ground, hence also through the air.
        ({"stream_m_s": 0.1}, {"gps_m_s", "force_n", "wind_speed_m_s"}),
        ({"stream_drift_m_s": 0.1}, {"gps_m_s", "force_n", "wind_speed_m_s"}),
    ],
    ids=lambda value: "+".join(sorted(value)) if isinstance(value, dict) else "",
)
def test_a_defect_changes_only_its_channels(clean, sizes, channels):
    assert changed_channels(samples_with(**sizes)[0], clean) == channels


def test_askew_pulling_raises_water_force_by_its_excess(clean):
    frame, _, tow = samples_with(askew_share=1.0, askew_excess=(0.08, 0.08))
    assert tow.truth.askew_ratio == 1.08
    extra = (frame["force_n"] / clean["force_n"]).to_numpy() - 1.0
    # The still-air part, some 3 %, is not pulled askew.
    assert np.all((extra > 0.075) & (extra < 0.08))


@pytest.mark.parametrize(
    ("name", "size", "column", "relative"),
    [
        ("log_noise_m_s", 0.03, "log1_m_s", False),
        ("log_noise_m_s", 0.03, "log2_m_s", False),
        ("speed_wander_m_s", 0.02, "log1_m_s", False),
        ("gps_noise_m_s", 0.05, "gps_m_s", False),
        ("gps_wander_m_s", 0.08, "gps_m_s", False),
        ("surge_force", 0.06, "force_n", True),
        ("force_wander", 0.02, "force_n", True),
        ("force_noise", 0.05, "force_n", True),
        ("log_flicker", 0.02, "log1_m_s", True),
        ("surge_m_s", 0.02, "log1_m_s", False),
    ],
)
def test_a_random_defect_has_its_size(name, size, column, relative):
    """Root mean square over 60 runs; the slowest, with 20 s, has some 75 independent values."""
    size_of = {"seasons": (SEASON,), "tows_per_season": 10, "rate_hz": 10}
    calm_world, world = (
        simulate_world(WorldSettings(**size_of, defects=lambda s, one=one: one))
        for one in (Defects(), replace(Defects(), **{name: size}))
    )
    squares = []
    for tow, calm_tow in zip(world.tows, calm_world.tows, strict=True):
        disturbed = simulate_tow(world, tow)[0][column].to_numpy().astype(float)
        calm = simulate_tow(calm_world, calm_tow)[0][column].to_numpy()
        squares.append(np.mean((disturbed / calm - 1.0 if relative else disturbed - calm) ** 2))
    # sd / sqrt(2 * 75) is 8 %; three of those. The rest is better known.
    assert np.sqrt(np.mean(squares)) == pytest.approx(size, rel=0.25)


def test_a_flickering_log_has_equal_power_in_every_octave():
    """1/f: a mean over four times as long is hardly steadier; that of white noise twice."""
    frame, _, _ = samples_with(log_flicker=0.01, number=1)
    calm, _, _ = samples_with(number=1)
    error = (frame["log1_m_s"] / calm["log1_m_s"]).to_numpy().reshape(6, -1) - 1.0
    sd = [error.reshape(6, -1, 20 * s).mean(axis=2).std() for s in (1, 5)]
    assert 0.6 < sd[1] / sd[0] < 1.0


def test_steering_peaks_push_up_and_stand_anywhere_in_a_run():
    frame, _, _ = samples_with(steering_peaks=3.0, steering_peak_force=0.3)
    calm, _, _ = samples_with()
    excess = (frame["force_n"] / calm["force_n"]).to_numpy().reshape(6, -1) - 1.0
    assert excess.min() >= -1e-6
    assert 0.1 < excess.max() < 0.65
    in_the_middle = excess[:, 15 * 20 : 35 * 20]
    assert in_the_middle.max() > 0.1


def test_slow_gusts_outlast_the_window_over_which_wind_is_averaged():
    frame, _, _ = samples_with(wind_m_s=4.0, slow_gusts=0.3)
    steady, _, _ = samples_with(wind_m_s=4.0)
    wind = (frame["wind_speed_m_s"] - steady["wind_speed_m_s"]).to_numpy().reshape(6, -1)
    per_second = wind.reshape(6, 50, 20).mean(axis=2)
    lagged = [np.corrcoef(run[:-5], run[5:])[0, 1] for run in per_second]
    assert np.mean(lagged) > 0.4


def test_gps_is_late_by_its_lag_and_held_between_fixes():
    frame, _, _ = samples_with(speed_wander_m_s=0.05, gps_lag_s=2.0, gps_hold_s=1.0)
    run = frame.filter(pl.col("run") == 1)
    gps, log = run["gps_m_s"].to_numpy(), run["log1_m_s"].to_numpy()
    np.testing.assert_array_equal(gps.reshape(50, 20), np.repeat(gps[::20], 20).reshape(50, 20))
    np.testing.assert_allclose(gps[2 * 20 :: 20], log[: -2 * 20 : 20], rtol=1e-6)


def test_inertia_adds_mass_times_acceleration():
    ramp = {"ramp_share": 1.0, "ramp_m_s": 0.2}
    without, _, tow = samples_with(**ramp)
    with_inertia, _, _ = samples_with(**ramp, inertia=1.0)
    run = with_inertia["run"].to_numpy() == 1
    extra_n = (with_inertia["force_n"] - without["force_n"]).to_numpy()[run]
    speed = with_inertia["log1_m_s"].to_numpy()[run].astype(float)
    mass_kg = 1.08 * tow.hull.displacement_kg
    assert np.mean(extra_n) == pytest.approx(mass_kg * (speed[-1] - speed[0]) / 50.0, rel=0.03)


def test_true_wind_is_the_same_out_and_back():
    frame, _, _ = samples_with(wind_m_s=3.0)
    angle = np.radians(frame["wind_angle_deg"].to_numpy().astype(float))
    wind = frame["wind_speed_m_s"].to_numpy().astype(float)
    ahead = wind * np.cos(angle) - frame["gps_m_s"].to_numpy()
    abeam = wind * np.sin(angle)
    half = frame.height // 2
    np.testing.assert_allclose(ahead[:half], -ahead[half:], atol=1e-5)
    np.testing.assert_allclose(abeam[:half], -abeam[half:], atol=1e-5)
    assert np.hypot(ahead[0], abeam[0]) > 0.5


@pytest.mark.parametrize(
    ("kind", "sizes", "column"),
    [
        ("ramp", {"ramp_share": 1.0, "ramp_m_s": 0.2}, "log1_m_s"),
        ("gust", {"gust_share": 1.0, "gust_m_s": 2.0}, "wind_speed_m_s"),
        ("steering", {"steering_share": 1.0, "steering_force": 0.3}, "force_n"),
    ],
)
def test_undisturbed_windows_leave_out_what_was_planted(kind, sizes, column):
    frame, runs, _ = samples_with(**sizes)
    values = frame[column].to_numpy().reshape(6, -1)
    time_s = np.arange(values.shape[1]) / 20
    for run, channel in zip(runs, values, strict=True):
        assert [d.kind for d in run.disturbances] == [kind]
        assert run.undisturbed_end_s - run.undisturbed_start_s >= 30.0
        inside = (time_s >= run.undisturbed_start_s) & (time_s <= run.undisturbed_end_s)
        calm = np.median(channel[inside])
        # What a ramp still lacks at the end of its window is 0.01 m/s.
        assert np.abs(channel[inside] - calm).max() < 0.005 * calm
        assert np.abs(channel[~inside] - calm).max() > 0.02 * calm


def test_magnitudes_are_those_of_the_printed_runs_of_2014():
    """Two runs of 2014: log sd 1.2-2.6 %, force sd 8-9 %, vane sd 15-21 deg, wind sd 24-35 %."""
    world = simulate_world(WorldSettings(rate_hz=50, seasons=(2014,)))
    log_sd, force_sd, vane_sd, wind_sd = [], [], [], []
    for tow in world.tows:
        for _, run in simulate_tow(world, tow)[0].group_by("run"):
            log_sd.append(run["log1_m_s"].std() / run["log1_m_s"].mean())
            force_sd.append(run["force_n"].std() / run["force_n"].mean())
            wind_sd.append(run["wind_speed_m_s"].std() / run["wind_speed_m_s"].mean())
            angle = np.radians(run["wind_angle_deg"].to_numpy())
            resultant = np.hypot(np.cos(angle).mean(), np.sin(angle).mean())
            vane_sd.append(np.degrees(np.sqrt(-2 * np.log(resultant))))
    assert 0.010 < np.median(log_sd) < 0.03
    assert 0.07 < np.median(force_sd) < 0.10
    assert 13 < np.median(vane_sd) < 21
    assert 0.1 < np.median(wind_sd) < 0.35
