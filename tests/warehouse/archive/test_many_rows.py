"""Rows that repeat one fault take time in proportion to their number."""

import time
from collections.abc import Callable

import pytest

from tests.warehouse.archive.conftest import BOATS, TOWS, Archive
from warehouse.archive import FileHashes, index_archive

MANY = 5_000
MOST_S = 3.5
"""Processor time; the square of so many rows takes longer by far."""
TOW = "{id};2014-03-01;FSN{boat};eerste boot 8h 2014;;{rowers};H;2,40;;;;;;;;;;nee;20;"


@pytest.mark.parametrize(
    ("row", "reason_code"),
    [
        (lambda i: {"id": "1", "boat": i}, "duplicate_tow_id"),
        (lambda i: {"boat": i}, "samples_listed_twice"),
        (lambda i: {"rowers": f"x{i}"}, "bad_list_row"),
    ],
    ids=["one tow", "boats", "bad cells"],
)
def test_rows_that_repeat_one_fault(
    archive: Archive, row: Callable[[int], dict[str, object]], reason_code: str
) -> None:
    rows = [TOW.format(**{"id": i, "boat": 1, "rowers": 8} | row(i)) for i in range(MANY)]
    archive.edit(TOWS, lambda text: "\n".join([text.split("\n")[0], *rows, ""]))
    began = time.process_time()
    faults = index_archive(archive.root, FileHashes().hash_file).faults
    assert time.process_time() - began < MOST_S
    assert sum(fault.reason_code == reason_code for fault in faults) >= len(rows) - 1


def test_boats_that_contradict_each_other(archive: Archive) -> None:
    rows = [f"FSN1;1;een;;8;{2 + i % 2};;1000;8;H" for i in range(MANY)]
    archive.edit(BOATS, lambda text: "\n".join([text.split("\n")[0], *rows, ""]))
    began = time.process_time()
    faults = index_archive(archive.root, FileHashes().hash_file).faults
    assert time.process_time() - began < MOST_S
    assert sum(f.reason_code == "duplicate_boat" and f.path == BOATS for f in faults) == MANY / 2
