"""Wind: the resistance in air that is taken off, and the still-air resistance put back.

The air force is taken away as the wind was felt on the moving boom, and the force in still air
at boat speed is added (Sleepproef, R. Pot 2017, "Wind"; the same structure as ITTC 7.5-04-01-01.1
eq. 9). Divided by boat speed squared, the still-air part is a constant of the boat. Here: the two
formulas and the coefficients that are searched. Areas are in `pipeline.hull`.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from pipeline.arrays import BoolArray, FloatArray, OnDemand
from pipeline.blocks.run_blocks import AIR_SUMS, RunBlocks
from pipeline.hull import AIR_DENSITY_KG_M3

PER_RUN_BOUNDS: Final = (0.0, 1.0)
"""Between which the old tool searched, run by run (presentation 2015, "Tegenwind en
omstroom-coefficient")."""


@dataclass(frozen=True)
class AirParts:
    """Air resistance / v^2 of each run for drag coefficients of 1, shape (runs,), kg/m.

    v is the speed as the log reads.

    Attributes:
        ahead, behind: of the wind from ahead (positive) and from behind (negative) on the front.
        side: of the oblique wind on the side; 0 for the head-wind model.
    """

    ahead: FloatArray
    behind: FloatArray
    side: FloatArray

    def total(self, ahead: FloatArray, behind: FloatArray, side: FloatArray | float) -> FloatArray:
        """Return the air part for given coefficients, shape (runs,), kg/m."""
        return ahead * self.ahead + behind * self.behind + side * self.side

    def times(self, factor: FloatArray) -> "AirParts":
        """Return these parts times a factor of each run, shape (runs,)."""
        return AirParts(self.ahead * factor, self.behind * factor, self.side * factor)


def compute_air_parts(
    oblique: BoolArray,
    term: Callable[[str], FloatArray],
    front_area_m2: FloatArray,
    side_area_m2: FloatArray,
) -> AirParts:
    """Return the air resistance of each run for drag coefficients of 1.

    - head: F = rho/2 front Cvt u|u| with u = w cos a (presentation 2015, "Windweerstand")
    - oblique: F = rho/2 (front |cos a| Cvt + side |sin a| Cvd) (w cos a)^2, with the sign of cos a
      ("Dwarse tegenwind")

    Args:
        oblique: whether the second holds, else the first, shape (runs,).
        term: gives the mean over the window of a term of `AIR_SUMS` / v^2, shape (runs,).
        front_area_m2, side_area_m2: shape (runs,).
    """
    front = 0.5 * AIR_DENSITY_KG_M3 * front_area_m2
    side = 0.5 * AIR_DENSITY_KG_M3 * side_area_m2
    ahead = np.where(oblique, term("front_ahead"), term("head_ahead"))
    behind = np.where(oblique, term("front_behind"), term("head_behind"))
    return AirParts(front * ahead, front * behind, np.where(oblique, side * term("side"), 0.0))


def average_terms(blocks: RunBlocks, averaging_s: int) -> dict[str, FloatArray]:
    """Return air terms of each block from the mean wind of some seconds around it.

    The vane jitters, and the square of a jittering wind is not the square of its mean: per
    sample the force comes out -17 to +12 % wrong (docs/method-details.md, 5). Mean wind is the mean
    speed in the circular mean direction: a mean vector would be too short, by 3 % at 13 degrees of
    jitter.

    Args:
        averaging_s: length of the centred average; shorter at the ends of a run.

    Returns:
        Means by name of `AIR_SUMS`, each of shape (runs, seconds), m2/s2.
    """
    count = np.maximum(_centred_sum(blocks.n, averaging_s), 1.0)
    speed = _centred_sum(blocks["wind_v"], averaging_s) / count
    cos_sum = _centred_sum(blocks["wind_cos"], averaging_s)
    sin_sum = _centred_sum(blocks["wind_sin"], averaging_s)
    length = np.maximum(np.hypot(cos_sum, sin_sum), 1e-9)
    cos, sin = cos_sum / length, sin_sum / length
    along = speed * cos
    head = along * np.abs(along)
    ahead, behind = np.maximum(head, 0.0), np.minimum(head, 0.0)
    front = np.abs(cos)
    terms = ahead, behind, ahead * front, behind * front, head * np.abs(sin)
    return dict(zip(AIR_SUMS, terms, strict=True))


def average_wind(blocks: RunBlocks, averaging_s: int) -> RunBlocks:
    """Return the blocks with the sums of their air terms as `average_terms` gives them."""
    terms = average_terms(blocks, averaging_s)

    def compute(name: str) -> FloatArray:
        if name in AIR_SUMS:
            return terms[name] * blocks.n
        source, _, term = name.partition("_")
        return terms[term] * blocks[f"{source}_inv_v2"] if term in AIR_SUMS else blocks[name]

    return replace(blocks, sums=OnDemand(blocks.sums.keys(), compute))


def _centred_sum(values: FloatArray, width: int) -> FloatArray:
    """Sum over `width` neighbours along axis 1, centred, cut off at the ends."""
    total = np.zeros_like(values)
    seconds = values.shape[1]
    before, after = min(width // 2, seconds - 1), min((width - 1) // 2, seconds - 1)
    for shift in range(-before, after + 1):
        low, high = max(0, -shift), min(seconds, seconds - shift)
        total[:, low:high] += values[:, low + shift : high + shift]
    return total


def find_nearest_coefficients(
    air: AirParts, excess_kg_m: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return coefficients within `PER_RUN_BOUNDS` that bring each run nearest to a value.

    The wind that is felt most is searched first, the other takes what is left.

    Args:
        air: air parts of the runs.
        excess_kg_m: what the air part should be, shape (runs,).

    Returns:
        Coefficients for wind from ahead and from behind, each of shape (runs,).
    """
    mostly_ahead = np.abs(air.ahead) >= np.abs(air.behind)
    larger = np.where(mostly_ahead, air.ahead, air.behind)
    smaller = np.where(mostly_ahead, air.behind, air.ahead)
    first = _clipped_quotient(excess_kg_m, larger)
    # Within its bounds the first takes all: what is left then is rounding.
    within = (first > PER_RUN_BOUNDS[0]) & (first < PER_RUN_BOUNDS[1])
    second = _clipped_quotient(np.where(within, 0.0, excess_kg_m - first * larger), smaller)
    return np.where(mostly_ahead, first, second), np.where(mostly_ahead, second, first)


def _clipped_quotient(numerator: FloatArray, denominator: FloatArray) -> FloatArray:
    """Return the quotient within `PER_RUN_BOUNDS`; the lower bound where there is no wind."""
    some = np.abs(denominator) > 1e-12
    quotient = np.where(some, numerator, 0.0) / np.where(some, denominator, 1.0)
    lowest, highest = PER_RUN_BOUNDS
    return np.clip(quotient, lowest, highest)


def mean_angle_deg(sin: FloatArray, cos: FloatArray) -> FloatArray:
    """Return the circular mean of the vane, from its sine and cosine, degrees in [0, 360)."""
    return np.asarray(np.degrees(np.arctan2(sin, cos)) % 360.0, dtype=np.float64)
