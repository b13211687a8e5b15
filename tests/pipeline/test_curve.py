"""The batch fit against an independent solver, its corner cases, and coverage by simulation."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from pipeline import curve
from pipeline.errors import BrokenPromiseError
from pipeline.quantiles import LEVEL

RUN_RATIOS = np.array([0.9, 1.0, 1.1, 0.9, 1.0, 1.1])


def noisy_points(seed, n_fits, r=(0.1, 0.45), noise=(0.01, 0.03)):
    """Six run points a curve with known truth: points, C0, s and declared speed."""
    rng = np.random.default_rng(seed)
    v0 = rng.uniform(2.0, 3.0, n_fits)
    c0 = rng.uniform(15.0, 60.0, n_fits)
    ratio = rng.uniform(*r, n_fits)
    a, s = curve.from_c0_q(c0, ratio / (1 - ratio), v0)
    speed = v0[:, None] * RUN_RATIOS * rng.normal(1.0, 0.005, (n_fits, 6))
    error = rng.uniform(*noise, (n_fits, 1)) * rng.normal(size=(n_fits, 6))
    cw = curve.cw(a[:, None], s[:, None], speed) * (1 + error)
    return curve.Points.from_arrays(speed, cw), c0, s, v0


def scipy_fit(speed, cw):
    """A and s by `least_squares`, in C0 and q at the middle speed, where it is well scaled.

    It stops when the sum of squares no longer changes, which leaves up to 2e-8 in the parameters
    of scattered points; plain Gauss-Newton steps take its answer the rest of the way.
    """
    x = (speed / speed.mean()) ** 2 - 1

    def residuals(p):
        return p[0] / (1 - p[1] * x) - cw

    def jacobian(p):
        g = 1 / (1 - p[1] * x)
        return np.stack([g, p[0] * x * g * g], axis=1)

    solution = least_squares(
        residuals, [cw.mean(), 0.1], jacobian, method="lm", xtol=1e-15, ftol=1e-15, gtol=1e-15
    ).x
    for _ in range(3):
        solution = solution - np.linalg.lstsq(jacobian(solution), residuals(solution))[0]
    return curve.from_c0_q(*solution, speed.mean())


def test_equals_scipy():
    # Wider than the field, with falling curves; the benchmark compares 10,000 cases.
    points, *_ = noisy_points(seed=1, n_fits=500, r=(-0.3, 0.6), noise=(0.0, 0.05))
    fitted = curve.fit(points)
    cases = zip(points.speed_m_s, points.cw_kg_m, strict=True)
    a, s = np.transpose([scipy_fit(speed, cw) for speed, cw in cases])
    assert fitted.converged.all()
    assert fitted.a_kg_m == pytest.approx(a, rel=1e-8)
    # s passes through zero, so its error is measured on the scale 1 / v^2 it works on.
    assert np.abs((fitted.s_s2_m2 - s) * points.speed_m_s.mean(axis=1) ** 2).max() < 1e-8


def test_a_curve_does_not_depend_on_its_batch(monkeypatch):
    points, *_ = noisy_points(seed=2, n_fits=25)
    whole = curve.fit(points)
    monkeypatch.setattr(curve, "CHUNK_FITS", 10)
    in_chunks = curve.fit(points)
    for i, single in enumerate(map(curve.Points.from_arrays, points.speed_m_s, points.cw_kg_m)):
        alone = curve.fit(single)
        assert alone.a_kg_m[0] == whole.a_kg_m[i] == in_chunks.a_kg_m[i]
        assert alone.s_s2_m2[0] == whole.s_s2_m2[i] == in_chunks.s_s2_m2[i]


@pytest.mark.parametrize(
    ("speed", "cw"),
    [
        ([2.0, 2.0, 2.0], [30.0, 31.0, 32.0]),  # one speed
        ([2.0, 2.5, 3.0], [40.0, 10.0, 5.0]),  # force itself falls with speed
        ([2.5], [30.0]),
    ],
)
def test_points_that_determine_no_curve_are_flagged_and_flat(speed, cw):
    fitted = curve.fit(curve.Points.from_arrays(speed, cw))
    assert not fitted.converged[0]
    assert not fitted.b_determined[0]
    assert fitted.a_kg_m[0] == pytest.approx(np.mean(cw))
    assert fitted.s_s2_m2[0] == 0.0
    points = curve.Points.from_arrays(speed, cw)
    scatter = curve.own_scatter(fitted)
    assert curve.b_interval(points, fitted, scatter).hi[0] == np.inf
    assert curve.cw_interval(points, fitted, scatter, 2.5) == (0.0, np.inf)


def test_a_search_that_does_not_come_to_rest_gives_no_curve(monkeypatch):
    points, *_ = noisy_points(seed=4, n_fits=5)
    monkeypatch.setattr(curve, "MAX_ITERATIONS", 2)
    unsettled = curve.fit(points)
    assert not unsettled.converged.any()
    assert unsettled.a_kg_m == pytest.approx(points.cw_kg_m.mean(axis=1))


def test_two_points_are_interpolated_and_have_unbounded_intervals():
    points = curve.Points.from_arrays([2.0, 3.0], [20.0, 30.0])
    fitted = curve.fit(points)
    assert curve.cw(fitted.a_kg_m, fitted.s_s2_m2, [2.0, 3.0]) == pytest.approx([20.0, 30.0])
    scatter = curve.own_scatter(fitted)
    assert curve.b_interval(points, fitted, scatter) == (pytest.approx(3.0), np.inf)
    assert curve.cw_interval(points, fitted, scatter, 2.5) == (0.0, np.inf)


def test_from_b_on_the_resistance_is_infinite():
    assert curve.cw(30.0, curve.s_of_b(4.0), [2.0, 4.0, 5.0]) == pytest.approx([40, np.inf, np.inf])


def test_capped_curve_has_the_cap_and_a_refitted_height():
    points, *_ = noisy_points(seed=4, n_fits=200, r=(-0.1, 0.4))
    free, cap = curve.fit(points), 5.0
    capped = curve.fit_capped(points, curve.fit(points), cap)
    met = ~(free.b_m_s < cap)
    assert 20 < met.sum() < 180, "both kinds belong to the cases"
    assert capped.b_capped.tolist() == met.tolist()
    assert capped.b_m_s[met] == pytest.approx(cap)
    given = curve.fit_given_b(points, cap)
    assert capped.a_kg_m[met] == pytest.approx(given.a_kg_m[met])
    assert capped.a_kg_m[~met].tolist() == free.a_kg_m[~met].tolist()
    assert np.all(capped.rss_kg2_m2 >= free.rss_kg2_m2)


def test_given_b_is_linear_least_squares():
    points, *_ = noisy_points(seed=5, n_fits=1)
    basis = 1 / (1 - (points.speed_m_s[0] / 4.5) ** 2)
    (a,), (rss,), *_ = np.linalg.lstsq(basis[:, None], points.cw_kg_m[0], rcond=None)
    fitted = curve.fit_given_b(points, 4.5)
    assert fitted.a_kg_m[0] == pytest.approx(a)
    assert fitted.rss_kg2_m2[0] == pytest.approx(rss)


def test_covariance_is_that_of_the_linearised_fit():
    points, *_, v0 = noisy_points(seed=6, n_fits=1)
    fitted = curve.fit(points)
    scatter = curve.own_scatter(fitted)
    c0, q = curve.to_c0_q(fitted.a_kg_m, fitted.s_s2_m2, v0)

    def model(p):
        return curve.cw(*curve.from_c0_q(p[0], p[1], v0[0]), points.speed_m_s[0])

    step = np.array([c0[0], q[0]]) * 1e-5
    jacobian = np.stack(
        [(model([c0[0] + dc, q[0] + dq]) - model([c0[0] - dc, q[0] - dq])) / (2 * (dc + dq))
         for dc, dq in ((step[0], 0.0), (0.0, step[1]))], axis=1)  # fmt: skip
    expected = np.linalg.inv(jacobian.T @ jacobian) * scatter.variance_kg2_m2[0]
    errors = curve.covariance(points, fitted, scatter, v0)
    assert errors.c0_variance_kg2_m2[0] == pytest.approx(expected[0, 0], rel=1e-6)
    assert errors.q_variance[0] == pytest.approx(expected[1, 1], rel=1e-6)
    assert errors.c0_q_covariance_kg_m[0] == pytest.approx(expected[0, 1], rel=1e-6)


def test_profile_bounds_lie_where_the_sum_of_squares_says():
    points, *_ = noisy_points(seed=8, n_fits=300)
    fitted = curve.fit(points)
    scatter = curve.own_scatter(fitted)
    interval = curve.b_interval(points, fitted, scatter)
    t = 2.7764451  # 95 %, 4 degrees of freedom, from a printed table
    limit = fitted.rss_kg2_m2 + t**2 * scatter.variance_kg2_m2
    finite = np.isfinite(interval.hi)
    assert 30 < finite.sum() < 300, "both kinds belong to the cases"
    at_lo = curve.fit_given_b(points, interval.lo).rss_kg2_m2
    at_hi = curve.fit_given_b(points, interval.hi).rss_kg2_m2
    assert at_lo == pytest.approx(limit, rel=1e-6)
    assert at_hi[finite] == pytest.approx(limit[finite], rel=1e-6)
    assert np.all(at_hi[~finite] <= limit[~finite])


@pytest.mark.parametrize("pooled", [False, True])
def test_intervals_cover_the_truth_as_often_as_they_say(pooled):
    n_fits, level = 2000, LEVEL
    points, c0, s, v0 = noisy_points(seed=10, n_fits=n_fits, noise=(0.02, 0.02))
    if not pooled:
        points, c0, s, v0 = noisy_points(seed=11, n_fits=n_fits)
    fitted = curve.fit(points)
    scatter = curve.own_scatter(fitted)
    if pooled:
        # As a season would pool it: the noise is proportional to Cw, so its ratio is pooled.
        ratio = np.mean(scatter.variance_kg2_m2 / fitted.cw_at(v0) ** 2)
        scatter = curve.Scatter(ratio * fitted.cw_at(v0) ** 2, np.full(n_fits, np.inf))
    at_v0 = curve.cw_interval(points, fitted, scatter, v0)
    b = curve.b_interval(points, fitted, scatter)
    true_b = 1 / np.sqrt(s)
    # Three standard errors of a share of n_fits trials.
    tolerance = 3 * np.sqrt(level * (1 - level) / n_fits)
    assert np.mean((at_v0.lo <= c0) & (c0 <= at_v0.hi)) == pytest.approx(level, abs=tolerance)
    assert np.mean((b.lo <= true_b) & (true_b <= b.hi)) == pytest.approx(level, abs=tolerance)


@pytest.mark.parametrize("bad", [np.nan, np.inf, 0.0, -30.0])
def test_a_used_point_that_is_no_measurement_is_refused(bad):
    cw = np.array([[30.0, 31.0, 32.0], [30.0, bad, 32.0]])
    speed = np.full((2, 3), [2.0, 2.5, 3.0])
    with pytest.raises(BrokenPromiseError, match="first is curve 1"):
        curve.Points.from_arrays(speed, cw)
    assert curve.fit(curve.Points.from_arrays(speed, cw, np.isin(cw, bad, invert=True) & (cw > 0)))
