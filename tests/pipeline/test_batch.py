"""Bookkeeping between tows and runs."""

import numpy as np
import polars as pl
import pytest

from pipeline.blocks.batch import Batch
from pipeline.blocks.run_blocks import SUM_NAMES, RunBlocks


@pytest.fixture
def batch() -> Batch:
    """Tows a, b, c with 2, 0 and 3 runs, given out of order, among runs of another tow."""
    runs = pl.DataFrame(
        {
            "tow_id": ["a", "a", "c", "c", "c", "x"],
            "run": [1, 4, 1, 2, 4, 1],
            "direction": [1, -1, 1, 1, -1, 1],
            "target_speed_ratio": [0.9, 0.9, 0.9, 1.0, 0.9, 0.9],
            "selected": [True] * 6,
        }
    )
    blocks = RunBlocks(runs, np.ones((6, 2)), {name: np.zeros((6, 2)) for name in SUM_NAMES})
    tows = pl.DataFrame({"tow_id": ["c", "a", "b"], "weight_kg": [30.0, None, 20.0]})
    return Batch.of(tows, blocks)


def test_tows_are_sorted_and_keep_their_own_runs(batch):
    assert batch.tows["tow_id"].to_list() == ["a", "b", "c"]
    assert batch.tow.tolist() == [0, 0, 2, 2, 2]
    assert batch.size == 3


def test_numbers_of_a_tow_are_spread_over_its_runs(batch):
    assert np.array_equal(batch.of_tow("weight_kg"), [np.nan, 20, 30], equal_nan=True)
    assert np.array_equal(batch.of_run("weight_kg"), [np.nan, np.nan, 30, 30, 30], equal_nan=True)


def test_counts_and_means_skip_runs_that_are_not_marked_and_tows_without_runs(batch):
    marked = np.array([True, False, True, False, True])
    assert batch.count(marked).tolist() == [1, 0, 2]
    assert batch.any(marked).tolist() == [True, False, True]
    values = np.array([1.0, np.nan, 3.0, np.nan, 5.0])
    assert batch.mean(values, marked).tolist() == [1.0, 0.0, 4.0]


def test_by_tow_puts_runs_in_their_order(batch):
    assert batch.place.tolist() == [0, 1, 0, 1, 2]
    rows = batch.by_tow(np.array([1.0, 2.0, 3.0, 4.0, 5.0]))
    assert rows.tolist() == [[1, 2, 0], [0, 0, 0], [3, 4, 5]]
