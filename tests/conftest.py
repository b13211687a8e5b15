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

import assets.rebuild
import assets.report
import assets.run
import assets.workers
from assets.definitions import ASSETS
from assets.report import Report
from hatch_build import compile_catalogues, compile_templates
from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from pipeline.tables.schemas import TABLES
from warehouse.store.database import open_database
from warehouse.store.store import Store

compile_catalogues(Path(__file__).parents[1])
compile_templates(Path(__file__).parents[1])

# The same examples every time, whatever the machine's speed.
settings.register_profile("repeatable", deadline=None, derandomize=True, max_examples=50)
settings.load_profile("repeatable")

os.environ["LC_ALL"] = "C.UTF-8"
"""Commands speak English, whatever the language of the machine."""

METHODS = ("as-published", "rebased-2015")
SMALL = WorldSettings(seasons=(2009, 2014), tows_per_season=20, rate_hz=20, seed=3)
"""Season 2009 is written as plain CSV, 2014 as .csv.gz."""


STUDIES: Final = frozenset(
    key.to_user_string()
    for asset in ASSETS
    for key in asset.keys
    if key.to_user_string() in TABLES
    if asset.group_names_by_key[key] == "consistency"
    or key.to_user_string() in ("correction_steps", "vote_curves")
)
"""Tables that take two thirds of the time of a small rebuild."""

EVERY: Final = frozenset(key.to_user_string() for asset in ASSETS for key in asset.keys)

DEMO: Final = WorldSettings(seasons=tuple(range(2009, 2019)), tows_per_season=6, rate_hz=20, seed=1)
"""The archive of `make demo` with fewer tows and samples."""
DEMO_METHODS: Final = ("as-published", "rebased-2015", "rebased")
"""Those that the documents name in what they tell a reader to type."""


def leave_out(store: Store, tables: Collection[str]) -> None:
    """Let tables that a rebuild leaves out be there: empty, unless they are."""
    for name in tables:
        if store.read_fingerprint(name) is None:
            frame = NO_SITE if name == "site" else TABLES[name].create_empty()
            store.write(name, frame)


NO_SITE: Final = pl.DataFrame({"failed": [[]]}, schema={"failed": pl.List(pl.String)})


def in_one_process() -> AbstractContextManager[object]:
    """Inside, a thread does the heavy work: a process takes seconds to import what it needs."""
    thread = ThreadPoolExecutor(1)
    return mock.patch.object(assets.workers, "get_executor", return_value=thread)


def without_page() -> AbstractContextManager[object]:
    """Inside, the page about a rebuild is not drawn: that takes a second."""
    return mock.patch.object(assets.report, "make_report_pages", return_value={})


def records_in_memory() -> AbstractContextManager[object]:
    """Inside, rebuilds keep no records of Dagster's on disk."""
    in_memory = dg.DagsterInstance.ephemeral
    return mock.patch.object(assets.run, "open_instance", side_effect=lambda _: in_memory())


@contextmanager
def quickly(store: Store, left_out: Collection[str] = (*STUDIES, "site")) -> Iterator[None]:
    """Inside, `assets.rebuild.rebuild` makes all but some tables, and no page about itself."""
    leave_out(store, left_out)
    run_all = assets.rebuild.rebuild
    made = partial(run_all, selection=EVERY - {*left_out})
    with (
        in_one_process(), records_in_memory(), without_page(),
        mock.patch.object(assets.rebuild, "rebuild", made),
    ):  # fmt: skip
        yield


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
        """Run the job in this process, recorded in memory.

        The whole has studies, comparisons of types and pages; most tests do without, and without
        the page about the rebuild.
        """
        left_out = () if whole else (*STUDIES, "site")
        leave_out(self.store, left_out)
        selection = None if whole else EVERY - {*left_out}
        with (
            in_one_process(),
            records_in_memory(),
            nullcontext() if page or whole else without_page(),
        ):
            return assets.rebuild.rebuild(self.archive, self.data, methods, seasons, selection)

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
        update = "If that is meant, run `pytest --snapshot-update` and look at what changed."
        assert text == kept.read_text(encoding="utf-8"), update

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
    with quickly(Store(root / "data"), left_out=("site",)):
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
