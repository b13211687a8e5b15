"""The runs of a rebuild in Dagster, with their history in the data folder."""

import os
import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Final

import dagster as dg
import yaml  # type: ignore[import-untyped]

from herijk.assets import partitions
from herijk.assets.archive import index_metadata
from herijk.assets.jobs import BUILD_JOBS, CHECK, NAMES, READ, SITE, job_defs
from herijk.assets.progress import Progress
from herijk.assets.resources import QUIET_LOG, Setup
from herijk.pipeline.errors import MissingKnowledgeError
from herijk.warehouse.archive import ArchiveIndex
from herijk.warehouse.build.step import Step
from herijk.warehouse.store.files import written_beside
from herijk.warehouse.store.lock import nobody_writes
from herijk.warehouse.store.store import Store

INSTANCE_SETTINGS = Path(__file__).with_name("dagster.yaml")
"""Dagster's settings for a new data folder."""

STEP_TAG: Final = "herijk/step"
"""Marks runs that live and die with the process of a rebuild."""


class Jobs:
    """Runs jobs in process; an error comes out as the step raised it."""

    def __init__(self, defs: dg.Definitions, instance: dg.DagsterInstance) -> None:
        self.defs, self.instance = defs, instance
        self._checks: dict[dg.AssetCheckKey, dg.AssetCheckEvaluation] = {}

    @property
    def checks(self) -> list[dg.AssetCheckEvaluation]:
        """What the checks said, each the last time."""
        return list(self._checks.values())

    def record_index(self, index: ArchiveIndex) -> None:
        """Notes that the archive was looked through, which takes no run of its own."""
        seen = dg.AssetMaterialization("archive_index", metadata=index_metadata(index))
        self.instance.report_runless_asset_event(seen)

    def read(self, season: int) -> None:
        """Reads a season."""
        self.run(READ, str(season))

    def build(self, step: Step, method: str | None) -> None:
        """Makes the tables of a step, for one method where they are made so."""
        self.run(BUILD_JOBS[step], method)

    def make_site(self) -> None:
        """Makes the pages."""
        self.run(SITE)

    def check(self) -> None:
        """Runs the checks that look at the whole."""
        self.run(CHECK)

    def run(self, job: str, partition: str | None = None) -> None:
        """Runs a job, for a season or method where it has partitions."""
        if partition is not None:
            kind = partitions.seasons if job == READ else partitions.methods
            self.instance.add_dynamic_partitions(str(kind.name), [partition])
        result = self.defs.resolve_job_def(job).execute_in_process(
            instance=self.instance,
            partition_key=partition,
            run_config=QUIET_LOG,
            tags={STEP_TAG: job},
        )
        self._keep(result.get_asset_check_evaluations())

    def read_on_dask(
        self, address: str, folders: tuple[Path, Path], seasons: Sequence[int]
    ) -> Mapping[int, str]:
        """Has a cluster read seasons from archive to data; gives why, for those it could not."""
        try:
            from herijk.assets.cluster import read_seasons  # noqa: PLC0415 - needs the extra dask
        except ImportError as error:
            raise MissingKnowledgeError(
                "to read on {} a library is needed that is not there; install it "
                "with: pip install 'herijk[dask]'",
                address,
            ) from error
        read = read_seasons(self.instance, address, folders, seasons, {STEP_TAG: READ})
        self._keep(read.checks)
        return read.failed

    def _keep(self, checks: Iterable[dg.AssetCheckEvaluation]) -> None:
        self._checks |= {check.asset_check_key: check for check in checks}


def taking_over(store: Store) -> Iterator[str]:
    """Ends the runs of a server that was stopped or killed: later ones would wait for them.

    Returns:
        A sentence for anyone who starts the new server, about each kind of run that was found.
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
    unfinished = dg.RunsFilter(tags={STEP_TAG: list(NAMES)}, statuses=[dg.DagsterRunStatus.STARTED])
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


@contextmanager
def opened_jobs(setup: Setup, progress: Progress) -> Iterator[Jobs]:
    """The jobs of a rebuild, by whoever holds the lock: runs of killed rebuilds are ended."""
    with instance_of(setup.store) as instance:
        _end_lost_runs(instance)
        yield Jobs(job_defs(setup, progress), instance)


def prepare_home(store: Store) -> Path:
    """Dagster's folder, with settings that may be changed by hand afterwards."""
    settings = store.dagster_home / "dagster.yaml"
    if not settings.exists():
        with written_beside(settings) as beside:
            shutil.copyfile(INSTANCE_SETTINGS, beside)
    return store.dagster_home.resolve()
