"""A rebuild: the jobs of the code location, run in process, only where something changed.

The decision what is stale is `warehouse`'s; here it becomes Dagster runs, with their history in
the data folder.
"""

import datetime as dt
import os
import shutil
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final

import dagster as dg

from herijk.assets import partitions
from herijk.assets.jobs import BUILD_JOBS, CHECK, INDEX, NAMES, READ, SITE, job_defs
from herijk.assets.report import write_report
from herijk.assets.resources import QUIET_LOG, Progress, Setup
from herijk.assets.settings import read_settings
from herijk.assets.site import site_is_stale
from herijk.pipeline.errors import MissingKnowledgeError
from herijk.warehouse.build.graph import DATABASE
from herijk.warehouse.build.step import Step
from herijk.warehouse.intake import seasons as intake
from herijk.warehouse.intake.lake import ArchiveChangedError
from herijk.warehouse.queries.change_report import is_reported
from herijk.warehouse.store.files import written_beside
from herijk.warehouse.store.lock import nobody_writes, only_writer
from herijk.warehouse.store.machine_faults import machine_faults_explained
from herijk.warehouse.store.storage import Place
from herijk.warehouse.store.store import DamagedFileError, Store

INSTANCE_SETTINGS = Path(__file__).with_name("dagster.yaml")
"""Dagster's settings for a new data folder."""

STEP_TAG: Final = "herijk/step"
"""Marks runs that live and die with the process of a rebuild."""

ROUNDS: Final = 3
"""So many times a rebuild begins again because the archive changed under its hands."""


@dataclass
class Done:
    """What a rebuild did: seasons read again, methods applied again, database made again.

    Attributes:
        report: what changed and what the checks say (`assets.report`).
    """

    seasons: list[int] = field(default_factory=list)
    methods: list[str] = field(default_factory=list)
    database: bool = False
    report: dict[str, Any] = field(default_factory=dict, compare=False, repr=False)

    @property
    def work(self) -> dict[str, Any]:
        """The work alone, as plain data."""
        return {name: value for name, value in asdict(self).items() if name != "report"}


def rebuild(
    archive: Path,
    data: Path,
    methods: Sequence[str],
    progress: Progress,
    seasons: Collection[int] | None = None,
) -> Done:
    """Brings the data folder up to date with the archive, and reports what that changed.

    Files of ours that turn out to be damaged are made again. Where the archive changes during the
    rebuild, it begins again.

    Args:
        archive: the archive folder.
        data: the data folder; made if it is not there.
        methods: names of methods; the first is what the others are compared with.
        progress: is told what happens.
        seasons: seasons to read; None for all. Others stay as they are.

    Raises:
        HerijkError: there is no archive, a promise was broken, another rebuild is at work, or the
            machine is in the way.
    """
    check_apart(archive, data)
    with machine_faults_explained(data):
        settings = read_settings(data)
    setup = Setup(
        archive=str(archive),
        data=str(data),
        methods=list(methods),
        set_aside_share=settings.set_aside_share,
        factor_jump=settings.factor_jump,
    )
    with machine_faults_explained(data), only_writer(data), _instance(setup.store) as instance:
        _bury_the_dead(instance)
        work = _Rebuild(_Jobs(job_defs(setup, progress), instance), setup, progress, settings.dask)
        _mending(lambda: work.do(archive, seasons))
    return work.done


def _mending(work: Callable[[], None]) -> None:
    """Does the work; begins again without a file that is damaged, or when the archive changed."""
    damaged: set[Place] = set()
    rounds_left = ROUNDS
    while True:
        try:
            return work()
        except DamagedFileError as error:
            if error.path in damaged:
                raise
            damaged.add(error.path)
            error.path.unlink(missing_ok=True)
        except ArchiveChangedError:
            rounds_left -= 1
            if not rounds_left:
                raise


class _Rebuild:
    """One rebuild: knows what it did so far, also when it begins again."""

    def __init__(self, jobs: "_Jobs", setup: Setup, progress: Progress, dask: str | None) -> None:
        self.jobs, self.setup, self.progress, self.dask = jobs, setup, progress, dask
        self.store, self.done = setup.store, Done()

    def do(self, archive: Path, seasons: Collection[int] | None) -> None:
        """Everything that is stale, and the report."""
        self._read(archive, seasons)
        for step in BUILD_JOBS:
            self._build(step)
        self._make_site()
        if not is_reported(self.store):
            self.progress.step("checking the tables")
            self.jobs.run(CHECK)
        now = dt.datetime.now().astimezone()
        self.done.report = write_report(self.store, self.done.work, self.jobs.checks, now)

    def _read(self, archive: Path, seasons: Collection[int] | None) -> None:
        self.progress.step("looking what the archive holds")
        self.jobs.run(INDEX)
        intake.forget_unlisted_seasons(self.store)
        stale = intake.stale_seasons(self.store, archive, seasons)
        self.done.seasons = sorted({*self.done.seasons, *stale})
        if self.dask is not None and stale:
            stale = self._read_elsewhere(self.dask, stale)
        self.progress.expect(intake.count_listed(self.store, stale))
        for season in stale:
            self.jobs.run(READ, str(season))

    def _read_elsewhere(self, address: str, seasons: Sequence[int]) -> list[int]:
        """Has a Dask cluster read seasons; gives those to read here, where an error comes out."""
        self.progress.step(f"reading {len(seasons)} seasons on the Dask cluster at {address}")
        failed = self.jobs.run_on_dask(address, self.setup, seasons)
        for season, why in failed.items():
            self.progress.step(f"season {season} could not be read there ({why}); reading it here")
        return list(failed)

    def _build(self, step: Step) -> None:
        """Makes the tables of a step where they are stale, per method where they are made so."""
        chosen = self.setup.chosen_methods
        for methods in [[m] for m in chosen] if step.per_method else [chosen]:
            if not step.is_stale(self.store, methods):
                continue
            method = methods[0].name if step.per_method else None
            self.progress.step(step.says.format(method))
            self.jobs.run(BUILD_JOBS[step], method)
            if method is not None and method not in self.done.methods:
                self.done.methods.append(method)
            self.done.database |= step is DATABASE

    def _make_site(self) -> None:
        if site_is_stale(self.store):
            self.progress.step("making the site")
            self.jobs.run(SITE)


class _Jobs:
    """Runs jobs in process; an error comes out as the step raised it."""

    def __init__(self, defs: dg.Definitions, instance: dg.DagsterInstance) -> None:
        self.defs, self.instance = defs, instance
        self._checks: dict[dg.AssetCheckKey, dg.AssetCheckEvaluation] = {}

    @property
    def checks(self) -> list[dg.AssetCheckEvaluation]:
        """What the checks said, each the last time."""
        return list(self._checks.values())

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

    def run_on_dask(self, address: str, setup: Setup, seasons: Sequence[int]) -> Mapping[int, str]:
        """Has a cluster read seasons; gives why, for those that it could not read."""
        try:
            from herijk.assets.cluster import read_seasons  # noqa: PLC0415 - needs the extra dask
        except ImportError as error:
            raise MissingKnowledgeError(
                f"to read on {address} a library is needed that is not there; install it with: "
                "pip install 'herijk[dask]'"
            ) from error
        folders = setup.archive_root, setup.store.root
        read = read_seasons(self.instance, address, folders, seasons, {STEP_TAG: READ})
        self._keep(read.checks)
        return read.failed

    def _keep(self, checks: Iterable[dg.AssetCheckEvaluation]) -> None:
        self._checks |= {check.asset_check_key: check for check in checks}


def check_apart(archive: Path, data: Path) -> None:
    """Refuses an archive in the data folder: a rebuild would write among what it reads.

    Raises:
        MissingKnowledgeError: the archive is the data folder, or lies in it.
    """
    if archive.resolve().is_relative_to(data.resolve()):
        raise MissingKnowledgeError(
            f"the archive {archive} lies in the data folder {data}, or is the same; name a data "
            "folder outside the archive with --data"
        )


def taking_over(store: Store) -> Iterator[str]:
    """Ends the runs of a server that was stopped or killed: later ones would wait for them.

    Returns:
        A sentence for anyone who starts the new server, about each kind of run that was found.
    """
    if not nobody_writes(store.root):
        yield "A rebuild is at work; scheduled ones wait for it."
        return
    with _instance(store) as instance:
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


def _bury_the_dead(instance: dg.DagsterInstance) -> None:
    """Records runs of killed rebuilds as failed; only who holds the lock can tell."""
    unfinished = dg.RunsFilter(tags={STEP_TAG: list(NAMES)}, statuses=[dg.DagsterRunStatus.STARTED])
    for run in instance.get_runs(unfinished):
        instance.report_run_failed(run, "The rebuild it was part of was killed.")


@contextmanager
def _instance(store: Store) -> Iterator[dg.DagsterInstance]:
    """Dagster's own records, under the data folder."""
    home = prepare_home(store)
    os.environ["DAGSTER_HOME"] = str(home)
    with dg.DagsterInstance.from_config(str(home)) as instance:
        yield instance


def prepare_home(store: Store) -> Path:
    """Dagster's folder, with settings that may be changed by hand afterwards."""
    settings = store.dagster_home / "dagster.yaml"
    if not settings.exists():
        with written_beside(settings) as beside:
            shutil.copyfile(INSTANCE_SETTINGS, beside)
    return store.dagster_home.resolve()
