"""From a power to a speed: how fast a boat goes by its curve when every rower gives so much.

The other way round is in `pipeline.races.race`. Belongs here: reading a curve back from a line
of a register, where B may not be known. Does not: what the speed is asked for.
"""

from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray
from pipeline.curve import cw, s_of_b, s_of_height

BISECTIONS: Final = 60
FASTEST_M_S: Final = 20.0


def find_line_curves(lines: pl.DataFrame, suffix: str = "") -> tuple[FloatArray, FloatArray]:
    """Return A [kg/m] and s = 1/B^2 [s2/m2] of lines; without a B, s follows from A and Cw.

    Args:
        lines: `a_kg_m`, `b_m_s`, `cw_kg_m`, `declared_speed_m_s`, each with the suffix.
        suffix: of the columns that are read.
    """
    a = lines[f"a_kg_m{suffix}"].to_numpy()
    b = lines[f"b_m_s{suffix}"].to_numpy()
    c = lines[f"cw_kg_m{suffix}"].to_numpy()
    v = lines[f"declared_speed_m_s{suffix}"].to_numpy()
    has_b = np.isfinite(b)
    s = np.where(has_b, s_of_b(np.where(has_b, b, 1.0)), s_of_height(a, c, v))
    return a, s


def compute_line_cw(lines: pl.DataFrame, speed_m_s: FloatArray | pl.Series) -> FloatArray:
    """Return Cw [kg/m] of each line at a speed; infinite from its B on.

    Args:
        lines: as `find_line_curves` takes them.
        speed_m_s: a speed for each line.
    """
    a, s = find_line_curves(lines)
    return cw(a, s, speed_m_s)


def speed_at_power(a_kg_m: FloatArray, s_s2_m2: FloatArray, power_w: FloatArray) -> FloatArray:
    """Return the speed [m/s] at which Cw(v) v^3 is a power of the whole crew, by bisection."""
    low = np.zeros_like(power_w)
    high = np.where(s_s2_m2 > 0, 1.0 / np.sqrt(np.where(s_s2_m2 > 0, s_s2_m2, 1.0)), FASTEST_M_S)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        below = cw(a_kg_m, s_s2_m2, middle) * middle**3 < power_w
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return low
