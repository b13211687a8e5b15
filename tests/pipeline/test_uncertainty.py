"""Uncertainty of run points and the budget of a tow."""

import numpy as np
import polars as pl
import pytest
from scipy import stats

from pipeline.uncertainty.propagation import (
    Assumed,
    combine,
    list_components,
    make_budget,
    pool_scatter,
)


def tows(**changed):
    usual = {
        "tow_id": "2014-001", "speed_ratio": 1.0, "season": 2014, "part": 0,
        "kappa": 2.86,
        "misfit_ratio": 0.0, "wind_ln_sd": None,
        "random_ratio": 0.0061, "random_dof": 96.0, "force_n": 250.0,
        "calibrated": True, "log_sd": 0.0,
        "tow_log_sd": 0.0,
        "air_ratio": 0.025, "air_per_coefficient": 0.05,
        "wind_measured": True, "still_air_ratio": 0.025, "temperature_known": False,
        "water_off_c": 0.0, "mass_ln_sd": 0.0, "water_change_ratio": 0.0,
        "wind_coefficient": Assumed().wind_coefficient,
        "unmeasured_wind": Assumed().unmeasured_wind,
        "askew_ratio": None,
        "force_sd": None,
    }  # fmt: skip
    return pl.DataFrame([usual | changed])


def budget(rows, assumed=None):
    return make_budget(rows, assumed or Assumed())


def u_of(held, component):
    return held.filter(pl.col("component") == component)["u_ratio"][0]


def test_residuals_are_pooled_over_the_season_with_their_degrees_of_freedom():
    rng = np.random.default_rng(5)
    season = np.repeat([2010, 2014], 500)
    speed = np.tile([0.9, 1.0, 1.1], 2)
    design = np.column_stack([np.ones(6), speed])
    noise = rng.standard_normal((1000, 6)) * np.where(season == 2010, 0.02, 0.01)[:, None]
    residual = noise - noise @ np.linalg.pinv(design).T @ design.T
    used = np.ones_like(residual, bool)
    sd, dof = pool_scatter(residual, used, season)
    assert sd[[0, -1]] == pytest.approx([0.02, 0.01], rel=0.05)
    assert dof.tolist() == [2000.0] * 1000
    used[:500, 2:] = False
    sd, dof = pool_scatter(residual, used, season)
    assert np.isinf(sd[0])
    assert dof[0] == 0


def test_the_budget_of_a_usual_tow():
    """The project's note on uncertainties, r = 0.3: its figures in per cent, to the last digit."""
    held = budget(tows())
    assert held["component"].to_list() == list(list_components(Assumed()))
    printed = {
        "calibration": 1.03, "force": 0.30, "wind": 0.58,
        "anemometer": 0.25, "random": 0.61, "mass": 0.60, "temperature": 0.63,
        "straightness": 0.20,
    }  # fmt: skip
    found = {name: 100 * u_of(held, name) for name in printed}
    assert found == pytest.approx(printed, abs=0.006)
    assert 100 * combine(tows(), Assumed())["u_ratio"][0] == pytest.approx(1.6, abs=0.06)


def test_keys_say_what_tows_have_in_common():
    rows = [tows(), tows(tow_id="2014-002"), tows(tow_id="2015-001", season=2015)]
    held = budget(pl.concat(rows))
    keys = dict(held.group_by("component").agg(pl.col("key").n_unique()).iter_rows())
    one_each = {"between_tows", "misfit", "random", "calibration", "mass", "straightness"}
    assert {name for name, count in keys.items() if count == 3} == one_each
    assert {name for name, count in keys.items() if count == 1} == {"wind"}
    season = {"force", "anemometer", "temperature", "season_log"}
    assert {name for name, count in keys.items() if count == 2} == season


def test_interval_takes_few_degrees_of_freedom_into_account():
    total = combine(tows(random_ratio=0.05, random_dof=4.0), Assumed()).row(0, named=True)
    assert 4.0 < total["dof"] < 5.5
    quantile = np.log(total["hi_ratio"]) / total["u_ratio"]
    assert quantile == pytest.approx(stats.t.ppf(0.975, total["dof"]))
    assert total["lo_ratio"] == pytest.approx(1 / total["hi_ratio"])
    many = combine(tows(random_dof=np.inf), Assumed()).row(0, named=True)
    assert np.log(many["hi_ratio"]) / many["u_ratio"] == pytest.approx(1.95996, abs=1e-4)


def test_repeat_tows_show_what_differs_between_tows_and_shrink_nothing_else():
    """What repeats share cancels in their difference (ISO 5725-1; GUM, type B)."""
    few, many = (Assumed().replace_by_repeats(sd, 0.0, 0.5 * sd) for sd in (0.0001, 0.02))
    held, other = (budget(tows(temperature_known=True), assumed) for assumed in (few, many))
    shared = pl.col("component").is_in(["force", "wind", "anemometer", "mass", "temperature"])
    assert (held.filter(shared)["u_ratio"] > 0.001).all()
    assert held.filter(shared)["u_ratio"].to_list() == other.filter(shared)["u_ratio"].to_list()
    assert u_of(other, "between_tows") == pytest.approx(0.02)
    assert u_of(other, "calibration") == pytest.approx(2.86 * 0.01)


def test_a_zero_that_wanders_between_tows_counts_most_for_light_boats():
    assumed = Assumed().replace_by_repeats(0.003, 2.0, 0.0)
    light, heavy = (budget(tows(force_n=force), assumed) for force in (125.0, 500.0))
    assert u_of(light, "between_tows") == pytest.approx(np.hypot(0.003, 2.0 / 125.0))
    assert u_of(heavy, "between_tows") == pytest.approx(np.hypot(0.003, 2.0 / 500.0))
