"""Wind: the resistance in air that is taken off, and the still-air resistance put back.

The air force is taken away as the wind was felt on the moving boom, and the force in still air
at boat speed is added (Sleepproef, R. Pot 2017, "Wind"; the same structure as ITTC 7.5-04-01-01.1
eq. 9). Divided by boat speed squared, the still-air part is a constant of the boat. Here: the two
formulas. Areas stand in `pipeline.hull`.
"""

import numpy as np

from pipeline.arrays import BoolArray, FloatArray
from pipeline.blocks import RunBlocks
from pipeline.hull import AIR_DENSITY_KG_M3
from pipeline.method import Wind


def air_weights(
    wind: Wind, front_area_m2: FloatArray, side_area_m2: FloatArray
) -> dict[str, FloatArray]:
    """What each air sum of `pipeline.blocks` is multiplied by to become a force in N.

    - head: F = rho/2 front Cvt u|u| with u = w cos a (presentation 2015, "Windweerstand")
    - oblique: F = rho/2 (front |cos a| Cvt + side |sin a| Cvd) (w cos a)^2, with the sign of cos a
      ("Dwarse tegenwind")

    Cvt may differ for wind from ahead and from behind.

    Args:
        wind: model and coefficients.
        front_area_m2: shape (runs,).
        side_area_m2: shape (runs,).

    Returns:
        Weight per name of an air sum, each of shape (runs,), in kg/m.
    """
    front = 0.5 * AIR_DENSITY_KG_M3 * front_area_m2
    side = 0.5 * AIR_DENSITY_KG_M3 * side_area_m2
    along = "head" if wind.model == "head" else "front"
    weights = {f"{along}_ahead": front * wind.ahead, f"{along}_behind": front * wind.behind}
    if wind.model == "oblique":
        weights |= {"side_ahead": side * wind.side, "side_behind": side * wind.side}
    return weights


def air_part(
    blocks: RunBlocks, window: BoolArray, source: str, weights: dict[str, FloatArray]
) -> FloatArray:
    """Mean of F_air / v^2 over each window, shape (runs,), kg/m; v as the log reads."""
    parts = [w * blocks.mean(f"{source}_{name}", window) for name, w in weights.items()]
    return np.asarray(np.sum(parts, axis=0), dtype=np.float64)


def mean_wind_angle_deg(blocks: RunBlocks, window: BoolArray) -> FloatArray:
    """Circular mean of the vane over each window, shape (runs,), degrees in [0, 360)."""
    sin, cos = blocks.total("wind_sin", window), blocks.total("wind_cos", window)
    return np.asarray(np.degrees(np.arctan2(sin, cos)) % 360.0, dtype=np.float64)
