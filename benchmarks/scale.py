"""Seasons read by one and by two Dask workers into S3 storage, and by this process into a folder.

    python benchmarks/scale.py [tows a season] [repeats]

Scheduler and workers (one thread each) are processes of their own; this process serves S3.
Each repeat begins with an empty lake, one worker and two by turns. The tables of every repeat have
to be those read here. A last round kills a worker halfway. Busy machines give low ratios, so the
load is printed beside them.
"""

import os
import platform
import signal
import statistics
import sys
import tempfile
import threading
import time
from pathlib import Path

import polars as pl
from polars.testing import assert_frame_equal

from assets.cluster import read_seasons
from assets.rebuild import _instance
from pipeline.simulate import WorldSettings, simulate_world
from tests.elsewhere import dask_cluster, lie_in_bucket, s3_server
from warehouse import intake
from warehouse.archive.write import write_simulated_archive
from warehouse.store import Store

SEASONS = tuple(range(2009, 2017))
RATE_HZ = 1000


def read_here(archive, store):
    """Seconds, and of them those of a processor, to read every season here into a folder."""
    intake.index(store, archive)
    start, used = time.perf_counter(), time.process_time()
    for season in SEASONS:
        intake.read_season(store, archive, season, lambda *_: None)
        intake.collect_blocks(store, season)
    return time.perf_counter() - start, time.process_time() - used


def megabytes(folder, pattern):
    return sum(file.stat().st_size for file in folder.rglob(pattern)) / 1e6


def read_there(archive, data, workers, kill=False):
    """Seconds to read every season on warm workers, into the bucket."""
    lie_in_bucket(data, data.name)
    store = Store(data)
    intake.index(store, archive)
    with _instance(store) as instance, dask_cluster(workers, store.dagster_home) as cluster:
        killer = threading.Thread(target=kill_one, args=(store, cluster), daemon=True)
        if kill:
            killer.start()
        start = time.perf_counter()
        read = read_seasons(instance, cluster.address, (archive, data), SEASONS, {})
        seconds = time.perf_counter() - start
    assert read.failed == {}, read.failed
    return seconds, store


def kill_one(store, cluster):
    """Kills a worker when the first tows are in the lake."""
    while next((store.lake / "blocks").iterdir(), None) is None:
        time.sleep(0.05)
    cluster.workers[0].send_signal(signal.SIGKILL)


def assert_same_tables(one, other):
    for table in intake.SEASON_TABLES:
        for season in map(str, SEASONS):
            assert_frame_equal(one.read(table, season), other.read(table, season))
            assert one.made_from(table, season) == other.made_from(table, season)


def main():
    tows = int(sys.argv[1]) if len(sys.argv) > 1 else 4
    repeats = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    number = tows * len(SEASONS)
    with tempfile.TemporaryDirectory() as folder, s3_server():
        root = Path(folder)
        archive = root / "archive"
        write_simulated_archive(archive, simulate_world(WorldSettings(SEASONS, tows, RATE_HZ)))
        here = Store(root / "here")
        here_s, processor_s = read_here(archive, here)
        print(
            f"{platform.machine()}, {os.cpu_count()} cores, python {platform.python_version()}, "
            f"polars {pl.__version__}; {number} tows at {RATE_HZ} Hz; date {time.strftime('%F')}"
        )
        print(f"here, into a folder, two threads: {here_s:.1f} s, {number / here_s:.2f} tows/s")
        print(f"processor: {processor_s / number:.2f} s a tow")
        sizes = {
            "text": megabytes(archive, "*.csv*"),
            "samples": megabytes(here.lake / "samples", "*.parquet"),
            "blocks": megabytes(here.lake / "blocks", "*.parquet"),
            "tables": megabytes(here.lake / "tables", "*.parquet"),
        }
        sizes["blocks in memory"] = here.read_all("blocks").estimated_size() / 1e6
        print("MB a tow: " + ", ".join(f"{n} {mb / number:.2f}" for n, mb in sizes.items()))
        seconds = {1: [], 2: []}
        for repeat in range(repeats):
            for workers, found in seconds.items():
                took, there = read_there(archive, root / f"{workers}-{repeat}", workers)
                assert_same_tables(here, there)
                found.append(took)
            took = " and ".join(f"{found[-1]:.1f} s" for found in seconds.values())
            print(f"  repeat {repeat}: {took}; load {os.getloadavg()[0]:.1f}", flush=True)
        for workers, found in seconds.items():
            middle = statistics.median(found)
            print(
                f"{workers} worker(s), into S3: median {middle:.1f} s, lowest {min(found):.1f} s, "
                f"{number / middle:.2f} tows/s"
            )
        ratios = [one / two for one, two in zip(*seconds.values(), strict=True)]
        print(f"two against one: median {statistics.median(ratios):.2f}, best {max(ratios):.2f}")
        took, there = read_there(archive, root / "killed", 2, kill=True)
        assert_same_tables(here, there)
        print(f"one of two killed: {took:.1f} s, the same tables")


if __name__ == "__main__":
    main()
