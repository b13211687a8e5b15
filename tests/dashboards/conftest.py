"""The site of the small archive, with a boat whose name is an attack."""

import shutil

import duckdb
import pytest

from dashboards.site import build_site
from warehouse.store import Store

ATTACK = "</script><script>alert(1)</script>"


@pytest.fixture(scope="session")
def store(built, tmp_path_factory):
    """A copy of the built data in which the first boat has the name `ATTACK`, with its site."""
    root = tmp_path_factory.mktemp("site")
    shutil.copytree(built.data, root / "data")
    store = Store(root / "data")
    with duckdb.connect(store.database) as db:
        db.sql(f"UPDATE boats SET name = '{ATTACK}' WHERE fsn_no = (SELECT min(fsn_no) FROM tows)")  # noqa: S608
    build_site(store)
    return store


@pytest.fixture(scope="session")
def site(store):
    return store.root / "site"


@pytest.fixture(scope="session")
def attacked(built):
    """Number of the boat with the name `ATTACK`."""
    return built.table("tows")["fsn_no"].min()
