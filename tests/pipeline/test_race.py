import numpy as np
import pytest

from pipeline.errors import MissingKnowledgeError
from pipeline.races import race


def test_mean_speed_and_power_broadcast():
    assert race.mean_speed_m_s([9000.0, 18000.0], 3600.0) == pytest.approx([2.5, 5.0])
    assert race.power_per_rower_w(40.0, [2.0, 3.0], 8) == pytest.approx([40.0, 135.0])


def test_reference_share_passes_through_the_published_points():
    assert race.reference_power_share([7200.0, 10800.0]) == pytest.approx([0.79, 0.77])


def test_reference_share_falls_ever_more_slowly():
    shares = race.reference_power_share(np.linspace(7200.0, 10800.0, 20))
    assert np.all(np.diff(shares) < 0)
    assert np.all(np.diff(shares, 2) > 0)


@pytest.mark.parametrize("time_s", [7199.0, 10801.0])
def test_outside_the_published_points_nothing_is_guessed(time_s):
    with pytest.raises(MissingKnowledgeError, match="2 to 3 h"):
        race.fatigue_factor([9000.0, time_s], 9000.0)
