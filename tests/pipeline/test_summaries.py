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
