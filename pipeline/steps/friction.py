"""Friction of a hull in water: density and viscosity of fresh and salt water, the ITTC-57 line.

Belongs here: textbook formulas, as functions of temperature, salinity, speed and hull form. Does
not belong here: what a method does with them (`resistance`). Arguments broadcast.
"""

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from pipeline.arrays import FloatArray
from pipeline.errors import BrokenPromiseError

LIQUID_RANGE_C: Final = (0.0, 40.0)
"""Temperatures both formulas below hold for."""


def water_density_kg_m3(temperature_c: ArrayLike, salinity_g_kg: ArrayLike = 0.0) -> FloatArray:
    """Return the density [kg/m3] of water, 0-40 C and 0-42 g/kg of salt, good to 0.01 kg/m3.

    Fresh water: Tanaka et al. 2001, Metrologia 38, 301-309 (the CIPM formula), without dissolved
    air. What salt adds: Millero & Poisson 1981, Deep-Sea Research 28A, 625-629 (EOS-80).

    Raises:
        BrokenPromiseError: a temperature outside 0-40 C.
    """
    t = _liquid(temperature_c)
    numerator = (t - 3.983035) ** 2 * (t + 301.797)
    fresh = 999.974950 * (1.0 - numerator / (522528.9 * (t + 69.34881)))
    s = np.asarray(salinity_g_kg, dtype=np.float64)
    linear = 0.824493 - 4.0899e-3 * t + 7.6438e-5 * t**2 - 8.2467e-7 * t**3 + 5.3875e-9 * t**4
    root = -5.72466e-3 + 1.0227e-4 * t - 1.6546e-6 * t**2
    return np.asarray(fresh + s * linear + s**1.5 * root + s**2 * 4.8314e-4)


def kinematic_viscosity_m2_s(
    temperature_c: ArrayLike, salinity_g_kg: ArrayLike = 0.0
) -> FloatArray:
    """Return the kinematic viscosity [m2/s] of water, 0-40 C and 0-42 g/kg of salt, good to 1.5 %.

    Dynamic viscosity of fresh water by the IAPWS supplementary release SR6-08 (Patek et al. 2009,
    J. Phys. Chem. Ref. Data 38, 21-29); times what salt does (Sharqawy, Lienhard & Zubair 2010,
    Desalination and Water Treatment 16, 354-380, eq. 22); divided by the density.

    Raises:
        BrokenPromiseError: a temperature outside 0-40 C.
    """
    t = _liquid(temperature_c)
    reduced = (t + 273.15) / 300.0
    fresh_pa_s = 1e-6 * (
        280.68 * reduced**-1.9
        + 511.45 * reduced**-7.7
        + 61.131 * reduced**-19.6
        + 0.45903 * reduced**-40.0
    )
    s = np.asarray(salinity_g_kg, dtype=np.float64) / 1000.0
    linear = 1.541 + 1.998e-2 * t - 9.52e-5 * t**2
    square = 7.974 - 7.561e-2 * t + 4.724e-4 * t**2
    salt_ratio = 1.0 + s * linear + s**2 * square
    return fresh_pa_s * salt_ratio / water_density_kg_m3(temperature_c, salinity_g_kg)


def reynolds_number(
    speed_m_s: FloatArray, length_m: FloatArray, kinematic_viscosity_m2_s: FloatArray
) -> FloatArray:
    """Return the Reynolds number V L / nu."""
    return speed_m_s * length_m / kinematic_viscosity_m2_s


def ittc57_friction_coefficient(reynolds: FloatArray) -> FloatArray:
    """Return CF by the ITTC-57 correlation line: 0.075 / (log10 Re - 2)^2."""
    return 0.075 / (np.log10(reynolds) - 2.0) ** 2


def friction_cw_kg_m(
    speed_m_s: FloatArray,
    length_m: FloatArray,
    wetted_surface_m2: FloatArray,
    temperature_c: ArrayLike,
    salinity_g_kg: ArrayLike = 0.0,
) -> FloatArray:
    """Return the part of Cw [kg/m] due to friction: rho/2 S CF, CF by ITTC-57 on the length."""
    viscosity_m2_s = kinematic_viscosity_m2_s(temperature_c, salinity_g_kg)
    coefficient = ittc57_friction_coefficient(reynolds_number(speed_m_s, length_m, viscosity_m2_s))
    density_kg_m3 = water_density_kg_m3(temperature_c, salinity_g_kg)
    return 0.5 * density_kg_m3 * wetted_surface_m2 * coefficient


def _liquid(temperature_c: ArrayLike) -> FloatArray:
    t = np.asarray(temperature_c, dtype=np.float64)
    lowest, highest = LIQUID_RANGE_C
    if not np.all((t >= lowest) & (t <= highest)):
        raise BrokenPromiseError(
            "Water temperatures must lie in {:g}-{:g} C, in degrees Celsius.", lowest, highest
        )
    return t
