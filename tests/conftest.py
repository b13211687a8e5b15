"""Settings of the property tests, and a small simulated archive with what a rebuild makes of it."""

import os
import shutil
from collections.abc import Callable, Collection, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final
from unittest import mock

import dagster as dg
import polars as pl
import pytest
from filelock import FileLock
from hypothesis import settings

import assets.instance
import assets.rebuild
import assets.run
import assets.workers
import dashboards.report_page
from assets.report import Done, Report
from hatch_build import compile_catalogues
from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from pipeline.tables.schemas import TABLES
from warehouse.derive.graph import DATABASE, METHOD, STEPS
from warehouse.intake import seasons as intake
from warehouse.store.database import open_database
from warehouse.store.methods import KnownMethods
from warehouse.store.store import Store

compile_catalogues(Path(__file__).parents[1])

# The same examples every time, whatever the machine's speed.
settings.register_profile("repeatable", deadline=None, derandomize=True, max_examples=50)
settings.load_profile("repeatable")

os.environ["LC_ALL"] = "C.UTF-8"
"""Commands speak English, whatever the language of the machine."""

METHODS = ("as-published", "rebased-2015")
SMALL = WorldSettings(seasons=(2009, 2014), tows_per_season=20, rate_hz=20, seed=3)
"""Season 2009 is written as plain CSV, 2014 as .csv.gz."""


LEFT_OUT: Final = ("studies", "lines", "consistency")
"""Groups of steps that take two thirds of the time of a small rebuild."""

DEMO: Final = WorldSettings(seasons=tuple(range(2009, 2019)), tows_per_season=6, rate_hz=20, seed=1)
"""The archive of `make demo` with fewer tows and samples."""
DEMO_METHODS: Final = ("as-published", "rebased-2015", "rebased")
"""Those that the documents name in what they tell a reader to type."""


def _make_directly(
    archive: Path,
    data: Path,
    methods: Sequence[str],
    seasons: Collection[int] | None,
    done: Done,
    left_out: Collection[str] = LEFT_OUT,
) -> list[object]:
    """What a rebuild makes without Dagster, and with empty tables where they are left out."""
    store = Store(data)
    known = [KnownMethods.of(store).get(name) for name in methods]
    for season in intake.stale_seasons(store, archive, seasons):
        intake.read_season(store, archive, season)
        done.seasons = sorted({*done.seasons, season})
    for step in STEPS:
        for scope in step.stale(store, known):
            if step.group in left_out:
                partition = scope.at_hand.name if step.per_method else None
                for name in step.outputs:
                    empty = TABLES[name].create_empty()
                    store.write(name, empty, step.made_from(scope), partition)
            else:
                step.make(scope)
            if step is METHOD:
                applied = {*done.methods, scope.at_hand.name}
                done.methods = [name for name in methods if name in applied]
            done.database |= step is DATABASE
    return []


@contextmanager
def directly(page: bool = False, left_out: Collection[str] = LEFT_OUT) -> Iterator[None]:
    """Inside, rebuilds do their work without Dagster, and the site counts as made.

    Args:
        page: make the page about the rebuild too, a quarter of the work.
        left_out: groups of steps whose tables stay empty.
    """
    no_site = mock.patch.object(assets.rebuild, "SITE", mock.Mock(stale=lambda *_: []))
    make = partial(_make_directly, left_out=left_out)
    no_dagster = mock.patch.object(assets.run, "run_assets", make)
    no_page = mock.patch.object(dashboards.report_page, "report_pages", return_value={})
    with no_site, no_dagster, nullcontext() if page else no_page:
        yield


def in_one_process() -> AbstractContextManager[object]:
    """Inside, a thread does the heavy work: a process takes seconds to import what it needs."""
    thread = ThreadPoolExecutor(1)
    return mock.patch.object(assets.workers, "workers", return_value=thread)


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
        with in_one_process(), self.records_in_memory() if whole else directly(page):
            return assets.rebuild.rebuild(self.archive, self.data, methods, seasons)

    @staticmethod
    def records_in_memory() -> AbstractContextManager[object]:
        """Inside, rebuilds keep no records of Dagster's on disk."""
        in_memory = dg.DagsterInstance.ephemeral
        return mock.patch.object(assets.instance, "instance_of", side_effect=lambda _: in_memory())

    def table(self, name: str) -> pl.DataFrame:
        """A table as a reader of the database gets it."""
        with open_database(self.store.database) as db:
            return db.sql(f'SELECT * FROM "{name}"').pl()  # noqa: S608

    def tables(self) -> dict[str, pl.DataFrame]:
        """All tables of the database."""
        with open_database(self.store.database) as db:
            names = [row[2] for row in db.execute("SHOW ALL TABLES").fetchall()]
            return {name: db.sql(f'SELECT * FROM "{name}"').pl() for name in names}  # noqa: S608

    def lake_files(self) -> dict[str, int]:
        """Samples and blocks in the lake, with the time at which each was written."""
        return {
            str(f.relative_to(self.data)): f.stat().st_mtime_ns
            for kind in ("samples", "blocks")
            for f in (self.data / "lake" / kind).rglob("*")
            if f.is_file()
        }


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--snapshot-update", action="store_true", help="write kept texts anew")


@pytest.fixture
def snapshot(request: pytest.FixtureRequest) -> Callable[[str, str], None]:
    """Holds a text against the one that is kept in `tests/data/texts`."""

    def hold(name: str, text: str) -> None:
        kept = Path(__file__).parent / "data" / "texts" / f"{name}.txt"
        if request.config.getoption("snapshot_update"):
            kept.write_text(text, encoding="utf-8")
        assert text == kept.read_text(encoding="utf-8")

    return hold


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


def build_small(root: Path) -> None:
    write_simulated_archive(root / "archive", simulate_world(SMALL))
    Workbench(root / "archive", root / "data").rebuild(whole=True)


def build_demo(root: Path) -> None:
    """Make the small demo with all its tables; the samples of one tow are missing."""
    write_simulated_archive(root / "archief", simulate_world(DEMO))
    sorted((root / "archief").glob("meetdata_2014/*"))[-1].unlink()
    with in_one_process(), directly(left_out=()):
        assets.rebuild.rebuild(root / "archief", root / "data", DEMO_METHODS)


@pytest.fixture(scope="session")
def demo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a small `make demo`, with `archief` and `data`; read only."""
    return shared(tmp_path_factory, "demo", build_demo)


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> Workbench:
    """The small archive, rebuilt once; read only."""
    root = shared(tmp_path_factory, "built", build_small)
    return Workbench(root / "archive", root / "data")


@pytest.fixture
def bench(built: Workbench, tmp_path: Path) -> Workbench:
    """A copy of the small archive and its data folder, to change at will."""
    shutil.copytree(built.archive, tmp_path / "archive")
    shutil.copytree(built.data, tmp_path / "data")
    return Workbench(tmp_path / "archive", tmp_path / "data")
