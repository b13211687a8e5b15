"""Equals but for rounding are equals, in every place where one of several is chosen."""

import numpy as np
import polars as pl
import pytest

from pipeline.assessment.assess import apply_checks
from pipeline.assessment.checks import CHECK
from pipeline.choice import find_first_largest
from pipeline.crews import STANDARD_CREWS


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


@pytest.mark.parametrize(
    ("crew_class", "power_w", "flagged"),
    [("X", 65.0, False), ("X", 75.0, True), ("H", 75.0, False)],
)
def test_a_tow_is_held_to_the_limits_of_its_own_class(crew_class, power_w, flagged):
    mixed = STANDARD_CREWS.head(1).with_columns(
        crew_class=pl.lit("X"), lowest_power_w=50.0, highest_power_w=70.0
    )
    of_tow = {"method": ["m"], "tow_id": ["t"], "season": [2014], "crew_class": [crew_class]}
    tows = pl.DataFrame({**of_tow, "power_w": [power_w]})
    checks = (CHECK["power_outside_range"],)
    found = apply_checks(tows, checks, pl.concat([STANDARD_CREWS, mixed]))
    assert found["flagged"].to_list() == [flagged]
