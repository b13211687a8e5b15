"""A rebuild: whatever is stale is made again, in one run of Dagster; then a report.

The decision what is stale is `warehouse`'s. Dagster is imported when there is work to do: looking
that there is none takes a second, importing it two.
"""

import datetime as dt
from collections.abc import Callable, Collection, Sequence
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Final

from herijk.assets.progress import Progress
from herijk.assets.report import Done, Report, write_report
from herijk.assets.settings import Settings, read_settings
from herijk.assets.side_by_side import Join, Read, Reading, Task, helper, shared, stages
from herijk.assets.site_state import site_is_stale
from herijk.pipeline.errors import MissingKnowledgeError
from herijk.pipeline.method.definition import Method
from herijk.warehouse.build.graph import DATABASE, STEPS
from herijk.warehouse.build.inputs import forget_other_methods
from herijk.warehouse.build.step import Step
from herijk.warehouse.intake import seasons as intake
from herijk.warehouse.intake.lake import ArchiveChangedError
from herijk.warehouse.queries.change_report import is_reported
from herijk.warehouse.store.lock import only_writer
from herijk.warehouse.store.machine_faults import machine_faults_explained
from herijk.warehouse.store.methods import KnownMethods
from herijk.warehouse.store.store import DamagedFileError, Store
from herijk.warehouse.store.unforeseen import FailedTowsError, set_aside
from herijk.words import tell

if TYPE_CHECKING:
    import dagster as dg

    from herijk.assets.runs import Work

ROUNDS: Final = 3
"""How often a rebuild begins at most, where the archive changes while it runs."""


def rebuild(
    archive: Path,
    data: Path,
    methods: Sequence[str],
    progress: Progress,
    seasons: Collection[int] | None = None,
) -> Report:
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
    with machine_faults_explained(data), only_writer(data):
        store = Store(data)
        known = [KnownMethods.of(store).get(name) for name in methods]
        work = _Rebuild(archive, store, known, progress, settings)
        return _mending(store, lambda: work.do(seasons))


def _mending(store: Store, work: Callable[[], Report]) -> Report:
    """Does the work; begins again without what is damaged or fails, or when the archive changed."""
    damaged: set[Path] = set()
    rounds_left = ROUNDS
    while True:
        try:
            return work()
        except DamagedFileError as error:
            if error.path in damaged:
                raise
            damaged.add(error.path)
            error.path.unlink(missing_ok=True)
        except FailedTowsError as error:
            set_aside(store, error)
        except ArchiveChangedError:
            rounds_left -= 1
            if not rounds_left:
                raise


@dataclass
class _Rebuild:
    """One rebuild: knows what it did so far, also when it begins again."""

    archive: Path
    store: Store
    methods: Sequence[Method]
    progress: Progress
    settings: Settings
    done: Done = field(default_factory=Done)

    def do(self, seasons: Collection[int] | None) -> Report:
        """Everything that is stale, and the report."""
        self.progress.step("looking at what the archive holds")
        intake.index(self.store, self.archive)
        intake.forget_unlisted_seasons(self.store)
        forget_other_methods(self.store, {method.name for method in self.methods})
        _check_listed(seasons, intake.listed_seasons(self.store))
        stale = intake.stale_seasons(self.store, self.archive, seasons)
        checks: Sequence[dg.AssetCheckEvaluation] = ()
        if stale or self._is_stale():
            checks = self._work(stale)
        now = dt.datetime.now().astimezone()
        return write_report(self.store, self.done, checks, now)

    def _is_stale(self) -> bool:
        """Whether anything that follows from the seasons has to be made again."""
        return (
            any(step.is_stale(self.store, m) for step in STEPS for m in self._applied_by(step))
            or site_is_stale(self.store)
            or not is_reported(self.store)
        )

    def _work(self, stale: list[int]) -> "Sequence[dg.AssetCheckEvaluation]":
        """Reads seasons and makes what is stale; gives what the checks said."""
        self.done.seasons = sorted({*self.done.seasons, *stale})
        with helper() as other:
            address = self.settings.dask
            if address is not None and stale:
                return self._work_with(other, lambda w: self._read_elsewhere(w, address, stale))
            with self._reading(stale, other) as join:  # it begins while we import Dagster
                return self._work_with(other, lambda work: self._read(work, stale, join))

    def _work_with(
        self, other: Executor, read: "Callable[[Work], None]"
    ) -> "Sequence[dg.AssetCheckEvaluation]":
        from herijk.assets.resources import Setup  # noqa: PLC0415 - see above
        from herijk.assets.runs import in_one_run  # noqa: PLC0415

        setup = Setup.of(
            self.archive, self.store.root, [m.name for m in self.methods], self.settings
        )

        def do(work: "Work") -> None:
            work.record_index()
            read(work)
            for stage in stages(STEPS):
                self._build(work, stage)
            if site_is_stale(self.store):
                self.progress.step("making the site")
                work.make_site()
            if not is_reported(self.store):
                self.progress.step("checking the tables")
                work.check()

        return in_one_run(setup, other, do)

    def _reading(
        self, seasons: Sequence[int], other: Executor
    ) -> "AbstractContextManager[Join[Reading, Read]]":
        """Has the other process begin to read seasons."""
        self.progress.expect(intake.count_listed(self.store, seasons))
        readings = [Reading(self.archive, self.store.root, season) for season in seasons]
        return shared(readings, other, Reading.do, came=self._tell)

    def _tell(self, read: Read) -> None:
        for tow_id, reason in read.index.select("tow_id", "reason_code").rows():
            self.progress.tow_read(tow_id, reason is not None)

    def _read(self, work: "Work", seasons: Sequence[int], join: "Join[Reading, Read]") -> None:
        """Joins in reading seasons."""
        work.record_seasons(seasons, join(lambda reading: reading.do(self.progress.tow_read)))

    def _read_elsewhere(self, work: "Work", address: str, seasons: Sequence[int]) -> None:
        """Has a Dask cluster read seasons; those it cannot are read here: an error comes out."""
        self.progress.step(
            tell("reading {} seasons on the Dask cluster at {}", len(seasons), address)
        )
        failed = work.read_on_dask(address, (self.archive, self.store.root), seasons)
        for season, why in failed.items():
            self.progress.step(
                tell("season {} could not be read there ({}); reading it here", season, why)
            )
        with self._reading(list(failed), work.other) as join:
            self._read(work, list(failed), join)

    def _applied_by(self, step: Step) -> list[Sequence[Method]]:
        """The methods, one at a time where the step is made per method.

        Those that estimate take longest, so they begin: both processes are busy to the end.
        """
        if not step.per_method:
            return [self.methods]
        longest_first = sorted(self.methods, key=lambda method: method.estimates_logs, reverse=True)
        return [[method] for method in longest_first]

    def _build(self, work: "Work", stage: Sequence[Step]) -> None:
        """Makes the tables of steps where they are stale, per method where they are made so."""
        tasks = []
        for step, methods in ((s, m) for s in stage for m in self._applied_by(s)):
            if not step.is_stale(self.store, methods):
                continue
            self.progress.step(step.says.format(methods[0].name))
            names = tuple(method.name for method in methods)
            tasks.append(Task(self.store.root, step.name, names))
            if step.per_method:
                made = {*self.done.methods, *names}
                self.done.methods = [m.name for m in self.methods if m.name in made]
            self.done.database |= step is DATABASE
        work.build(tasks)


def _check_listed(wanted: Collection[int] | None, listed: Sequence[int]) -> None:
    """Refuses seasons of which the archive lists no tow: a typing error would pass unseen.

    Raises:
        MissingKnowledgeError: it lists none in any of them.
    """
    if wanted is not None and listed and not set(wanted) & set(listed):
        raise MissingKnowledgeError(
            "the archive lists no tow in the seasons asked for; it has tows of {}",
            ", ".join(map(str, listed)),
        )


def check_apart(archive: Path, data: Path) -> None:
    """Refuses an archive in the data folder: a rebuild would write among what it reads.

    Raises:
        MissingKnowledgeError: the archive is the data folder, or lies in it.
    """
    if archive.resolve().is_relative_to(data.resolve()):
        raise MissingKnowledgeError(
            "the archive {} lies in the data folder {}, or is the same; name a data "
            "folder outside the archive with --data",
            archive,
            data,
        )
