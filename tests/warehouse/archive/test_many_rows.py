"""Rows that repeat one fault take time in proportion to their number."""

import time

import pytest

from pipeline.errors import DefectiveInputError
from pipeline.tables.lake import ListedTows
from warehouse.archive.index.comparisons import unique_ids, unique_samples
from warehouse.archive.index.tow_rows import Entry
from warehouse.archive.lists.boats import Boats
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.sheets.row import ListRow, Reading

MANY = 10_000
MOST_S = 7
"""Processor time; the square of so many rows takes longer by far."""
READING = Reading({}, "bad_list_row", {}, "", "", ListedTows)
PROFILES = Profiles()


def entry_of(line: int, **values: object) -> Entry:
    tow = {"samples_sha256": "a", "second_sha256": None, "fsn_no": "FSN1", "rowers": 8}
    row = ListRow(line, {"tow_id": "1"}, READING, None)
    return Entry(row, "list.csv", 2014, PROFILES, tow=tow | {"crew_class": "H"} | values)


@pytest.mark.parametrize("differing", ["fsn_no", "rowers"])
def test_tows_with_the_same_samples(differing: str) -> None:
    entries = [entry_of(row, **{differing: row}) for row in range(MANY)]
    began, check = time.process_time(), unique_samples(entries)
    for entry in entries:
        with pytest.raises(DefectiveInputError, match="nobody can know whose"):
            check(entry)
    assert time.process_time() - began < MOST_S


def test_rows_of_one_tow() -> None:
    entries = [entry_of(row) for row in range(MANY)]
    began, check = time.process_time(), unique_ids(entries)
    check(entries[0])
    for entry in entries[1:]:
        with pytest.raises(DefectiveInputError, match="the rows are equal"):
            check(entry)
    assert time.process_time() - began < MOST_S


def test_tows_of_unknown_boats() -> None:
    boats = Boats({f"FSN{number}": {} for number in range(MANY)}, (), {}, ())
    began = time.process_time()
    assert not any(boats.find(f"FSN{MANY + number}") for number in range(MANY))
    assert time.process_time() - began < MOST_S
