"""The maximum of a restricted likelihood over its variances (REML).

Source: Patterson & Thompson 1971; Gilmour, Thompson & Cullis 1995 (average information). What the
data and the variances mean is decided in `consistency.mixed`.
"""

from collections.abc import Callable
from typing import Final, NamedTuple

import numpy as np

from pipeline.arrays import BoolArray, FloatArray

MAX_ITERATIONS: Final = 100
MAX_HALVINGS: Final = 40
TOLERANCE: Final = 1e-11
"""The search has converged when a step changes no variance by more than this share of its size."""
NEGLIGIBLE: Final = 1e-3
"""Share of the unit below which a variance need not be known as a share of itself."""
ROUNDING: Final = 1e-11
"""Share of a deviance, or 1 if that is larger, that is lost in its sums."""
MIN_INFORMATION: Final = 1e-10
"""Information, in units of the spread, below which it is rounding: boats of one type have none of
what differs between types."""


class Likelihood(NamedTuple):
    """A restricted likelihood at given variances, v of them.

    Attributes:
        deviance: -2 ln of it but for a constant.
        gradient: (v,) derivative of the deviance by each variance.
        information: (v, v) average of observed and expected second derivative of the deviance.
    """

    deviance: float
    gradient: FloatArray
    information: FloatArray


def minimize_deviance(
    likelihood: Callable[[FloatArray], Likelihood],
    is_free: BoolArray,
    start: FloatArray,
    unit: float,
) -> tuple[FloatArray, float]:
    """Minimise a deviance over some of its variances, the others fixed.

    Newton's method with the average information, on variances that are not negative: one that is 0
    and would fall stays 0. A step is halved until the deviance does not rise. The size of the step,
    not of the gain, says when it is done: near its minimum a smooth function is flat over the root
    of its rounding, while its slope crosses 0 there.

    Args:
        likelihood: function of the variances, (v,).
        is_free: (v,) which variances are searched.
        start: (v,) where to begin; variances that are not free keep this value.
        unit: size of a variance.

    Returns:
        The variances, (v,), and the deviance there; infinite where the search did not converge.
    """
    variances = start
    current = likelihood(start)
    for _ in range(MAX_ITERATIONS):
        may_move = is_free & ((variances > 0.0) | (current.gradient < 0.0))
        if not may_move.any():
            return variances, current.deviance
        step = _newton_step(current, may_move, unit)
        highest = current.deviance + ROUNDING * max(1.0, abs(current.deviance))
        for _ in range(MAX_HALVINGS):
            proposal = np.maximum(variances + step, 0.0)
            current = likelihood(proposal)
            if current.deviance <= highest:
                break
            step = 0.5 * step
        else:
            break
        moved = np.abs(proposal - variances)
        variances = proposal
        if (moved <= TOLERANCE * np.maximum(variances, NEGLIGIBLE * unit)).all():
            return variances, current.deviance
    return variances, np.inf


def _newton_step(current: Likelihood, may_move: BoolArray, unit: float) -> FloatArray:
    """Return the Newton step, (v,); a variance on which there is no information stays."""
    information = np.diagonal(current.information)
    is_informed = may_move & (information > MIN_INFORMATION / unit**2)
    both = is_informed[:, None] & is_informed
    scale = np.sqrt(np.where(is_informed, information, 1.0))
    scaled = np.where(both, current.information / np.outer(scale, scale), 0.0)
    gradient = np.where(is_informed, current.gradient, 0.0) / scale
    step = -np.linalg.pinv(scaled, rcond=MIN_INFORMATION, hermitian=True) @ gradient / scale
    return np.where(is_informed, step, 0.0)
