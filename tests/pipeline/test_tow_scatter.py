"""The scatter of tows beyond their random part, from pairs of which some boats changed."""

import numpy as np
import pytest

from herijk.pipeline.season_log.assumed import USUAL
from herijk.pipeline.season_log.scatter import tow_scatter

RANDOM_SD = 0.006


def pairs(number: int, tow_sd: float, changed_share: float, seed: int = 0):
    """Differences of pairs of tows, some of a boat that changed by 5 %, and their variance."""
    rng = np.random.default_rng(seed)
    variance = np.full(number, 2 * RANDOM_SD**2)
    difference = np.sqrt(variance + 2 * tow_sd**2) * rng.standard_normal(number)
    changed = rng.random(number) < changed_share
    return difference + changed * 0.05 * rng.standard_normal(number), variance


@pytest.mark.parametrize("changed_share", [0.0, 0.1, 0.2])
@pytest.mark.parametrize("tow_sd", [0.005, 0.012])
def test_scatter_is_found_among_changed_boats(tow_sd, changed_share):
    number = 2000
    found = tow_scatter(*pairs(number, tow_sd, changed_share), USUAL)
    # The variance of a pair is known to sqrt(2 / n), four of which move that of a tow by:
    slack = 4 * np.sqrt(2 / number) * (RANDOM_SD**2 + tow_sd**2)
    # Changes of less than a pair's scatter cannot be told from none: a share of those is scatter.
    slack += changed_share * (RANDOM_SD**2 + tow_sd**2)
    assert found**2 == pytest.approx(tow_sd**2, abs=slack)


def test_without_pairs_the_usual_scatter_remains():
    assert tow_scatter(np.zeros(0), np.zeros(0), USUAL) == pytest.approx(USUAL.tow_sd, rel=0.05)


def test_few_pairs_leave_room_for_more_scatter():
    few, many = (tow_scatter(*pairs(n, 0.0, 0.0), USUAL) for n in (4, 400))
    assert few > 2 * many
