"""The calibration factor: every run weighs the same, and the current drops out."""

import numpy as np
import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.blocks.run_blocks import RunBlocks
from pipeline.blocks.tows import Tows
from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.steps.calibration import estimate_gps_factor_of_files, gps_factor

WAY = np.array([1, 1, 1, -1, -1, -1])
TOW = np.zeros(6, dtype=np.int64)
ALL = np.ones(6, dtype=bool)
LOG = np.array([2.0, 2.2, 2.4, 2.0, 2.2, 2.4])
NUMBER = np.arange(1, 7)


def batch_of(number: np.ndarray = NUMBER, way: np.ndarray = WAY) -> Tows:
    """One tow with runs of these numbers and directions."""
    runs = pl.DataFrame({"run": number, "direction": way})
    blocks = RunBlocks(runs, np.ones((len(way), 1)), {})
    return Tows(pl.DataFrame({"tow_id": ["a"]}), blocks, np.zeros(len(way), dtype=np.int64))


@given(y=st.floats(0.9, 1.1), stream=st.floats(-0.3, 0.3), lost=st.sampled_from([None, 2, 3]))
def test_the_stream_drops_out_also_with_a_run_lost(y, stream, lost):
    used = lost != NUMBER - 1
    factor, known = gps_factor(LOG * y + stream * WAY, LOG, WAY, TOW, used, 1)
    assert factor[0] == pytest.approx(y, rel=1e-12)
    assert known[0]


@pytest.mark.parametrize("used", [[1, 1, 1, 0, 0, 0], [0, 0, 0, 1, 1, 1], [0] * 6])
def test_without_both_ways_nothing_is_known(used):
    factor, known = gps_factor(LOG * 1.05, LOG, WAY, TOW, np.array(used, dtype=bool), 1)
    assert not known[0]
    assert factor[0] == 1.0


def test_each_tow_has_its_own_factor():
    tow = np.repeat([0, 1], 6)
    gps = np.concatenate([LOG * 1.02, LOG * 0.97])
    factor, known = gps_factor(gps, np.tile(LOG, 2), np.tile(WAY, 2), tow, np.tile(ALL, 2), 3)
    assert factor == pytest.approx([1.02, 0.97, 1.0], rel=1e-12)
    assert known.tolist() == [True, True, False]


def of_two_files(used: list[int], second: float, steady: list[int] | None = None):
    """Factors of a combined tow, each file of six runs, whose second log reads otherwise."""
    way, log = np.tile(WAY, 2), np.concatenate([LOG, LOG * second])
    batch = batch_of(np.concatenate([NUMBER, NUMBER + SECOND_FILE_OFFSET]), way)
    gps = np.tile(LOG, 2) + 0.05 * way
    chosen = np.array(used, dtype=bool)
    there = np.ones(12, dtype=bool) if steady is None else np.array(steady, dtype=bool)
    return estimate_gps_factor_of_files(batch, gps, log, chosen, there)


@given(second=st.floats(0.95, 1.05))
def test_each_file_of_a_combined_tow_has_its_own_factor(second):
    """Log1 bij elke sleep calibreren (2015): also where the runs out are of one file only."""
    for used in ([1] * 12, [1, 1, 1, 0, 0, 0, 0, 0, 0, 1, 1, 1], [1, 0, 0, 1, 0, 0] * 2):
        y, known = of_two_files(used, second)
        assert known.all()
        assert y[0] == pytest.approx([1.0, 1.0 / second], rel=1e-12)


def test_files_towed_one_way_each_share_the_factor_of_the_tow():
    one_way = [1, 1, 1, 0, 0, 0, 0, 0, 0, 1, 1, 1]
    y, known = of_two_files(one_way, 1.02, steady=one_way)
    assert known.all()
    assert y[0] == pytest.approx([1 / 1.01, 1 / 1.01], rel=1e-12)


def test_runs_that_were_not_chosen_calibrate_no_tow_of_one_file():
    used = np.array([1, 1, 1, 0, 0, 0], dtype=bool)
    known = estimate_gps_factor_of_files(batch_of(), LOG, LOG, used, ALL)[1]
    assert not known.any()
