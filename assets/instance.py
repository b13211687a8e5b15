"""Dagster's records of a data folder, and the one run in which a rebuild makes assets."""

import os
import shutil
import sqlite3
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Final
from unittest import mock

import dagster as dg
import yaml  # type: ignore[import-untyped]
from sqlalchemy import event
from sqlalchemy.engine import Engine

from assets.archive import know_seasons
from assets.location import assets_of
from assets.report import Done
from assets.resources import Setup
from pipeline.errors import MissingKnowledgeError
from warehouse.store.files import written_beside
from warehouse.store.store import Store

INSTANCE_SETTINGS: Final = Path(__file__).with_name("dagster.yaml")
"""Dagster's settings for a new data folder."""

OF_A_COMMAND: Final = {"herijk/by": "rebuild"}
"""Marks runs that live and die with the process of a rebuild."""

QUIET_LOG: Final = {"loggers": {"console": {"config": {"log_level": "CRITICAL"}}}}
"""Nothing on the terminal: what Dagster says is in its records."""


@event.listens_for(Engine, "connect")
def _without_waiting_for_the_disk(connection: object, _: object) -> None:
    """Dagster commits 500 times in a run. Its records survive a kill, and can be made again."""
    if isinstance(connection, sqlite3.Connection):
        connection.execute("PRAGMA synchronous = OFF")


def run_assets(setup: Setup, names: Sequence[str], done: Done) -> Sequence[dg.AssetCheckEvaluation]:
    """Makes assets in one run, with all seasons that are wanted; an error is raised as it is.

    Seasons can be asked for as a range only: those between confirm that they are fresh.

    Returns:
        What the checks said.
    """
    job = assets_of(setup).resolve_implicit_global_asset_job_def()
    with instance_of(setup.store) as instance:
        end_lost_runs(instance, OF_A_COMMAND)
        seasons = [s for s in know_seasons(instance, setup.store) if setup.wanted([s])]
        ends = {"start": seasons[0], "end": seasons[-1]} if seasons else {}
        ranges = {f"dagster/asset_partition_range_{end}": season for end, season in ends.items()}
        result = job.execute_in_process(
            instance=instance,
            asset_selection=[dg.AssetKey(name) for name in names],
            run_config=QUIET_LOG,
            tags=OF_A_COMMAND | ranges,
        )
    for made in result.get_asset_materialization_events():
        _note(done, made.materialization, setup.methods)
    return result.get_asset_check_evaluations()


def _note(done: Done, made: dg.AssetMaterialization, methods: Sequence[str]) -> None:
    """Notes what was made anew."""
    new = made.metadata.get("new")
    if new is None or not new.value:
        return
    match made.asset_key.to_user_string():
        case "samples":
            done.seasons = sorted({*done.seasons, int(str(made.partition))})
        case "curves" if isinstance(new.value, list):
            done.methods = [name for name in methods if name in (*done.methods, *new.value)]
        case "warehouse_database":
            done.database = True


def end_lost_runs(instance: dg.DagsterInstance, tags: Mapping[str, str]) -> None:
    """Records runs as failed whose process was killed: nobody else would, and others wait.

    Rebuilds ask it of their own kind, as holders of the lock; a new server of all that began.
    """
    begun = [
        dg.DagsterRunStatus.STARTED,
        dg.DagsterRunStatus.STARTING,
        dg.DagsterRunStatus.CANCELING,
    ]
    for run in instance.get_runs(dg.RunsFilter(tags=tags, statuses=begun)):
        instance.report_run_failed(run, "The process it was part of was stopped or killed.")


@contextmanager
def instance_of(store: Store) -> Iterator[dg.DagsterInstance]:
    """Dagster's own records: where `DAGSTER_HOME` says, or under the data folder."""
    home = prepare_home(store)
    try:
        with mock.patch.dict(os.environ, DAGSTER_HOME=str(home)):
            opened = dg.DagsterInstance.from_config(str(home))
    except (yaml.YAMLError, dg.DagsterError) as error:
        what = " ".join(str(error).split())[:200]
        raise MissingKnowledgeError(
            "{} cannot be understood: {}. Mend it, or remove it: it is made again "
            "with the usual settings",
            home / "dagster.yaml",
            what,
        ) from error
    with opened as instance:
        yield instance


def prepare_home(store: Store) -> Path:
    """Dagster's folder, with settings that may be changed by hand afterwards."""
    home = Path(os.environ.get("DAGSTER_HOME") or store.dagster_home)
    settings = home / "dagster.yaml"
    if not settings.exists():
        with written_beside(settings) as beside:
            shutil.copyfile(INSTANCE_SETTINGS, beside)
    return home.resolve()
