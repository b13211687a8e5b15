"""The run of a rebuild in Dagster, with its history in the data folder."""

import os
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Final

import dagster as dg
import yaml  # type: ignore[import-untyped]

from herijk.assets import checks, partitions
from herijk.assets.archive import blocks_result, index_result, samples_result
from herijk.assets.events import Result, events_of
from herijk.assets.resources import QUIET_LOG, Setup
from herijk.assets.side_by_side import Read, Task, side_by_side
from herijk.assets.site import make_site
from herijk.assets.tables import results_of
from herijk.pipeline.errors import MissingKnowledgeError
from herijk.warehouse.store.files import written_beside
from herijk.warehouse.store.lock import nobody_writes
from herijk.warehouse.store.store import Store

INSTANCE_SETTINGS = Path(__file__).with_name("dagster.yaml")
"""Dagster's settings for a new data folder."""

STEP_TAG: Final = "herijk/step"
"""Marks runs that live and die with the process of a rebuild."""

WORK: Final = "make_what_is_stale"
"""The run in which a rebuild does its work."""

READ: Final = "read_season"
"""The run in which a Dask cluster reads seasons for it."""


class Work:
    """The pieces of a rebuild, each recorded in the rebuild's run as its asset would be.

    A thread of its own writes the records, in order: each waits for the disk four times.
    """

    def __init__(
        self, setup: Setup, run: dg.OpExecutionContext, other: Executor, clerk: Executor
    ) -> None:
        self.setup, self.run, self.other, self.clerk = setup, run, other, clerk
        self.checks: list[dg.AssetCheckEvaluation] = []
        self.records: list[Future[None]] = []

    def record_index(self) -> None:
        """Notes that the archive was looked through."""
        self._record(index_result(self.setup.store))

    def record_seasons(self, seasons: Sequence[int], readings: Sequence[Read]) -> None:
        """Notes what reading seasons gave."""
        self._add_partition(partitions.seasons, *map(str, seasons))
        for season, read in zip(seasons, readings, strict=True):
            self._record(samples_result(read.index), str(season))
            self._record(blocks_result(read.blocks), str(season))

    def build(self, tasks: Sequence[Task]) -> None:
        """Makes the tables of steps that do not wait for each other."""
        made = side_by_side(tasks, self.other, Task.do)
        for task, tables in zip(tasks, made, strict=True):
            method = task.method
            if method is not None:
                self._add_partition(partitions.methods, method)
            for result in results_of(tables):
                self._record(result, method)

    def make_site(self) -> None:
        """Makes the pages."""
        self._record(make_site(self.setup.store, self.other))

    def check(self) -> None:
        """Runs the checks that look at the whole."""
        for result in checks.results(self.setup):
            self._record(result)

    def read_on_dask(
        self, address: str, folders: tuple[Path, Path], seasons: Sequence[int]
    ) -> Mapping[int, str]:
        """Has a cluster read seasons from archive to data; why, for each that it could not."""
        try:
            from herijk.assets.cluster import read_seasons  # noqa: PLC0415 - needs the extra dask
        except ImportError as error:
            raise MissingKnowledgeError(
                "to read on {} a library is needed that is not there; install it "
                "with: pip install 'herijk[dask]'",
                address,
            ) from error
        tags = {STEP_TAG: READ}
        checked, failed = read_seasons(self.run.instance, address, folders, seasons, tags)
        self.checks += checked
        return failed

    def _add_partition(self, kind: dg.DynamicPartitionsDefinition, *names: str) -> None:
        self.run.instance.add_dynamic_partitions(str(kind.name), names)

    def _record(self, result: Result, partition: str | None = None) -> None:
        for event in events_of(result, partition):
            # Its annotation leaves out checks, which it takes too.
            self.records.append(self.clerk.submit(self.run.log_event, event))  # type: ignore[arg-type]
            if isinstance(event, dg.AssetCheckEvaluation):
                self.checks.append(event)

    def wait_for_records(self) -> None:
        """Waits until everything is written; raises what went wrong in writing."""
        for record in self.records:
            record.result()


def in_one_run(
    setup: Setup, other: Executor, work: Callable[[Work], None]
) -> list[dg.AssetCheckEvaluation]:
    """Does work in a run of Dagster; the caller holds the lock, and an error is raised as it is.

    A run costs a second and more, so a rebuild is one and not one for each of its thirty pieces.

    Returns:
        What the checks said.
    """
    checked: list[dg.AssetCheckEvaluation] = []

    @dg.op(name=WORK)
    def whole(context: dg.OpExecutionContext) -> None:
        with ThreadPoolExecutor(1) as clerk:
            pieces = Work(setup, context, other, clerk)
            work(pieces)
            pieces.wait_for_records()
            checked.extend(pieces.checks)

    @dg.job(name=WORK)
    def job() -> None:
        whole()

    with instance_of(setup.store) as instance:
        _end_lost_runs(instance)
        job.execute_in_process(instance=instance, run_config=QUIET_LOG, tags={STEP_TAG: WORK})
    return checked


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
    unfinished = dg.RunsFilter(
        tags={STEP_TAG: [WORK, READ]}, statuses=[dg.DagsterRunStatus.STARTED]
    )
    for run in instance.get_runs(unfinished):
        instance.report_run_failed(run, "The rebuild it was part of was killed.")


@contextmanager
def instance_of(store: Store) -> Iterator[dg.DagsterInstance]:
    """Dagster's own records, under the data folder."""
    home = prepare_home(store)
    os.environ["DAGSTER_HOME"] = str(home)
    try:
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
    settings = store.dagster_home / "dagster.yaml"
    if not settings.exists():
        with written_beside(settings) as beside:
            shutil.copyfile(INSTANCE_SETTINGS, beside)
    return store.dagster_home.resolve()
