"""How far calibrated tows of one boat scatter beyond their random part, boats that changed aside.

Only pairs of tows that are both calibrated tell: no log factor and no wander is in them. A boat
that was altered without a report is no error of a tow, so a pair is either sound or of a changed
boat: a contaminated normal distribution (Tukey 1960). Few pairs leave the scatter uncertain; it is
averaged over what they allow, so that without any pair the usual scatter remains.
"""

from typing import Final

import numpy as np

from herijk.pipeline.arrays import FloatArray
from herijk.pipeline.season_log.assumed import Settings

SCATTERS: Final = np.linspace(0.0, 3.0, 61)
"""Standard deviations that are tried / the usual one."""

CHANGED_SHARES: Final = np.linspace(0.02, 0.3, 8)
"""Shares of pairs of a changed boat that are tried, all equally likely."""


def tow_scatter(difference: FloatArray, variance: FloatArray, settings: Settings) -> float:
    """Standard deviation of ln Cw of a calibrated tow beyond its random part.

    Args:
        difference: (pairs,) ln Cw of a tow less that of the boat's tow before it, with ageing,
            weight and length taken out.
        variance: (pairs,) sum of the random variances of both.
        settings: the scatter is half normal about none beforehand, with `tow_sd` as its scale;
            changed boats differ by `changed_sd` more.

    Returns:
        Root of the mean of its square.
    """
    sd = settings.tow_sd * SCATTERS[:, None, None]
    share = CHANGED_SHARES[:, None]
    sound = variance + 2.0 * sd**2
    ln_likelihood = np.logaddexp(
        np.log(1.0 - share) + _ln_normal(difference, sound),
        np.log(share) + _ln_normal(difference, sound + settings.changed_sd**2),
    ).sum(axis=2)
    ln_weight = ln_likelihood - 0.5 * SCATTERS[:, None] ** 2
    weight = np.exp(ln_weight - ln_weight.max()).sum(axis=1)
    return float(np.sqrt(np.average(sd[:, 0, 0] ** 2, weights=weight)))


def _ln_normal(difference: FloatArray, variance: FloatArray) -> FloatArray:
    return np.asarray(-0.5 * (difference**2 / variance + np.log(variance)))
