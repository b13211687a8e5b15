"""The quick look for a stuck instrument overlooks no stretch that the whole search finds."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from herijk.warehouse.archive.plausibility import _longest_hold, _may_hold


@given(values=st.lists(st.integers(0, 2), min_size=2, max_size=80), samples=st.integers(2, 30))
def test_a_stretch_is_never_overlooked(values, samples):
    channel = np.array(values, np.float32)
    assert _longest_hold(channel)[1] < samples or _may_hold(channel, samples)


def test_a_channel_that_moves_is_not_searched():
    assert not _may_hold(np.arange(100, dtype=np.float32), 10)
