"""Repeated tows of one boat: reproducibility and pairs, against known truth."""

import numpy as np
import polars as pl
import pytest

from pipeline.consistency.observed import observe
from pipeline.consistency.repeats import repeat_pairs, reproducibility
from tests.pipeline.consistency_fleet import fleet


def test_reproducibility_recovers_the_spread_of_a_tow():
    tables = fleet(20, boats=60, seasons=(2014, 2016, 2018), tow_sd=0.03, noise=0.001)
    pairs = repeat_pairs(tables[0], tables[1])
    found = reproducibility(pairs, observe(*tables)).row(0, named=True)
    assert found["scope"] == "all"
    assert found["n_pairs"] == 120
    # Pairs share a tow, so the spread rests on about 90 instead of 120 differences.
    assert found["sd_ratio"] == pytest.approx(0.03, rel=4 / np.sqrt(2 * 90))


def test_no_pair_across_an_alteration():
    curves, tows, *_ = fleet(22, boats=2, seasons=(2014, 2016))
    tows = tows.with_columns((pl.col("tow_id") == "2016-001").alias("altered"))
    assert repeat_pairs(curves, tows)["tow_id"].to_list() == ["2016-000"]
