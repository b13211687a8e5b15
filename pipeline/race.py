"""From a race time to power per rower, and the fatigue factor.

Belongs here: what turns distance, time and a curve's Cw into the number races are decided on.
Does not belong here: the curve itself (`curve`), penalties and tidal streams, which are inputs.
Arguments broadcast.
"""

from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pipeline.errors import MissingKnowledgeError

FloatArray = NDArray[np.float64]

FATIGUE_REFERENCE: Final = ((7200.0, 0.79), (10800.0, 0.77))
"""Race time [s] and mean power over it as a share of the reference: all that is published
(presentation R. Pot, 24 January 2015, "Uitputtings-correctie")."""


def mean_speed_m_s(distance_m: ArrayLike, time_s: ArrayLike) -> FloatArray:
    """Mean speed [m/s] through the water; take the stream off the distance beforehand."""
    distance, time = (np.asarray(x, dtype=np.float64) for x in (distance_m, time_s))
    return distance / time


def power_per_rower_w(cw_kg_m: ArrayLike, speed_m_s: ArrayLike, rowers: ArrayLike) -> FloatArray:
    """Power per rower [W]: Cw(v) v^3 / n (presentation R. Pot, 24 January 2015)."""
    cw, speed, number = (np.asarray(x, dtype=np.float64) for x in (cw_kg_m, speed_m_s, rowers))
    return cw * speed**3 / number


def reference_power_share(time_s: ArrayLike) -> FloatArray:
    """Share of the reference power that a crew keeps up on average over a race of that length.

    Only two points of the reference curve are public. Between them a power law of time is taken:
    straight in the logarithms, so it falls ever more slowly, as the source describes it.

    Raises:
        MissingKnowledgeError: a time outside the two points; the curve there is not public.
    """
    time = np.asarray(time_s, dtype=np.float64)
    known_times, known_shares = np.array(FATIGUE_REFERENCE).T
    outside = (time < known_times[0]) | (time > known_times[-1])
    if outside.any():
        message = (
            f"The fatigue reference is known from {known_times[0] / 3600:g} to "
            f"{known_times[-1] / 3600:g} h; {int(outside.sum())} race times lie outside, the "
            f"first is {time[outside].flat[0] / 3600:.2f} h. Leave these without correction."
        )
        raise MissingKnowledgeError(message)
    log_share = np.interp(np.log(time), np.log(known_times), np.log(known_shares))
    return np.asarray(np.exp(log_share), dtype=np.float64)


def fatigue_factor(time_s: ArrayLike, winning_time_s: ArrayLike) -> FloatArray:
    """Factor on a crew's power for rowing longer than the winner; 1 for the winner.

    Raises:
        MissingKnowledgeError: see `reference_power_share`.
    """
    return np.asarray(reference_power_share(winning_time_s) / reference_power_share(time_s))
