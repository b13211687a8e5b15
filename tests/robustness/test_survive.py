"""A few of the kills, and that a loss would be noticed; the whole is `make survive`."""

import shutil
from collections import Counter

import pytest

from benchmarks.robustness import survive

TWO_IN_TIME = 45
"""A seed with which the rebuilds are killed after 0.4 and 0.7 of the time an undisturbed one takes:
neither is done before."""


@pytest.mark.slow
def test_killed_rebuilds_lose_nothing_and_readers_see_whole_states(tmp_path):
    outcome = survive.survive(tmp_path, 2, seed=TWO_IN_TIME, tell=lambda line: None)
    assert (outcome.kills, outcome.different, outcome.bad_reads) == (2, 0, set())
    assert outcome.reads["archive-a"] > 0
    assert outcome.reads["site whole"] > 0


@pytest.fixture
def data(built, tmp_path):
    """A data folder with a database and a page."""
    (tmp_path / "site").mkdir()
    shutil.copy(built.store.database, tmp_path)
    shutil.copy(built.data / "site" / "index.html", tmp_path / "site")
    return tmp_path


def looked_once(data, monkeypatch, capsys):
    """What the reader says after one look at a state that it does not know."""
    monkeypatch.setattr(survive, "_told_to_stop", iter([False, True]).__next__)
    survive.read_until_stopped(data, ["a", "b"])
    seen = (line.split("\t")[0] for line in capsys.readouterr().out.splitlines())
    return survive.Outcome(reads=Counter(seen)).bad_reads


def test_tables_of_another_state_are_noticed(data, monkeypatch, capsys):
    assert looked_once(data, monkeypatch, capsys) == {"neither state"}


def test_half_a_page_is_noticed(data, monkeypatch, capsys):
    page = data / "site" / "index.html"
    page.write_bytes(page.read_bytes()[:1000])
    assert looked_once(data, monkeypatch, capsys) == {"neither state", "site cut off"}


def test_a_database_that_cannot_be_read_is_noticed(data, monkeypatch, capsys):
    (data / "warehouse.duckdb").write_bytes(b"half")
    (seen,) = looked_once(data, monkeypatch, capsys)
    assert seen.startswith("error: ")
