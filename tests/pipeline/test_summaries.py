"""Medians over many tows, on frames small enough to do by hand."""

from types import SimpleNamespace

import polars as pl
import pytest

from pipeline.studies import summaries

CURVES = pl.DataFrame(
    [
        ("a", "t1", 2010, 10.0, "accepted", []),
        ("a", "t2", 2010, 20.0, "flagged", ["few_runs"]),
        ("a", "t3", 2011, None, "rejected", ["few_runs", "no_curve"]),
        ("b", "t1", 2010, 9.0, "accepted", []),
        ("b", "t2", 2010, 22.0, "accepted", []),
        ("b", "t3", 2011, 30.0, "accepted", []),
    ],
    schema=["method", "tow_id", "season", "cw_kg_m", "status", "flags"],
    orient="row",
)


def test_a_season_s_change_counts_tows_with_both_curves():
    found = summaries.season_changes(CURVES, SimpleNamespace(name="a"))
    assert found.height == 1
    row = found.row(0, named=True)
    assert (row["method"], row["from_method"], row["season"], row["tows"]) == ("b", "a", 2010, 2)
    assert (row["lowest_ratio"], row["highest_ratio"]) == (0.9, 1.1)
    assert row["median_ratio"] == pytest.approx(1.0)


LINE = {"fsn_no": "FSN1", "rowers": 8, "crew_class": "H", "a_kg_m": 30.0, "b_m_s": 5.0}


def printed(season, cw, speed=2.5):
    numbers = {"declared_speed_m_s": speed, "cw_kg_m": cw}
    return {**LINE, "season": season, "tow_date": 1, "has_valid_curve": True, **numbers}


def test_print_is_compared_at_the_printed_speed_by_the_first_register_that_printed_it():
    of_2015, of_2014 = printed(2015, 99.0), printed(2014, 41.0, speed=2.75)
    curve = {"tow_id": "a", "method": "m", "cw_kg_m": 40.0, "declared_speed_m_s": 2.5}
    curves = pl.DataFrame([LINE | curve | {"season": 2014}])
    tows = pl.DataFrame([LINE | {"tow_id": "a", "tow_date": 1}])
    found = summaries.print_reproduction(pl.DataFrame([of_2015, of_2014]), curves, tows)
    row = found.row(0, named=True)
    assert (row["printed_in"], row["printed_cw_kg_m"]) == (2014, 41.0)
    # A 30 and Cw 40 at 2.5 m/s are B 5: at 2.75 m/s 30 / (1 - 0.55^2).
    assert row["cw_kg_m"] == pytest.approx(30.0 / (1 - 0.55**2))
    assert row["cw_ratio"] == pytest.approx(41.0 / row["cw_kg_m"])
