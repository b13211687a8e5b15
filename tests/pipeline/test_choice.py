"""Equals but for rounding are equals, in every place where one of several is chosen."""

import numpy as np
import polars as pl
import pytest

from pipeline.assessment.assess import apply_checks
from pipeline.assessment.checks import CHECK
from pipeline.choice import find_first_largest


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
    assert find_first_largest(np.array(values)) == place
    assert find_first_largest(np.array([values, values]).T).tolist() == [place, place]


@pytest.mark.parametrize(("observed", "side"), [(-2e-16, 1), (0.0, 1), (-0.01, 0)])
def test_half_way_between_two_limits_rounding_does_not_choose(observed, side):
    check = CHECK["out_and_back_differ"]
    of_tow = {"method": ["m"], "tow_id": ["t"], "season": [2014], "crew_class": ["H"]}
    tows = pl.DataFrame({**of_tow, "out_over_back": [observed + 1.0]})
    assert apply_checks(tows, (check,))["limit"].item() == check.limits("H")[side]
