"""Measuring errors as repeat tows show them, against known truth."""

import numpy as np
import polars as pl
import pytest

from pipeline.consistency.noise import PRIOR_DOF, Noise, estimate_noise

FORCE_N = 200.0


def pairs(seed, boats=60, seasons=8, run_sd=0.01, zero_n=0.0, season_sd=0.0, said_sd=None):
    """Differences of boats towed in three consecutive seasons; each boat has two pairs."""
    rng = np.random.default_rng(seed)
    first = rng.integers(0, seasons - 2, boats)
    towed = first[:, None] + np.arange(3)
    force = FORCE_N * rng.uniform(0.7, 1.3, towed.shape)
    y = season_sd * rng.normal(size=seasons)[towed]
    y += run_sd * rng.normal(size=towed.shape) + zero_n / force * rng.normal(size=towed.shape)
    variance = (run_sd if said_sd is None else said_sd) ** 2
    rows = []
    for boat in range(boats):
        for old, new in ((0, 1), (1, 2)):
            rows.append(
                {
                    "tow_id": f"{boat}-{new}",
                    "tow_id_before": f"{boat}-{old}",
                    "season": 2010 + int(towed[boat, new]),
                    "season_before": 2010 + int(towed[boat, old]),
                    "difference": y[boat, new] - y[boat, old],
                    "variance": variance,
                    "variance_before": variance,
                    "zero_effect": 1.0 / force[boat, new],
                    "zero_effect_before": 1.0 / force[boat, old],
                }
            )
    return pl.DataFrame(rows)


def test_without_repeat_tows_the_errors_are_those_that_are_assumed():
    nothing = estimate_noise(pairs(1).clear())
    assert nothing == Noise(1.0, 0.0, 0.0, PRIOR_DOF, 0)


def test_errors_that_are_as_they_say_stay_as_they_are():
    found = [estimate_noise(pairs(seed)) for seed in range(2, 12)]
    assert np.mean([one.variance_ratio for one in found]) == pytest.approx(1.0, abs=0.1)
    assert np.mean([one.zero_sd_n for one in found]) < 0.4
    assert np.mean([one.season_sd for one in found]) < 0.003


@pytest.mark.parametrize("said", [0.5, 0.7])
def test_errors_that_say_too_much_are_made_smaller(said):
    found = [estimate_noise(pairs(seed, said_sd=0.01 / said)) for seed in range(40, 50)]
    ratio = np.mean([one.variance_ratio for one in found])
    assert np.sqrt(ratio) == pytest.approx(said, rel=0.15)
    assert {one.zero_sd_n for one in found} == {0.0}


def test_a_load_cell_whose_zero_moves_is_found_in_newtons():
    found = estimate_noise(pairs(13, zero_n=5.0))
    assert found.zero_sd_n == pytest.approx(5.0, rel=0.2)
    assert found.variance_ratio == 1.0


def test_what_a_season_shares_is_not_taken_for_an_error_of_a_tow():
    found = [estimate_noise(pairs(seed, season_sd=0.05)) for seed in range(20, 30)]
    assert np.sqrt(np.mean([one.season_sd**2 for one in found])) == pytest.approx(0.05, rel=0.3)
    assert np.mean([one.zero_sd_n for one in found]) < 0.5


def test_a_pair_with_a_tow_pulled_askew_is_left_out():
    clean = pairs(14)
    is_askew = pl.int_range(pl.len()) == 0
    higher = pl.when(is_askew).then(0.15).otherwise(0.0)
    askew = clean.with_columns(difference=pl.col("difference") + higher)
    before, after = estimate_noise(clean), estimate_noise(askew)
    assert after.n_pairs < clean.height
    assert after.zero_sd_n == pytest.approx(before.zero_sd_n, abs=0.3)


def test_two_pairs_alone_do_not_overrule_the_errors():
    few = pairs(15, boats=1, said_sd=0.1)
    assert estimate_noise(few).variance_ratio > 0.7
