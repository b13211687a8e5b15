"""Choosing the best of several that may be equal but for rounding.

Processors sum in different orders, so equal numbers differ in their last digits by chance. A choice
must not rest on that: of numbers that are equal to `SAME_SHARE` the first counts. The caller
decides by the order which that is.
"""

from typing import Final

import numpy as np

from pipeline.arrays import FloatArray, IntArray

SAME_SHARE: Final = 1e-9
"""Numbers that differ by no more than this share of themselves are equal."""


def find_first_largest(values: FloatArray) -> IntArray:
    """Return the index along axis 0 of the first of the largest values."""
    top = values.max(axis=0)
    enough = np.where(top > 0.0, top * (1.0 - SAME_SHARE), top * (1.0 + SAME_SHARE))
    return np.asarray((values >= enough).argmax(axis=0))
