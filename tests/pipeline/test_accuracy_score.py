"""The figures of `make accuracy`: sums over archives, and their Monte Carlo error."""

import numpy as np
import polars as pl
import pytest

from benchmarks.accuracy.score import faulty_seasons, mean_and_error, score


def test_the_error_of_a_share_is_that_of_its_mean_over_archives():
    shares = np.array([0.2, 0.5, 0.4, 0.3])
    mean, error = mean_and_error(24 * shares, np.full(4, 24.0))
    assert (mean, error) == pytest.approx((shares.mean(), shares.std(ddof=1) / 2.0))


def test_nothing_seen_is_no_figure():
    assert np.isnan(mean_and_error(np.zeros(3), np.zeros(3))).all()


def test_a_fault_is_in_the_seasons_of_its_world():
    seasons = range(2009, 2019)
    assert faulty_seasons("force-zero", seasons) == {2016}
    assert faulty_seasons("unlinked", seasons) == {2010}
    assert faulty_seasons("clean", seasons) == set()


def test_a_miss_is_silent_where_neither_the_tow_nor_its_season_is_flagged():
    truth = pl.DataFrame(
        {"tow_id": ["a", "b", "c"], "season": [2015, 2015, 2016]}
        | {"cw_at_15c_kg_m": 40.0, "log_factor": 1.0}
    )
    curves = pl.DataFrame(
        {"tow_id": ["a", "b", "c"], "status": ["accepted", "flagged", "accepted"]}
        | {"cw_kg_m": 44.0, "cw_lo_kg_m": 43.0, "cw_hi_kg_m": 45.0}
    )
    factors = pl.DataFrame(
        schema={"season": pl.Int64} | dict.fromkeys(("factor", "lo", "hi"), pl.Float64)
    )
    steps = pl.DataFrame({"season": [2016], "cause": ["force"]})
    tables = {"curves": curves, "log_factors": factors, "season_steps": steps}
    found = {(r["what"], r["group"]): r for r in score("force-zero", tables, truth)}
    all_of_them = found["as measured", "2014 on"]
    assert (all_of_them["n"], all_of_them["covered"], all_of_them["silent"]) == (3.0, 0.0, 1.0)
    assert all_of_them["error"] == pytest.approx(0.3)
    assert found["as measured", "faulty"]["flagged"] == 1.0
    assert (found["alarms", "seasons"]["found"], found["alarms", "seasons"]["false"]) == (1, 0)
