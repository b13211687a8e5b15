"""Sums over many tows, on frames small enough to do by hand."""

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
    found = summaries.season_changes(CURVES, "a")
    assert found.height == 1
    row = found.row(0, named=True)
    assert (row["method"], row["from_method"], row["season"], row["tows"]) == ("b", "a", 2010, 2)
    assert (row["lowest_ratio"], row["highest_ratio"]) == (0.9, 1.1)
    assert row["median_ratio"] == pytest.approx(1.0)


def test_steps_of_a_season_multiply_as_those_of_its_tows():
    steps = pl.DataFrame(
        {
            "from_method": "a",
            "to_method": "b",
            "tow_id": ["t1", "t1", "t1", "t2", "t2", "t2"],
            "position": [0, 1, 2] * 2,
            "step": ["", "speed", "wind"] * 2,
            "factor": [1.0, 0.8, 1.1, 1.0, 0.9, 1.0],
        }
    )
    found = summaries.season_ladder(steps, CURVES.unique("tow_id")).sort("position")
    assert found["step"].to_list() == ["speed", "wind"]
    assert found["tows"].to_list() == [2, 2]
    assert found["factor"].product() ** 2 == pytest.approx(0.8 * 1.1 * 0.9)


def test_counts_of_all_seasons_are_those_of_each_together():
    run_points = pl.DataFrame(
        {"method": "a", "tow_id": ["t1", "t3"], "used": [True, False], "reason": ["", "no_window"]}
    )
    found = summaries.quality_counts(CURVES, run_points)
    of_all = found.filter(pl.col("scope") == summaries.ALL_SEASONS).drop("scope")
    each = found.filter(pl.col("scope") != summaries.ALL_SEASONS)
    summed = each.group_by("method", "kind", "code").agg(pl.col("number").sum())
    assert set(of_all.rows()) == set(summed.select(of_all.columns).rows())
    assert ("a", "flag", "few_runs", 2) in of_all.rows()
    assert ("a", "run", "no_window", 1) in of_all.rows()
