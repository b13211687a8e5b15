"""The model of boats: against closed forms, and against known truth over many draws."""

import numpy as np
import pytest
import scipy

from pipeline.consistency.boat_model import BoatModel, Interval
from pipeline.consistency.types import judge_slope, name_spread

DRAWS = 150
ERROR = 0.012
MATTERS = 0.03


def draw(seed, boats=12, boat_sd=0.0, boat_off=0.0, slope=0.05, crews_of_last=1):
    """A type with two crews and one explaining column; the last boat may have both crews."""
    rng = np.random.default_rng(seed)
    women = np.arange(boats) % 2 == 1
    weight = rng.normal(size=boats)
    x = np.column_stack([women, ~women, weight - weight.mean()]).astype(float)
    boat = np.arange(boats)
    boat[boats - crews_of_last :] = boats - crews_of_last
    error = ERROR * np.exp(0.3 * rng.normal(size=boats))
    own = boat_sd * rng.normal(size=boats)
    y = 3.5 - 0.08 * women + slope * weight + own[boat] + error * rng.normal(size=boats)
    y[0] += boat_off
    return BoatModel(y, np.diag(error**2), x, boat)


def is_near(share, expected, draws=DRAWS):
    """Whether a share lies within four standard errors of what is expected."""
    return abs(share - expected) <= 4.0 * np.sqrt(expected * (1.0 - expected) / draws)


def judge(model):
    return name_spread(model.lower_bound(), model.upper_bound(), MATTERS)


def test_with_equal_errors_it_is_least_squares():
    model = draw(1)
    equal = BoatModel(model.y, 1e-6 * np.eye(12), model.x, model.boat)
    beta, rss, *_ = np.linalg.lstsq(model.x, model.y)
    assert equal.beta == pytest.approx(beta, rel=1e-9)
    (slope,) = equal.predict(np.array([[0.0, 0.0, 1.0]]))
    assert equal.boat_sd**2 + 1e-6 == pytest.approx(rss[0] / 9, rel=1e-9)
    sd = np.sqrt(np.linalg.inv(model.x.T @ model.x)[2, 2] * rss[0] / 9)
    assert slope.hi - slope.value == pytest.approx(sd * scipy.stats.t.ppf(0.975, 9), rel=1e-9)


def test_misfit_is_the_weighted_sum_of_squares_about_the_columns():
    model = draw(2, boat_sd=0.03)
    shares_boat = model.boat[:, None] == model.boat
    precision = np.linalg.inv(model.covariance + 0.02**2 * shares_boat)
    beta = np.linalg.solve(model.x.T @ precision @ model.x, model.x.T @ precision @ model.y)
    rest = model.y - model.x @ beta
    assert model.misfit(0.02) == pytest.approx(rest @ precision @ rest, rel=1e-9)


def test_equal_boats_are_seldom_said_to_differ_and_mostly_equal():
    verdicts = [judge(draw([3, k])) for k in range(DRAWS)]
    assert verdicts.count("differ") <= 0.05 * DRAWS
    assert verdicts.count("equal") >= 0.8 * DRAWS


def test_boats_that_differ_by_what_matters_are_seldom_said_to_be_equal():
    verdicts = [judge(draw([4, k], boat_sd=MATTERS)) for k in range(DRAWS)]
    assert verdicts.count("equal") <= 0.10 * DRAWS
    assert verdicts.count("differ") >= 0.8 * DRAWS


def test_few_boats_that_agree_by_chance_do_not_prove_equality():
    model = draw(5, boats=5)
    fitted = BoatModel(model.x @ model.beta, model.covariance, model.x, model.boat)
    assert fitted.boat_sd == 0.0
    assert judge(fitted) == "open"


@pytest.mark.parametrize("boat_sd", [0.0, 0.03, 0.10])
def test_slope_and_spread_lie_in_their_intervals(boat_sd):
    models = [draw([6, k], boat_sd=boat_sd) for k in range(DRAWS)]
    slopes = [model.predict(np.array([[0.0, 0.0, 1.0]]))[0] for model in models]
    covered = np.mean([slope.lo <= 0.05 <= slope.hi for slope in slopes])
    assert covered >= 0.95 or is_near(covered, 0.95)
    above = np.mean([model.upper_bound() >= boat_sd for model in models])
    assert above >= 0.95 or is_near(above, 0.95)
    if boat_sd > 0.0:
        assert is_near(np.mean([model.lower_bound() <= boat_sd for model in models]), 0.95)


@pytest.mark.parametrize("boat_sd", [0.0, 0.03])
def test_like_boats_seldom_stand_out(boat_sd):
    named = 0
    for k in range(DRAWS):
        outside = scipy.stats.t.ppf(1.0 - 0.025 / 12, 8)
        left_out = draw([7, k], boat_sd=boat_sd).leave_boats_out()
        named += any(np.abs(boat.deviation_sd).max() > outside for boat in left_out)
    assert named <= 0.05 * DRAWS or is_near(named / DRAWS, 0.05)


def test_a_boat_far_off_stands_out_alone():
    boats = list(draw(8, boat_off=0.15).leave_boats_out())
    outside = scipy.stats.t.ppf(1.0 - 0.025 / 12, boats[0].dof)
    assert [boat.rows.tolist() for boat in boats if (abs(boat.deviation_sd) > outside).any()] == [
        [0]
    ]


def test_what_tows_of_one_boat_differ_by_says_nothing_of_the_spread_between_boats():
    model = draw(11, crews_of_last=2)
    apart = model.y.copy()
    apart[-2:] += [0.2, -0.2]
    pulled = BoatModel(apart, model.covariance, model.x, model.boat)
    contrasts = len(np.unique(model.boat)) - model.x.shape[1]
    assert model.dof == contrasts
    assert pulled.boat_sd < 1.0


def test_an_error_that_a_season_shares_is_no_spread_between_boats():
    rng = np.random.default_rng(12)
    season = np.arange(12) // 4
    shared = 0.05 * rng.normal(size=(DRAWS, 3))[:, season]
    noise = ERROR * rng.normal(size=(DRAWS, 12))
    shares_season = season[:, None] == season
    x, boat = np.ones((12, 1)), np.arange(12)
    told_apart = {}
    for name, season_sd in (("known", 0.05), ("unknown", 0.0)):
        covariance = ERROR**2 * np.eye(12) + season_sd**2 * shares_season
        models = [BoatModel(y, covariance, x, boat) for y in 3.5 + shared + noise]
        told_apart[name] = np.mean([model.lower_bound() > 0.0 for model in models])
    assert is_near(told_apart["known"], 0.05)
    assert told_apart["unknown"] > 0.5


def test_a_boat_that_alone_determines_a_column_is_not_judged():
    model = draw(9)
    only = model.x.copy()
    only[:, 0], only[:, 1] = np.arange(12) == 3, np.arange(12) != 3
    judged = BoatModel(model.y, model.covariance, only, model.boat).leave_boats_out()
    assert 3 not in [boat.rows[0] for boat in judged]


@pytest.mark.parametrize(
    ("lo", "hi", "verdict"),
    [(0.01, 0.09, "rises"), (-0.09, -0.01, "falls"), (-0.01, 0.01, "none"), (-0.01, 0.02, "open")],
)
def test_a_slope_is_none_only_where_one_that_matters_is_left_out(lo, hi, verdict):
    assert judge_slope(Interval(0.5 * (lo + hi), lo, hi), 2.0, MATTERS) == verdict
