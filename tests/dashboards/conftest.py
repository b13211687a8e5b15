"""The site of the small archive, with two editions and names that attack; a running workbench."""

import contextlib
import datetime as dt
import shutil
import threading

import duckdb
import pytest

from dashboards.guard import listen
from dashboards.site.render import build_site
from dashboards.workbench.server import LOOPBACK, address, serving
from pipeline.method.definition import shipped_method
from tests.conftest import METHODS, Workbench, shared
from warehouse.editions.publish import Terms, publish
from warehouse.store.store import Store

ATTACK = "</script><script>alert(1)</script>"
ACCENT = "Tréwes"
FORMULA = "Foo;=1+1;bar"
"""A formula to a spreadsheet that separates by semicolons, wherever it is in the name."""
EDITIONS = ("2015-1", "2026-1")
LINKS = [(0, "estimated"), (1, "estimated")]
"""Log, part and source of season factors: the methods of the small archive estimate none."""
PUBLISHED_ON = dt.date(2026, 5, 9)


@pytest.fixture(scope="session")
def store(built, tmp_path_factory):
    """A copy of the built data with editions and attacks, and its site.

    The first boat towed is called `ATTACK`, the last one `FORMULA`.
    """
    return Store(shared(tmp_path_factory, "site", lambda root: _attack(built, root)) / "data")


def _attack(built, root):
    data = root / "data"
    shutil.copytree(built.data, data)
    store = Store(data)
    for edition, method in zip(EDITIONS, METHODS, strict=True):
        terms = Terms(edition, dt.date(2015, 1, 1), "SKC <8 mei>", PUBLISHED_ON)
        publish(store, shipped_method(method), terms)
    Workbench(built.archive, data).rebuild()
    with duckdb.connect(store.database) as db:
        for name, which in ((ATTACK, "min"), (FORMULA, "max"), (ACCENT, "mode")):
            db.execute(
                f"UPDATE boats SET name = ? WHERE fsn_no = (SELECT {which}(fsn_no) FROM tows)",  # noqa: S608
                [name],
            )
        for part, source in LINKS:
            db.execute(
                "INSERT INTO study.season_links BY NAME SELECT ? AS method, 2009 AS season, "
                "? AS part, ? AS source, 4 AS n_tows, 3 AS n_links, 1.0 AS factor",
                [METHODS[-1], part, source],
            )
        db.execute("UPDATE contents SET rows = 3 WHERE \"table\" = 'season_links'")
    build_site(store)


@pytest.fixture(scope="session")
def site(store):
    return store.root / "site"


@pytest.fixture(scope="session")
def attacked(built):
    """Number of the boat with the name `ATTACK`."""
    return built.table("tows")["fsn_no"].min()


@contextlib.contextmanager
def served(bench):
    """The address of a workbench that runs meanwhile."""
    held = listen(LOOPBACK, 0)
    server = serving(bench)
    thread = threading.Thread(target=server.run, kwargs={"sockets": [held]})
    thread.start()
    yield address(held)
    server.should_exit = True
    thread.join()
