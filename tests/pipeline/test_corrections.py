"""Every correction against the mock instrument: with it the truth is recovered, without it not.

A defect is planted alone, and a tow is compared with the same tow without the defect, so that
neither the shape of the hyperbola nor any other defect has a part in it.
"""

import numpy as np
import polars as pl
import pytest

from herijk.simulate import Defects, WorldSettings, simulate_tow, simulate_world
from pipeline.blocks.run_blocks import stack_blocks
from pipeline.blocks.sums import block_sums
from pipeline.channels import SAMPLE_SCHEMA
from pipeline.recompute.recompute import recompute
from pipeline.recompute.results import Recomputed
from tests.pipeline.methods import method
from tests.worlds import Measured, measure, recompute_world, run_rows, tow_rows

ADDED_MASS = 1.08
EXACT = 1e-6
"""Samples are in single precision."""

OBLIQUE = '{ model = "oblique", ahead = 0.5, behind = 0.5, side = 0.2%s }'


def world(defects: Defects, season: int = 2015, seed: int = 5) -> WorldSettings:
    return WorldSettings((season,), 8, 20, seed, defects=lambda season: defects)


def cw_of(defects: Defects, **steps: str) -> np.ndarray:
    """Cw at the declared speed of each tow of a world with these defects."""
    tables, _ = recompute_world(world(defects), [method(**steps)])
    assert tables.curves["cw_kg_m"].null_count() == 0
    return tables.curves["cw_kg_m"].to_numpy()


@pytest.fixture(scope="module")
def clean() -> np.ndarray:
    return cw_of(Defects())


def error(found: np.ndarray, clean: np.ndarray) -> np.ndarray:
    return np.abs(found / clean - 1.0)


def test_without_defects_a_plain_method_finds_the_truth_but_for_the_hyperbola(clean):
    truth = measure(world(Defects())).truth["cw_at_tow_temperature_kg_m"].to_numpy()
    # 22 hulls of the Delft series miss by 0.2 % in the median and 1.5 % at most.
    assert np.median(error(clean, truth)) < 0.003
    assert error(clean, truth).max() < 0.015


def test_calibration_on_dgps(clean):
    worn = Defects(log_season_factor=(1.05, 1.05), log_tow_sd=0.01, stream_m_s=0.1)
    wind = OBLIQUE % ""  # the current carries the boat through the air
    assert error(cw_of(worn, wind=wind), clean).min() > 0.08
    found = cw_of(worn, wind=wind, calibration='{ rule = "gps_per_tow" }')
    assert error(found, clean).max() < EXACT


def test_prescribed_speed_correction(clean):
    worn = Defects(log_season_factor=(1.06, 1.06))
    prescribed = '{ correction = "prescribed", factor = %s }'
    assert error(cw_of(worn), clean).min() > 0.12  # (2 + s) 6 %
    assert error(cw_of(worn, speed=prescribed % 1.06), clean).max() < EXACT
    assert error(cw_of(worn, speed=prescribed % (1 / 0.94)), clean).min() > 0.005


def test_a_percentage_of_the_tow_list_goes_before_that_of_the_season(clean):
    worn = measure(world(Defects(log_season_factor=(1.04, 1.04))))
    speed = '{ correction = "prescribed", factor = 1.06 }'
    tows = worn.tows.with_columns(pl.lit(0.04).alias("speed_correction_ratio"))
    found = recompute(method(speed=speed), tows, worn.blocks).curves["cw_kg_m"].to_numpy()
    assert error(found, clean).max() < EXACT
    unused = recompute(method(), tows, worn.blocks).curves["cw_kg_m"].to_numpy()
    assert error(unused, clean).min() > 0.08


def test_a_load_cell_that_reads_too_much(clean):
    too_much = Defects(force_scale=1.04)
    assert error(cw_of(too_much), clean).min() > 0.039
    assert error(cw_of(too_much, force="{ ratio = 1.04 }"), clean).max() < EXACT


def test_oblique_wind(clean):
    windy = Defects(wind_m_s=5.0, wind_turbulence=0.25)
    assert error(cw_of(windy), clean).max() > 0.1
    head = error(cw_of(windy, wind='{ model = "head", ahead = 0.5, behind = 0.5 }'), clean)
    assert 0.02 < head.max() < 0.1
    # The wind is simulated 20 times a second, so at 20 Hz the samples are all there is.
    assert error(cw_of(windy, wind=OBLIQUE % ""), clean).max() < EXACT


def test_averaging_of_the_wind_against_a_jittering_vane(clean):
    jitter = Defects(wind_m_s=5.0, wind_turbulence=0.25, vane_jitter_deg=13.0)
    as_read = cw_of(jitter, wind=OBLIQUE % "") / clean - 1.0
    averaged = cw_of(jitter, wind=OBLIQUE % ", averaging_s = 5") / clean - 1.0
    assert np.sqrt(np.mean(as_read**2)) > 2.5 * np.sqrt(np.mean(averaged**2))
    assert abs(averaged.mean()) < 0.001
    assert np.abs(averaged).max() < 0.005


@pytest.mark.parametrize("water_c", [3.0, 27.0])
def test_temperature(clean, water_c):
    water = Defects(water_temperature_c=(water_c, water_c))
    without = error(cw_of(water), clean)
    corrected = error(cw_of(water, temperature='{ rule = "ittc57" }'), clean)
    # CF changes by 4-5 % over those 12 degrees, and friction is over 40 % of the resistance.
    assert without.min() > 0.016
    # The method knows neither the form factor nor the wetted surface, only estimates of it.
    assert corrected.max() < 0.25 * without.max()
    assert corrected.max() < 0.01


def test_salt_water(clean):
    """Friction grows by 2 % in the North Sea: heavier and tougher water, on less wetted surface."""
    sea = Defects(salinity_g_kg=34.0)
    without = cw_of(sea) / clean - 1.0
    assert 0.008 < without.min() < without.max() < 0.02
    corrected = error(cw_of(sea, temperature='{ rule = "ittc57" }'), clean)
    assert corrected.max() < 0.25 * without.max()


def cold_without(column: str, tows: int) -> tuple[pl.DataFrame, pl.DataFrame, Measured]:
    """A world in cold water, its tows as recorded, and with a column lost in the first few."""
    cold = measure(world(Defects(water_temperature_c=(4.0, 4.0))))
    lost = pl.col("tow_id").is_in(cold.tows["tow_id"].sort().head(tows).implode())
    return cold.tows, cold.tows.with_columns(pl.when(~lost).then(column).alias(column)), cold


def test_a_temperature_that_is_not_known_is_not_corrected():
    _, tows, cold = cold_without("water_temperature_c", 1)
    with_rule = recompute(method(temperature='{ rule = "ittc57" }'), tows, cold.blocks)
    without = recompute(method(), tows, cold.blocks)
    corrected = (with_rule.curves["cw_kg_m"] < without.curves["cw_kg_m"]).to_list()
    assert corrected == [False] + 7 * [True]
    assert with_rule.curves["cw_kg_m"][0] == without.curves["cw_kg_m"][0]


@pytest.mark.parametrize("missing", ["weight_kg", "crew_weight_kg"])
def test_a_boat_without_a_weight_is_corrected_by_that_of_others(missing):
    """It is off by 2 to 3 % in cold water otherwise, and nobody was told."""
    tows, unweighed, cold = cold_without(missing, 1)
    ittc57 = method(temperature='{ rule = "ittc57" }')
    plain = recompute(method(), tows, cold.blocks).curves["cw_kg_m"]
    right, found = (recompute(ittc57, rows, cold.blocks) for rows in (tows, unweighed))
    correction = (right.curves["cw_kg_m"] / plain).log()
    moved = (found.curves["cw_kg_m"] / right.curves["cw_kg_m"]).log()
    assert correction[0] < -0.015
    # Friction goes with the root of the mass: 40 % of mass is 20 % of the correction.
    assert abs(moved[0]) < 0.2 * abs(correction[0])
    assert moved[1:].to_list() == [0.0] * 7
    notes = found.assessments.filter("flagged", check="weight_not_recorded")
    assert notes["tow_id"].to_list() == [found.curves["tow_id"][0]]
    assert right.assessments.filter("flagged", check="weight_not_recorded").is_empty()
    u_right, u_found = (u_of_temperature(made) for made in (right, found))
    # All crews of a class weigh the same in this world; boats do not.
    assert (u_found[0] > u_right[0]) == (missing == "weight_kg")
    assert u_found[1:].to_list() == u_right[1:].to_list()
    _, no_temperature, _ = cold_without("water_temperature_c", 1)
    assert u_found[0] < u_of_temperature(recompute(ittc57, no_temperature, cold.blocks))[0]


def u_of_temperature(made: Recomputed) -> pl.Series:
    """Relative uncertainty of Cw by the temperature, of each tow."""
    return made.uncertainty_budget.filter(component="temperature").sort("tow_id")["u_ratio"]


def test_an_archive_without_any_weight_is_not_corrected():
    _, unweighed, cold = cold_without("weight_kg", 8)
    with_rule = recompute(method(temperature='{ rule = "ittc57" }'), unweighed, cold.blocks)
    without = recompute(method(), unweighed, cold.blocks)
    assert with_rule.curves["cw_kg_m"].to_list() == without.curves["cw_kg_m"].to_list()
    assert with_rule.assessments.filter(check="weight_not_recorded")["flagged"].all()


def accelerating(acceleration_m_s2: float) -> tuple[pl.DataFrame, "object"]:
    """A world without defects whose boats gain or lose speed steadily during each run."""
    settings = world(Defects())
    simulated = simulate_world(settings)
    tows = tow_rows(simulated)
    mass = dict(
        tows.select("tow_id", (pl.col("weight_kg") + pl.col("crew_weight_kg")) * ADDED_MASS).rows()
    )
    frames = []
    for tow in simulated.tows:
        samples = simulate_tow(simulated, tow)[0]
        time_s = (pl.int_range(pl.len()).over("run") / settings.rate_hz).cast(pl.Float64)
        before = pl.col("log1_m_s").cast(pl.Float64)
        after = before + acceleration_m_s2 * (time_s - 25.0)
        force = pl.col("force_n") * (after / before) ** 2 + mass[tow.tow_id] * acceleration_m_s2
        moved = samples.with_columns(after.alias("log1_m_s"), force.alias("force_n"))
        moved = moved.cast(SAMPLE_SCHEMA)
        tow_id = pl.lit(tow.tow_id).alias("tow_id")
        frames.append(block_sums(moved, settings.rate_hz).select(tow_id, pl.all()))
    return tows, stack_blocks(pl.concat(frames), run_rows(tows))


@pytest.mark.parametrize("acceleration_m_s2", [0.002, -0.002])
def test_inertia(clean, acceleration_m_s2):
    """0.1 m/s over 50 s at 2 t is 2 % of the force."""
    tows, blocks = accelerating(acceleration_m_s2)
    corrected = '{ estimator = "mean_of_ratios", inertia = "end_speeds" }'
    plain, mended = (
        recompute(m, tows, blocks).curves["cw_kg_m"].to_numpy()
        for m in (method(), method(run_point=corrected))
    )
    assert error(plain, clean).min() > 0.01
    assert (np.sign(plain - clean) == np.sign(acceleration_m_s2)).all()
    assert error(mended, clean).max() < 1e-4


def test_ratio_of_means_is_not_biased_by_a_noisy_log(clean):
    """The mean of F / v^2 exceeds the ratio of means by 3 (sd / v)^2."""
    noisy = Defects(log_noise_m_s=0.15)
    v = measure(world(noisy)).tows["declared_speed_m_s"].to_numpy()
    ratios = cw_of(noisy) / clean - 1.0
    means = cw_of(noisy, run_point='{ estimator = "ratio_of_means" }') / clean - 1.0
    expected = float((3 * (0.15 / v) ** 2).mean())
    assert ratios.mean() == pytest.approx(expected, rel=0.25)
    assert abs(means.mean()) < 0.3 * expected


def test_seconds_with_a_steering_peak_count_less(clean):
    """A peak in the middle of a run cannot be cut, and always pulls upwards."""
    peaks = Defects(steering_peaks=1.0, steering_peak_force=0.3, force_noise=0.08)
    means, robust = (
        cw_of(peaks, run_point=f'{{ estimator = "{name}" }}') / clean - 1.0
        for name in ("ratio_of_means", "ratio_of_robust_means")
    )
    assert means.mean() > 0.004
    assert abs(robust.mean()) < 0.6 * means.mean()


def test_a_steering_peak_does_not_make_a_run_that_swings():
    peaks = Defects(steering_peaks=1.0, steering_peak_force=0.3, force_noise=0.08)
    plain, robust = (
        recompute_world(world(peaks), [method(run_point=f'{{ estimator = "{name}" }}')])[0]
        for name in ("ratio_of_means", "ratio_of_robust_means")
    )
    highest = [one.run_points["cw_seconds_sd_kg_m"].max() for one in (plain, robust)]
    assert highest[1] < 0.7 * highest[0]


def test_seconds_count_alike_where_none_stands_out(clean):
    wind = '{ model = "oblique", ahead = 0.5, behind = 0.5, side = 0.2, averaging_s = 3 }'
    calm = Defects(wind_m_s=3.0)
    means, robust = (
        cw_of(calm, run_point=f'{{ estimator = "{name}" }}', wind=wind)
        for name in ("ratio_of_means", "ratio_of_robust_means")
    )
    np.testing.assert_allclose(robust, means, rtol=1e-5)
