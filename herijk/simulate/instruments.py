"""What each instrument reads of the true motion: logs, GPS, load cell and anemometer.

Slow errors are drawn on the grid of the motion; only sensor noise is drawn sample by sample, as
the same process at every rate. What is true is in `motion` and `hull`.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from herijk.simulate.defects import Defects
from herijk.simulate.hull import AirCoefficients, air_force_n, water_cw_kg_m
from herijk.simulate.motion import SLOW_HZ, TrueRun
from herijk.simulate.random_streams import (
    Component,
    TowStreams,
    coloured_noise,
    flicker_noise,
    smooth_wander,
)
from herijk.simulate.world import Tow
from pipeline.channels import RUN_SECONDS

ADDED_MASS: Final = 0.08
"""Water that moves along, relative to the boat's mass (stated assumption: 5 to 10 % is usual)."""
SURGE_HZ: Final = 1.0
SPIKE_RATIO: Final = 30.0

# Correlation times [s] (stated assumptions; the force spectrum gives a sample sd of about 8 %).
VANE_S: Final = 0.4
GPS_WANDER_S: Final = 20.0
LOG_WANDER_S: Final = 10.0
LOG_NOISE_S: Final = 0.1
SURGE_COHERENCE_S: Final = 5.0
FORCE_WANDER_S: Final = 3.0
FORCE_NOISE_S: Final = 0.05

Floats = NDArray[np.float64]
Samples = NDArray[np.float32]


def read_logs(
    time_s: Floats, run: TrueRun, tow: Tow, defects: Defects, streams: TowStreams
) -> tuple[Samples, Samples]:
    """Simulate both logs; log 2 shares the factor of log 1, times its own ratio."""
    step_s = RUN_SECONDS / time_s.size
    speed_m_s = np.interp(time_s, run.grid_s, run.speed_m_s)
    readings = []
    for ratio, slow, fast, one_over_f in (
        (1.0, Component.LOG1_SLOW, Component.LOG1_NOISE, Component.LOG1_FLICKER),
        (tow.truth.log2_ratio, Component.LOG2_SLOW, Component.LOG2_NOISE, Component.LOG2_FLICKER),
    ):
        offset = streams[slow].standard_normal()
        wander = offset + smooth_wander(streams[slow], run.grid_s.size, 1 / SLOW_HZ, LOG_WANDER_S)
        flicker = flicker_noise(streams[one_over_f], run.grid_s.size, 1 / SLOW_HZ)
        error = defects.log_run_wander * wander + defects.log_flicker * flicker
        scale = ratio / tow.truth.log_factor * (1.0 + error)
        noise = coloured_noise(streams[fast], speed_m_s.size, step_s, LOG_NOISE_S)
        reading = speed_m_s * np.interp(time_s, run.grid_s, scale) + defects.log_noise_m_s * noise
        readings.append(reading.astype(np.float32))
    return readings[0], readings[1]


def read_gps(time_s: Floats, run: TrueRun, defects: Defects, streams: TowStreams) -> Samples:
    """Simulate speed over ground, late, and held between two fixes."""
    rng = streams[Component.GPS]
    wander = smooth_wander(rng, run.grid_s.size, 1.0 / SLOW_HZ, GPS_WANDER_S)
    speed = run.ground_speed_m_s + defects.gps_wander_m_s * wander
    noise = rng.standard_normal(int(RUN_SECONDS) + 1)
    held_s = defects.gps_hold_s
    # A hair of a sample keeps a fix on its own second in spite of rounding.
    fix_s = np.floor(time_s / held_s + 1e-9) * held_s if held_s else time_s
    reading = defects.gps_scale * np.interp(fix_s - defects.gps_lag_s, run.grid_s, speed)
    return np.asarray(reading + defects.gps_noise_m_s * noise[fix_s.astype(int)], dtype=np.float32)


def read_load_cell(
    time_s: Floats,
    run: TrueRun,
    tow: Tow,
    *,
    defects: Defects,
    air: AirCoefficients,
    streams: TowStreams,
) -> Samples:
    """Simulate the force on the load cell: water, air, inertia, unrest of tow line and helm."""
    count, step_s = time_s.size, RUN_SECONDS / time_s.size

    def interpolate_to_samples(slow: Floats) -> Floats:
        return np.interp(time_s, run.grid_s, slow)

    speed_m_s = interpolate_to_samples(run.speed_m_s)
    cw = water_cw_kg_m(tow.hull, speed_m_s, tow.water_temperature_c, tow.salinity_g_kg)
    water_n = cw * speed_m_s**2 * tow.truth.askew_ratio
    air_n = air_force_n(
        tow.hull,
        interpolate_to_samples(run.wind_ahead_m_s),
        interpolate_to_samples(run.wind_abeam_m_s),
        air,
    )
    mass_kg = tow.hull.displacement_kg * (1.0 + ADDED_MASS)
    inertia_n = defects.inertia * mass_kg * interpolate_to_samples(run.acceleration_m_s2)
    wander = smooth_wander(
        streams[Component.FORCE_WANDER], run.grid_s.size, 1.0 / SLOW_HZ, FORCE_WANDER_S
    )
    noise = coloured_noise(streams[Component.FORCE_NOISE], count, step_s, FORCE_NOISE_S)
    unrest = (
        defects.surge_force * _simulate_surge(time_s, run.grid_s, streams[Component.FORCE_SURGE])
        + interpolate_to_samples(defects.force_wander * wander + run.steering_force)
        + defects.force_noise * noise
    )
    felt_n = water_n * (1.0 + unrest) + air_n + inertia_n
    return np.asarray(defects.force_scale * felt_n + tow.truth.force_zero_n, dtype=np.float32)


def _simulate_surge(time_s: Floats, grid_s: Floats, rng: np.random.Generator) -> Floats:
    """Simulate the swing of the tow line about `SURGE_HZ`, of unit variance and drifting phase."""
    in_phase = coloured_noise(rng, grid_s.size, 1.0 / SLOW_HZ, SURGE_COHERENCE_S)
    quadrature = coloured_noise(rng, grid_s.size, 1.0 / SLOW_HZ, SURGE_COHERENCE_S)
    phase = 2 * np.pi * SURGE_HZ * time_s
    cosine = np.interp(time_s, grid_s, in_phase) * np.cos(phase)
    sine = np.interp(time_s, grid_s, quadrature) * np.sin(phase)
    return np.asarray(cosine + sine)


def read_anemometer(
    time_s: Floats, run: TrueRun, defects: Defects, streams: TowStreams
) -> tuple[Samples, Samples]:
    """Simulate apparent wind speed and its angle in [0, 360), with the swinging of the vane."""
    ahead = np.interp(time_s, run.grid_s, run.wind_ahead_m_s)
    abeam = np.interp(time_s, run.grid_s, run.wind_abeam_m_s)
    jitter = coloured_noise(streams[Component.VANE], run.grid_s.size, 1.0 / SLOW_HZ, VANE_S)
    swing_deg = defects.vane_jitter_deg * np.interp(time_s, run.grid_s, jitter)
    true_deg = np.degrees(np.arctan2(abeam, ahead))
    angle = (true_deg + defects.vane_offset_deg + swing_deg).astype(np.float32)
    angle = np.mod(angle, np.float32(360.0))
    # A hair below zero rounds to 360 in single precision.
    angle[angle == 360.0] = 0.0
    return (defects.anemometer_scale * np.hypot(ahead, abeam)).astype(np.float32), angle


def damage(force: Samples, log1: Samples, defects: Defects, rng: np.random.Generator) -> None:
    """Put what files of real instruments hold into one run: zeros, no numbers, a spike."""
    a_second = force.size / RUN_SECONDS
    spike_n = SPIKE_RATIO * float(force.mean())
    for share, channel, value, longest in (
        (defects.dropout_share, log1, 0.0, a_second),
        (defects.gap_share, force, np.nan, a_second),
        (defects.spike_share, force, spike_n, 1.0),
    ):
        chance, length, place = rng.random(3)
        if chance < share:
            samples = max(int(length * longest), 1)
            first = int(place * (force.size - samples))
            channel[first : first + samples] = value
