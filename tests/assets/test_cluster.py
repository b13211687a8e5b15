"""Seasons read by two Dask workers into a bucket are those read here into a folder."""

import signal
import threading
import time

import dagster as dg
import pytest
from polars.testing import assert_frame_equal

from assets import rebuild
from assets.cluster import read_seasons
from tests.elsewhere import dask_cluster, lie_in_bucket, s3_server
from warehouse import intake
from warehouse.intake import SEASON_TABLES
from warehouse.store import Store

SEASONS = [2009, 2014]


@pytest.fixture
def instance(tmp_path):
    """Dagster's records on disk, where workers find them too."""
    with rebuild._instance(Store(tmp_path / "data")) as found:
        yield found


@pytest.fixture
def remote(built, tmp_path):
    """A data folder with its lake in a bucket that holds the archive's lists and no season yet."""
    with s3_server():
        lie_in_bucket(tmp_path / "data", "cluster")
        store = Store(tmp_path / "data")
        intake.index(store, built.archive)
        yield store


def kill_when_something_is_read(store, worker):
    """Kills a worker as soon as the first tow is in the lake."""
    while next((store.lake / "samples").iterdir(), None) is None:
        time.sleep(0.01)
    worker.send_signal(signal.SIGKILL)


def test_two_workers_of_which_one_is_killed_give_the_same_tables(built, remote, instance):
    with dask_cluster(2, remote.dagster_home) as cluster:
        killer = threading.Thread(
            target=kill_when_something_is_read, args=(remote, cluster.workers[0]), daemon=True
        )
        killer.start()
        folders = (built.archive, remote.root)
        read = read_seasons(instance, cluster.address, folders, SEASONS, {})
        killer.join()
        assert cluster.workers[0].wait() == -signal.SIGKILL
    assert read.failed == {}
    for table in SEASON_TABLES:
        for season in map(str, SEASONS):
            assert_frame_equal(remote.read(table, season), built.store.read(table, season))
            assert remote.made_from(table, season) == built.store.made_from(table, season)
    assert intake.stale_seasons(remote, built.archive) == []
    assert not (remote.root / "lake" / "tables").exists()
    for asset in ("samples", "blocks"):
        assert instance.get_materialized_partitions(dg.AssetKey(asset)) == set(map(str, SEASONS))
    assert {check.check_name for check in read.checks} == {"most_tows_sound"}
