"""Likely units: which exchange of units would shift a quantity as it is seen to be shifted."""

from typing import Final

import numpy as np

TOLERANCE: Final = 0.12
"""How far a logarithm may lie from that of an exchange, when it is known exactly."""

_EXCHANGES: Final = {
    "force": {
        "kgf instead of N": 9.80665,
        "daN instead of N": 10.0,
        "lbf instead of N": 4.4482216,
        "kN instead of N": 1e3,
        "a gain of two": 2.0,
    },
    "wind": {
        "km/h instead of m/s": 3.6,
        "knots instead of m/s": 1.9438445,
        "mph instead of m/s": 2.2369363,
        "ft/s instead of m/s": 3.2808399,
    },
}
"""Size of an exchange, whichever way round. kgf and daN differ by 2 % and are named together."""


def likely_cause(quantity: str, ln_size: float, sd: float) -> str:
    """The exchange that gives a shift; several where they cannot be told apart, else empty.

    Args:
        quantity: `force` or `wind`; nothing is known of others.
        ln_size: logarithm of the number in the file / the number expected.
        sd: its standard deviation.
    """
    known = _EXCHANGES.get(quantity, {})
    far = {name: abs(abs(ln_size) - np.log(ratio)) for name, ratio in known.items()}
    near = sorted((d, name) for name, d in far.items() if d <= TOLERANCE + 2.0 * sd)
    return " or ".join(name for d, name in near if d <= near[0][0] + TOLERANCE)
