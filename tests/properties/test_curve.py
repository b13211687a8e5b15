"""What must hold for the hyperbola whatever the numbers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from pipeline import curve

RUN_RATIOS = np.array([0.9, 1.0, 1.1, 0.9, 1.0, 1.1])

declared_speeds = st.floats(1.5, 4.0)
heights = st.floats(5.0, 100.0)
bends = st.floats(-0.5, 0.6)  # r = (v0/B)^2; negative is a falling curve
errors = arrays(np.float64, 6, elements=st.floats(-0.03, 0.03))
log_errors = st.floats(-0.08, 0.08)


def exact_points(v0, c0, r):
    a, s = curve.from_c0_q(c0, r / (1 - r), v0)
    speed = v0 * RUN_RATIOS
    return speed, curve.cw(a, s, speed)


def c0_and_q(fitted, v0):
    return curve.to_c0_q(fitted.a_kg_m, fitted.s_s2_m2, v0)


def in_s(b_interval):
    """An interval of B as one of s = 1/B^2, which passes through "no upper bound" smoothly."""
    edge = np.where(b_interval.lo > 0, b_interval.lo, 1e-3)
    return curve.Interval(curve.s_of_b(b_interval.hi), curve.s_of_b(edge))


def bounds_of_everything(points, fitted, scatter, v0):
    return [
        curve.cw_interval(points, fitted, scatter, v0),
        curve.cw_interval(points, fitted, scatter, 1.15 * v0),
        in_s(curve.b_interval(points, fitted, scatter)),
    ]


def contains(outer, inner):
    relative, absolute = 1e-6, 1e-9  # rounding, where a fit was repeated
    low_enough = outer.lo <= inner.lo * (1 + relative) + absolute
    high_enough = outer.hi >= inner.hi * (1 - relative) - absolute
    return np.all(low_enough & high_enough)


@given(declared_speeds, heights, bends)
def test_exact_data_are_recovered(v0, c0, r):
    fitted = curve.fit(curve.Points.from_arrays(*exact_points(v0, c0, r)))
    found_c0, found_q = c0_and_q(fitted, v0)
    assert fitted.converged[0]
    assert found_c0[0] == pytest.approx(c0, rel=1e-10)
    assert found_q[0] == pytest.approx(r / (1 - r), rel=1e-9, abs=1e-10)


@given(declared_speeds, heights, bends, errors, st.lists(st.booleans(), min_size=6, max_size=6))
def test_masking_a_point_is_dropping_it(v0, c0, r, error, keep):
    used = np.array(keep)
    used[:3] = True  # so that a curve is left
    speed, cw = exact_points(v0, c0, r)
    cw = cw * (1 + error)
    junk = np.where(used, cw, np.nan)
    masked_points = curve.Points.from_arrays(speed, junk, used)
    dropped_points = curve.Points.from_arrays(speed[used], cw[used])
    masked, dropped = curve.fit(masked_points), curve.fit(dropped_points)
    assert masked.n_points[0] == used.sum()
    assert masked.a_kg_m[0] == pytest.approx(dropped.a_kg_m[0], rel=1e-9)
    assert masked.s_s2_m2[0] == pytest.approx(dropped.s_s2_m2[0], rel=1e-9, abs=1e-9)
    of_masked = bounds_of_everything(masked_points, masked, curve.own_scatter(masked), v0)
    of_dropped = bounds_of_everything(dropped_points, dropped, curve.own_scatter(dropped), v0)
    for one, other in zip(of_masked, of_dropped, strict=True):
        assert contains(one, other)
        assert contains(other, one)


@given(declared_speeds, heights, st.floats(0.05, 0.6), errors, log_errors)
def test_a_log_error_is_undone_in_closed_form(v0, c0, r, error, log_error):
    # The log shows (1 + e) v; Cw is force over the square of what it shows.
    speed, cw = exact_points(v0, c0, r)
    cw = cw * (1 + error)
    shown_speed, shown_cw = speed * (1 + log_error), cw / (1 + log_error) ** 2
    fitted = curve.fit(curve.Points.from_arrays([speed, shown_speed], [cw, shown_cw]))
    if not fitted.b_determined.all():
        return  # the closed form is about register lines, which have a B
    a, b = fitted.a_kg_m, fitted.b_m_s
    rebased_a, rebased_b = curve.rebase(a[1], b[1], 1 / (1 + log_error))
    assert rebased_a == pytest.approx(a[0], rel=1e-9)
    assert 1 / rebased_b**2 == pytest.approx(1 / b[0] ** 2, rel=1e-9, abs=1e-10)
    assert rebased_a * rebased_b**2 == pytest.approx(a[1] * b[1] ** 2, rel=1e-12)


@given(declared_speeds, heights, bends, errors, st.floats(0.0, 0.99))
def test_points_nearer_to_their_curve_never_widen_an_interval(v0, c0, r, error, share):
    # Shrinking the residuals leaves the least-squares curve where it is.
    speed, cw = exact_points(v0, c0, r)
    points = curve.Points.from_arrays(speed, cw * (1 + error))
    fitted = curve.fit(points)
    on_curve = curve.cw(fitted.a_kg_m[:, None], fitted.s_s2_m2[:, None], points.speed_m_s)
    nearer_cw = on_curve + share * (points.cw_kg_m - on_curve)
    nearer = curve.Points.from_arrays(points.speed_m_s, nearer_cw)
    refitted = curve.fit(nearer)
    assert c0_and_q(refitted, v0)[0] == pytest.approx(c0_and_q(fitted, v0)[0], rel=1e-8)
    wide = bounds_of_everything(points, fitted, curve.own_scatter(fitted), v0)
    narrow = bounds_of_everything(nearer, refitted, curve.own_scatter(refitted), v0)
    for outer, inner in zip(wide, narrow, strict=True):
        assert contains(outer, inner)


@given(
    arrays(np.float64, (4, 5), elements=st.floats(0.1, 10.0)),
    arrays(np.float64, (4, 5), elements=st.floats(0.01, 1000.0)),
    arrays(np.bool_, (4, 5)),
    st.floats(0.05, 12.0),
)
def test_no_input_gives_nan_or_a_warning(speed, cw, used, cap):
    # Warnings are errors in the test configuration, so this also proves their absence.
    points = curve.Points.from_arrays(speed, cw, used)
    for fitted in (
        curve.fit(points),
        curve.fit_capped(points, curve.fit(points), cap),
        curve.fit_given_b(points, cap),
    ):
        assert np.isfinite(fitted.a_kg_m).all()
        assert np.isfinite(fitted.s_s2_m2).all()
        assert np.isfinite(fitted.rss_kg2_m2).all()
        assert (fitted.b_m_s > 0).all()
    free = curve.fit(points)
    for interval in bounds_of_everything(points, free, curve.own_scatter(free), 2.5):
        assert (interval.lo >= 0).all()
        assert (interval.hi >= interval.lo).all()
