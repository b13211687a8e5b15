"""A few of the kills; the whole is `make survive`."""

import pytest

from benchmarks.robustness.survive import survive


@pytest.mark.slow
def test_killed_rebuilds_and_publications_end_as_if_nothing_had_happened(tmp_path):
    assert survive(tmp_path, kills=4, seed=1) >= 2
