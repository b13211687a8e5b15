"""What goes wrong around a rebuild: the old state stays, the message helps, the next run mends."""

import errno
import os
import resource  # noqa: TID251 - of limits, which Windows has not
import shutil
import sqlite3
import subprocess
import sys
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from unittest import mock

import pytest

from assets.instance import open_instance
from pipeline.errors import MissingKnowledgeError, UnavailableError
from tests.assets.test_rebuild import (
    assert_same_tables,
    list_samples_files,
    mended_while_read,
    spoil,
    when_read,
    without_studies,
)
from tests.conftest import METHODS
from warehouse.intake.lake import ArchiveChangedError
from warehouse.store.machine_faults import explain_machine_faults
from warehouse.store.store import Store

ROOT = Path(__file__).parents[2]


def mounted(folder, size):
    """Mounts a small disk; the test is skipped where that is not allowed."""
    folder.mkdir()
    options = ["-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(folder)]
    if (
        shutil.which("mount") is None
        or subprocess.run(["mount", *options], capture_output=True, check=False).returncode
    ):
        pytest.skip("may not mount a disk here")


@pytest.mark.more
def test_a_full_disk_leaves_the_old_tables_and_the_next_run_goes_on(bench, built, tmp_path):
    """A disk with room for what is there and a little more, filled while it works."""
    used = sum(f.stat().st_size for f in bench.data.rglob("*") if f.is_file())
    disk = tmp_path / "disk"
    mounted(disk, used + 4_000_000)
    try:
        shutil.copytree(bench.data, disk / "data")
        small = type(bench)(bench.archive, disk / "data")
        filler = disk / "filler"
        filler.write_bytes(bytes(shutil.disk_usage(disk).free - 100_000))
        kept = spoil(list_samples_files(bench, 2009)[3])
        with pytest.raises(UnavailableError, match=r"no room left .* Free some"):
            small.rebuild()
        assert_same_tables(small.tables(), built.tables())
        filler.unlink()
        list_samples_files(bench, 2009)[3].write_bytes(kept)
        small.rebuild()
        assert_same_tables(small.tables(), built.tables())
        assert not list((disk / "data").rglob(".herijk-*"))
    finally:
        subprocess.run(["umount", str(disk)], check=True)


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (OSError(errno.ENOSPC, ""), "no room left"),
        (OSError(errno.EROFS, "", "/archief"), "/archief cannot be read or written"),
        (OSError(errno.EIO, ""), "the disk under"),
        (sqlite3.OperationalError("database or disk is full"), "no room left"),
        (OSError(errno.EFBIG, ""), "none as large"),
        (MemoryError(), "not enough memory"),
        (type("PanicException", (BaseException,), {})("Too many open files"), "more files"),
    ],
)
def test_each_machine_fault_is_a_sentence_with_a_way_out(error, words, tmp_path):
    with pytest.raises(UnavailableError) as told, explain_machine_faults(tmp_path):
        raise RuntimeError("wrapped") from error
    assert words in str(told.value)
    assert "Earlier results are intact" in str(told.value)


def test_sqlite_calls_a_full_disk_one_that_gives_errors(tmp_path, monkeypatch):
    monkeypatch.setattr(shutil, "disk_usage", lambda _: mock.Mock(free=1000))
    with pytest.raises(UnavailableError, match="no room left"), explain_machine_faults(tmp_path):
        raise sqlite3.OperationalError("disk I/O error")


@contextmanager
def few_file_handles(*_):
    yield {"preexec_fn": partial(resource.setrlimit, resource.RLIMIT_NOFILE, (16, 16))}


@contextmanager
def little_memory(*_):
    yield {"preexec_fn": partial(resource.setrlimit, resource.RLIMIT_AS, (700 << 20, 700 << 20))}


@contextmanager
def damaged_records(bench, _):
    history = bench.store.dagster_home / "history"
    history.mkdir(parents=True, exist_ok=True)
    (history / "runs.db").write_bytes(b"no database " * 1000)
    yield {}
    shutil.rmtree(bench.store.dagster_home)


MACHINE_FAULTS = {
    few_file_handles: "may not open more files",
    little_memory: "memory",  # Polars and DuckDB end the process themselves where they lack it
    damaged_records: "Remove that folder",
}


@pytest.mark.slow
@pytest.mark.parametrize("fault", MACHINE_FAULTS)
def test_what_the_machine_lacks_is_said_and_the_next_rebuild_ends_equal(
    fault, bench, built, tmp_path
):
    def command(**settings):
        names = [part for name in METHODS for part in ("--method", name)]
        folders = ("--archive", str(bench.archive), "--data", str(bench.data))
        return subprocess.run(
            [sys.executable, "-m", "herijk", "rebuild", *names, *folders],
            cwd=ROOT, capture_output=True, text=True, check=False, **settings,
        )  # fmt: skip

    for table in ("samples", "blocks", "curves"):
        (bench.data / "lake" / "tables" / f"{table}.parquet").unlink()
    with fault(bench, tmp_path) as settings:
        stopped = command(**settings)
    assert stopped.returncode, stopped.stderr
    assert MACHINE_FAULTS[fault] in stopped.stderr
    assert "Traceback" not in stopped.stderr
    assert_same_tables(bench.tables(), built.tables())
    assert command().returncode == 0
    assert_same_tables(bench.tables(), built.tables())


NOBODY = 65534
AS_NOBODY = """
import os, sys
from pathlib import Path
from assets.rebuild import rebuild
from pipeline.errors import UnavailableError
os.setuid(int(sys.argv[3]))
try:
    rebuild(Path(sys.argv[1]), Path(sys.argv[2]), ["as-published", "rebased-2015"])
except UnavailableError as error:
    sys.exit(str(error))
"""


@pytest.mark.more
@pytest.mark.skipif(os.geteuid() != 0, reason="only root can become somebody else")
def test_in_a_folder_of_somebody_else_it_stops_with_the_way_out(bench, built):
    for folder in (bench.data, *bench.data.parents[:3]):
        folder.chmod(0o755)
    spoil(list_samples_files(bench, 2009)[3])
    run = subprocess.run(
        [sys.executable, "-c", AS_NOBODY, bench.archive, bench.data, str(NOBODY)],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert run.returncode == 1
    assert "cannot be read or written" in run.stderr
    assert "Traceback" not in run.stderr
    assert_same_tables(bench.tables(), built.tables())


def damaged(path, how):
    content = path.read_bytes()
    middle = len(content) // 2
    path.write_bytes(
        {
            "cut": content[:middle],
            "empty": b"",
            "garbage": b"\xff" * len(content),
            "a byte": content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :],
        }[how]
    )


DAMAGED = {
    "cut": ("listed_tows", "curves", "tows"),
    "empty": ("samples", "run_points", "boats"),
    "garbage": ("listed_runs", "log_factors", "tow_runs"),
    "a byte": ("read_tows", "blocks", "quarantine"),
}
"""Tables of lists, of methods and of the whole. Of one with a changed byte the end is sound, so it
is met only where it is read: those are."""


@pytest.mark.slow
def test_damaged_tables_are_made_again_when_they_are_needed(bench, built):
    file = list_samples_files(bench, 2009)[0]
    kept, left = file.read_bytes(), {}
    for how, tables in DAMAGED.items():
        for table in tables:
            path = bench.data / "lake" / "tables" / f"{table}.parquet"
            damaged(path, how)
            left[path] = path.read_bytes()
    file.write_bytes(b"")
    bench.rebuild()
    assert [path for path, content in left.items() if path.read_bytes() == content] == []
    assert set(bench.table("tows")["season"]) == {2009, 2014}
    assert bench.table("tows").height == built.table("tows").height - 1
    file.write_bytes(kept)
    bench.rebuild()
    assert_same_tables(without_studies(bench.tables()), without_studies(built.tables()))


@pytest.mark.slow
def test_a_damaged_database_is_made_again_by_the_next_run(bench, built):
    statistics = bench.store.table_path("type_consistency")
    made = statistics.stat().st_mtime_ns
    for how in DAMAGED:
        damaged(bench.store.database, how)
        assert bench.rebuild().done.database, how
        assert statistics.stat().st_mtime_ns == made, how
        assert_same_tables(bench.tables(), built.tables())


@pytest.mark.more
def test_an_archive_that_changes_meanwhile_is_read_again(bench, built, monkeypatch):
    """The file is another than the one that was hashed: its samples would be kept as that one's."""
    read = mended_while_read(bench, monkeypatch)
    bench.rebuild()
    assert read
    assert_same_tables(bench.tables(), built.tables())


@pytest.mark.more
def test_an_archive_that_never_stops_changing_is_left_alone(bench, built, monkeypatch):
    file = list_samples_files(bench, 2009)[3]
    spoil(file)
    when_read(monkeypatch, lambda _: file.write_bytes(file.read_bytes() + b" "))
    with pytest.raises(ArchiveChangedError, match="Try again when nobody is copying"):
        bench.rebuild()
    assert_same_tables(bench.tables(), built.tables())


@pytest.mark.parametrize("text", ["storage: [\n : :", "no_such_key: 1\n"])
def test_settings_of_dagster_that_cannot_be_understood_are_one_sentence(tmp_path, text):
    store = Store(tmp_path)
    store.dagster_home.mkdir(parents=True)
    (store.dagster_home / "dagster.yaml").write_text(text)
    expected = pytest.raises(MissingKnowledgeError, match=r"dagster\.yaml cannot be understood")
    with expected, open_instance(store):
        pass
