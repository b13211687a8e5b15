"""What follows from a boat's main dimensions: hull speed, wind areas, still-air coefficient.

Does not belong here: the wind correction itself (`wind`), friction in water (`friction`), and the
cap on B, which is a choice of the method.

Source of all formulas: presentation R. Pot, 24 January 2015. Arguments broadcast.
"""

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from herijk.pipeline.arrays import FloatArray

AIR_DENSITY_KG_M3: Final = 1.225
CREW_FRONT_AREA_M2: Final = 0.5
"""Added to breadth x height; printed as 2 x 0.25, presumably the crew."""

CREW_SIDE_AREA_M2: Final = 1.0
"""Added to length x height in the oblique-wind formula of 2015."""

USUAL_BOW_HEIGHT_M: Final = 1.0
"""Of a bow that nobody measured (inferred). Only boats towed without an anemometer may lack the
height; there it moves the interval and not Cw."""


def hull_speed_m_s(waterline_length_m: ArrayLike) -> FloatArray:
    """Speed [m/s] whose wave is as long as the waterline: 1.25 sqrt(L)."""
    return 1.25 * np.sqrt(np.asarray(waterline_length_m, dtype=np.float64))


def front_area_m2(beam_m: ArrayLike, bow_height_m: ArrayLike) -> FloatArray:
    """Area [m2] seen by a head wind: b h + 0.5."""
    return np.asarray(beam_m, dtype=np.float64) * _known_height_m(bow_height_m) + CREW_FRONT_AREA_M2


def side_area_m2(length_m: ArrayLike, bow_height_m: ArrayLike) -> FloatArray:
    """Area [m2] seen by a beam wind: l h + 1.0."""
    return (
        np.asarray(length_m, dtype=np.float64) * _known_height_m(bow_height_m) + CREW_SIDE_AREA_M2
    )


def _known_height_m(bow_height_m: ArrayLike) -> FloatArray:
    height = np.asarray(bow_height_m, dtype=np.float64)
    return np.where(np.isnan(height), USUAL_BOW_HEIGHT_M, height)


def still_air_coefficient_kg_m(area_m2: ArrayLike, drag_coefficient: ArrayLike) -> FloatArray:
    """Part of Cw [kg/m] due to still air: rho/2 area Cvt; force over speed squared, so constant."""
    area, drag = (np.asarray(x, dtype=np.float64) for x in (area_m2, drag_coefficient))
    return 0.5 * AIR_DENSITY_KG_M3 * area * drag
