"""Dagster's records of a data folder, and the one run in which a rebuild makes assets."""

import os
import shutil
import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Final
from unittest import mock

import dagster as dg
import yaml  # type: ignore[import-untyped]
from sqlalchemy import event
from sqlalchemy.engine import Engine

from assets.archive import SEASONS, observe
from assets.location import assets_of
from assets.progress import Progress
from assets.report import Done
from assets.resources import QUIET_LOG, Setup
from assets.stale import Stale
from pipeline.errors import MissingKnowledgeError
from warehouse.intake import seasons as intake
from warehouse.store.files import written_beside
from warehouse.store.lock import nobody_writes
from warehouse.store.store import Store

INSTANCE_SETTINGS = Path(__file__).with_name("dagster.yaml")
"""Dagster's settings for a new data folder."""

OF_A_COMMAND: Final = {"herijk/by": "rebuild"}
"""Marks runs that live and die with the process of a rebuild."""


@event.listens_for(Engine, "connect")
def _without_waiting_for_the_disk(connection: object, _: object) -> None:
    """Dagster commits 500 times in a run. Its records survive a kill, and can be made again."""
    if isinstance(connection, sqlite3.Connection):
        connection.execute("PRAGMA synchronous = OFF")


def run_assets(
    setup: Setup, progress: Progress, stale: Stale, done: Done
) -> Sequence[dg.AssetCheckEvaluation]:
    """Makes assets in one run; an error is raised as it is.

    Seasons can be asked for as a range only: those between confirm that they are fresh.

    Returns:
        What the checks said.
    """
    defs = assets_of(setup, progress)
    graph = defs.resolve_asset_graph()
    store = setup.store
    with instance_of(store) as instance:
        _end_lost_runs(instance)
        known = _add_seasons(instance, [str(s) for s in intake.listed_seasons(store)])
        changed = observe(instance, setup)
        seasons = {*map(str, stale.seasons), *(season for _, season in changed)}
        chosen = [s for s in known if s in seasons and setup.wanted([s])]
        assets = {dg.AssetKey(name) for name in stale.assets}
        for name, season in changed:
            if season is None or season in chosen:
                assets |= graph.get(dg.AssetKey(name)).child_keys
        ends = {"start": chosen[0], "end": chosen[-1]} if chosen else {}
        result = defs.resolve_implicit_global_asset_job_def().execute_in_process(
            instance=instance,
            asset_selection=sorted(assets),
            run_config=QUIET_LOG,
            tags=OF_A_COMMAND
            | {f"dagster/asset_partition_range_{end}": season for end, season in ends.items()},
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


def _add_seasons(instance: dg.DagsterInstance, listed: Sequence[str]) -> Sequence[str]:
    """Makes the seasons of the archive those of Dagster; gives them in Dagster's order."""
    kind = str(SEASONS.name)
    instance.add_dynamic_partitions(kind, listed)
    for season in set(instance.get_dynamic_partitions(kind)) - {*listed}:
        instance.delete_dynamic_partition(kind, season)
    return instance.get_dynamic_partitions(kind)


def taking_over(store: Store) -> Iterator[str]:
    """Ends the runs of a server that was stopped or killed: later ones would wait for them.

    Returns:
        A sentence for anyone who starts the new server, about each kind of run.
    """
    if not nobody_writes(store.root):
        yield "A rebuild is at work; scheduled ones wait for it."
        return
    with instance_of(store) as instance:
        dead = instance.get_runs(dg.RunsFilter(statuses=list(_BEGUN)))
        for run in dead:
            instance.report_run_failed(run, "The process it was part of was stopped or killed.")
        waiting = instance.get_runs_count(dg.RunsFilter(statuses=[dg.DagsterRunStatus.QUEUED]))
    if dead:
        yield f"{len(dead)} runs that were stopped or killed are recorded as failed."
    if waiting:
        yield f"{waiting} runs wait in the queue, and are done now one by one."


_BEGUN: Final = (
    dg.DagsterRunStatus.STARTED,
    dg.DagsterRunStatus.STARTING,
    dg.DagsterRunStatus.CANCELING,
)


def _end_lost_runs(instance: dg.DagsterInstance) -> None:
    """Records runs of killed rebuilds as failed; only the holder of the lock can tell."""
    unfinished = dg.RunsFilter(tags=OF_A_COMMAND, statuses=[dg.DagsterRunStatus.STARTED])
    for run in instance.get_runs(unfinished):
        instance.report_run_failed(run, "The rebuild it was part of was killed.")


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
