"""Finding measured series that are copies of each other.

Two independent measurements never agree to the last printed digit over a whole series; a copy
does. Does not belong here: what is done about it, and files that are byte for byte the same.
"""

from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from herijk.pipeline.errors import BrokenPromiseError

IntArray = NDArray[np.int64]

EXACT: Final = 1e-9
"""Tolerance for copies that went through another number format."""


def duplicate_pairs(series: ArrayLike, tolerance_ratio: float = EXACT) -> IntArray:
    """Pairs of series that agree at every point.

    Points are compared on the scale of the larger series of the pair (its root mean square), so
    that values near zero do not hide a copy.

    Args:
        series: (n_series, n_points), finite, measured at the same points, e.g. resistance.
        tolerance_ratio: largest difference at any point, as a share of that scale.

    Returns:
        (n_pairs, 2) row numbers, the lower first, in order.

    Raises:
        BrokenPromiseError: the series are not a finite table.
    """
    values = np.asarray(series, dtype=np.float64)
    if values.ndim != 2 or not np.isfinite(values).all():
        message = f"Series must be a finite table (n_series, n_points); shape is {values.shape}."
        raise BrokenPromiseError(message)
    scale = np.sqrt(np.mean(values * values, axis=1))
    difference = np.abs(values[:, None, :] - values[None, :, :]).max(axis=2, initial=0.0)
    alike = difference <= tolerance_ratio * np.maximum(scale[:, None], scale[None, :])
    return np.argwhere(np.triu(alike, k=1))
