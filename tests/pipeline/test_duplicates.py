import numpy as np
import pytest

from herijk.pipeline.errors import BrokenPromiseError
from herijk.pipeline.studies.duplicates import duplicate_pairs


def test_every_pair_of_copies_is_found_once():
    a, b = [1.0, 2.0, 3.0], [1.0, 2.0, 3.1]
    assert duplicate_pairs([a, b, a, a]).tolist() == [[0, 2], [0, 3], [2, 3]]


def test_tolerance_is_relative_to_the_series_as_a_whole():
    series = np.array([[0.0, 3.0, 4.0], [0.02, 3.0, 4.0]])  # rms about 2.89
    assert len(duplicate_pairs(series, tolerance_ratio=0.006)) == 0
    assert duplicate_pairs(series, tolerance_ratio=0.008).tolist() == [[0, 1]]
    assert duplicate_pairs(1000 * series, tolerance_ratio=0.008).tolist() == [[0, 1]]


def test_nothing_to_compare_gives_no_pairs():
    assert duplicate_pairs(np.ones((1, 5))).shape == (0, 2)


@pytest.mark.parametrize("series", [[1.0, 2.0], [[1.0, np.nan], [1.0, 2.0]]])
def test_anything_but_a_finite_table_is_refused(series):
    with pytest.raises(BrokenPromiseError, match="finite table"):
        duplicate_pairs(series)
