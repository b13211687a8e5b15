"""A real resistance without a bend: B is not determined, and no number is given for it."""

import numpy as np
import pytest

from pipeline import curve
from tests.golden.sources import read_table
from tests.pipeline.fieller import b_interval_fieller


@pytest.fixture(scope="module")
def points():
    rows = read_table("unh_rm2_tare_drag.csv")
    speed = np.array([float(row["tow_speed_m_per_s"]) for row in rows])
    drag_n = np.array([float(row["tare_drag_N"]) for row in rows])
    return curve.Points.of(speed, drag_n / speed**2)


def test_coefficient_has_no_trend(points):
    assert points.cw_kg_m.min() == pytest.approx(46.5, abs=0.05)
    assert points.cw_kg_m.max() == pytest.approx(52.3, abs=0.05)


def test_b_is_not_determined(points):
    fitted = curve.fit(points)
    assert fitted.converged[0]
    assert not fitted.b_determined[0]
    assert fitted.b_m_s[0] == np.inf


@pytest.mark.parametrize("interval_of", [curve.b_interval, b_interval_fieller])
def test_b_has_no_upper_bound(points, interval_of):
    fitted = curve.fit(points)
    interval = interval_of(points, fitted, curve.own_scatter(fitted))
    assert interval.hi[0] == np.inf
    # What the data do say: a bend within the speeds measured is excluded.
    assert interval.lo[0] > points.speed_m_s.max()


def test_height_is_determined_all_the_same(points):
    fitted = curve.fit(points)
    scatter = curve.own_scatter(fitted)
    interval = curve.cw_interval(points, fitted, scatter, 0.8)
    assert interval.hi[0] / interval.lo[0] < 1.1
