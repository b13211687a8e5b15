"""The mixed model: against the formulas of textbooks and another optimiser."""

import numpy as np
import pytest
from scipy import optimize, stats

from pipeline.consistency import mixed
from pipeline.consistency.mixed import Problem


def grouped_data(seed=1, n=60, boats=20, others=5, known=None):
    rng = np.random.default_rng(seed)
    boat, other = rng.integers(0, boats, n), rng.integers(0, others, n)
    boat[:boats], other[:others] = np.arange(boats), np.arange(others)
    x = np.column_stack([np.ones(n), rng.normal(size=n)])
    error = rng.uniform(0.5, 2.0, n) ** 2
    y = x @ [1.0, 0.5] + 2.0 * rng.normal(size=boats)[boat] + rng.normal(size=others)[other]
    y += np.sqrt(error) * rng.normal(size=n)
    return Problem(y, error if known is None else np.full(n, known), x, boat, other)


def likelihood(problem, sd):
    return mixed.Fit(problem, np.square(sd)).likelihood


def covariance_of(problem, sd):
    boat, other, cell = np.square(sd)
    of_boat = boat * (problem.boat[:, None] == problem.boat)
    of_other = other * problem.other @ problem.other.T
    return np.diag(problem.variance + cell) + of_boat + of_other


def dense_deviance(problem, sd):
    """-2 log restricted likelihood from the whole covariance matrix, as in the textbooks."""
    v, x = covariance_of(problem, sd), problem.x
    inverse = np.linalg.inv(v)
    information = x.T @ inverse @ x
    r = problem.y - x @ np.linalg.solve(information, x.T @ inverse @ problem.y)
    return np.linalg.slogdet(v)[1] + np.linalg.slogdet(information)[1] + r @ inverse @ r


@pytest.mark.parametrize("sd", [(0.0, 0.0, 0.0), (2.0, 1.0, 0.5), (0.3, 0.0, 1.5)])
def test_deviance_and_its_slope_equal_the_dense_formula(sd):
    problem = grouped_data()
    found = likelihood(problem, sd)
    assert found.deviance == pytest.approx(dense_deviance(problem, sd), rel=1e-10)
    slope = optimize.approx_fprime(
        np.square(sd) + 1e-3, lambda v: dense_deviance(problem, np.sqrt(v)), 1e-6
    )
    at = likelihood(problem, np.sqrt(np.square(sd) + 1e-3))
    assert at.gradient == pytest.approx(slope, rel=1e-3, abs=1e-3)


def one_row_a_boat(variance, true_sd=0.0, seed=3):
    rng = np.random.default_rng(seed)
    x = np.column_stack([np.ones(12), rng.normal(size=12)])
    y = x @ [1.0, 2.0] + np.sqrt(variance + true_sd**2) * rng.normal(size=12)
    return Problem(y, variance, x, range(12))


def least_squares(problem, weights):
    """Coefficients and 95 % intervals of weighted least squares, as in the textbooks."""
    information = problem.x.T @ (weights[:, None] * problem.x)
    beta = np.linalg.solve(information, problem.x.T @ (weights * problem.y))
    misfit = (weights * (problem.y - problem.x @ beta) ** 2).sum()
    dof = len(problem.y) - len(beta)
    sd = np.sqrt(np.diag(np.linalg.inv(information)) * misfit / dof)
    return beta, beta[:, None] + stats.t.ppf(0.975, dof) * sd[:, None] * [-1, 1]


def test_equal_errors_give_ordinary_and_known_ones_weighted_least_squares():
    equal = one_row_a_boat(np.full(12, 1e-6), true_sd=1.0)
    known = one_row_a_boat(np.linspace(0.5, 3.0, 12) ** 2)
    for problem, free, weights in (
        (equal, (mixed.BOAT,), np.ones(12)),
        (known, (), 1.0 / known.variance),
    ):
        found = mixed.fit(problem, *free).coefficients()
        beta, interval = least_squares(problem, weights)
        assert found.value == pytest.approx(beta, rel=1e-9)
        assert np.column_stack([found.lo, found.hi]) == pytest.approx(interval, rel=1e-9)


def test_intervals_of_components_cover_the_truth():
    rng, trials, true = np.random.default_rng(5), 60, (0.05, 0.03, 0.015)
    boat, other = np.repeat(np.arange(20), 4), np.arange(80) % 8
    found = []
    for _ in range(trials):
        of_boat, of_other, cell = (
            sd * rng.normal(size=n) for sd, n in zip(true, (20, 8, 80), strict=True)
        )
        y = 3.5 + of_boat[boat] + of_other[other] + cell + 0.01 * rng.normal(size=80)
        problem = Problem(y, np.full(80, 1e-4), np.ones((80, 1)), boat, other)
        found.append(mixed.fit(problem, *mixed.COMPONENTS).intervals())
    for name, sd in zip(mixed.COMPONENTS, true, strict=True):
        inside = [lo <= sd <= (np.inf if hi is None else hi) for lo, hi in (f[name] for f in found)]
        # Four standard errors of a share of 0.95.
        assert abs(np.mean(inside) - 0.95) <= 4 * np.sqrt(0.95 * 0.05 / trials)


def test_leaving_a_boat_out_equals_fitting_without_it():
    problem, sd = grouped_data(), (2.0, 1.0, 0.5)
    fit = mixed.Fit(problem, np.square(sd))
    error, variances, scales = fit.leave_boats_out()
    v, out = covariance_of(problem, sd), problem.boat == 3
    inverse, x = np.linalg.inv(v[np.ix_(~out, ~out)]), problem.x[~out]
    information = x.T @ inverse @ x
    beta = np.linalg.solve(information, x.T @ inverse @ problem.y[~out])
    gain = v[np.ix_(out, ~out)] @ inverse
    predicted = problem.x[out] @ beta + gain @ (problem.y[~out] - x @ beta)
    rest = problem.x[out] - gain @ x
    variance = v[np.ix_(out, out)] - gain @ v[np.ix_(~out, out)]
    variance = variance + rest @ np.linalg.inv(information) @ rest.T
    assert error[out] == pytest.approx(problem.y[out] - predicted, rel=1e-8)
    assert variances[out] == pytest.approx(np.diag(variance), rel=1e-8)
    of_others = problem.y[~out] - x @ beta
    own = fit.misfit - of_others @ inverse @ of_others
    scale = (fit.scale * problem.rows_beyond - own) / (problem.rows_beyond - out.sum())
    assert scales[out] == pytest.approx(np.full(out.sum(), scale), rel=1e-8)
