import pytest

from tests.conftest import shared
from tests.warehouse.edition_bench import EditionBench


@pytest.fixture(scope="session")
def edition_archive(tmp_path_factory):
    """Rebuilt once; read only."""
    root = shared(tmp_path_factory, "editions", EditionBench.simulated)
    return EditionBench(root / "archive", root / "data")


@pytest.fixture
def bench_of_editions(edition_archive, tmp_path):
    """A copy to change at will."""
    return edition_archive.copy(tmp_path)


@pytest.fixture(scope="session")
def published(edition_archive, tmp_path_factory):
    """With two editions of the two methods, published; read only."""

    def publish(root):
        bench = edition_archive.copy(root)
        bench.publish("2014-1", "as-published")
        bench.publish("2014-2", "rebased")

    root = shared(tmp_path_factory, "published", publish)
    return EditionBench(root / "archive", root / "data")


@pytest.fixture
def published_copy(published, tmp_path):
    """With two published editions, to change at will."""
    return published.copy(tmp_path)
