"""The printed curve of a tow: by the practice of its year, from its own samples.

Written from the texts (R. Pot 2015 and 2017), apart from the method's own code, so that a method
that says it repeats the practice of a year can be compared with what that year printed. Where a
person chose, as in trimming, this one chooses what is true.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import polars as pl
import scipy
from numpy.typing import NDArray

from herijk.simulate.hull import (
    AIR_DENSITY_KG_M3,
    REFERENCE_TEMPERATURE_C,
    AirCoefficients,
    air_force_n,
    still_air_cw_kg_m,
    water_cw_kg_m,
)
from herijk.simulate.motion import RunTruth
from herijk.simulate.world import Tow
from pipeline.channels import RUN_SECONDS, RUNS_PER_FILE, SECOND_FILE_OFFSET

OLD_COEFFICIENTS: Final = (0.5, 0.7)
"""Air drag ahead and following, before they were searched."""
AIR_OF_2015: Final = AirCoefficients()
ITERATIONS: Final = 4
FASTEST_OF_2015: Final = 1.15
"""Speed / declared speed above which a run no longer counted."""
HIGHEST_B_M_S: Final = 25.0
HULL_SPEEDS: Final = 3.0
NEAREST_TO_B: Final = 0.97
"""Largest run speed / B that is tried."""
READS_M_S: Final = 0.1
"""A log that reads less has dropped out; a person left that out."""

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Practice:
    """How a year computed; the default is that of the years until 2013."""

    improved: bool = False
    """Trimmed, calibrated on dGPS, oblique wind, B capped, no runs at 120 %."""
    temperature: bool = False


def find_practice(season: int, printed_in: int) -> Practice:
    """Return by which practice a register printed a tow; 2014 was recomputed in 2015."""
    if season <= 2013 or printed_in <= 2014:
        return Practice()
    return Practice(improved=True, temperature=season >= 2018)


def practices(season: int) -> tuple[Practice, ...]:
    """Return all practices by which a tow of a season can have been printed."""
    return tuple(dict.fromkeys(find_practice(season, year) for year in (season, season + 1)))


@dataclass(frozen=True)
class _Run:
    """Samples of a run that counts, and what is known of it."""

    direction: int
    log_m_s: Floats
    force_n: Floats
    gps_m_s: Floats
    wind_m_s: Floats
    angle_rad: Floats


def print_curve(
    samples: pl.DataFrame, runs: Sequence[RunTruth], tow: Tow, practice: Practice
) -> tuple[float, float]:
    """Return A [kg/m] and B [m/s] by a practice."""
    used = []
    for truth in runs:
        is_out = truth.run <= RUNS_PER_FILE // 2
        is_back_of_second_file = truth.run > SECOND_FILE_OFFSET + RUNS_PER_FILE // 2
        if not tow.second_name or is_out or is_back_of_second_file:
            used.append(_read_run(samples, truth, trimmed=practice.improved))
    log_factor = _calibrate_on_gps(used) if practice.improved else 1.0
    means = []
    for run in used:
        ahead = run.wind_m_s * np.cos(run.angle_rad)
        abeam = run.wind_m_s * np.sin(run.angle_rad)
        force = air_force_n(tow.hull, ahead, abeam, AIR_OF_2015)
        speed_m_s = log_factor * run.log_m_s
        square = speed_m_s**2
        means.append((speed_m_s.mean(), (run.force_n / square).mean(), (force / square).mean()))
    speed, gross, air = np.array(means).T
    highest_b = HIGHEST_B_M_S
    if practice.improved:
        counted = speed <= FASTEST_OF_2015 * tow.declared_speed_m_s
        cw = (gross - air)[counted] + still_air_cw_kg_m(tow.hull, AIR_OF_2015)
        speed = speed[counted]
        highest_b = HULL_SPEEDS * 1.25 * float(np.sqrt(tow.boat.waterline_length_m))
    else:
        cw = _search_air_coefficients(speed, gross, used, tow)
    if practice.temperature:  # its formula is secret: what is true takes its place
        at_reference = water_cw_kg_m(tow.hull, speed, REFERENCE_TEMPERATURE_C)
        cw = (
            cw
            + at_reference
            - water_cw_kg_m(tow.hull, speed, tow.water_temperature_c, tow.salinity_g_kg)
        )
    return _fit(speed, cw, highest_b)


def _read_run(samples: pl.DataFrame, run: RunTruth, *, trimmed: bool) -> _Run:
    """Return the samples of a run that a person kept: where trimmed, what is undisturbed."""
    mine = samples.filter(pl.col("run") == run.run)
    first, last = 0, mine.height
    if trimmed:
        rate_hz = mine.height / RUN_SECONDS
        first = int(run.undisturbed_start_s * rate_hz)
        last = int(run.undisturbed_end_s * rate_hz)
    mine = mine.slice(first, last - first).filter(
        (pl.col("log1_m_s") > READS_M_S) & pl.col("force_n").is_not_nan()
    )

    def channel(name: str) -> Floats:
        return mine[name].cast(pl.Float64).to_numpy()

    return _Run(
        direction=run.direction,
        log_m_s=channel("log1_m_s"),
        force_n=channel("force_n"),
        gps_m_s=channel("gps_m_s"),
        wind_m_s=channel("wind_speed_m_s"),
        angle_rad=np.radians(channel("wind_angle_deg")),
    )


def _calibrate_on_gps(runs: Sequence[_Run]) -> float:
    """Return GPS over log from as many runs out as back, so that the current drops out."""
    gps, log = [], []
    for direction in (1, -1):
        own = [run for run in runs if run.direction == direction]
        gps.append(np.mean([run.gps_m_s.mean() for run in own]))
        log.append(np.mean([run.log_m_s.mean() for run in own]))
    return float(np.mean(gps) / np.mean(log))


def _search_air_coefficients(
    speed: Floats, gross: Floats, runs: Sequence[_Run], tow: Tow
) -> Floats:
    """Return Cw with air coefficients searched per run between 0 and 1 to fit the curve best."""
    front = AIR_DENSITY_KG_M3 / 2 * tow.hull.front_m2
    still = front * OLD_COEFFICIENTS[0]
    parts = []  # air part of each run for a coefficient of 1: ahead and following
    for run in runs:
        along = run.wind_m_s * np.cos(run.angle_rad)
        felt = front * along * np.abs(along) / run.log_m_s**2
        parts.append((np.maximum(felt, 0.0).mean(), np.minimum(felt, 0.0).mean()))
    ahead, following = np.array(parts).T
    head = np.full(speed.size, OLD_COEFFICIENTS[0])
    behind = np.full(speed.size, OLD_COEFFICIENTS[1])
    for _ in range(ITERATIONS):
        cw = gross - head * ahead - behind * following + still
        a_kg_m, b_m_s = _fit(speed, cw, HIGHEST_B_M_S)
        too_much = gross + still - a_kg_m / (1.0 - (speed / b_m_s) ** 2)
        head = _find_coefficient(too_much - behind * following, ahead, head)
        behind = _find_coefficient(too_much - head * ahead, following, behind)
    return np.asarray(gross - head * ahead - behind * following + still)


def _find_coefficient(wanted: Floats, unit: Floats, before: Floats) -> Floats:
    """Return the coefficient in [0, 1] that takes off what is wanted; unchanged without wind."""
    felt = unit != 0.0
    return np.where(felt, np.clip(wanted / np.where(felt, unit, 1.0), 0.0, 1.0), before)


def _fit(speed: Floats, cw: Floats, highest_b: float) -> tuple[float, float]:
    """Return A and B by least squares in Cw, B at most `highest_b`."""

    def a_of(s: float) -> float:
        shape = 1.0 / (1.0 - s * speed**2)
        return float(shape @ cw / (shape @ shape))

    def misfit(s: float) -> float:
        return float(((cw - a_of(s) / (1.0 - s * speed**2)) ** 2).sum())

    bounds = (highest_b**-2, (NEAREST_TO_B / speed.max()) ** 2)
    s = float(scipy.optimize.minimize_scalar(misfit, bounds=bounds, method="bounded").x)
    return a_of(s), s**-0.5
