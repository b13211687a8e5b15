"""Likely units: which exchange of units would shift a quantity as it is seen to be shifted."""

from typing import Final

import numpy as np

TOLERANCE: Final = 0.12
"""How far a logarithm may lie from that of an exchange, when it is known exactly."""

FORCE: Final = {
    "kN": 1e-3,
    "kgf": 1 / 9.80665,
    "daN": 1 / 10.0,
    "lbf": 1 / 4.4482216,
    "half the gain": 0.5,
    "twice the gain": 2.0,
    "mN": 1e3,
}
"""Number in the file / newtons, for what may stand under a header of newtons. kgf and daN differ by
2 % and are named together."""

WIND: Final = {"km/h": 3.6, "mph": 2.2369363, "knots": 1.9438445, "ft/s": 3.2808399}
"""Number in the file / metres a second."""

_EXCHANGES: Final = {"force": FORCE, "wind": WIND}


def likely_cause(quantity: str, ln_size: float, sd: float) -> str:
    """The exchange that gives a shift; several where they cannot be told apart, else empty.

    Args:
        quantity: `force` or `wind`; nothing is known of others.
        ln_size: logarithm of the number in the file / the number expected.
        sd: its standard deviation.
    """
    known = _EXCHANGES.get(quantity, {})
    far = {name: abs(ln_size - np.log(ratio)) for name, ratio in known.items()}
    near = sorted((d, name) for name, d in far.items() if d <= TOLERANCE + 2.0 * sd)
    if not near:
        return ""
    return " or ".join(name for d, name in near if d <= near[0][0] + TOLERANCE)
