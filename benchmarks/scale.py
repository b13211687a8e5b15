"""Seasons read by one and by two Dask workers into S3 storage, and a rebuild of which one dies.

    PYTHONPATH=. python -m benchmarks.scale [--tows-per-season 60] [--seasons 8] [--repeats 3]

S3 server, scheduler and workers (one thread each) are processes of their own. Each round begins
with an empty bucket, and scheduler and workers that have imported everything; timed is the reading
of the seasons, one worker and two by turns. Processor seconds are shown apart for workers, server
and this process, since the server takes its share of the same cores. Every lake has to be the one
made here, table by table; so have, in the last round, the database and an edition of a whole
rebuild during which a worker is killed. The archive is that of `make bench`.
"""

import argparse
import datetime as dt
import os
import platform
import shutil
import signal
import statistics
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import duckdb
import polars as pl
from distributed import Client
from polars.testing import assert_frame_equal

from benchmarks.world import RATE_HZ, SEASONS, World
from herijk.assets import rebuild, runs
from herijk.assets.cluster import read_seasons
from herijk.pipeline.method.definition import shipped_method, shipped_methods
from herijk.warehouse.editions.publish import Terms, publish
from herijk.warehouse.intake import seasons as intake
from herijk.warehouse.store.store import Store
from tests.elsewhere import (
    Cluster,
    assert_same_lake,
    dask_cluster,
    edition_hashes,
    lie_in_bucket,
    s3_server,
)
from tests.quiet import Quiet

METHODS = tuple(shipped_methods())
TERMS = Terms("2026-1", dt.date(2026, 5, 8), "benchmark", dt.date(2026, 5, 1))


@dataclass(frozen=True)
class Round:
    """What it took to read the seasons: seconds elapsed, and of a processor by who used them."""

    seconds: float
    processor_s: dict[str, float]


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--tows-per-season", type=int, default=60)
    parser.add_argument("--seasons", type=int, default=8, help="how many of them are read")
    parser.add_argument("--repeats", type=int, default=3)
    chosen = parser.parse_args()
    seasons = SEASONS[: chosen.seasons]
    world = World(chosen.tows_per_season)
    if not world.archive.exists():
        world.make()
    with tempfile.TemporaryDirectory() as folder:
        compare(world.archive, Path(folder), seasons, chosen.repeats)


def compare(archive: Path, root: Path, seasons: Sequence[int], repeats: int) -> None:
    """Prints all figures; stops where a table differs."""
    here = Store(root / "here")
    start = time.perf_counter()
    rebuild.rebuild(archive, here.root, METHODS, Quiet(), seasons)
    took_here = time.perf_counter() - start
    tows = here.read_all("season_index")["blocks_key"].count()
    print(
        f"{platform.machine()}, {os.cpu_count()} cores, python {platform.python_version()}, "
        f"polars {pl.__version__}; {tows} tows at {RATE_HZ} Hz in {len(seasons)} seasons; "
        f"{dt.date.today()}; load {os.getloadavg()[0]:.1f}"
    )
    print(
        "MB per tow: "
        + ", ".join(f"{n} {mb / tows:.2f}" for n, mb in sizes(archive, here, seasons))
    )
    rounds: dict[int, list[Round]] = {1: [], 2: []}
    for repeat in range(repeats):
        for workers, found in rounds.items():
            found.append(read_there(archive, here, root / f"{workers}-{repeat}", workers, seasons))
            shares = ", ".join(f"{n} {s / tows:.3f}" for n, s in found[-1].processor_s.items())
            print(
                f"  {workers} worker(s): {found[-1].seconds:.1f} s; processor s per tow: {shares}; "
                f"load {os.getloadavg()[0]:.1f}",
                flush=True,
            )
    for workers, found in rounds.items():
        middle = statistics.median(one.seconds for one in found)
        print(f"{workers} worker(s): median {middle:.1f} s, {tows / middle:.2f} tows/s")
    pairs = zip(*rounds.values(), strict=True)
    ratios = sorted(one.seconds / two.seconds for one, two in pairs)
    print(
        f"two against one: median {statistics.median(ratios):.2f} of {ratios[0]:.2f} to "
        f"{ratios[-1]:.2f}; every lake the same"
    )
    took_there = rebuild_there(archive, here, root / "killed", seasons)
    print(
        f"whole rebuild, {len(METHODS)} methods: here {took_here:.1f} s; two workers of which one "
        f"is killed {took_there:.1f} s, with the same lake, database and edition"
    )


def sizes(archive: Path, here: Store, seasons: Sequence[int]) -> Iterator[tuple[str, float]]:
    """Megabytes of the seasons in the archive, in the lake by kind, and of blocks in memory."""
    yield "text", sum(megabytes(archive / f"meetdata_{season}") for season in seasons)
    for kind in ("samples", "blocks", "tables"):
        yield kind, megabytes(here.root / "lake" / kind)
    yield "blocks in memory", intake.all_blocks(here).estimated_size() / 1e6


def megabytes(folder: Path) -> float:
    return sum(file.stat().st_size for file in folder.rglob("*") if file.is_file()) / 1e6


def read_there(
    archive: Path, here: Store, data: Path, workers: int, seasons: Sequence[int]
) -> Round:
    """Reads every season on warm workers into an empty bucket."""
    with s3_server() as server:
        store = remote_store(data, here)
        intake.index(store, archive)
        with (
            runs.instance_of(store) as instance,
            dask_cluster(workers, store.dagster_home) as cluster,
        ):
            warm_up(cluster)
            with processor_seconds(cluster, server.pid) as used:
                start = time.perf_counter()
                read = read_seasons(instance, cluster.address, (archive, data), seasons, {})
                seconds = time.perf_counter() - start
        assert read.failed == {}, read.failed
        assert_same_seasons(here, store, seasons)
    return Round(seconds, used)


def rebuild_there(archive: Path, here: Store, data: Path, seasons: Sequence[int]) -> float:
    """Seconds of a whole rebuild during which a worker is killed."""
    with s3_server():
        store = remote_store(data, here)
        with dask_cluster(2, store.dagster_home) as cluster:
            (data / "beheer.toml").write_text(f'dask = "{cluster.address}"\n')
            threading.Thread(target=kill_one, args=(store, cluster), daemon=True).start()
            start = time.perf_counter()
            rebuild.rebuild(archive, data, METHODS, Quiet(), seasons)
            seconds = time.perf_counter() - start
            assert cluster.workers[0].poll() == -signal.SIGKILL
        assert_same_lake(here, store)
        assert_same_database(here, store)
        assert published(here) == published(store)
    return seconds


def remote_store(data: Path, here: Store) -> Store:
    """A data folder with its lake in the bucket; hashes of the archive's files are known."""
    lie_in_bucket(data, data.name)
    store = Store(data)
    store.file_hashes.parent.mkdir()
    shutil.copy(here.file_hashes, store.file_hashes)
    return store


def warm_up(cluster: Cluster) -> None:
    """Has every worker import what it needs, and the scheduler what it has to unpack."""
    with Client(cluster.address) as client:
        client.run_on_scheduler(__import__, "herijk.assets.cluster")
        for module in ("herijk.assets.cluster", "herijk.pipeline.blocks.sums"):
            client.run(__import__, module)


@contextmanager
def processor_seconds(cluster: Cluster, server: int) -> Iterator[dict[str, float]]:
    """Processor seconds used inside, by who used them; filled in at the end."""
    pids = {
        **{f"worker {n}": w.pid for n, w in enumerate(cluster.workers, start=1)},
        "S3 server": server,
        "this process": os.getpid(),
    }
    before = {name: processor_s(pid) for name, pid in pids.items()}
    used: dict[str, float] = {}
    yield used
    used |= {name: processor_s(pid) - before[name] for name, pid in pids.items()}


def processor_s(pid: int) -> float:
    """Processor seconds of a process until now: fields 14 and 15 of `/proc/PID/stat`."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def kill_one(store: Store, cluster: Cluster) -> None:
    """Kills a worker when the first blocks are in the lake."""
    while next((store.lake / "blocks").iterdir(), None) is None:
        time.sleep(0.05)
    cluster.workers[0].send_signal(signal.SIGKILL)


def assert_same_seasons(one: Store, other: Store, seasons: Sequence[int]) -> None:
    for table in intake.SEASON_TABLES:
        for season in map(str, seasons):
            assert_frame_equal(one.read(table, season), other.read(table, season), check_exact=True)
            assert one.made_from(table, season) == other.made_from(table, season)


def assert_same_database(one: Store, other: Store) -> None:
    with (
        duckdb.connect(one.database, read_only=True) as ours,
        duckdb.connect(other.database, read_only=True) as theirs,
    ):
        names = ours.sql("SHOW TABLES").pl()["name"].to_list()
        assert names == theirs.sql("SHOW TABLES").pl()["name"].to_list()
        for name in names:
            assert_frame_equal(ours.table(name).pl(), theirs.table(name).pl(), check_exact=True)


def published(store: Store) -> dict[str, str]:
    """Hashes of the files of an edition that is published now."""
    publish(store, shipped_method("rebased-2015"), TERMS)
    return edition_hashes(store, TERMS.edition)


if __name__ == "__main__":
    main()
