"""Consistency of boats: against independent implementations, known truth, and degenerate input."""

import datetime as dt
from dataclasses import replace
from itertools import product

import numpy as np
import polars as pl
import pytest
from polars.testing import assert_frame_equal
from scipy import optimize, stats
from scipy.stats import binom

from pipeline.consistency import mixed, reml, repeats, tow_speed
from pipeline.consistency.compared import compared_tows, hull_speed_statistics
from pipeline.consistency.components import variance_components
from pipeline.consistency.homogeneity import pooled_curves, type_homogeneity
from pipeline.consistency.lines import (
    LN_CW,
    quantities,
    type_lines,
    type_outliers,
)
from pipeline.consistency.observed import newest, observe
from pipeline.consistency.reml import Design, Problem, Stack, Whitened
from pipeline.consistency.repeats import repeat_pairs, reproducibility
from pipeline.consistency.tables import consistency_tables, line_tables
from pipeline.consistency.tow_speed import slow_tows, speed_trend
from pipeline.tables.schemas import conform
from tests.pipeline.consistency_fleet import NO_RACES, fleet, type_consistency


def within(observed, expected, trials):
    """Whether a share of trials lies within four standard errors of what is expected."""
    return abs(observed - expected) <= 4.0 * np.sqrt(expected * (1 - expected) / trials)


# The mixed model


def grouped_data(seed=1, n=60, boats=20, others=5):
    rng = np.random.default_rng(seed)
    boat, other = rng.integers(0, boats, n), rng.integers(0, others, n)
    boat[:boats], other[:others] = np.arange(boats), np.arange(others)
    x = np.column_stack([np.ones(n), rng.normal(size=n)])
    known = rng.uniform(0.5, 2.0, n) ** 2
    y = x @ [1.0, 0.5] + 2.0 * rng.normal(size=boats)[boat] + rng.normal(size=others)[other]
    return Problem.of(Design.of(x, boat, other), y + np.sqrt(known) * rng.normal(size=n), known)


def deviance(problem, sd):
    return Stack.of([problem]).likelihood(np.square([sd])).deviance[0]


def fit_at(problem, free, sd):
    """The model with these standard deviations."""
    return mixed.Fit(problem, free, sd, Whitened(Stack.of([problem]), np.square([sd])), 0)


def dense_deviance(problem, sd):
    """-2 log restricted likelihood from the whole covariance matrix, as in the textbooks."""
    v = np.diag(problem.variance + sd[2] ** 2)
    v += sd[0] ** 2 * (problem.design.boat[:, None] == problem.design.boat)
    v += sd[1] ** 2 * (problem.design.other[:, None] == problem.design.other)
    inverse, x = np.linalg.inv(v), problem.design.x
    information = x.T @ inverse @ x
    beta = np.linalg.solve(information, x.T @ inverse @ problem.y)
    r = problem.y - x @ beta
    return np.linalg.slogdet(v)[1] + np.linalg.slogdet(information)[1] + r @ inverse @ r


@pytest.mark.parametrize("sd", [(0.0, 0.0, 0.0), (2.0, 1.0, 0.5), (0.3, 0.0, 1.5)])
def test_deviance_equals_the_dense_formula(sd):
    problem = grouped_data()
    assert deviance(problem, sd) == pytest.approx(dense_deviance(problem, sd), rel=1e-10)


def test_a_tow_without_any_error_keeps_the_fit_exact():
    """Runs that lie exactly on their curve: beside a spread of boats no digit was left."""
    y = np.array([0.367, 0.464, 0.569, 0.481, 0.508, 0.516])
    x = np.array(
        [[1, 0, 0], [0, 1, 0.009], [0, 1, -0.091], [0, 1, 0.023], [0, 1, 0.059], [1, 0, 0]]
    )
    variance = [0.0, 9.6e-5, 1.1e-3, 3.8e-4, 2.2e-4, 7.4e-6]
    problem = Problem.of(Design.of(x, range(6), [0] * 6), y, variance)
    for sd in (0.001, 0.1, 10.0):
        dense = dense_deviance(problem, (sd, 0.0, 0.0))
        assert deviance(problem, (sd, 0.0, 0.0)) == pytest.approx(dense, abs=1e-4)
    assert np.isfinite(mixed.fit(problem, (mixed.BOAT,)).coefficients()).all()


def test_fit_finds_the_minimum_that_another_optimiser_finds():
    problem = grouped_data()
    found = mixed.fit(problem, mixed.COMPONENTS)
    other = optimize.minimize(
        lambda v: dense_deviance(problem, np.sqrt(v)), [1.0] * 3, bounds=[(0, 50)] * 3
    )
    assert deviance(problem, found.sd) == pytest.approx(other.fun, abs=1e-3)
    # The likelihood is flat at its top, so the components agree less closely than its height.
    assert found.sd == pytest.approx(np.sqrt(other.x), abs=0.02 * problem.spread)


def test_a_large_problem_carries_few_empty_rows():
    for n, rows in ((1, 1), (1020, 1024), (1025, 2048), (10_200, 10_240)):
        assert Design.of(np.ones(n), range(n)).size[:2] == (rows, rows)


@pytest.mark.parametrize(
    ("boat_sd", "other_sd", "error"), [(2.0, 1.0, 1.0), (0.1, 0.1, 1e-5), (0.0, 1.0, 1.0)]
)
def test_the_last_bits_of_the_data_do_not_reach_the_components(boat_sd, other_sd, error):
    rng = np.random.default_rng(4)
    n, boat, other = 60, np.r_[np.arange(20), rng.integers(0, 20, 40)], np.arange(60) % 6
    y = 3.4 + boat_sd * rng.normal(size=20)[boat] + other_sd * rng.normal(size=6)[other]
    y += np.sqrt(error) * rng.normal(size=n)
    x = np.column_stack([np.ones(n), rng.normal(size=n)])
    design = Design.of(x, boat, other)
    fits = [
        mixed.fit(Problem.of(design, y * noise, np.full(n, error**2)), mixed.COMPONENTS)
        for noise in (1.0, 1.0 + 4e-16 * rng.normal(size=n))
    ]
    sds, intervals = (
        np.array([getter(f) for f in fits], dtype=np.float64)
        for getter in (lambda f: f.sd, lambda f: list(f.intervals().values()))
    )
    spread = fits[0].problem.spread
    assert sds[0] == pytest.approx(sds[1], abs=1e-10 * spread)
    assert intervals[0] == pytest.approx(intervals[1], abs=1e-10 * spread, nan_ok=True)
    # A variance on its bound is none at all, not almost none.
    assert ((sds == 0.0) | (sds > 1e-3 * spread)).all()


def one_row_a_boat(variance, true_sd=0.0, seed=3):
    rng = np.random.default_rng(seed)
    x = np.column_stack([np.ones(12), rng.normal(size=12)])
    y = x @ [1.0, 2.0] + np.sqrt(variance + true_sd**2) * rng.normal(size=12)
    return Problem.of(Design.of(x, range(12)), y, variance)


def assert_same_line(fit, other):
    """Coefficients and 95 % intervals of a fitted line are those of a result of statsmodels."""
    found = fit.coefficients()
    assert found.value == pytest.approx(other.params, rel=1e-9)
    assert np.column_stack([found.lo, found.hi]) == pytest.approx(other.conf_int(), rel=1e-9)


def test_equal_errors_give_the_line_and_interval_of_ordinary_least_squares():
    from statsmodels.regression.linear_model import OLS  # noqa: PLC0415 - takes seconds to import

    problem = one_row_a_boat(np.full(12, 1e-6), true_sd=1.0)
    assert_same_line(mixed.fit(problem, (mixed.BOAT,)), OLS(problem.y, problem.design.x).fit())


def test_known_variances_give_the_line_and_interval_of_weighted_least_squares():
    from statsmodels.regression.linear_model import WLS  # noqa: PLC0415 - takes seconds to import

    problem = one_row_a_boat(np.linspace(0.5, 3.0, 12) ** 2)
    other = WLS(problem.y, problem.design.x, weights=1 / problem.variance).fit()
    assert_same_line(mixed.fit(problem, ()), other)


def test_the_mean_of_unlike_boats_is_that_of_a_meta_analysis():
    from statsmodels.stats.meta_analysis import combine_effects  # noqa: PLC0415 - takes seconds to import

    # At the same spread: statsmodels estimates it by Paule and Mandel, not by likelihood.
    problem = one_row_a_boat(np.linspace(0.5, 3.0, 12) ** 2, true_sd=2.0)
    other = combine_effects(problem.y, problem.variance, method_re="iterated", atol=1e-12)
    only_mean = replace(problem, design=Design.of(np.ones(12), range(12)))
    found = fit_at(only_mean, (mixed.BOAT,), (np.sqrt(other.tau2), 0.0, 0.0))
    assert found.beta[0] == pytest.approx(other.mean_effect_re, rel=1e-9)
    half = stats.t.ppf(0.975, 11) * other.sd_eff_w_re_hksj
    assert found.coefficients().hi[0] - found.beta[0] == pytest.approx(half, rel=1e-6)


def test_variance_components_are_those_of_another_program():
    problem = grouped_data()
    problem = replace(problem, variance=np.full(len(problem.y), 1e-9))
    groups = [
        np.eye(group.max() + 1)[group] for group in (problem.design.boat, problem.design.other)
    ]
    from statsmodels.regression.mixed_linear_model import MixedLM, VCSpec  # noqa: PLC0415 - takes seconds to import

    crossed = VCSpec(
        ["boat", "other"],
        [[[str(i) for i in range(g.shape[1])]] for g in groups],
        [[g] for g in groups],
    )
    whole = np.zeros(len(problem.y))
    other = MixedLM(problem.y, problem.design.x, whole, exog_vc=crossed).fit(reml=True)
    found = mixed.fit(problem, mixed.COMPONENTS)
    assert found.beta == pytest.approx(other.fe_params, rel=1e-3)
    assert found.sd == pytest.approx(np.sqrt([*other.vcomp, other.scale]), rel=1e-3)
    # The likelihood is flat at its top, so its height agrees more closely than the components.
    assert deviance(problem, found.sd) == pytest.approx(
        deviance(problem, np.sqrt([*other.vcomp, other.scale])), abs=1e-4
    )


def test_problems_side_by_side_are_fitted_as_each_alone():
    rng = np.random.default_rng(4)
    first = grouped_data()
    ones = [replace(first, y=first.y + s * rng.normal(size=len(first.y))) for s in (0.0, 0.5, 20)]
    problems = [*ones, replace(first, design=replace(first.design, other=None))]
    together = mixed.fit_all(problems, (mixed.BOAT, mixed.CELL))
    for problem, fit in zip(problems, together, strict=True):
        assert fit.sd == pytest.approx(mixed.fit(problem, fit.free).sd, rel=1e-9)


def test_a_mask_takes_the_problems_that_it_names():
    """`[False, True]` equals the places `[0, 1]`: such a mask once took both."""
    problem = grouped_data()
    stack = Stack.of([replace(problem, y=problem.y * scale) for scale in (1.0, 2.0)])
    for mask in ([False, True], [True, False], [True, True]):
        assert stack.take(np.array(mask)).spread.tolist() == stack.spread[mask].tolist()


def test_leaving_a_boat_out_equals_fitting_without_it():
    problem = grouped_data()
    sd = (2.0, 1.0, 0.5)
    fit = fit_at(problem, mixed.COMPONENTS, sd)
    found = fit.leave_boats_out()
    v = np.diag(problem.variance + sd[2] ** 2)
    v += sd[0] ** 2 * (problem.design.boat[:, None] == problem.design.boat)
    v += sd[1] ** 2 * (problem.design.other[:, None] == problem.design.other)
    out = problem.design.boat == 3
    inverse, x = np.linalg.inv(v[np.ix_(~out, ~out)]), problem.design.x[~out]
    information = x.T @ inverse @ x
    beta = np.linalg.solve(information, x.T @ inverse @ problem.y[~out])
    gain = v[np.ix_(out, ~out)] @ inverse
    predicted = problem.design.x[out] @ beta + gain @ (problem.y[~out] - x @ beta)
    rest = problem.design.x[out] - gain @ x
    variance = v[np.ix_(out, out)] - gain @ v[np.ix_(~out, out)]
    variance = variance + rest @ np.linalg.inv(information) @ rest.T
    assert found.error[out] == pytest.approx(problem.y[out] - predicted, rel=1e-8)
    assert found.variance[out] == pytest.approx(np.diag(variance), rel=1e-8)
    of_others = problem.y[~out] - x @ beta
    own = fit.misfit - of_others @ inverse @ of_others
    rows = problem.rows_beyond
    scale = (fit.scale * rows - own) / (rows - out.sum())
    assert found.scale[out] == pytest.approx(np.full(out.sum(), scale), rel=1e-8)


# Equal boats, equal B?

TRIALS = 100
TRIALS_OF_LINES = 40


@pytest.fixture(scope="module")
def like_boats():
    return observe(*fleet(11, TRIALS))


def test_like_boats_raise_few_false_alarms(like_boats):
    rejected = (type_homogeneity(like_boats)["p_value"].to_numpy() < 0.05).mean()
    assert within(rejected, 0.05, TRIALS)


def test_like_hulls_that_are_no_hyperbolas_raise_no_more():
    """One shape with a hump, towed at other speeds by each crew."""
    curves, tows, boats, runs = fleet(13, TRIALS, speeds_m_s=np.linspace(2.1, 2.9, 12))
    hump = 0.04 * (np.pi * (pl.col("speed_m_s") - 2.4)).cos()
    humped = runs.with_columns((pl.col("cw_kg_m") * hump.exp()).alias("cw_kg_m"))
    p = type_homogeneity(observe(curves, tows, boats, humped))["p_value"].to_numpy()
    assert within((p < 0.05).mean(), 0.05, TRIALS)


@pytest.mark.parametrize("boats", [4, 14])
def test_zeros_of_the_load_cell_make_no_hull_another(boats):
    found = type_homogeneity(observe(*fleet(14, TRIALS, boats=boats, noise=0.008, zero_sd_n=2.0)))
    assert within((found["p_value"].to_numpy() < 0.05).mean(), 0.05, TRIALS)


@pytest.mark.parametrize(
    ("boats", "cv", "least"), [(4, 0.05, 0.3), (12, 0.05, 0.5), (12, 0.10, 0.9)]
)
def test_power_is_what_is_stated_and_enough(boats, cv, least):
    hulls = fleet(12, TRIALS, boats=boats, noise=0.01, zero_sd_n=2.0, b_cv=cv)
    found = type_homogeneity(observe(*hulls))
    rejected = (found["p_value"].to_numpy() < 0.05).mean()
    assert rejected >= least
    # Stated with the estimated bend and noise, so a few points beside the sampling error.
    stated = found[f"power_at_{round(100 * cv)}pct"].mean()
    assert abs(rejected - stated) < 3 * np.sqrt(stated * (1 - stated) / TRIALS) + 0.01


def test_of_like_boats_noise_gives_the_whole_spread_and_a_and_b_go_together():
    found = type_homogeneity(observe(*fleet(10, 40, weights_kg=np.full(12, 1000.0))))
    assert found["noise_share"].median() > 0.8
    assert found["ab_correlation"].mean() == pytest.approx(
        found["ab_noise_correlation"].mean(), abs=0.1
    )
    # Linearised spread of B against the spread seen; the second is skewed upwards.
    assert found["b_noise_sd_ratio"].mean() == pytest.approx(found["b_sd_ratio"].mean(), rel=0.2)


def test_pooling_halves_the_error_of_the_bend_of_like_boats(like_boats):
    found = pooled_curves(like_boats)
    s = pl.col("q") / (1 + pl.col("q")) / pl.col("standard_speed_m_s") ** 2
    error = {
        kind: np.sqrt((((group.select(s).to_series() * 4.6**2) - 1) ** 2).mean())
        for (kind,), group in found.group_by("pooling")
    }
    assert error["partial"] <= 0.5 * error["own"]
    assert error["shared"] <= 0.5 * error["own"]


def test_sharing_the_bend_hardly_moves_cw_at_the_declared_speed(like_boats):
    found = pooled_curves(like_boats).pivot("pooling", index=["method", "tow_id"], values="cw_kg_m")
    assert (found["shared"] / found["own"] - 1).abs().max() < 0.03


# Lines, outliers, tow speed


def test_a_line_of_a_type_is_that_of_weighted_least_squares():
    observed = newest(observe(*fleet(27, boats=12, b_cv=0.05, height_sd=0.03)))
    row = type_consistency(observed).row(by_predicate=(pl.col("quantity") == LN_CW), named=True)
    y, unit = quantities(observed)[LN_CW]
    variance = unit * observed.column("run_sd_ratio") ** 2 + row["between_sd_ratio"] ** 2
    from statsmodels.regression.linear_model import WLS  # noqa: PLC0415 - takes seconds to import

    x = np.column_stack([np.ones(len(y)), np.log(observed.column("displacement_kg"))])
    other = WLS(y, x, weights=1 / variance).fit()
    assert row["slope"] == pytest.approx(other.params[1], rel=1e-6)
    assert [row["slope_lo"], row["slope_hi"]] == pytest.approx(other.conf_int()[1], rel=1e-6)


def test_boats_of_a_type_are_compared_at_one_speed_whatever_methods_lose_a_curve():
    curves, *rest = fleet(31, 2, boats=8, speeds_m_s=np.linspace(2.2, 3.2, 8))
    fewer = curves.filter((pl.col("method") == "m0000") | (pl.col("fsn_no") > "FSN003"))
    alone = [observe(fewer.filter(method=name), *rest) for name in ("m0000", "m0001")]
    speeds = {seen.table["standard_speed_m_s"][0] for seen in (*alone, observe(curves, *rest))}
    assert len(speeds) == 1


def of_two_classes(tables):
    """The fleet with its lightest half of the boats rowed by women."""
    curves, tows, boats, points = tables
    light = tows.filter(pl.col("weight_kg") < pl.col("weight_kg").median())["tow_id"]
    women = pl.when(pl.col("tow_id").is_in(light.to_list())).then(pl.lit("D"))
    return curves.with_columns(crew_class=women.otherwise(pl.lit("H"))), tows, boats, points


def test_r2_and_spread_are_those_of_the_line_as_drawn():
    """Tows weigh as they were measured, and boats with many tows less; a chart shows them alike."""
    of = {"seasons": (2012, 2014, 2016), "weights_kg": np.linspace(700, 1300, 8)}
    curves, *rest = of_two_classes(fleet(28, boats=8, height_sd=0.05, **of))
    counted = (pl.col("season") == 2016) | (pl.col("fsn_no") < "FSN003")
    observed = observe(curves.filter(counted), *rest)
    lines, drawn = type_lines(observed)
    of = {"tows": "all", "quantity": "cw_standard_kg_m", "explaining": "weight_kg"}
    row, places = lines.filter(**of).row(0, named=True), drawn.filter(**of)
    y, x = quantities(observed)["cw_standard_kg_m"][0], observed.column("weight_kg")
    about_line, about_mean = np.zeros(len(y)), np.zeros(len(y))
    for crew_class in ("D", "H"):
        mine = (observed.table["crew_class"] == crew_class).to_numpy()
        line = places.filter(crew_class=crew_class)
        about_line[mine] = y[mine] - np.interp(x[mine], line["x"], line["y"])
        about_mean[mine] = y[mine] - y[mine].mean()
    left = (about_line**2).sum()
    assert row["r2"] == pytest.approx(1 - left / (about_mean**2).sum(), rel=1e-9)
    spread = np.sqrt(left / (len(y) - 3)) / y.mean()
    assert row["residual_sd_ratio"] == pytest.approx(spread, rel=1e-9)


def test_a_slope_that_comes_from_the_class_is_none_within_men_and_within_women():
    """Men are heavier and towed faster; among men, and among women, speed says nothing of Cw."""
    speeds = np.concatenate([np.linspace(2.1, 2.3, 8), np.linspace(2.5, 2.7, 8)])
    weights = np.repeat([900.0, 1300.0], 8) + np.arange(16) * 1e-3
    of = {"boats": 16, "speeds_m_s": speeds, "weights_kg": weights, "height_sd": 0.02}
    lines, points = type_lines(observe(*of_two_classes(fleet(29, TRIALS_OF_LINES, **of))))
    found = lines.filter(tows="newest", quantity="cw_standard_kg_m")
    by_speed = found.filter(explaining="declared_speed_m_s").partition_by("within", as_dict=True)
    assert (by_speed["all",]["slope_lo"] > 0).all()
    for name in ("men", "women"):
        rows = by_speed[name,]
        assert rows["n"].unique().to_list() == rows["n_boats"].unique().to_list() == [8]
        inside = ((rows["slope_lo"] <= 0) & (rows["slope_hi"] >= 0)).mean()
        assert within(inside, 0.95, TRIALS_OF_LINES)
    assert found.filter(pl.col("explaining") != "declared_speed_m_s")["within"].unique()[0] == "all"
    drawn = points.filter(tows="newest", quantity="cw_standard_kg_m").group_by("method")
    assert drawn.len()["len"].unique().to_list() == [21]


def test_within_a_class_of_too_few_boats_no_line_is_drawn():
    lines, _ = type_lines(observe(*fleet(30, boats=6)))
    women = lines.filter(within="women", tows="newest")
    assert women["n"].unique().to_list() == [0]
    assert women["reason"].unique().to_list() == ["few_boats"]
    same = [lines.filter(within=name, explaining="declared_speed_m_s") for name in ("men", "all")]
    assert_frame_equal(*(frame.drop("within") for frame in same), check_row_order=False)


def test_intervals_of_slopes_cover_the_truth():
    lines = type_consistency(
        observe(*fleet(13, TRIALS_OF_LINES, boats=8, b_cv=0.05, height_sd=0.02))
    )
    for quantity, explaining, truth in (
        ("ln_cw_standard", "ln_displacement", 0.8),
        ("b_m_s", "weight_kg", 0.0),
        ("q", "declared_speed_m_s", 0.0),
    ):
        row = lines.filter((pl.col("quantity") == quantity) & (pl.col("explaining") == explaining))
        inside = ((row["slope_lo"] <= truth) & (truth <= row["slope_hi"])).mean()
        assert within(inside, 0.95, TRIALS_OF_LINES)


def test_the_finding_of_2015():
    # B and A do not follow weight, Cw at one speed does.
    lines = type_consistency(observe(*fleet(14, 10, boats=12, height_sd=0.01)))
    by_weight = lines.filter(pl.col("explaining") == "weight_kg")
    r2 = dict(by_weight.group_by("quantity").agg(pl.col("r2").mean()).iter_rows())
    assert r2["b_m_s"] < 0.2
    assert r2["cw_standard_kg_m"] > 0.7


def test_two_tows_of_a_boat_are_one_boat():
    lines = type_consistency(observe(*fleet(15, boats=6, seasons=(2014, 2016))))
    assert lines["n"].unique().to_list() == [6]
    assert lines["n_boats"].unique().to_list() == [6]


def with_run_points(tables, tow_id, factor):
    """One tow with all its coefficients multiplied."""
    curves, tows, boats, points = tables
    grow = pl.when(pl.col("tow_id") == tow_id).then(factor).otherwise(1.0)
    points = points.with_columns(pl.col("cw_kg_m") * grow)
    curves = curves.with_columns(pl.col("cw_kg_m") * grow, pl.col("a_kg_m") * grow)
    return curves, tows, boats, points


def test_a_boat_pulled_askew_lies_outside_and_is_named():
    for season, candidates in ((2012, ["askew"]), (2016, [])):
        tables = fleet(16, height_sd=0.01, seasons=(season,))
        found = type_outliers(observe(*with_run_points(tables, f"{season}-003", 1.15))).filter(
            "outside"
        )
        assert found["tow_id"].to_list() == [f"{season}-003"]
        assert found["candidates"].to_list() == [candidates]


@pytest.mark.parametrize("b_cv", [0.0, 0.05])
def test_no_boat_is_called_outside_too_often(b_cv):
    found = type_outliers(observe(*fleet(17, TRIALS, height_sd=0.02, b_cv=b_cv)))
    for _, rows in found.group_by("quantity"):
        alarms = rows.group_by("method").agg(pl.col("outside").any())
        assert alarms["outside"].mean() <= 0.05 + 4 * np.sqrt(0.05 * 0.95 / TRIALS)


def test_the_spread_about_the_line_of_ln_cw_is_that_of_cw():
    found = type_consistency(observe(*fleet(26, 40, boats=12, height_sd=0.05, noise=0.01)))
    lines = found.filter(pl.col("quantity") == "ln_cw_standard")
    # Noise of a tow at the standard speed: near 1 % / sqrt(6) in the middle of its runs.
    assert lines["noise_sd_ratio"].mean() == pytest.approx(0.01 / np.sqrt(6), rel=0.3)
    assert np.sqrt((lines["residual_sd_ratio"] ** 2).mean()) == pytest.approx(
        np.hypot(0.05, 0.01 / np.sqrt(6)), rel=4 / np.sqrt(2 * 40 * 10)
    )


def test_a_bend_that_follows_tow_speed_is_seen_and_none_is_not_claimed():
    speeds = np.linspace(2.1, 2.7, 12)
    plain = speed_trend(observe(*fleet(18, speeds_m_s=speeds)))
    assert (plain["slope_lo"] < 0).all()
    assert (plain["slope_hi"] > 0).all()
    curves, tows, boats, points = fleet(18, speeds_m_s=speeds)
    slow = curves.select("tow_id", "declared_speed_m_s")
    # Cw of slow tows made to rise faster: (v/v0)^(3 (2.7 - v0)).
    points = points.join(slow, on="tow_id").with_columns(
        pl.col("cw_kg_m")
        * (pl.col("speed_m_s") / pl.col("declared_speed_m_s"))
        ** (3 * (2.7 - pl.col("declared_speed_m_s")))
    )
    assert (speed_trend(observe(curves, tows, boats, points))["slope_hi"] < 0).all()


def test_slow_tows_are_singled_out_with_their_effect_on_power():
    speeds = np.full(8, 2.5)
    speeds[2] = 2.0
    tables = fleet(19, boats=8, speeds_m_s=speeds, noise=1e-4)
    found = slow_tows(observe(*tables), NO_RACES).filter("slow")
    assert found["tow_id"].to_list() == ["2016-002"]
    assert found["power_w"][0] < 60
    # The same hyperbola for all: a slow tow does no harm.
    assert found["rowed_speed_m_s"][0] == 2.5
    assert found["power_ratio_rowed"][0] == pytest.approx(1.0, abs=0.005)


def test_a_slow_tow_whose_bend_is_too_steep_asks_too_much_power_where_it_is_rowed():
    speeds = np.full(8, 2.5)
    speeds[2] = 2.0
    curves, tows, boats, points = fleet(19, boats=8, speeds_m_s=speeds, noise=1e-4)
    steeper = pl.when(tow_id="2016-002").then((pl.col("speed_m_s") / 2.0) ** 0.5).otherwise(1.0)
    points = points.with_columns(pl.col("cw_kg_m") * steeper)
    found = (
        slow_tows(observe(curves, tows, boats, points), NO_RACES).filter("slow").row(0, named=True)
    )
    # Cw grows by another (2.5 / 2)^0.5 = 12 %, and more as the hyperbola bends away.
    assert found["power_ratio_rowed"] > 1.12
    assert 1.0 < found["power_ratio_rowed_lo"] < found["power_ratio_rowed"]


def raced(tables, tow_id, speed_m_s):
    """A race of two hours by the crew of a tow."""
    line = tables[0].filter(tow_id=tow_id).select("fsn_no", "rowers", "crew_class")
    return line.with_columns(
        race_date=pl.lit(dt.date(2016, 6, 4)),
        distance_m=7200.0 * speed_m_s + 300.0,
        stream_m=300.0,
        rowing_time_s=7200.0,
    )


def test_a_slow_tow_raced_hard_says_whom_its_curve_favours():
    speeds = np.full(8, 2.5)
    speeds[2] = 2.0
    curves, tows, boats, points = fleet(19, boats=8, speeds_m_s=speeds, noise=1e-4)
    steeper = pl.when(tow_id="2016-002").then((pl.col("speed_m_s") / 2.0) ** 0.5).otherwise(1.0)
    points = points.with_columns(pl.col("cw_kg_m") * steeper)
    race = raced((curves,), "2016-002", 2.8)
    found = slow_tows(observe(curves, tows, boats, points), race).filter("slow").row(0, named=True)
    assert found["raced_speed_m_s"] == pytest.approx(2.8)
    assert (found["speed_case"], found["text_says"]) == ("low", "advantaged")
    assert found["raced_high"]
    # More power is computed than was delivered: that is the advantage.
    assert found["power_ratio_raced_lo"] > 1.1


def test_each_case_of_the_text_says_who_is_wronged():
    # Length from "v_r = 1,25 x wortel(lengte)", for tows at 2.5 m/s.
    cases = {"low": 0.60, "middle": 0.73, "high": 0.85}
    raced_at = {"faster": 1.2, "slower": 0.8, "within": 1.1}
    expected = {
        ("low", "faster"): "advantaged", ("low", "slower"): None,
        ("middle", "faster"): "disadvantaged", ("middle", "slower"): "advantaged",
        ("high", "faster"): "disadvantaged", ("high", "slower"): "disadvantaged",
    }  # fmt: skip
    both = list(product(cases, raced_at))
    curves, tows, boats, points = fleet(4, boats=len(both), speeds_m_s=np.full(len(both), 2.5))
    length = [(2.5 / cases[case] / 1.25) ** 2 for case, _ in both]
    tows = tows.with_columns(waterline_length_m=pl.Series(length))
    races = pl.concat(
        raced((curves,), tow_id, 2.5 * raced_at[pace])
        for tow_id, (_, pace) in zip(curves["tow_id"], both, strict=True)
    )
    found = slow_tows(observe(curves, tows, boats, points), races)
    said = dict(zip(found["tow_id"], found.select("speed_case", "text_says").rows(), strict=True))
    for tow_id, (case, pace) in zip(curves["tow_id"], both, strict=True):
        if pace != "within" or tow_id in said:
            assert said[tow_id] == (case, expected.get((case, pace)))


def test_a_race_before_the_tow_or_after_the_next_does_not_count():
    tables = fleet(3, boats=6, seasons=(2014, 2016, 2018))
    found = tow_speed.raced(observe(*tables), raced(tables, "2014-001", 2.4))
    assert found["tow_id"].to_list() == ["2016-001"]


# Every choice of tows


@pytest.fixture(scope="module")
def three_seasons():
    """Boats with 1,000 kg of spread in weight, towed in three seasons, one of them 15 % high."""
    curves, tows, boats, points = fleet(
        5, boats=12, seasons=(2010, 2014, 2016), weights_kg=np.linspace(700, 1300, 12), noise=0.01
    )
    high = pl.when(pl.col("tow_id").str.starts_with("2010")).then(1.15).otherwise(1.0)
    cw = [(pl.col(name) * high).alias(name) for name in curves.columns if "_kg_m" in name]
    return (
        curves.with_columns(cw),
        tows,
        boats,
        points.with_columns(pl.col("cw_kg_m") * high),
    )


def test_every_choice_of_tows_has_its_line_with_its_own_count(three_seasons):
    lines, points = type_lines(observe(*three_seasons))
    of_cw = lines.filter(quantity="cw_standard_kg_m", explaining="weight_kg")
    assert dict(of_cw.select("tows", "n").iter_rows()) == {
        "all": 36, "newest": 12, "2010": 12, "2014": 12, "2016": 12, "2014:2016": 24,
    }  # fmt: skip
    # Of repeats only 12 boats count, and a season that reads high spoils the line of all tows.
    assert of_cw["n_boats"].unique().to_list() == [12]
    explained = dict(of_cw.select("tows", "r2").iter_rows())
    assert explained["all"] < min(explained["newest"], explained["2010"])
    drawn = points.filter(tows="2014", quantity="cw_standard_kg_m", explaining="weight_kg")
    assert drawn["x"].min() == 700
    assert drawn["x"].max() == 1300
    slope = of_cw.filter(tows="2014")["slope"][0]
    assert (drawn["y"].max() - drawn["y"].min()) / 600 == pytest.approx(slope, rel=1e-6)
    assert (drawn["lo"] < drawn["y"]).all()


def test_repeats_of_few_boats_do_not_narrow_a_line():
    tables = fleet(7, boats=6, seasons=tuple(range(2009, 2019)), noise=0.005, height_sd=0.05)
    lines, _ = type_lines(observe(*tables))
    width = lines.filter(quantity="cw_standard_kg_m", explaining="weight_kg").select(
        "tows", width=pl.col("slope_hi") - pl.col("slope_lo")
    )
    of = dict(width.iter_rows())
    assert of["all"] > 0.5 * of["newest"]


def test_a_tow_far_too_slow_for_the_standard_speed_is_there_and_marked():
    speeds = np.full(8, 2.5)
    speeds[2] = 2.0
    found = compared_tows(observe(*fleet(19, boats=8, speeds_m_s=speeds, noise=1e-4)))
    assert found.filter("beyond_curve")["tow_id"].to_list() == ["2016-002"]
    assert found.filter("slow")["tow_id"].to_list() == ["2016-002"]
    one = found.filter("slow").row(0, named=True)
    assert one["standard_speed_m_s"] == 2.5
    assert one["cw_standard_kg_m"] == pytest.approx(one["expected_cw_kg_m"], rel=0.02)


def test_one_tow_pulled_askew_is_named_among_all_tows(three_seasons):
    curves, tows, boats, points = three_seasons
    askew = pl.when(tow_id="2014-004").then(1.2).otherwise(1.0)
    cw = [(pl.col(name) * askew).alias(name) for name in curves.columns if "_kg_m" in name]
    found = compared_tows(
        observe(
            curves.with_columns(cw), tows, boats, points.with_columns(pl.col("cw_kg_m") * askew)
        ),
    )
    # The season that reads high does not put all its tows outside.
    assert found.filter("outside")["tow_id"].to_list() == ["2014-004"]


def test_b_is_told_apart_from_hull_speed():
    found = compared_tows(observe(*fleet(19, boats=12, noise=0.002)))
    row = hull_speed_statistics(found).filter(tows="all", boat_type="all").row(0, named=True)
    hull = 1.25 * 8.2**0.5
    assert row["b_ratio_lo"] < 4.6 / hull < row["b_ratio_hi"]
    assert row["b_is_hull_speed"] is False
    at_hull = found.with_columns(pl.col("b_hull_ratio") * hull / 4.6)
    assert hull_speed_statistics(at_hull)["b_is_hull_speed"].all()


# Repeats


def test_reproducibility_recovers_the_spread_of_a_tow():
    tables = fleet(20, boats=60, seasons=(2014, 2016, 2018), tow_sd=0.03, noise=0.001)
    pairs = repeat_pairs(tables[0], tables[1])
    found = reproducibility(pairs, observe(*tables)).row(0, named=True)
    assert found["scope"] == "all"
    assert found["n_pairs"] == 120
    # Pairs share a tow, so the spread rests on about 90 instead of 120 differences.
    assert found["sd_ratio"] == pytest.approx(0.03, rel=4 / np.sqrt(2 * 90))
    assert found["run_sd_ratio"] == pytest.approx(0.001, rel=4 / np.sqrt(2 * 720))


def test_e_n_is_the_difference_in_both_intervals():
    curves, tows, *_ = fleet(21, boats=1, seasons=(2014, 2016), speeds_m_s=[2.5])
    pair = repeat_pairs(curves, tows).row(0, named=True)
    old, new = curves.sort("season").iter_rows(named=True)
    half = [0.5 * np.log(c["cw_hi_kg_m"] / c["cw_lo_kg_m"]) for c in (old, new)]
    difference = np.log(new["cw_kg_m"] / old["cw_kg_m"])
    assert pair["e_n"] == pytest.approx(difference / np.hypot(*half))


def test_a_pair_is_compared_by_the_instruments_of_other_boats():
    curves, tows, *_ = fleet(21, boats=1, seasons=(2014, 2016), speeds_m_s=[2.5])
    by_others = curves.with_columns(
        (pl.col("cw_kg_m") * pl.col("season").replace_strict({2014: 1.01, 2016: 1.0})).alias(
            "cw_others_kg_m"
        )
    )
    own, others = (repeat_pairs(c, tows)["ln_ratio"][0] for c in (curves, by_others))
    assert others == pytest.approx(own - np.log(1.01))


def test_pairs_that_share_a_tow_are_not_counted_as_independent():
    """Ten tows of one boat: as independent pairs the interval covered 92 %."""
    rng = np.random.default_rng(32)
    tow_id = [f"{year}-1" for year in range(2009, 2019)]
    truth, trials, covered = 0.01, 1000, 0
    for _ in range(trials):
        ln_ratio = np.diff(truth * rng.normal(size=10))
        pairs = pl.DataFrame(
            {"tow_id_before": tow_id[:-1], "tow_id": tow_id[1:], "ln_ratio": ln_ratio, "e_n": 0.0}
        )
        spread = repeats._spread(pairs)
        covered += spread["lo"] <= truth <= spread["hi"]
    low, high = binom.ppf([0.001, 0.999], trials, 0.95)
    assert low <= covered <= high


def test_no_pair_across_an_alteration():
    curves, tows, *_ = fleet(22, boats=2, seasons=(2014, 2016))
    tows = tows.with_columns((pl.col("tow_id") == "2016-001").alias("altered"))
    assert repeat_pairs(curves, tows)["tow_id"].to_list() == ["2016-000"]


def test_a_boat_ends_at_an_alteration_in_lines_too():
    """One boat rebuilt in between weighs as much as two boats, and no line hangs on its change."""
    tables = fleet(31, boats=12, seasons=(2014, 2016), height_sd=0.06)
    curves, tows, boats, run_points = tables
    gone = ["2016-010", "2014-011"]
    curves, tows, run_points = (
        frame.filter(~pl.col("tow_id").is_in(gone)) for frame in (curves, tows, run_points)
    )

    def slopes(renamed, altered):
        now = {"FSN011": "FSN010"} if renamed else {}
        named = (frame.with_columns(pl.col("fsn_no").replace(now)) for frame in (curves, tows))
        of_curves, of_tows = named
        of_tows = of_tows.with_columns(altered=(pl.col("tow_id") == "2016-011") & altered)
        lines = type_lines(observe(of_curves, of_tows, boats, run_points))[0]
        return lines.filter(tows="all").drop("n_boats").sort("quantity", "explaining")

    apart = slopes(renamed=False, altered=False)
    assert_frame_equal(slopes(renamed=True, altered=True), apart)
    assert not slopes(renamed=True, altered=False).equals(apart)


def test_a_falling_curve_is_compared_at_its_own_height():
    curves, tows, *_ = fleet(23, boats=1, seasons=(2014, 2016), speeds_m_s=[2.5])
    falling = curves.with_columns(
        pl.lit(None, pl.Float64).alias("b_m_s"), (1.1 * pl.col("cw_kg_m")).alias("a_kg_m")
    )
    old, new = falling.sort("season")["cw_kg_m"]
    assert repeat_pairs(falling, tows)["ln_ratio"][0] == pytest.approx(np.log(new / old))


def test_variance_components_recover_the_truth():
    tables = fleet(
        24,
        boats=60,
        seasons=range(2009, 2019),
        height_sd=0.05,
        season_sd=0.03,
        tow_sd=0.015,
        weights_kg=np.full(60, 1000.0),
    )
    found = variance_components(observe(*tables)).filter(pl.col("scope") == "fleet")
    for name, sd, dof in (("boat", 0.05, 59), ("season", 0.03, 9), ("boat_season", 0.015, 500)):
        row = found.row(by_predicate=pl.col("component") == name, named=True)
        assert row["sd_ratio"] == pytest.approx(sd, rel=4 / np.sqrt(2 * dof))
        assert row["lo"] < row["sd_ratio"] < row["hi"]
    assert found["share"].sum() == pytest.approx(1.0)


def test_boats_are_told_apart_at_one_speed():
    # Cw grows with the speed of comparison; boats that differ in nothing else do not differ.
    tables = fleet(
        27, seasons=(2014, 2016, 2018), weights_kg=np.full(12, 1000.0),
        speeds_m_s=np.linspace(2.1, 2.7, 12),
    )  # fmt: skip
    found = variance_components(observe(*tables)).filter(pl.col("component") == "boat")
    assert found["sd_ratio"].max() < 0.01


def test_the_classes_told_apart_are_the_boats_spread_over_that_of_their_tows():
    tables = fleet(28, boats=40, seasons=(2014, 2016), height_sd=0.05, noise=0.02)
    found = consistency_tables(*tables, NO_RACES)
    boats = found["variance_components"].filter(scope="within_type", component="boat")
    row = found["reproducibility"].filter(scope="2014-").row(0, named=True)
    expected = 1.41 * boats["sd_ratio"].item() / row["sd_ratio"]
    assert row["distinct_categories"] == pytest.approx(expected)
    assert found["reproducibility"].filter(scope="2009-2011")["distinct_categories"].item() is None


# Degenerate input: nulls and a reason, never NaN, never a warning (warnings are errors here)


def undetermined(tables):
    curves, *rest = tables
    return curves.with_columns(pl.lit(None, pl.Float64).alias("b_m_s")), *rest


CASES = {
    "no tows": tuple(frame.clear() for frame in fleet(30)),
    "one boat": fleet(31, boats=1),
    "two boats": fleet(32, boats=2),
    "no type": fleet(33, boat_type=None),
    "equal weights": fleet(34, weights_kg=np.full(12, 1000.0), speeds_m_s=np.full(12, 2.5)),
    "no weights": fleet(35, weights_kg=np.full(12, np.nan)),
    "no B": undetermined(fleet(36)),
    "no scatter": fleet(37, noise=0.0, weights_kg=np.full(12, 1000.0)),
    "two seasons": fleet(38, boats=4, seasons=(2014, 2016)),
}


def everything(*tables):
    return line_tables(observe(*tables)) | consistency_tables(*tables, NO_RACES)


@pytest.mark.parametrize("case", CASES)
def test_degenerate_input_gives_no_nan_and_fits_the_schemas(case):
    for name, frame in everything(*CASES[case]).items():
        checked = conform(name, frame)
        for column in checked.select(pl.col(pl.Float64)):
            assert not column.is_nan().any(), (name, column.name)
            assert not column.is_infinite().any(), (name, column.name)


@pytest.mark.parametrize(
    ("case", "quantity", "explaining", "reason", "n"),
    [
        ("one boat", "cw_kg_m", "weight_kg", "few_boats", 1),
        ("two boats", "cw_kg_m", "weight_kg", "few_boats", 2),
        ("no type", "cw_kg_m", "weight_kg", "no_type", 12),
        ("equal weights", "cw_kg_m", "weight_kg", "equal_values", 12),
        ("no weights", "cw_kg_m", "weight_kg", "few_boats", 0),
        ("no weights", "ln_cw_standard", "ln_displacement", "few_boats", 0),
        ("no B", "b_m_s", "weight_kg", "few_boats", 0),
    ],
)
def test_where_there_is_no_line_the_reason_is_said(case, quantity, explaining, reason, n):
    lines = type_consistency(observe(*CASES[case]))
    row = lines.row(
        by_predicate=(pl.col("quantity") == quantity) & (pl.col("explaining") == explaining),
        named=True,
    )
    assert (row["reason"], row["n"], row["slope"]) == (reason, n, None)


SEARCHED = {
    "type_lines": "slope",
    "speed_trend": "slope",
    "predicted_cw": "predicted_cw_kg_m",
    "variance_components": "sd_ratio",
}


@pytest.mark.parametrize(
    ("module", "limit", "unsettled"),
    [
        (reml, "MAX_ITERATIONS", {*SEARCHED}),
        (reml, "MAX_HALVINGS", {*SEARCHED}),
        (mixed, "MAX_STEPS", {"variance_components"}),
    ],
)
def test_a_search_that_does_not_come_to_rest_says_so(module, limit, unsettled, monkeypatch):
    """No number that rests on it is given, and every table fits its schema."""
    tables = fleet(41, boats=24, seasons=(2014, 2016, 2018), height_sd=0.03, season_sd=0.02)
    settled = everything(*tables)
    monkeypatch.setattr(module, limit, 0)
    forced = {name: conform(name, frame) for name, frame in everything(*tables).items()}
    for name, number in SEARCHED.items():
        assert settled[name].filter(reason="not_settled").is_empty()
        assert settled[name][number].count() > 0
        mute = forced[name].filter(reason="not_settled")
        assert (mute.height > 0) == (name in unsettled), name
        assert mute[number].count() == 0


def test_the_order_of_rows_does_not_matter():
    tables = fleet(40, boats=8, seasons=(2014, 2016, 2018), height_sd=0.03, season_sd=0.02)
    shuffled = [frame.sample(fraction=1.0, shuffle=True, seed=1) for frame in tables]
    ours, theirs = everything(*tables), everything(*shuffled)
    for name, frame in ours.items():
        assert conform(name, frame).equals(conform(name, theirs[name])), name
