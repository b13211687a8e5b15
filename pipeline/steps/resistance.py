"""From a window of a run to its point: means, and what is corrected on the coefficient.

Per sample the gross coefficient is `Cw = F / (v y)^2` (Sleepproef, R. Pot 2017, "IJking
snelheid"). Everything here is in the speed that the log reads; a factor k that turns it into true
speed divides every coefficient by k^2, and is applied last (`pipeline.recompute.computed`). Which
runs count and which factor holds is decided elsewhere.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from pipeline.arrays import BoolArray, FloatArray
from pipeline.blocks.run_blocks import SUM_NAMES, RunBlocks, WindowSums
from pipeline.blocks.tows import Tows
from pipeline.hull import front_area_m2, side_area_m2
from pipeline.method.constants import REFERENCE_WATER_C
from pipeline.steps.friction import friction_cw_kg_m, water_density_kg_m3
from pipeline.steps.wind import (
    AirParts,
    average_wind,
    compute_air_parts,
    mean_angle_deg,
)
from pipeline.steps.window import END_SECONDS, Windows, compute_robust_moments

ADDED_MASS_RATIO: Final = 0.08
"""Water that is accelerated with the boat, as a share of its mass (inferred; method-details, 6)."""

HUBER_SD: Final = 1.345
"""Robust standard deviations within which a second counts in full: 95 % efficient where seconds are
normal (Holland & Welsch 1977)."""
HUBER_ITERATIONS: Final = 5
MIN_SECONDS_SD_RATIO: Final = 0.001
"""Least standard deviation of seconds, as a share of their median: below it they are equal."""
MIN_WEIGHT: Final = 1e-9
SCATTER_SUMS: Final = {"log1_cw", "log1_cw2"}

WETTED_SURFACE_RATIO: Final = 3.0
"""Wetted surface / sqrt(displaced volume x waterline length). Stated assumption: the Delft formula
`(1.97 + 0.171 B/T) (0.65/Cm)^(1/3)` gives it at the beam / draught of sloops (`pipeline.hull`)."""


@dataclass(frozen=True)
class RunMeans:
    """Means over each run's window in log speed, shape (runs,).

    Attributes:
        speed_m_s: mean speed by log 1.
        gross_kg_m: F / v^2.
        sd_kg_m: standard deviation of the samples' F / v^2.
        seconds_sd_kg_m: standard deviation of its means per second.
        inertia_kg_m: part of it that accelerated the boat.
        air: air resistance / v^2 for drag coefficients of 1.
        gps_m_s: mean ground speed, NaN without a fix.
        log2_m_s, wind_m_s: mean reading of the other log and of the anemometer.
        wind_angle_deg: circular mean of the vane.
    """

    speed_m_s: FloatArray
    gross_kg_m: FloatArray
    sd_kg_m: FloatArray
    seconds_sd_kg_m: FloatArray
    inertia_kg_m: FloatArray
    air: AirParts
    gps_m_s: FloatArray
    log2_m_s: FloatArray
    wind_m_s: FloatArray
    wind_angle_deg: FloatArray

    def correct_force(self, factor: FloatArray, zero_n: FloatArray) -> "RunMeans":
        """Return these means for a load cell that reads true force x factor + zero, (runs,)."""
        zero = zero_n / _or_one(self.speed_m_s) ** 2
        return replace(self, gross_kg_m=(self.gross_kg_m - zero) / factor)

    def scale_wind(self, scale: FloatArray) -> "RunMeans":
        """Return these means for an anemometer that reads the wind x scale, shape (runs,)."""
        return replace(self, air=self.air.times(scale**-2.0))


def window_means(
    blocks: RunBlocks, windows: Windows, averaging_s: int, is_robust: bool
) -> dict[str, FloatArray]:
    """Return means over the window of every run of what is summed in blocks, shape (runs,) each.

    Args:
        averaging_s: seconds over which the wind of air terms is averaged; 0 takes it as it is.
        is_robust: whether seconds count by `weigh_seconds`. Mean and scatter of F / v² itself,
            `SCATTER_SUMS`, are over all samples in any case.

    Returns:
        The means by `SUM_NAMES`, and as `seconds_sd` the standard deviation of the means of
        F / v^2 per second.
    """
    averaged = average_wind(blocks, averaging_s) if averaging_s else blocks
    sums = WindowSums(averaged, windows.mask)
    weighted = set(SUM_NAMES) - SCATTER_SUMS if is_robust else set()
    means = {name: sums.mean(name) for name in SUM_NAMES if name not in weighted}
    weight = (windows.mask & (blocks.n > 0)).astype(np.float64)
    if is_robust:
        weight = weigh_seconds(blocks, windows.mask)
        samples = np.maximum((weight * blocks.n).sum(axis=1), MIN_WEIGHT)
        for name in weighted:
            means[name] = np.einsum("rs,rs->r", weight, averaged[name]) / samples
    return means | {"seconds_sd": _sd_of_seconds(blocks, windows.mask, weight)}


def weigh_seconds(blocks: RunBlocks, window: BoolArray) -> FloatArray:
    """Return the weight of each second of a run, (runs, seconds); 0 outside its window.

    Huber's weights for a location (Huber 1964), k / |z| beyond k robust standard deviations z of
    the seconds' mean F / v². A steering peak in the middle of a run cannot be cut and always pushes
    upwards; a second that it spoils counts less. All quantities of a run are averaged with the
    same weights, so that a gust is taken off with the wind that made it.
    """
    is_measured = window & (blocks.n > 0)
    per_second = blocks["log1_cw"] / np.maximum(blocks.n, 1.0)
    centre, sd = compute_robust_moments(per_second, is_measured)
    sd = np.maximum(sd, MIN_SECONDS_SD_RATIO * np.abs(centre))
    weight = is_measured.astype(np.float64)
    for _ in range(HUBER_ITERATIONS):
        distance = np.abs(per_second - centre) / np.where(sd > 0, sd, 1.0)
        weight = np.where(is_measured, HUBER_SD / np.maximum(distance, HUBER_SD), 0.0)
        total = np.maximum(weight.sum(axis=1, keepdims=True), MIN_WEIGHT)
        centre = (weight * per_second).sum(axis=1, keepdims=True) / total
    return np.asarray(weight)


def _sd_of_seconds(blocks: RunBlocks, window: BoolArray, weight: FloatArray) -> FloatArray:
    """Return the standard deviation of the means of F / v² per second of each window, (runs,).

    With Huber's weights it is that of the winsorised seconds, whose mean the run point is: one
    steering peak does not make a run that swings.

    Args:
        weight: of each second, (runs, seconds).
    """
    total = np.maximum(weight.sum(axis=1), MIN_WEIGHT)
    count = np.maximum((window & (blocks.n > 0)).sum(axis=1), 1)
    per_second = blocks["log1_cw"] / np.maximum(blocks.n, 1.0)
    mean = (weight * per_second).sum(axis=1) / total
    deviation = weight * (per_second - mean[:, None])
    return np.asarray(np.sqrt((deviation**2).sum(axis=1) / count))


def run_means(
    tows: Tows,
    over: Mapping[str, FloatArray],
    of_ratios: BoolArray,
    oblique: BoolArray,
    accelerated_kg: FloatArray,
) -> RunMeans:
    """Return means of every run over its window.

    Args:
        over: as `window_means` gives them, with `start_s` and `end_s` of the window, and `rise_m_s`
            of the speed from its first to its last seconds.
        of_ratios: the mean of F / v^2 is taken, else mean F over mean v squared, shape (runs,).
        oblique: the oblique wind model holds, shape (runs,).
        accelerated_kg: mass that the rise of the speed accelerated, shape (runs,); 0 leaves it in.
    """
    speed, ratio = over["log1_v"], over["log1_cw"]
    square = _or_one(speed) ** 2

    def term(name: str) -> FloatArray:
        return np.where(of_ratios, over[f"log1_{name}"], over[name] / square)

    seconds_apart = np.maximum(over["end_s"] - over["start_s"] - END_SECONDS, 1)
    fixes = over["gps_n"]
    return RunMeans(
        speed_m_s=speed,
        gross_kg_m=np.where(of_ratios, ratio, over["force"] / square),
        sd_kg_m=np.sqrt(np.maximum(over["log1_cw2"] - ratio**2, 0.0)),
        seconds_sd_kg_m=over["seconds_sd"],
        inertia_kg_m=accelerated_kg * (over["rise_m_s"] / seconds_apart) / square,
        air=compute_air_parts(
            oblique,
            term,
            front_area_m2(tows.get_of_runs("beam_m"), tows.get_of_runs("bow_height_m")),
            side_area_m2(tows.get_of_runs("waterline_length_m"), tows.get_of_runs("bow_height_m")),
        ),
        gps_m_s=np.where(fixes > 0, over["gps"] / np.where(fixes > 0, fixes, 1.0), np.nan),
        log2_m_s=over["log2_v"],
        wind_m_s=over["wind_v"],
        wind_angle_deg=mean_angle_deg(over["wind_sin"], over["wind_cos"]),
    )


def accelerated_mass_kg(tows: Tows) -> FloatArray:
    """Return the mass of boat, crew and the water that moves with them, shape (runs,), kg.

    0 where no tow of the archive has a weight. Source: docs/method-details.md, 6.
    """
    return (1.0 + ADDED_MASS_RATIO) * np.nan_to_num(tows.get_of_runs("mass_kg"))


def water_change_kg_m(
    tows: Tows, corrected: BoolArray, expected: BoolArray, speed_m_s: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Return the change of Cw to fresh water of 15 C: friction there less that as towed.

    Friction by the ITTC-57 line, without form factor, on the wetted surface of
    `wetted_surface_m2` (inferred: the federation's own formula of 2018 is not public). Salt changes
    its density, its viscosity and how deep the boat lies. The other resistance is a share of the
    weight of the boat (Gerritsma, Onnink & Versluis 1981), and stays (method-details, 6).

    Args:
        corrected: whether the method asks it, shape (tows,).
        expected: whether the day's temperature is taken where nobody wrote it down, shape (tows,).
        speed_m_s: true speed of each run, shape (runs,).

    Returns:
        Change of Cw, shape (runs,), kg/m, 0 where no tow of the archive has a weight; and for which
        tows the temperature was recorded and used, shape (tows,). Water whose temperature is not
        known is taken to have the reference temperature, and no salt where nobody recorded it.
    """
    recorded_c = tows.get_of_tows("water_temperature_c")
    mass_kg = tows.get_of_tows("mass_kg")
    is_recorded = np.isfinite(recorded_c) & np.isfinite(mass_kg)
    day_c = np.where(expected, tows.get_of_tows("expected_water_c"), np.nan)
    temperature_c = np.where(is_recorded, recorded_c, day_c)
    has_change = corrected & np.isfinite(mass_kg)
    is_known = has_change & np.isfinite(temperature_c)
    celsius = np.where(is_known, temperature_c, REFERENCE_WATER_C)[tows.tow]
    listed_salinity = np.nan_to_num(tows.get_of_tows("salinity_g_kg"))
    salinity_g_kg = np.where(has_change, listed_salinity, 0.0)[tows.tow]
    mass = np.where(has_change, mass_kg, 0.0)[tows.tow]
    length = tows.get_of_runs("waterline_length_m")
    speed = _or_one(speed_m_s)
    in_fresh = wetted_surface_m2(mass, length)
    in_salt = wetted_surface_m2(mass, length, salinity_g_kg)
    at_reference = friction_cw_kg_m(speed, length, in_fresh, REFERENCE_WATER_C)
    as_towed = friction_cw_kg_m(speed, length, in_salt, celsius, salinity_g_kg)
    return at_reference - as_towed, is_recorded


def wetted_surface_m2(
    mass_kg: FloatArray, waterline_length_m: FloatArray, salinity_g_kg: ArrayLike = 0.0
) -> FloatArray:
    """Return the wetted surface c sqrt(V L) [m2] of a boat with its crew, V in water of 15 C."""
    volume_m3 = mass_kg / water_density_kg_m3(15.0, salinity_g_kg)
    return np.asarray(WETTED_SURFACE_RATIO * np.sqrt(volume_m3 * waterline_length_m))


def _or_one(values: FloatArray) -> FloatArray:
    """Return the values, with 1 in place of 0, for a quotient that is not used there."""
    return np.where(values > 0, values, 1.0)
