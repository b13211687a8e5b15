"""The true resistance of a simulated hull in still water and still air.

Friction by the ITTC-57 line with a form factor, a bow wave with humps and hollows, and the air
of the boat's own speed. On purpose no hyperbola: the method's hyperbola has to approximate it
as well as it approximates a real boat. Nothing here is shared with the method's own temperature
correction, so that the one can test the other. Motion and instruments belong elsewhere.
"""

from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
import scipy
from numpy.typing import NDArray

from herijk.simulate.delft import FROUDE

GRAVITY_M_S2: Final = 9.81
AIR_DENSITY_KG_M3: Final = 1.225
REFERENCE_TEMPERATURE_C: Final = 15.0
SALT_CONTRACTION: Final = 7.7e-4
SALT_VISCOSITY: Final = 1.07e-3
"""Relative change of density and of kinematic viscosity per g/kg of salt, at 15 C and 35 g/kg
(Millero 1974, The Sea 5)."""
REFERENCE_FROUDE: Final = 0.28
"""Froude number at which `wave_coefficient` is stated; the middle of rowing speeds."""

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class AirCoefficients:
    """Air drag coefficients that are true in a simulated world (Pot 2015: 0.5, 0.5, 0.2)."""

    head: float = 0.5
    following: float = 0.5
    abeam: float = 0.2


@dataclass(frozen=True)
class Hull:
    """A boat with its crew on board, as it meets water and air on one day.

    Args:
        displacement_kg: boat with oars and crew.
        form_factor: k in (1 + k) CF: pressure drag of viscous origin.
        wave_coefficient: bow-wave resistance over (displacement / length) v^2 at
            `REFERENCE_FROUDE`, dimensionless.
        wave_exponent: how fast that grows: as Fn^exponent.
        hump_amplitude, hump_phase_rad: humps and hollows, 1 + a cos(1 / Fn^2 + phase).
        condition: factor on the whole water resistance: roughness, ageing, alterations.
        residuary: a row of `delft.RESIDUARY`; takes the place of the bow wave.
    """

    waterline_length_m: float
    beam_m: float
    bow_height_m: float
    displacement_kg: float
    wetted_surface_m2: float
    form_factor: float
    wave_coefficient: float
    wave_exponent: float
    hump_amplitude: float
    hump_phase_rad: float
    condition: float = 1.0
    residuary: tuple[float, ...] | None = None

    @property
    def front_m2(self) -> float:
        """Area the wind meets from ahead, `b*h + 0.5` (Pot 2015)."""
        return self.beam_m * self.bow_height_m + 0.5

    @property
    def side_m2(self) -> float:
        """Area the wind meets from abeam, `l*h + 1.0` (Pot 2015)."""
        return self.waterline_length_m * self.bow_height_m + 1.0


def water_density_kg_m3(temperature_c: float) -> float:
    """Return the density [kg/m3] of fresh water (Tilton & Taylor 1937), valid 0-20 C."""
    t = temperature_c
    return 999.972 * (1.0 - (t + 288.9414) / (508929.2 * (t + 68.12963)) * (t - 3.9863) ** 2)


def kinematic_viscosity_m2_s(temperature_c: float) -> float:
    """Return the kinematic viscosity [m2/s] of fresh water (Kestin et al. 1978), 0-40 C."""
    d = 20.0 - temperature_c
    log10_ratio = d / (temperature_c + 96.0) * (1.2364 - 1.37e-3 * d + 5.7e-6 * d**2)
    return float(1.002e-3 * 10.0**log10_ratio / water_density_kg_m3(temperature_c))


def friction_coefficient(
    speed_m_s: Floats, length_m: float, temperature_c: float, salinity_g_kg: float = 0.0
) -> Floats:
    """Return CF by the ITTC-57 line, `CF = 0.075 / (log10 Re - 2)^2`."""
    in_fresh_m2_s = kinematic_viscosity_m2_s(temperature_c)
    viscosity_m2_s = in_fresh_m2_s * (1.0 + SALT_VISCOSITY * salinity_g_kg)
    reynolds = speed_m_s * (length_m / viscosity_m2_s)
    return np.asarray(0.075 / (np.log10(reynolds) - 2.0) ** 2)


def water_cw_kg_m(
    hull: Hull, speed_m_s: Floats, temperature_c: float, salinity_g_kg: float = 0.0
) -> Floats:
    """Return the water resistance over speed squared [kg/m]; any shape, speeds above zero.

    A boat of one weight lies higher in salt water, with less wetted surface; its waves stay.
    """
    salt_ratio = 1.0 + SALT_CONTRACTION * salinity_g_kg
    density = water_density_kg_m3(temperature_c) * salt_ratio
    wetted_m2 = hull.wetted_surface_m2 / np.sqrt(salt_ratio)
    cf = friction_coefficient(speed_m_s, hull.waterline_length_m, temperature_c, salinity_g_kg)
    friction = density / 2 * wetted_m2 * (1.0 + hull.form_factor) * cf
    if hull.residuary is None:
        wave = _bow_wave_cw_kg_m(hull, speed_m_s)
    else:
        wave = _residuary_cw_kg_m(hull, speed_m_s, _ln_residuary(hull.residuary))
    return np.asarray(hull.condition * (friction + wave))


def _bow_wave_cw_kg_m(hull: Hull, speed_m_s: Floats) -> Floats:
    # 1 / Fn^2 sets how many bow waves stand along the hull, hence the humps and hollows.
    inverse_froude2 = GRAVITY_M_S2 * hull.waterline_length_m / speed_m_s**2
    growth = (REFERENCE_FROUDE**2 * inverse_froude2) ** (-hull.wave_exponent / 2)
    humps = 1.0 + hull.hump_amplitude * np.cos(inverse_froude2 + hull.hump_phase_rad)
    scale = hull.displacement_kg / hull.waterline_length_m
    return np.asarray(scale * hull.wave_coefficient * growth * humps)


def _residuary_cw_kg_m(
    hull: Hull, speed_m_s: Floats, ln_residuary: scipy.interpolate.CubicSpline
) -> Floats:
    froude = speed_m_s / np.sqrt(GRAVITY_M_S2 * hull.waterline_length_m)
    # Constant outside the tank's range.
    per_weight = np.exp(ln_residuary(np.clip(froude, FROUDE[0], FROUDE[-1])))
    return np.asarray(hull.displacement_kg * GRAVITY_M_S2 * per_weight / speed_m_s**2)


@cache
def _ln_residuary(per_1000: tuple[float, ...]) -> scipy.interpolate.CubicSpline:
    """Return the logarithm of residuary resistance / weight by Froude number."""
    return scipy.interpolate.CubicSpline(FROUDE, np.log(np.array(per_1000) / 1000.0))


def still_air_cw_kg_m(hull: Hull, air: AirCoefficients) -> float:
    """Return the air resistance of the boat's own speed over speed squared [kg/m]."""
    return AIR_DENSITY_KG_M3 / 2 * hull.front_m2 * air.head


def true_cw_kg_m(
    hull: Hull,
    speed_m_s: Floats,
    temperature_c: float,
    air: AirCoefficients,
    salinity_g_kg: float = 0.0,
) -> Floats:
    """Return the coefficient a perfect tow test would find: still water and still air, [kg/m]."""
    in_water = water_cw_kg_m(hull, speed_m_s, temperature_c, salinity_g_kg)
    return in_water + still_air_cw_kg_m(hull, air)


def air_force_n(
    hull: Hull, wind_ahead_m_s: Floats, wind_abeam_m_s: Floats, air: AirCoefficients
) -> Floats:
    """Return the air force against the boat by the oblique formula of 2015 (Pot 2015).

    `F = rho/2 (front |cos a| Cvt + side |sin a| Cvd) (w cos a)^2 sign(cos a)`, written with the
    components `w cos a` and `w sin a`.

    Args:
        hull: the boat.
        wind_ahead_m_s: apparent wind from ahead, negative when it follows.
        wind_abeam_m_s: apparent wind from starboard.
        air: coefficients.
    """
    speed = np.maximum(np.hypot(wind_ahead_m_s, wind_abeam_m_s), 1e-9)
    head = np.where(wind_ahead_m_s >= 0.0, air.head, air.following)
    drag_area = (
        hull.front_m2 * head * np.abs(wind_ahead_m_s)
        + hull.side_m2 * air.abeam * np.abs(wind_abeam_m_s)
    ) / speed
    return np.asarray(AIR_DENSITY_KG_M3 / 2 * drag_area * wind_ahead_m_s * np.abs(wind_ahead_m_s))
