"""Samples are read again where something changed, and curves made again where it concerns them."""

import pytest

from warehouse.archive import files as hashes

pytestmark = pytest.mark.more


def test_lists_are_read_again_where_a_file_could_not_be_read(bench, monkeypatch):
    tow_list = min((bench.archive / "sleeplijsten").iterdir())
    tow_list.touch()
    read = hashes.FileHashes.hash_file

    def hash_file(self, path):
        if path == tow_list:
            raise OSError(5, "I/O error")
        return read(self, path)

    with monkeypatch.context() as broken:
        broken.setattr(hashes.FileHashes, "hash_file", hash_file)
        bench.rebuild()
    assert "unreadable_file" in bench.store.read("list_faults")["reason_code"]
    bench.rebuild()
    assert "unreadable_file" not in bench.store.read("list_faults")["reason_code"]


def test_a_fault_in_a_list_of_races_leaves_the_curves_as_they_are(bench):
    races = bench.archive / "wedstrijden" / "grachtenrace_2014.csv"
    races.write_text("wedstrijd;datum\nGrachtenrace;gisteren\n")
    curves = bench.store.table_path("curves").stat().st_mtime_ns
    blocks = bench.store.table_path("blocks").stat().st_mtime_ns
    bench.rebuild()
    assert bench.table("quarantine")["path"].str.ends_with(races.name).any()
    assert bench.store.table_path("blocks").stat().st_mtime_ns == blocks
    assert bench.store.table_path("curves").stat().st_mtime_ns == curves
