"""A real resistance without a bend: B is not determined, and no number is given for it."""

import numpy as np
import pytest

from pipeline import curve
from tests.golden.sources import read_table


def test_a_drag_without_a_bend_has_a_height_and_no_b():
    rows = read_table("unh_rm2_tare_drag.csv")
    speed = np.array([float(row["tow_speed_m_per_s"]) for row in rows])
    points = curve.Points.from_arrays(speed, [float(row["tare_drag_N"]) for row in rows] / speed**2)
    assert points.cw_kg_m.min() == pytest.approx(46.5, abs=0.05)
    assert points.cw_kg_m.max() == pytest.approx(52.3, abs=0.05)
    fitted = curve.fit(points)
    assert (fitted.converged[0], fitted.b_determined[0], fitted.b_m_s[0]) == (True, False, np.inf)
    scatter = curve.own_scatter(fitted)
    b = curve.b_interval(points, fitted, scatter)
    # What the data do say: a bend within the speeds measured is excluded.
    assert b.lo[0] > speed.max()
    assert b.hi[0] == np.inf
    height = curve.cw_interval(points, fitted, scatter, 0.8)
    assert height.hi[0] / height.lo[0] < 1.1
