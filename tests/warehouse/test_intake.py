"""Lists are read again when something of the archive changed, and curves when it concerns them."""

import os
import time
from unittest import mock

import pytest

from pipeline.method.definition import shipped_method
from tests.warehouse.edition_bench import DAY
from warehouse.archive import files as hashes
from warehouse.derive.graph import ARCHIVE, METHOD
from warehouse.derive.inputs import Scope
from warehouse.intake import seasons as intake
from warehouse.intake.seasons import bring_in


@pytest.fixture
def settled(bench_of_editions, monkeypatch):
    """An archive that was indexed, and in which any later change can be seen."""
    monkeypatch.setattr(intake, "RACY_SECONDS", 0.0)
    intake.index(bench_of_editions.store, bench_of_editions.archive)
    return bench_of_editions


def is_read_again(bench):
    with mock.patch.object(intake, "index_archive", wraps=intake.index_archive) as reads:
        intake.index(bench.store, bench.archive)
    return reads.called


def changed(path):
    """Other content of the same size under the same time of change."""
    before = path.stat()
    content = path.read_bytes()
    time.sleep(0.02)
    path.write_bytes(content[:-2] + content[-2:-1].swapcase() + content[-1:])
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))


def test_lists_are_not_read_again_while_nothing_changed(settled):
    assert not is_read_again(settled)


@pytest.mark.parametrize(
    "change",
    [
        lambda bench: changed(next((bench.archive / "sleeplijsten").iterdir())),
        lambda bench: (bench.archive / "notes.txt").symlink_to("archief.toml"),
        lambda bench: (bench.store.table_path("listed_tows")).unlink(),
    ],
)
def test_lists_are_read_again_after_any_change(settled, change):
    change(settled)
    assert is_read_again(settled)


def test_lists_are_read_again_where_a_file_could_not_be_read(settled, monkeypatch):
    tow_list = min((settled.archive / "sleeplijsten").iterdir())
    tow_list.touch()

    def hash_file(self, path):
        if path == tow_list:
            raise OSError(5, "I/O error")
        return "0" * 64

    with monkeypatch.context() as broken:
        broken.setattr(hashes.FileHashes, "hash_file", hash_file)
        intake.index(settled.store, settled.archive)
    assert "unreadable_file" in settled.store.read("list_faults")["reason_code"]
    assert is_read_again(settled)
    assert not is_read_again(settled)


def test_what_changed_just_now_is_read_again(settled, monkeypatch):
    monkeypatch.setattr(intake, "RACY_SECONDS", hashes.RACY_SECONDS)
    changed(next((settled.archive / "sleeplijsten").iterdir()))
    assert is_read_again(settled)
    assert is_read_again(settled)


def test_a_fault_in_a_list_of_races_leaves_the_curves_as_they_are(bench_of_editions):
    store, method = bench_of_editions.store, shipped_method("as-published")
    races = bench_of_editions.archive / "wedstrijden" / "grachtenrace_2014.csv"
    races.parent.mkdir(exist_ok=True)
    races.write_text("wedstrijd;datum\nGrachtenrace;gisteren\n")
    bring_in(store, bench_of_editions.archive)
    assert ARCHIVE.is_stale(Scope(store, ()))
    ARCHIVE.make(Scope(store, (), today=DAY))
    assert store.read("quarantine")["path"].str.ends_with(races.name).any()
    assert not METHOD.is_stale(Scope(store, [method]))
