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
from pipeline.channels import RUNS_PER_FILE, SECOND_FILE_OFFSET

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
    used = [_run(samples, run, practice) for run in runs if _is_used(run, tow)]
    y = _calibration(used) if practice.improved else 1.0
    speed = np.array([y * run.log_m_s.mean() for run in used])
    gross = np.array([(run.force_n / (y * run.log_m_s) ** 2).mean() for run in used])
    if practice.improved:
        counted = speed <= FASTEST_OF_2015 * tow.declared_speed_m_s
        air = np.array([_oblique_kg_m(run, y, tow) for run in used])
        speed, cw = (
            speed[counted],
            (gross - air)[counted] + still_air_cw_kg_m(tow.hull, AIR_OF_2015),
        )
    else:
        cw = _searched(speed, gross, *_head_wind(used, y, tow))
    if practice.temperature:
        cw = cw + _to_reference(tow, speed)
    highest_b = HULL_SPEEDS * 1.25 * np.sqrt(tow.boat.waterline_length_m)
    return _fit(speed, cw, float(highest_b) if practice.improved else HIGHEST_B_M_S)


def _is_used(run: RunTruth, tow: Tow) -> bool:
    """Return whether a run counts; with a second file, its runs back replace the first file's."""
    if not tow.second_name:
        return True
    out = run.run <= RUNS_PER_FILE // 2
    return out or run.run > SECOND_FILE_OFFSET + RUNS_PER_FILE // 2


def _run(samples: pl.DataFrame, run: RunTruth, practice: Practice) -> _Run:
    mine = samples.filter(pl.col("run") == run.run)
    rate_hz = mine.height / 50.0
    first, last = (
        (int(run.undisturbed_start_s * rate_hz), int(run.undisturbed_end_s * rate_hz))
        if practice.improved
        else (0, mine.height)
    )
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


def _calibration(runs: Sequence[_Run]) -> float:
    """Return GPS over log from as many runs out as back, so that the current drops out."""
    ways = [[run for run in runs if run.direction == way] for way in (1, -1)]
    gps, log = (
        np.mean([np.mean([getattr(run, name).mean() for run in way]) for way in ways])
        for name in ("gps_m_s", "log_m_s")
    )
    return float(gps / log)


def _oblique_kg_m(run: _Run, y: float, tow: Tow) -> float:
    ahead = run.wind_m_s * np.cos(run.angle_rad)
    abeam = run.wind_m_s * np.sin(run.angle_rad)
    force = air_force_n(tow.hull, ahead, abeam, AIR_OF_2015)
    return float((force / (y * run.log_m_s) ** 2).mean())


def _head_wind(runs: Sequence[_Run], y: float, tow: Tow) -> tuple[Floats, Floats, float]:
    """Return the air part of each run for a coefficient of 1: ahead, following and still."""
    front = AIR_DENSITY_KG_M3 / 2 * tow.hull.front_m2
    parts = []
    for run in runs:
        along = run.wind_m_s * np.cos(run.angle_rad)
        felt = front * along * np.abs(along) / (y * run.log_m_s) ** 2
        parts.append((np.maximum(felt, 0.0).mean(), np.minimum(felt, 0.0).mean()))
    ahead, following = np.array(parts).T
    return ahead, following, front * OLD_COEFFICIENTS[0]


def _searched(
    speed: Floats, gross: Floats, ahead: Floats, following: Floats, still: float
) -> Floats:
    """Return Cw with air coefficients searched per run between 0 and 1 to fit the curve best."""
    head = np.full(speed.size, OLD_COEFFICIENTS[0])
    behind = np.full(speed.size, OLD_COEFFICIENTS[1])
    for _ in range(ITERATIONS):
        cw = gross - head * ahead - behind * following + still
        a_kg_m, b_m_s = _fit(speed, cw, HIGHEST_B_M_S)
        too_much = gross + still - a_kg_m / (1.0 - (speed / b_m_s) ** 2)
        head = _within(too_much - behind * following, ahead, head)
        behind = _within(too_much - head * ahead, following, behind)
    return np.asarray(gross - head * ahead - behind * following + still)


def _within(wanted: Floats, unit: Floats, before: Floats) -> Floats:
    """Return the coefficient in [0, 1] that takes off what is wanted; unchanged without wind."""
    felt = unit != 0.0
    return np.where(felt, np.clip(wanted / np.where(felt, unit, 1.0), 0.0, 1.0), before)


def _to_reference(tow: Tow, speed: Floats) -> Floats:
    """Return the true change of Cw to the reference temperature; the formula of 2018 is secret."""
    at_reference = water_cw_kg_m(tow.hull, speed, REFERENCE_TEMPERATURE_C)
    return at_reference - water_cw_kg_m(tow.hull, speed, tow.water_temperature_c)


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
