"""One writer at a time; a lock that dies with its owner; leftovers of the dead are removed."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from pipeline.errors import UnavailableError
from warehouse.store.lock import hold_write_lock

HOLD = """
import sys, time
from pathlib import Path
from warehouse.store.lock import hold_write_lock
with hold_write_lock(Path(sys.argv[1])):
    (Path(sys.argv[1]) / "lake").mkdir(exist_ok=True)
    (Path(sys.argv[1]) / "lake" / ".herijk-half.parquet").write_text("half")
    print("held", flush=True)
    time.sleep(60)
"""


@pytest.fixture
def holder(tmp_path):
    """Another process that holds the lock and is writing a file."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tmp_path)],
        cwd=Path(__file__).parents[2],
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout.readline() == "held\n"
    yield process
    process.kill()
    process.communicate()


def test_the_second_stops_and_touches_nothing(holder, tmp_path):
    with pytest.raises(UnavailableError, match="being rebuilt already"), hold_write_lock(tmp_path):
        pass
    assert (tmp_path / "lake" / ".herijk-half.parquet").exists()


def test_the_lock_dies_with_its_owner_and_the_next_clears_up(holder, tmp_path):
    holder.send_signal(signal.SIGKILL)
    holder.wait()
    with hold_write_lock(tmp_path):
        assert not (tmp_path / "lake" / ".herijk-half.parquet").exists()


def test_leftovers_of_publications_are_left_to_publishing(tmp_path):
    other = tmp_path / "editions" / ".herijk-2026-1"
    other.mkdir(parents=True)
    old_site = tmp_path / ".herijk-site"
    old_site.mkdir()
    (old_site / "index.html").write_text("")
    with hold_write_lock(tmp_path):
        assert other.is_dir()
        assert not old_site.exists()
