"""From a race time to power per rower, and the fatigue factor.

Belongs here: what turns distance, time and a curve's Cw into the number races are decided on.
Does not belong here: the curve itself (`curve`), penalties and tidal currents, which are inputs.
Arguments broadcast.
"""

from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from pipeline.arrays import FloatArray
from pipeline.errors import MissingKnowledgeError

FATIGUE_REFERENCE: Final = ((7200.0, 0.79), (10800.0, 0.77))
"""Race time [s] and mean power over it as a share of the reference: all that is published
(presentation R. Pot, 24 January 2015, "Uitputtings-correctie")."""


Outside = Literal["refuse", "extend"]
"""What to do with a race time outside the published points: nothing, or go on with the power law
between them."""


def mean_speed_m_s(distance_m: ArrayLike, time_s: ArrayLike) -> FloatArray:
    """Return the mean speed [m/s] through the water of a distance without the current."""
    distance = np.asarray(distance_m, dtype=np.float64)
    time = np.asarray(time_s, dtype=np.float64)
    return distance / time


def power_per_rower_w(cw_kg_m: ArrayLike, speed_m_s: ArrayLike, rowers: ArrayLike) -> FloatArray:
    """Return the power per rower [W]: Cw(v) v^3 / n (presentation R. Pot, 24 January 2015)."""
    cw = np.asarray(cw_kg_m, dtype=np.float64)
    speed = np.asarray(speed_m_s, dtype=np.float64)
    number = np.asarray(rowers, dtype=np.float64)
    return cw * speed**3 / number


def reference_power_share(time_s: ArrayLike, outside: Outside = "refuse") -> FloatArray:
    """Return the share of the reference power that a crew keeps up in a race of that length.

    Only two points of the reference curve are public. Between them a power law of time is taken:
    straight in the logarithms, so it falls ever more slowly, as the source describes it.

    Args:
        time_s: race times.
        outside: whether the power law is also used before the first and after the last point.

    Raises:
        MissingKnowledgeError: a time outside the two points, which is to be refused.
    """
    time = np.asarray(time_s, dtype=np.float64)
    (first, last), (first_share, last_share) = np.array(FATIGUE_REFERENCE).T
    beyond = (time < first) | (time > last)
    if outside == "refuse" and beyond.any():
        raise MissingKnowledgeError(
            "The fatigue reference is known from {:g} to {:g} h; {} race times lie outside, the "
            "first is {:.2f} h. Leave these without correction, or extend it.",
            first / 3600,
            last / 3600,
            int(beyond.sum()),
            time[beyond].flat[0] / 3600,
        )
    exponent = np.log(last_share / first_share) / np.log(last / first)
    return np.asarray(first_share * (time / first) ** exponent, dtype=np.float64)


def fatigue_factor(
    time_s: ArrayLike, winning_time_s: ArrayLike, outside: Outside = "refuse"
) -> FloatArray:
    """Return the factor on a crew's power for rowing longer than the winner; 1 for the winner.

    Raises:
        MissingKnowledgeError: see `reference_power_share`.
    """
    winner = reference_power_share(winning_time_s, outside)
    return np.asarray(winner / reference_power_share(time_s, outside))
