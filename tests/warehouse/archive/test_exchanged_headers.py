"""Two names of a header exchanged: the tow is set aside, or nothing can tell them apart."""

from itertools import combinations

import pytest

from tests.warehouse.archive.conftest import FIRST, HEADER, Archive, Scan

NAMES = HEADER.split(";")[1:]
ALIKE = {("log1 [m/s]", "log2 [m/s]")}
"""Two logs of one boat: no sample says which is which."""


@pytest.mark.parametrize(("one", "other"), [*combinations(NAMES, 2)])
def test_two_names_exchanged_are_noticed(
    archive: Archive, good_scan: Scan, one: str, other: str
) -> None:
    exchanged = HEADER.replace(one, "@").replace(other, one).replace("@", other)
    archive.replace(FIRST, HEADER, exchanged)
    scan = archive.read_first(good_scan.index)
    is_kept = "2014-001" in scan.good
    assert is_kept == ((one, other) in ALIKE), scan.faults
