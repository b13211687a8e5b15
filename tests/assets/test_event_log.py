"""Dagster's event log: what is stored is found by the next process, and its database stays open."""

import dagster as dg

from herijk.assets.runs import instance_of
from herijk.warehouse.store.store import Store


def _connection(log):
    with log.index_connection() as connection:
        return connection.connection.dbapi_connection


def test_events_are_kept(tmp_path):
    with instance_of(Store(tmp_path)) as instance:
        instance.report_runless_asset_event(dg.AssetMaterialization("tows"))
    with instance_of(Store(tmp_path)) as instance:
        assert instance.get_latest_materialization_event(dg.AssetKey("tows")) is not None
        assert instance.get_latest_materialization_event(dg.AssetKey("curves")) is None


def test_the_database_stays_open_until_the_end(tmp_path):
    with instance_of(Store(tmp_path)) as instance:
        log = instance.event_log_storage
        assert _connection(log) is _connection(log)
    assert not list(tmp_path.rglob("*-wal"))
