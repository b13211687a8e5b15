"""Seasons read by two Dask workers into a bucket are those read here into a folder."""

import signal
import threading
import time

import dagster as dg
import dask
import pytest
from polars.testing import assert_frame_equal

from assets import rebuild
from assets.cluster import read_seasons
from pipeline.errors import UnavailableError
from tests.elsewhere import dask_cluster, lie_in_bucket
from warehouse import intake
from warehouse.intake import SEASON_TABLES
from warehouse.store import Store

SEASONS = [2009, 2014]


@pytest.fixture(scope="module")
def remote(built, s3, tmp_path_factory):
    """A data folder with its lake in a bucket that holds the archive's lists and no season yet."""
    data = tmp_path_factory.mktemp("remote")
    lie_in_bucket(data, "cluster")
    intake.index(Store(data), built.archive)
    return Store(data)


@pytest.fixture(scope="module")
def instance(remote):
    """Dagster's records on disk, where workers find them too."""
    with rebuild._instance(remote) as found:
        yield found


@pytest.fixture(scope="module")
def cluster(remote):
    with dask_cluster(2, remote.dagster_home) as found:
        yield found


def kill_when_the_other_is_done(store, worker, done):
    """Kills a worker when a season is read; notes which were then."""
    while not store.partitions("blocks"):
        time.sleep(0.05)
    done += store.partitions("blocks")
    worker.kill()


def test_the_step_of_a_killed_worker_goes_to_another_and_tables_are_the_same(
    built, remote, instance, cluster
):
    done, stuck = [], cluster.workers[0]
    stuck.send_signal(signal.SIGSTOP)  # it will be given a step and not finish it
    arguments = (remote, stuck, done)
    threading.Thread(target=kill_when_the_other_is_done, args=arguments, daemon=True).start()
    folders = (built.archive, remote.root)
    read = read_seasons(instance, cluster.address, folders, SEASONS, {})
    assert stuck.wait() == -signal.SIGKILL
    assert len(done) == 1
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


def test_a_season_that_a_worker_cannot_read_is_told(built, remote, instance, cluster):
    elsewhere = remote.root / "without-settings"  # so the worker looks for a lake in it
    read = read_seasons(instance, cluster.address, (built.archive, elsewhere), [2009], {})
    assert list(read.failed) == [2009]
    assert "without-settings/lake/tables/listed_tows.parquet" in read.failed[2009]


def test_a_cluster_that_is_not_there_is_told_with_the_way_out(built, remote, instance):
    with (
        dask.config.set({"distributed.comm.timeouts.connect": "0.2s"}),
        pytest.raises(UnavailableError, match=r"tcp://127\.0\.0\.1:1 did not finish"),
    ):
        read_seasons(instance, "tcp://127.0.0.1:1", (built.archive, remote.root), SEASONS, {})
