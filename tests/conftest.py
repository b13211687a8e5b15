"""Settings of the property tests, and a small simulated archive with what a rebuild makes of it."""

import os
import shutil
from collections.abc import Callable, Collection, Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final
from unittest import mock

import dagster as dg
import duckdb
import polars as pl
import pytest
from filelock import FileLock
from hypothesis import settings

import herijk.assets.rebuild
import herijk.assets.runs
import herijk.dashboards.report_page
from herijk.assets.report import Report
from herijk.assets.resources import Setup
from herijk.assets.side_by_side import Read, Task
from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from herijk.tables.schemas import TABLES
from herijk.warehouse.build.graph import CONSISTENCY, LINES, STUDIES
from herijk.warehouse.store.store import Store
from tests.quiet import Quiet

# The same examples every time, whatever the machine's speed.
settings.register_profile("repeatable", deadline=None, derandomize=True, max_examples=50)
settings.load_profile("repeatable")

os.environ["LC_ALL"] = "C.UTF-8"
"""Commands speak English, whatever the language of the machine."""

METHODS = ("as-published", "rebased-2015")
SMALL = WorldSettings(seasons=(2009, 2014), tows_per_season=20, rate_hz=20, seed=3)
"""Season 2009 is written as plain CSV, 2014 as .csv.gz."""


@contextmanager
def _dagster_in_memory(store: Store) -> Iterator[dg.DagsterInstance]:
    with dg.DagsterInstance.ephemeral() as instance:
        yield instance


class _Directly:
    """The work of a rebuild without Dagster's runs, studies and comparisons of types.

    They take two thirds of the time of a small rebuild.
    """

    checks: Final = ()

    def __init__(self, setup: Setup) -> None:
        self.setup = setup

    def record_index(self) -> None:
        """Keeps no records."""

    def record_seasons(self, seasons: Sequence[int], found: Sequence[Read]) -> None:
        """Keeps no records."""

    def build(self, tasks: Sequence[Task]) -> None:
        store, known = self.setup.store, self.setup.known_methods
        for task in tasks:
            step, methods = task.made_by, [known.get(name) for name in task.methods]
            if step in (STUDIES, LINES, CONSISTENCY):
                for name in step.outputs:
                    store.write(name, TABLES[name].create_empty(), step.made_from(store, methods))
            else:
                task.do()

    def check(self) -> None:
        """Checks nothing."""


@contextmanager
def directly(page: bool = False) -> Iterator[None]:
    """Inside, rebuilds do their work without Dagster, and the site counts as made.

    Args:
        page: make the page about the rebuild too, a quarter of the work.
    """

    def unrecorded(setup: Setup, other: object, work: Callable[[Any], None]) -> list[object]:
        work(_Directly(setup))
        return []

    no_site = mock.patch.object(herijk.assets.rebuild, "site_is_stale", return_value=False)
    no_dagster = mock.patch.object(herijk.assets.runs, "in_one_run", unrecorded)
    no_page = mock.patch.object(herijk.dashboards.report_page, "report_pages", return_value={})
    with no_site, no_dagster, in_one_process(), nullcontext() if page else no_page:
        yield


def in_one_process() -> AbstractContextManager[object]:
    """Inside, a thread helps a rebuild: a process takes seconds to import what it needs."""

    def thread() -> Executor:
        return ThreadPoolExecutor(1)

    return mock.patch.object(herijk.assets.rebuild, "helper", thread)


@dataclass(frozen=True)
class Workbench:
    """An archive and a data folder that a test may change."""

    archive: Path
    data: Path

    @property
    def store(self) -> Store:
        return Store(self.data)

    def rebuild(
        self,
        methods: Sequence[str] = METHODS,
        seasons: Collection[int] | None = None,
        whole: bool = False,
        page: bool = False,
    ) -> Report:
        """A rebuild in this process.

        The whole has Dagster's runs (recorded in memory), studies, comparisons of types, checks and
        pages; most tests do without, and without the page about the rebuild.
        """
        with self.records_in_memory() if whole else directly(page):
            return herijk.assets.rebuild.rebuild(self.archive, self.data, methods, Quiet(), seasons)

    @staticmethod
    def records_in_memory() -> AbstractContextManager[object]:
        """Inside, rebuilds keep no records of Dagster's on disk."""
        return mock.patch.object(herijk.assets.runs, "instance_of", _dagster_in_memory)

    def table(self, name: str) -> pl.DataFrame:
        """A table as a reader of the database gets it."""
        with duckdb.connect(self.store.database, read_only=True) as db:
            return db.sql(f'SELECT * FROM "{name}"').pl()  # noqa: S608

    def tables(self) -> dict[str, pl.DataFrame]:
        """All tables of the database."""
        with duckdb.connect(self.store.database, read_only=True) as db:
            names = [row[0] for row in db.execute("SHOW TABLES").fetchall()]
            return {name: db.sql(f'SELECT * FROM "{name}"').pl() for name in names}  # noqa: S608

    def lake_files(self) -> dict[str, int]:
        """Samples and blocks in the lake, with the time at which each was written."""
        return {
            str(f.relative_to(self.data)): f.stat().st_mtime_ns
            for kind in ("samples", "blocks")
            for f in (self.data / "lake" / kind).rglob("*")
            if f.is_file()
        }


@pytest.fixture(autouse=True, scope="session")
def _disks_need_not_sync() -> Iterator[None]:
    """No test loses power; a rebuild waits for the disk two hundred times."""
    with mock.patch("os.fsync"):
        yield


def shared(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], object]) -> Path:
    """A folder for all workers, made by the first that asks; read only."""
    root = factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        root = root.parent  # that of the worker itself
    folder, done = root / name, root / f"{name}.done"
    with FileLock(root / f"{name}.lock"):
        if not done.exists():
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir()
            make(folder)
            done.touch()
    return folder


def _build(root: Path) -> None:
    write_simulated_archive(root / "archive", simulate_world(SMALL))
    Workbench(root / "archive", root / "data").rebuild(whole=True)


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> Workbench:
    """The small archive, rebuilt once; read only."""
    root = shared(tmp_path_factory, "built", _build)
    return Workbench(root / "archive", root / "data")


@pytest.fixture
def bench(built: Workbench, tmp_path: Path) -> Workbench:
    """A copy of the small archive and its data folder, to change at will."""
    shutil.copytree(built.archive, tmp_path / "archive")
    shutil.copytree(built.data, tmp_path / "data")
    return Workbench(tmp_path / "archive", tmp_path / "data")
