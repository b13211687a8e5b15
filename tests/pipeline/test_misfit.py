"""How far hulls lie from their hyperbolas, by the lack of fit of run points."""

import numpy as np
import pytest

from pipeline import curve
from pipeline.uncertainty.misfit import USUAL_RATIO, fit_parabolas, shrink_to_lines

TARGET = np.tile([0.9, 1.0, 1.1], 2)
WAY = np.repeat([1.0, -1.0], 3)
TOWS, PER_BOAT = 240, 3
SCATTER = 0.008


def departures(hump, seed=1):
    """Hulls that lie `hump` above a hyperbola at the declared speed and as much below at 10 %."""
    rng = np.random.default_rng(seed)
    boat = np.arange(TOWS) // PER_BOAT
    own = hump * rng.standard_normal(TOWS // PER_BOAT)[boat]
    speed = TARGET * (1.0 + 0.01 * rng.standard_normal((TOWS, 6)))
    shape = own[:, None] * (1.0 - ((speed - 1.0) / 0.1) ** 2)
    true = 40.0 / (1.0 - (speed / 1.6) ** 2)
    noise = SCATTER * rng.standard_normal((TOWS, 6))
    points = curve.Points.from_arrays(speed, true * (1.0 + shape + noise))
    fitted = curve.fit(points)
    on_curve = curve.cw(fitted.a_kg_m[:, None], fitted.s_s2_m2[:, None], speed)
    found = fit_parabolas(
        points.cw_kg_m / on_curve - 1.0,
        points.used,
        speed,
        np.broadcast_to(WAY, speed.shape),
        np.broadcast_to(TARGET, speed.shape),
        np.array([1.0]),
    )
    at_declared = 40.0 / (1.0 - 1.6**-2.0) * (1.0 + own)
    return found, boat, at_declared / fitted.cw_at(np.ones(TOWS)) - 1.0


def test_a_hump_is_seen_and_its_size_is_known():
    found, boat, true = departures(0.02)
    mean, variance = (x[:, 0] for x in shrink_to_lines(found, boat))
    assert np.std(true - mean) < 0.7 * np.std(true)
    assert np.abs(true - mean).mean() < 0.01
    assert np.sqrt(mean**2 + variance).mean() == pytest.approx(np.std(true), rel=0.3)


def test_the_variance_of_a_misfit_is_what_scatter_makes_of_it():
    """The curve has taken mean and slope of the scatter with it: two thirds of it are left."""
    found, _, _ = departures(0.0)
    # Its standard error over 240 tows is 9 %; without that third the quotient is 0.67.
    assert np.mean(found.ratio**2) / found.variance.mean() == pytest.approx(1.0, abs=0.2)


def test_hyperbolas_have_none():
    found, boat, _ = departures(0.0)
    mean, variance = shrink_to_lines(found, boat)
    assert np.sqrt(mean**2 + variance).max() < 0.004


def departure_of_residuals(residuals, target):
    return fit_parabolas(
        residuals,
        np.ones(residuals.shape, bool),
        np.broadcast_to(TARGET, residuals.shape),
        np.broadcast_to(WAY, residuals.shape),
        np.broadcast_to(target, residuals.shape),
        np.array([1.0]),
    )


@pytest.mark.parametrize("rounding", [0.0, 1e-16])
def test_points_that_wind_coefficients_brought_onto_the_curve_tell_nothing(rounding):
    """One tow under wind coefficients of each run has no scatter at all; its budget held NaN."""
    residuals = rounding * np.random.default_rng(3).standard_normal((1, 6))
    found = departure_of_residuals(residuals, TARGET)
    mean, variance = shrink_to_lines(found, np.zeros(1, np.int64))
    assert mean.item() == 0.0
    assert np.sqrt(variance.item()) == pytest.approx(USUAL_RATIO)
