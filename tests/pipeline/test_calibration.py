"""The calibration factor: every run weighs the same, and the stream drops out."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from herijk.pipeline.steps.calibration import gps_factor

WAY = np.array([1, 1, 1, -1, -1, -1])
TOW = np.zeros(6, dtype=np.int64)
ALL = np.ones(6, dtype=bool)
LOG = np.array([2.0, 2.2, 2.4, 2.0, 2.2, 2.4])


@given(y=st.floats(0.9, 1.1), stream=st.floats(-0.3, 0.3))
def test_the_stream_drops_out(y, stream):
    factor, known = gps_factor(LOG * y + stream * WAY, LOG, WAY, TOW, ALL, 1)
    assert factor[0] == pytest.approx(y, rel=1e-12)
    assert known[0]


def test_the_stream_drops_out_with_one_run_lost():
    used = np.array([True, True, False, True, True, True])
    lost = gps_factor(LOG * 1.01 + 0.05 * WAY, LOG, WAY, TOW, used, 1)[0][0]
    assert lost == pytest.approx(1.01, abs=1e-12)


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
