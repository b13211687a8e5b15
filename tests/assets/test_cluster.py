"""A rebuild with its seasons read on Dask: what it makes is the same."""

import datetime as dt
import os
import shutil
import signal
import threading
import time
from contextlib import contextmanager
from unittest import mock

import dagster as dg
import pytest

from herijk.assets import rebuild, runs
from herijk.pipeline.errors import UnavailableError
from herijk.pipeline.method.definition import shipped_method
from herijk.warehouse.editions.publish import Terms, publish
from herijk.warehouse.intake import seasons as intake
from herijk.warehouse.store.store import Store
from tests.assets.test_rebuild import assert_same_tables
from tests.conftest import METHODS, SMALL, Workbench
from tests.elsewhere import assert_same_lake, dask_cluster, edition_hashes
from tests.quiet import Quiet

DAY = dt.date(2026, 5, 1)


@pytest.fixture(scope="module")
def remote(built, tmp_path_factory):
    """A data folder in which nothing was made yet."""
    return Workbench(built.archive, tmp_path_factory.mktemp("remote"))


@contextmanager
def dask_here(remote, workers):
    """The address of a Dask scheduler with workers, all in this process."""
    from distributed import LocalCluster  # noqa: PLC0415 - takes seconds to import

    small = {"n_workers": workers, "threads_per_worker": 1, "dashboard_address": None}
    with (
        mock.patch.dict(os.environ, DAGSTER_HOME=str(remote.store.dagster_home)),
        LocalCluster(processes=False, protocol="tcp://", host="127.0.0.1", **small) as cluster,
    ):
        yield cluster.scheduler_address


class Told(Quiet):
    """Progress that keeps the steps."""

    def __init__(self):
        self.steps = []

    def step(self, what):
        self.steps.append(what)


def kill_when_the_other_is_done(store, worker, done):
    """Kills a worker when a season is read; notes which were then."""
    while not store.partitions("blocks"):
        time.sleep(0.05)
    done += store.partitions("blocks")
    worker.kill()


def published(store):
    """Hashes of the files of an edition that is published now."""
    method = shipped_method(METHODS[1])
    publish(store, method, Terms("2026-1", dt.date(2026, 5, 8), "ALV 2026", DAY))
    return edition_hashes(store, "2026-1")


@pytest.mark.slow
def test_a_rebuild_of_which_a_worker_is_killed_makes_what_is_made_here(built, remote, tmp_path):
    with dask_cluster(2, remote.store.dagster_home) as cluster:
        rebuild_while_a_worker_is_killed(remote, cluster)
    assert_same_lake(built.store, remote.store)
    assert_same_tables(remote.tables(), built.tables())
    shutil.copytree(built.data, tmp_path / "here")
    assert published(remote.store) == published(Store(tmp_path / "here"))
    assert intake.stale_seasons(remote.store, remote.archive) == []
    with runs.instance_of(remote.store) as instance:
        seasons = set(map(str, SMALL.seasons))
        for asset in ("samples", "blocks"):
            assert instance.get_materialized_partitions(dg.AssetKey(asset)) == seasons


def rebuild_while_a_worker_is_killed(remote, cluster):
    (remote.data / "beheer.toml").write_text(f'dask = "{cluster.address}"\n')
    done, stuck, told = [], cluster.workers[0], Told()
    stuck.send_signal(signal.SIGSTOP)  # it will be given a step and not finish it
    arguments = (remote.store, stuck, done)
    threading.Thread(target=kill_when_the_other_is_done, args=arguments, daemon=True).start()
    rebuild.rebuild(remote.archive, remote.data, METHODS, told)
    assert stuck.wait() == -signal.SIGKILL
    assert len(done) == 1
    assert not [step for step in told.steps if "reading it here" in step]


def test_a_season_that_a_worker_cannot_read_is_told(built, remote):
    from herijk.assets.cluster import read_seasons  # noqa: PLC0415 - takes seconds to import

    elsewhere = remote.data / "without-settings"  # so the worker looks for a lake in it
    with runs.instance_of(remote.store) as instance, dask_here(remote, 1) as address:
        folders = built.archive, elsewhere
        _, failed = read_seasons(instance, address, folders, [2009], {})
    assert list(failed) == [2009]
    assert "without-settings/lake/tables/listed_tows.parquet" in failed[2009]


def test_a_cluster_that_is_not_there_is_told_with_the_way_out(built, remote):
    import dask  # noqa: PLC0415 - takes seconds to import

    from herijk.assets.cluster import read_seasons  # noqa: PLC0415 - takes seconds to import

    with (
        runs.instance_of(remote.store) as instance,
        dask.config.set({"distributed.comm.timeouts.connect": "0.2s"}),
        pytest.raises(UnavailableError, match=r"tcp://127\.0\.0\.1:1 did not finish"),
    ):
        read_seasons(instance, "tcp://127.0.0.1:1", (built.archive, remote.data), [2009], {})


def test_a_scheduler_without_workers_is_not_waited_for_without_end(built, remote):
    import dask  # noqa: PLC0415 - takes seconds to import

    from herijk.assets.cluster import read_seasons  # noqa: PLC0415 - takes seconds to import

    with (
        runs.instance_of(remote.store) as instance,
        dask.config.set({"distributed.scheduler.no-workers-timeout": "1s"}),
        dask_here(remote, 0) as deserted,
        pytest.raises(UnavailableError, match=r"did not finish.*without any running workers"),
    ):
        read_seasons(instance, deserted, (built.archive, remote.data), [2009], {})
