"""Friction of a hull in fresh water: water properties, the ITTC-57 line, wetted surface.

Belongs here: textbook formulas, as functions of temperature, speed and hull form. Does not belong
here: what a method does with them (the temperature correction, `resistance`). Arguments broadcast.
"""

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from pipeline.arrays import FloatArray
from pipeline.errors import BrokenPromiseError

LIQUID_RANGE_C: Final = (0.0, 40.0)
"""Temperatures both formulas below hold for."""


def water_density_kg_m3(temperature_c: ArrayLike) -> FloatArray:
    """Return the density [kg/m3] of fresh water, 0-40 C, good to 0.001 kg/m3.

    Tanaka et al. 2001, Metrologia 38, 301-309 (the CIPM formula), without dissolved air.

    Raises:
        BrokenPromiseError: a temperature outside 0-40 C.
    """
    t = _liquid(temperature_c)
    numerator = (t - 3.983035) ** 2 * (t + 301.797)
    return 999.974950 * (1.0 - numerator / (522528.9 * (t + 69.34881)))


def kinematic_viscosity_m2_s(temperature_c: ArrayLike) -> FloatArray:
    """Return the kinematic viscosity [m2/s] of fresh water, 0-40 C, good to 1 %.

    Dynamic viscosity by the IAPWS supplementary release SR6-08 (Patek et al. 2009, J. Phys. Chem.
    Ref. Data 38, 21-29), divided by the density.

    Raises:
        BrokenPromiseError: a temperature outside 0-40 C.
    """
    reduced = (_liquid(temperature_c) + 273.15) / 300.0
    dynamic_pa_s = 1e-6 * (
        280.68 * reduced**-1.9
        + 511.45 * reduced**-7.7
        + 61.131 * reduced**-19.6
        + 0.45903 * reduced**-40.0
    )
    return dynamic_pa_s / water_density_kg_m3(temperature_c)


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
) -> FloatArray:
    """Return the part of Cw [kg/m] due to friction: rho/2 S CF, CF by ITTC-57 on the length."""
    reynolds = reynolds_number(speed_m_s, length_m, kinematic_viscosity_m2_s(temperature_c))
    coefficient = ittc57_friction_coefficient(reynolds)
    return 0.5 * water_density_kg_m3(temperature_c) * wetted_surface_m2 * coefficient


def _liquid(temperature_c: ArrayLike) -> FloatArray:
    t = np.asarray(temperature_c, dtype=np.float64)
    lowest, highest = LIQUID_RANGE_C
    if not np.all((t >= lowest) & (t <= highest)):
        raise BrokenPromiseError(
            "Water temperatures must lie in {:g}-{:g} C, in degrees Celsius.", lowest, highest
        )
    return t
