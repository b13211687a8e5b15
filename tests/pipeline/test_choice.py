"""Equals but for rounding are equals, in every place where one of several is chosen."""

import numpy as np
import pytest

from pipeline.choice import first_largest


@pytest.mark.parametrize(
    ("values", "place"),
    [
        ([1.0, 3.0, 3.0 + 1e-14], 1),
        ([1.0, 3.0, 3.0 + 1e-6], 2),
        ([-2.0, -1.0 - 1e-14, -1.0], 1),
        ([1.0, np.inf, np.inf], 1),
        ([0.0, 0.0], 0),
    ],
)
def test_of_equals_the_first_is_chosen(values, place):
    assert first_largest(np.array(values)) == place
    assert first_largest(np.array([values, values]).T).tolist() == [place, place]
