"""Rebuilds and publications killed at random moments; each rerun ends as if nothing happened.

After each kill the database, if there is one, must be readable. After the rerun all its tables must
equal those of a data folder in which nothing was killed, and `herijk verify` must find nothing.
"""

import random
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from tests.tables import digest_table
from warehouse.store.database import open_database
from warehouse.store.files import TEMPORARY_PREFIX
from warehouse.store.store import Store

WORLD = WorldSettings(seasons=(2009, 2014), tows_per_season=4, rate_hz=20, seed=3)
LOCK = f"{TEMPORARY_PREFIX}lock"
METHOD = ("--method", "rebased-2015")
KILLS, SEED = 4, 1
EDITION = ("2015-1", *METHOD, "--valid-from", "2015-01-01", "--decision", "ALV")


def herijk(*words: object) -> subprocess.Popen[bytes]:
    """Start the command, without what it prints."""
    command = [sys.executable, "-m", "herijk", *map(str, words)]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def digest_tables(data: Path) -> dict[str, str]:
    """Return a hash of every table that a reader finds, but for the day of first sight."""
    digests = {}
    with open_database(Store(data).database) as db:
        for _, _, name, *_ in db.execute("SHOW ALL TABLES").fetchall():
            table = db.sql(f'SELECT * FROM "{name}"').pl()  # noqa: S608
            digests[name] = digest_table(table.drop("first_seen", strict=False))
    return digests


@pytest.mark.slow
def test_killed_rebuilds_and_publications_end_as_if_nothing_had_happened(tmp_path):
    """With another seed, or more kills, other moments are tried."""
    root = tmp_path
    archive, whole, data = root / "archive", root / "whole", root / "data"
    write_simulated_archive(archive, simulate_world(WORLD))
    rebuild = ("rebuild", "--archive", archive, *METHOD, "--data")
    publish = ("publish", *EDITION, "--data")
    began = time.monotonic()
    assert herijk(*rebuild, whole).wait() == 0
    duration_s = time.monotonic() - began
    shutil.copytree(whole, root / "unpublished")
    assert herijk(*publish, whole).wait() == 0
    assert herijk(*rebuild, whole).wait() == 0
    expected = digest_tables(whole)
    chosen, n_killed = random.Random(SEED), 0
    for number in range(KILLS):
        command = publish if number % 4 == 3 else rebuild
        shutil.rmtree(data, ignore_errors=True)
        if command is publish or number % 4 == 2:  # publish, or rebuild where there is a database
            shutil.copytree(root / "unpublished", data)
        victim = herijk(*command, data)
        time.sleep(chosen.uniform(0.1, duration_s if command is rebuild else duration_s / 5))
        victim.kill()
        n_killed += victim.wait() < 0
        assert not (data / "warehouse.duckdb").exists() or digest_tables(data)
        assert herijk(*rebuild, data).wait() == 0
        herijk(*publish, data).wait()  # refused where the killed one was done
        assert herijk(*rebuild, data).wait() == 0
        assert herijk("verify", "--data", data).wait() == 0
        found = digest_tables(data)
        different = [name for name in expected if found.get(name) != expected[name]]
        assert not different, f"kill {number}: {different}"
        left = [file for file in data.rglob(f"{TEMPORARY_PREFIX}*") if file.name != LOCK]
        assert not left, f"kill {number}: {left}"
    assert n_killed >= KILLS / 2  # the others were done before
