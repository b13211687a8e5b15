import numpy as np
import pytest

from pipeline import hull


def test_hull_speed_grows_with_the_square_root_of_length():
    assert hull.hull_speed_m_s(4.0) == pytest.approx(2.5)
    assert hull.hull_speed_m_s([4.0, 16.0]) == pytest.approx([2.5, 5.0])


def test_areas_add_the_crew_to_length_or_beam_times_height():
    assert hull.front_area_m2(2.0, 1.5) == pytest.approx(3.5)
    assert hull.side_area_m2(8.0, 1.5) == pytest.approx(13.0)


def test_still_air_coefficient_is_drag_over_speed_squared():
    area, drag, speed = 3.0, 0.5, 2.4
    force = 0.5 * 1.225 * area * drag * speed**2
    assert hull.still_air_coefficient_kg_m(area, drag) == pytest.approx(force / speed**2)
    assert np.shape(hull.still_air_coefficient_kg_m(np.ones(3), drag)) == (3,)
