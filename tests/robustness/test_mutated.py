"""A small part of the mutated archive, and that it would notice; the whole is `make fuzz`."""

import pytest

from benchmarks.robustness import mutate
from warehouse.archive.plausibility.judge import Judged


def quiet(_):
    """Says nothing."""


def test_every_faulty_tow_is_set_aside_or_keeps_its_numbers(tmp_path):
    found = mutate.mutate(tmp_path, 30, 2, quiet)
    assert found.wrong == []
    assert len(found.faults) >= 30
    assert found.aside.total() > 20


def test_a_reader_that_looks_away_is_noticed(tmp_path, monkeypatch):
    monkeypatch.setattr(
        "warehouse.intake.reading.judge_samples", lambda samples, *_: Judged(samples, [])
    )
    assert mutate.mutate(tmp_path, 15, 2, quiet).wrong != []


@pytest.mark.parametrize(
    ("one", "other", "place"), [(b"abc", b"abd", 2), (b"ab", b"abc", 2), (b"ab", b"ab", None)]
)
def test_the_place_of_a_fault_is_where_the_text_differs(one, other, place):
    assert mutate.first_difference(one, other) == place
