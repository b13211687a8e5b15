"""Samples are read again where something changed, and curves made again where it concerns them."""

import pytest

from tests.assets.test_rebuild import files_read, samples_files, spoil
from warehouse.archive import files as hashes

__all__ = ["files_read"]


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


@pytest.mark.parametrize("change", ["samples", "list"])
def test_only_the_tow_that_changed_is_read_again(change, bench, files_read):
    file = samples_files(bench, 2009)[3]
    if change == "samples":
        spoil(file)
    else:
        path = bench.archive / "sleeplijsten" / "sleeplijst_2009.csv"
        path.write_bytes(path.read_bytes() + b"\n")
    bench.rebuild()
    assert len(files_read) == (change == "samples")
