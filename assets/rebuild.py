"""A rebuild: the jobs of the code location, run in process, only where something changed.

The decision what is stale is `warehouse`'s; here it becomes Dagster runs, with their history in
the data folder.
"""

import os
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import dagster as dg

from assets.definitions import APPLY, COLLECT, FINISH, INDEX, READ, STUDY, build_defs
from assets.resources import Progress, Setup
from assets.site import site_is_stale
from warehouse import intake, tables
from warehouse.files import written_beside
from warehouse.store import Store
from warehouse.summaries import summaries_are_stale

INSTANCE_SETTINGS = """\
telemetry:
  enabled: false
event_log_storage:
  module: dagster._core.storage.event_log
  class: ConsolidatedSqliteEventLogStorage
  config:
    base_dir: {env: DAGSTER_HOME}
run_storage:
  module: dagster._core.storage.runs
  class: SqliteRunStorage
  config:
    base_dir: {env: DAGSTER_HOME}
schedule_storage:
  module: dagster._core.storage.schedules
  class: SqliteScheduleStorage
  config:
    base_dir: {env: DAGSTER_HOME}
"""
"""Consolidated, because a database of its own for every run costs half a second each."""

QUIET_LOG = {"loggers": {"console": {"config": {"log_level": "CRITICAL"}}}}


@dataclass
class Done:
    """What a rebuild did: seasons read again, methods applied again, database made again."""

    seasons: list[int] = field(default_factory=list)
    methods: list[str] = field(default_factory=list)
    database: bool = False


def rebuild(
    archive: Path,
    data: Path,
    methods: Sequence[str],
    progress: Progress,
    seasons: Collection[int] | None = None,
) -> Done:
    """Brings the data folder up to date with the archive.

    Args:
        archive: the archive folder.
        data: the data folder; made if it is not there.
        methods: names of methods; the first is what the others are compared with.
        progress: is told what happens.
        seasons: seasons to read; None for all. Others stay as they are.

    Raises:
        HerijkError: there is no archive, or a promise was broken.
    """
    setup = Setup(archive=str(archive), data=str(data), methods=list(methods))
    store, done = setup.store, Done()
    with _instance(store) as instance:
        jobs = _Jobs(build_defs(setup, progress), instance)
        progress.step("looking what the archive holds")
        jobs.run(INDEX)
        intake.forget_unlisted_seasons(store)
        done.seasons = intake.stale_seasons(store, archive, seasons)
        progress.expect(intake.count_listed(store, done.seasons))
        for season in done.seasons:
            jobs.run(READ, str(season))
        if tables.archive_is_stale(store):
            progress.step("collecting boats, tows and what was set aside")
            jobs.run(COLLECT)
        done.methods = [m.name for m in setup.chosen_methods if tables.method_is_stale(store, m)]
        for name in done.methods:
            progress.step(f"applying method {name} to all tows")
            jobs.run(APPLY, name)
        if tables.studies_are_stale(store, setup.chosen_methods):
            progress.step("finding what each step changes, and how much choices matter")
            jobs.run(STUDY)
        done.database = _finish(jobs, setup, progress)
    return done


def _finish(jobs: "_Jobs", setup: Setup, progress: Progress) -> bool:
    chosen = setup.chosen_methods
    if not (
        tables.register_is_stale(setup.store, chosen)
        or summaries_are_stale(setup.store, [method.name for method in chosen])
        or tables.database_is_stale(setup.store, chosen)
        or site_is_stale(setup.store)
    ):
        return False
    progress.step("making registers, the database and the site")
    jobs.run(FINISH)
    return True


class _Jobs:
    """Runs jobs in process; an error comes out as the step raised it."""

    def __init__(self, defs: dg.Definitions, instance: dg.DagsterInstance) -> None:
        self.defs, self.instance = defs, instance

    def run(self, job: str, partition: str | None = None) -> None:
        if job == READ and partition is not None:
            self.instance.add_dynamic_partitions("season", [partition])
        self.defs.resolve_job_def(job).execute_in_process(
            instance=self.instance, partition_key=partition, run_config=QUIET_LOG
        )


@contextmanager
def _instance(store: Store) -> Iterator[dg.DagsterInstance]:
    """Dagster's own records, under the data folder."""
    home = store.dagster_home
    home.mkdir(parents=True, exist_ok=True)
    settings = home / "dagster.yaml"
    if not settings.exists():
        with written_beside(settings) as beside:
            beside.write_text(INSTANCE_SETTINGS, encoding="utf-8")
    os.environ["DAGSTER_HOME"] = str(home.resolve())
    with dg.DagsterInstance.from_config(str(home.resolve())) as instance:
        yield instance
