"""Eras that stand apart: the median's interval, ageing, and what is not claimed."""

import numpy as np
import polars as pl
import pytest
from scipy import stats

from pipeline.consistency.repeats import era_shifts, estimate_median

BOATS = pl.DataFrame({"fsn_no": [f"FSN{k}" for k in range(40)], "boat_type": ["like"] * 40})


def pairs(*groups):
    """Pairs of tows as (season before, season, ln ratios); each ratio is another boat's."""
    rows = [
        {"method": "m", "fsn_no": f"FSN{k}", "season_before": old, "season": new, "ln_ratio": value}
        for old, new, values in groups
        for k, value in enumerate(values)
    ]
    return pl.DataFrame(rows)


def early(*groups, boat_type="like"):
    found = era_shifts(pairs(*groups), BOATS)
    return found.row(
        by_predicate=(pl.col("era") == "2009-2011") & (pl.col("boat_type") == boat_type),
        named=True,
    )


SCATTER = np.linspace(-0.01, 0.01, 11)


@pytest.mark.parametrize("n", [6, 9, 40])
def test_the_interval_of_a_median_is_that_of_order_statistics(n):
    values = np.random.default_rng(n).normal(size=n)
    found = estimate_median(values)
    independent = stats.quantile_test(values, p=0.5).confidence_interval(0.95)
    assert found == pytest.approx((np.median(values), independent.low, independent.high))


def test_boats_that_only_age_do_not_stand_apart():
    # 0.5 % per year over six years is more than the scatter of the pairs.
    within = (2014, 2018, 4 * 0.005 + 0.1 * SCATTER)
    aged = early((2009, 2015, 6 * 0.005 + SCATTER), within)
    assert not aged["apart"]
    assert aged["ageing_per_year"] == pytest.approx(0.005)
    assert aged["shift_ratio"] == pytest.approx(1.0)
    unknown = early((2009, 2015, 6 * 0.005 + SCATTER))
    assert unknown["apart"]
    assert unknown["ageing_per_year"] is None


def test_a_shift_beyond_ageing_stands_apart():
    found = early((2009, 2015, 0.03 - 0.12 + SCATTER), (2014, 2018, 0.02 + 0.1 * SCATTER))
    assert found["apart"]
    assert found["shift_ratio"] == pytest.approx(np.exp(-0.12))


def test_only_pairs_into_a_later_era_count():
    found = early((2009, 2010, 0.3 + SCATTER), (2009, 2014, SCATTER[:6]))
    assert found["n"] == 6
    assert abs(np.log(found["shift_ratio"])) < 0.01


def test_too_few_pairs_claim_nothing_but_count_for_all_types_together():
    half = BOATS.with_columns(
        boat_type=pl.when(pl.int_range(pl.len()) < 5).then(pl.lit("a")).otherwise(pl.lit("b"))
    )
    found = era_shifts(pairs((2009, 2015, SCATTER[:8])), half).filter(era="2009-2011")
    by_type = {row["boat_type"]: row for row in found.iter_rows(named=True)}
    assert {t: row["n"] for t, row in by_type.items()} == {"a": 5, "b": 3, "all": 8}
    assert (by_type["a"]["reason"], by_type["a"]["apart"]) == ("few_pairs", None)
    assert by_type["all"]["reason"] == ""
