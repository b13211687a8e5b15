"""What follows from a boat's main dimensions: hull speed, wind areas, still-air coefficient.

Does not belong here: the wind correction itself (`wind`), friction in water (`friction`), and the
cap on B, which is a choice of the method.

Source of all formulas: presentation R. Pot, 24 January 2015. Arguments broadcast.
"""

from typing import Final

import numpy as np

from pipeline.arrays import FloatArray

AIR_DENSITY_KG_M3: Final = 1.225
GRAVITY_M_S2: Final = 9.813
"""In the Netherlands."""
CREW_FRONT_AREA_M2: Final = 0.5
"""Added to breadth x height; printed as 2 x 0.25, presumably the crew."""

CREW_SIDE_AREA_M2: Final = 1.0
"""Added to length x height in the oblique-wind formula of 2015."""

BEAM_DRAUGHTS: Final = 6.0
"""Beam / draught of sloops. Stated assumption: no list holds draughts."""

USUAL_BOW_HEIGHT_M: Final = 1.0
"""Height taken for a bow that nobody measured (inferred). Only boats towed without an anemometer
may lack the height; there it moves the interval and not Cw."""


def hull_speed_m_s(waterline_length_m: FloatArray) -> FloatArray:
    """Return the speed [m/s] whose wave is as long as the waterline: 1.25 sqrt(L)."""
    return 1.25 * np.sqrt(waterline_length_m)


def front_area_m2(beam_m: FloatArray, bow_height_m: FloatArray) -> FloatArray:
    """Return the area [m2] seen by a head wind: b h + 0.5."""
    return beam_m * _known_height_m(bow_height_m) + CREW_FRONT_AREA_M2


def side_area_m2(length_m: FloatArray, bow_height_m: FloatArray) -> FloatArray:
    """Return the area [m2] seen by a beam wind: l h + 1.0."""
    return length_m * _known_height_m(bow_height_m) + CREW_SIDE_AREA_M2


def _known_height_m(bow_height_m: FloatArray) -> FloatArray:
    return np.where(np.isnan(bow_height_m), USUAL_BOW_HEIGHT_M, bow_height_m)


def still_air_coefficient_kg_m(
    area_m2: FloatArray, drag_coefficient: FloatArray | float
) -> FloatArray:
    """Return the part of Cw [kg/m] due to still air: rho/2 area Cvt, the same at any speed."""
    return 0.5 * AIR_DENSITY_KG_M3 * area_m2 * drag_coefficient
