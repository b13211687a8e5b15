"""Likely units: which exchange of units would shift a quantity as much as is observed."""

from typing import Final

import numpy as np

from pipeline.messages import say

TOLERANCE: Final = 0.12
"""How far a logarithm that is known exactly may lie from that of an exchange."""

Cause = tuple[str, ...]
"""A text, and what goes between its braces."""


def instead_of(unit: str, meant: str) -> Cause:
    """A number in one unit that is read as in another."""
    return say("{} instead of {}"), unit, meant


_EXCHANGES: Final[dict[str, dict[Cause, float]]] = {
    "force": {
        instead_of("kgf", "N"): 9.80665,
        instead_of("daN", "N"): 10.0,
        instead_of("lbf", "N"): 4.4482216,
        instead_of("kN", "N"): 1e3,
        (say("a gain of two"),): 2.0,
    },
    "wind": {
        instead_of("km/h", "m/s"): 3.6,
        instead_of(say("knots"), "m/s"): 1.9438445,
        instead_of("mph", "m/s"): 2.2369363,
        instead_of("ft/s", "m/s"): 3.2808399,
    },
}
"""Ratio of the two units. kgf and daN differ by 2 % and are named together."""


def likely_causes(quantity: str, ln_size: float, sd: float) -> tuple[Cause, ...]:
    """The exchanges that explain a shift, likeliest first; several where they are too alike.

    Args:
        quantity: `force` or `wind`; nothing is known of others.
        ln_size: logarithm of the number in the file / the number expected.
        sd: its standard deviation.
    """
    known = _EXCHANGES.get(quantity, {})
    far = {cause: abs(abs(ln_size) - np.log(ratio)) for cause, ratio in known.items()}
    near = sorted((d, cause) for cause, d in far.items() if d <= TOLERANCE + 2.0 * sd)
    return tuple(cause for d, cause in near if d <= near[0][0] + TOLERANCE)
