"""The site of the small archive, with two editions and names that attack; workbench; browser."""

import datetime as dt
import shutil
import threading

import duckdb
import pytest

from dashboards.guard import listen
from dashboards.site import build_site
from dashboards.workbench.bench import Bench
from dashboards.workbench.server import LOOPBACK, get_address, serve_bench
from pipeline.method.reading import read_shipped_method
from tests.conftest import METHODS, Workbench, shared
from tests.dashboards.browser import CHROMIUM, FLAGS, HIDDEN_BARS, OWN, WIDTHS
from warehouse.editions.publish import Terms, publish
from warehouse.queries.history import History
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
        publish(store, read_shipped_method(method), terms)
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


@pytest.fixture(scope="session")
def history(built):
    return History.from_store(built.store)


@pytest.fixture
def workbench(history, built, tmp_path):
    """A workbench that saves into a folder of its own."""
    (tmp_path / "warehouse.duckdb").symlink_to(built.store.database)
    return Bench(Store(tmp_path), history)


@pytest.fixture
def url(workbench):
    """The address at which it is served."""
    held = listen(LOOPBACK, 0)
    server = serve_bench(workbench)
    thread = threading.Thread(target=server.run, kwargs={"sockets": [held]})
    thread.start()
    yield get_address(held)
    server.should_exit = True
    thread.join()


@pytest.fixture(scope="module")
def context(site, history):
    """A browser of a module, which reads the scripts of the site once.

    Playwright keeps an event loop running in this thread, in which Dagster could not run its own:
    the site is built before, and the browser closed with the module.
    """
    assert CHROMIUM is not None, "CI has to test in a browser: install the package chromium"
    from playwright.sync_api import expect, sync_playwright  # noqa: PLC0415 - not needed when skipped

    expect.set_options(timeout=30_000)  # other tests run beside these
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=CHROMIUM, args=FLAGS, ignore_default_args=HIDDEN_BARS
        )
        yield browser.new_context(accept_downloads=True, viewport=WIDTHS["desktop"])
        browser.close()


@pytest.fixture
def page(context):
    """An empty page; what pages should not do makes the test fail."""
    faults = []
    with context.new_page() as page:
        page.set_default_timeout(30_000)
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("console", lambda m: faults.append(m.text) if m.type == "error" else None)
        page.on("request", lambda r: None if r.url.startswith(OWN) else faults.append(r.url))
        page.on("dialog", lambda dialog: (faults.append("dialog"), dialog.dismiss()))
        yield page
    assert faults == []
