"""The true motion of a boat in its runs, and the current and wind around it.

Drawn on a grid of 20 points per second, the same at every sampling rate, so that a tow at 20 Hz
and at 1000 Hz is the same tow. What instruments make of it is in `instruments`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from herijk.simulate.defects import Defects
from herijk.simulate.random_streams import (
    Component,
    TowStreams,
    coloured_noise,
    smooth_wander,
    swing,
)
from herijk.simulate.world import Tow
from pipeline.channels import BACK, OUT, RUN_SECONDS, RUNS_PER_FILE, TARGET_SPEED_RATIOS

SLOW_HZ: Final = 20.0
LEAD_S: Final = 5.0
"""Motion before the start of a run, for the GPS that lags."""
SECONDS_BETWEEN_RUNS: Final = 75.0
SECONDS_TO_TURN: Final = 180.0
FAST_RUN_RATIO: Final = 1.2
TIDE_PERIOD_S: Final = 12.42 * 3600.0
SLACK_WITHIN_S: Final = 400.0
"""A tide that turns during a tow does so within so many seconds of its middle."""
EDGE_S: Final = 8.0
"""Gusts and steering corrections happen in the first or the last so many seconds of a run."""
BUMP_S: Final = (3.0, 6.0)
RAMP_TIME_CONSTANT_S: Final = (2.0, 3.5)
RAMP_OVER_M_S: Final = 0.01
"""A run counts as disturbed while more than this is missing from its speed."""

HELM_S: Final = 8.0
TURBULENCE_S: Final = 6.0
"""Correlation times of the helmsman's wander and of gusts (stated assumptions)."""
SLOW_GUSTS_S: Final = 30.0
SURGE_HZ: Final = 0.25
SURGE_PHASE_S: Final = 15.0
STEERING_PEAK_S: Final = (2.0, 5.0)
LATERAL_TURBULENCE: Final = 0.75
"""Turbulence across the wind, relative to that along it."""

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Disturbance:
    """Something planted in a run: ramp, gust or steering."""

    kind: str
    start_s: float
    end_s: float


@dataclass(frozen=True)
class RunTruth:
    """What really happened in a run; `undisturbed_*` bound what a perfect window would keep."""

    run: int
    direction: int
    target_speed_m_s: float
    undisturbed_start_s: float
    undisturbed_end_s: float
    disturbances: tuple[Disturbance, ...]


@dataclass(frozen=True)
class TrueRun:
    """A run before the instruments, on the slow grid."""

    truth: RunTruth
    grid_s: Floats
    speed_m_s: Floats
    acceleration_m_s2: Floats
    ground_speed_m_s: Floats
    wind_ahead_m_s: Floats
    wind_abeam_m_s: Floats
    steering_force: Floats


def simulate_runs(tow: Tow, defects: Defects, streams: TowStreams) -> list[TrueRun]:
    """Return the motion of a tow's six runs, with current and wind, in the order towed."""
    grid_s = np.arange(-LEAD_S, RUN_SECONDS + 1.0, 1.0 / SLOW_HZ)
    ratios = [*TARGET_SPEED_RATIOS[:-1], FAST_RUN_RATIO] if tow.fast_run else TARGET_SPEED_RATIOS
    stream_m_s, drift_m_s = streams[Component.STREAM].standard_normal(2)
    # The helmsman sees log 1: where it reads low, the ship goes too fast.
    steered = tow.truth.log_factor**defects.steered_by_log
    tide = _tide(defects, streams[Component.TIDE])
    # Mean wind over the tow: Rayleigh, so that calm and windy days both occur.
    wind_m_s = defects.wind_m_s * np.sqrt(2 / np.pi) * streams[Component.WIND].rayleigh()
    wind_from_rad = streams[Component.WIND].uniform(0.0, 2 * np.pi)
    cosine, sine = np.cos(wind_from_rad), np.sin(wind_from_rad)
    runs = []
    for run in range(1, RUNS_PER_FILE + 1):
        direction = OUT if run <= len(ratios) else BACK
        target_m_s = tow.declared_speed_m_s * ratios[(run - 1) % len(ratios)]
        noted: list[Disturbance] = []
        speed = _speed(steered * target_m_s, grid_s, defects, streams, noted)
        from_middle_s = _started_s(run, direction) + grid_s
        water_m_s = (
            defects.stream_m_s * stream_m_s
            + defects.stream_drift_m_s * drift_m_s * (from_middle_s / 600.0)
            + tide(from_middle_s)
        )
        ground_m_s = speed + direction * water_m_s
        gust = _bump("gust", grid_s, defects.gust_share, streams[Component.GUST], noted)
        along, across = _turbulent_wind(wind_m_s, grid_s, defects, streams)
        along += defects.gust_m_s * gust
        steering = _bump(
            "steering", grid_s, defects.steering_share, streams[Component.STEERING], noted
        )
        start_s, end_s = _find_undisturbed(noted)
        runs.append(
            TrueRun(
                truth=RunTruth(run, direction, target_m_s, start_s, end_s, tuple(noted)),
                grid_s=grid_s,
                speed_m_s=speed,
                acceleration_m_s2=np.gradient(speed, grid_s),
                ground_speed_m_s=ground_m_s,
                wind_ahead_m_s=ground_m_s + direction * (along * cosine - across * sine),
                wind_abeam_m_s=direction * (along * sine + across * cosine),
                steering_force=defects.steering_force * steering
                + _steering_peaks(grid_s, defects, streams[Component.STEERING_PEAKS]),
            )
        )
    return runs


def _tide(defects: Defects, rng: np.random.Generator) -> Callable[[Floats], Floats]:
    """Return the stream of the tide by seconds from the middle of the tow, where it turns."""
    slack_s, sign = rng.uniform(-SLACK_WITHIN_S, SLACK_WITHIN_S), rng.choice((-1.0, 1.0))
    amplitude = defects.tide_m_s * sign
    return lambda s: np.asarray(amplitude * np.sin(2 * np.pi * (s - slack_s) / TIDE_PERIOD_S))


def _started_s(run: int, direction: int) -> float:
    """Start of a run, from the middle of the tow: the boat turns once, between runs 3 and 4."""
    middle = (RUNS_PER_FILE + 1) / 2
    return (run - middle) * SECONDS_BETWEEN_RUNS - direction * SECONDS_TO_TURN / 2


def _speed(
    target_m_s: float,
    grid_s: Floats,
    defects: Defects,
    streams: TowStreams,
    noted: list[Disturbance],
) -> Floats:
    """Simulate speed through the water: the target, missed, wandering, sometimes slow at first.

    A ramp is added to `noted`.
    """
    rng = streams[Component.SPEED]
    missed = 1.0 + defects.speed_miss * rng.standard_normal()
    wander = smooth_wander(rng, grid_s.size, 1.0 / SLOW_HZ, HELM_S)
    speed = target_m_s * missed + defects.speed_wander_m_s * wander
    speed += defects.surge_m_s * swing(streams[Component.SURGE], grid_s, SURGE_HZ, SURGE_PHASE_S)
    chance, size, position = streams[Component.RAMP].random(3)
    if chance >= defects.ramp_share:
        return np.asarray(speed)
    missing_m_s = defects.ramp_m_s * (0.5 + 0.5 * size)
    shortest_s, longest_s = RAMP_TIME_CONSTANT_S
    time_constant_s = shortest_s + position * (longest_s - shortest_s)
    end_s = float(time_constant_s * np.log(missing_m_s / RAMP_OVER_M_S))
    noted.append(Disturbance("ramp", 0.0, end_s))
    return np.asarray(speed - missing_m_s * np.exp(-grid_s / time_constant_s))


def _bump(
    kind: str,
    grid_s: Floats,
    share: float,
    rng: np.random.Generator,
    noted: list[Disturbance],
) -> Floats:
    """Return a raised cosine of height 1 near one end of the run, or nothing; noted in `noted`."""
    chance, at_end, length, position = rng.random(4)
    if chance >= share:
        return np.zeros(grid_s.size)
    duration_s = BUMP_S[0] + length * (BUMP_S[1] - BUMP_S[0])
    start_s = position * (EDGE_S - duration_s) + (RUN_SECONDS - EDGE_S) * (at_end < 0.5)
    noted.append(Disturbance(kind, float(start_s), float(start_s + duration_s)))
    phase = np.clip((grid_s - start_s) / duration_s, 0.0, 1.0)
    return np.asarray(0.5 - 0.5 * np.cos(2 * np.pi * phase))


def _steering_peaks(grid_s: Floats, defects: Defects, rng: np.random.Generator) -> Floats:
    """Return relative force of raised cosines anywhere in the run, which no window can avoid."""
    force = np.zeros(grid_s.size)
    for _ in range(rng.poisson(defects.steering_peaks)):
        start, length, size = rng.random(3)
        duration_s = STEERING_PEAK_S[0] + length * (STEERING_PEAK_S[1] - STEERING_PEAK_S[0])
        phase = np.clip((grid_s - start * (RUN_SECONDS - duration_s)) / duration_s, 0.0, 1.0)
        height = defects.steering_peak_force * (0.5 + 0.5 * size)
        force += height * (0.5 - 0.5 * np.cos(2 * np.pi * phase))
    return force


def _find_undisturbed(noted: list[Disturbance]) -> tuple[float, float]:
    """Return the part of the run between the disturbances at its start and those at its end."""
    middle_s = RUN_SECONDS / 2
    starts = [d.end_s for d in noted if d.start_s < middle_s]
    ends = [d.start_s for d in noted if d.start_s >= middle_s]
    return max(starts, default=0.0), min(ends, default=RUN_SECONDS)


def _turbulent_wind(
    wind_m_s: float, grid_s: Floats, defects: Defects, streams: TowStreams
) -> tuple[Floats, Floats]:
    """Return the true wind along and across its mean direction."""
    rng = streams[Component.WIND]
    step_s = 1.0 / SLOW_HZ
    sd_m_s = wind_m_s * defects.wind_turbulence
    along = wind_m_s + sd_m_s * coloured_noise(rng, grid_s.size, step_s, TURBULENCE_S)
    across = sd_m_s * LATERAL_TURBULENCE * coloured_noise(rng, grid_s.size, step_s, TURBULENCE_S)
    slow = streams[Component.SLOW_GUSTS]
    slow_sd_m_s = wind_m_s * defects.slow_gusts
    along = along + slow_sd_m_s * coloured_noise(slow, grid_s.size, step_s, SLOW_GUSTS_S)
    slow_across = coloured_noise(slow, grid_s.size, step_s, SLOW_GUSTS_S)
    across = across + slow_sd_m_s * LATERAL_TURBULENCE * slow_across
    return along.astype(np.float64), across.astype(np.float64)
