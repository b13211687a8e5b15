"""A lake and editions in a bucket hold what they hold in a folder."""

import datetime as dt
import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path, PurePosixPath

import polars as pl
import pytest
from polars.testing import assert_frame_equal

from herijk.dashboards.site.downloads import copy_sheets
from herijk.pipeline.errors import BrokenPromiseError, MissingKnowledgeError, UnavailableError
from herijk.pipeline.method.definition import shipped_method
from herijk.warehouse.editions.publish import Terms, publish
from herijk.warehouse.editions.verify import verify
from herijk.warehouse.store import storage
from herijk.warehouse.store.bucket import BucketPath
from herijk.warehouse.store.editions import edition_names, read_edition, write_folder
from herijk.warehouse.store.store import (
    DamagedFileError,
    Store,
    count_rows,
    read_parquet,
    write_parquet,
)
from tests.conftest import Workbench
from tests.elsewhere import BUCKET, lie_in_bucket

FRAME = pl.DataFrame({"tow_id": ["a", "b"], "cw_kg_m": [1.5, 2.5]})


@pytest.fixture
def root(s3, request) -> BucketPath:
    """A prefix in the bucket that only this test uses."""
    return BucketPath.parse(f"s3://{BUCKET}/{request.node.name}")


@pytest.fixture
def moved(built, s3, tmp_path, request) -> Workbench:
    """The small archive's data folder, with lake and editions in the bucket."""
    data = tmp_path / "data"
    lie_in_bucket(data, request.node.name)
    store = Store(data)
    for file in (built.data / "lake").rglob("*.parquet"):
        parts = file.relative_to(built.data / "lake").parts
        BucketPath.parse(f"{store.lake}/{'/'.join(parts)}").write_bytes(file.read_bytes())
    shutil.copy(built.store.database, data)
    return Workbench(built.archive, data)


def test_without_settings_everything_lies_in_the_data_folder(tmp_path):
    assert Store(tmp_path).lake == tmp_path / "lake"
    assert Store(tmp_path).editions == tmp_path / "editions"


def test_lake_and_editions_may_lie_apart(tmp_path):
    (tmp_path / storage.FILE_NAME).write_text('lake = "s3://roeien/herijk/lake"\n')
    assert Store(tmp_path).lake == BucketPath("s3://roeien", PurePosixPath("herijk/lake"))
    assert Store(tmp_path).editions == tmp_path / "editions"


@pytest.mark.parametrize(
    "text",
    ['lake = "s3://key:secret@roeien/lake"', 'lake = "/mnt/lake"', 'meer = "s3://a/b"', "lake ="],
)
def test_settings_that_cannot_be_used_are_refused_without_repeating_them(tmp_path, text):
    (tmp_path / storage.FILE_NAME).write_text(text)
    with pytest.raises(MissingKnowledgeError, match=storage.FILE_NAME) as error:
        Store(tmp_path).lake  # noqa: B018 - asked for its error
    assert "secret" not in str(error.value)


def test_a_frame_comes_back_as_it_was_written(root):
    path = root / "table.parquet"
    assert not path.exists()
    write_parquet(FRAME, path, {"herijk.fingerprint": "abc"})
    assert path.exists()
    assert_frame_equal(read_parquet(path), FRAME)
    assert count_rows(path) == 2


def test_a_damaged_object_is_named(root):
    path = root / "table.parquet"
    write_parquet(FRAME, path)
    content = bytearray(path.read_bytes())
    content[20] ^= 0xFF
    path.write_bytes(bytes(content))
    with pytest.raises(DamagedFileError, match=r"table\.parquet is damaged"):
        read_parquet(path)


def test_what_is_not_there_is_not_found(root):
    with pytest.raises(FileNotFoundError):
        read_parquet(root / "nothing.parquet")
    (root / "nothing.parquet").unlink(missing_ok=True)


def test_a_prefix_is_listed_like_a_folder(root):
    for name in ("b.parquet", "a.parquet", "note.txt"):
        (root / name).write_bytes(b"")
    (root / "below" / "c.parquet").write_bytes(b"")
    assert [f.name for f in root.iterdir()] == ["a.parquet", "b.parquet", "below", "note.txt"]
    assert list(root.glob("[!.]*.parquet")) == [root / "a.parquet", root / "b.parquet"]
    assert list((root / "nothing").iterdir()) == []


@pytest.mark.slow
def test_a_listing_goes_on_past_the_thousand_that_the_service_gives_at_once(root):
    names = [f"{number:04}.parquet" for number in range(1001)]
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda name: (root / name).write_bytes(b""), names))
    assert [f.name for f in root.iterdir()] == names


def test_an_object_is_created_once(root):
    (root / "one").create_bytes(b"first")
    with pytest.raises(FileExistsError):
        (root / "one").create_bytes(b"second")
    assert (root / "one").read_bytes() == b"first"


def test_a_service_that_is_away_is_told_with_the_way_out(monkeypatch):
    monkeypatch.setenv("AWS_ENDPOINT_URL", "http://127.0.0.1:1")
    monkeypatch.setenv("AWS_ALLOW_HTTP", "true")
    with pytest.raises(UnavailableError, match="AWS_ENDPOINT_URL"):
        BucketPath.parse("s3://nobody/lake").read_bytes()


@pytest.mark.parametrize(
    "asked",
    [
        BucketPath.read_bytes,
        BucketPath.unlink,
        lambda path: path.write_bytes(b""),
        lambda path: path.create_bytes(b""),
        lambda path: path.read_end(8),
    ],
)
def test_a_bucket_that_is_not_there_is_told_with_the_way_out(s3, asked):
    with pytest.raises(UnavailableError, match=r"there is no bucket s3://no-such-bucket; make it"):
        asked(BucketPath.parse("s3://no-such-bucket/lake/table.parquet"))


def test_a_store_in_a_bucket_keeps_tables_partitions_and_fingerprints(built, moved):
    ours, theirs = moved.store, built.store
    assert ours.partitions("blocks") == theirs.partitions("blocks") == ["2009", "2014"]
    assert ours.made_from("blocks", "2009") == theirs.made_from("blocks", "2009")
    assert ours.made_from("about_archive") == theirs.made_from("about_archive")
    assert ours.made_from("no_such_table") is None
    assert_frame_equal(
        ours.read("run_points", "rebased-2015"), theirs.read("run_points", "rebased-2015")
    )
    ours.remove("blocks", "2009")
    assert ours.partitions("blocks") == ["2014"]


def test_an_edition_in_a_bucket_is_published_once_shown_and_verified(moved):
    store, method = moved.store, shipped_method("rebased-2015")
    terms = Terms("2026-1", dt.date(2026, 5, 8), "ALV 2026", dt.date(2026, 5, 1))
    publish(store, method, terms)
    assert edition_names(store) == ["2026-1"]
    assert read_edition(store, "2026-1").register.height > 0
    assert not verify(store).wrong
    with pytest.raises(BrokenPromiseError, match="already published"):
        publish(store, method, terms)
    copy_sheets(store, moved.data / "site")
    shown = moved.data / "site" / "downloads" / "2026-1" / "register.csv"
    assert shown.read_bytes() == (store.editions / "2026-1" / "register.csv").read_bytes()
    (store.editions / "2026-1" / "register.csv").write_bytes(b"other")
    assert verify(store).wrong


def test_of_two_publications_under_one_name_one_stops_and_nothing_is_overwritten(moved):
    store = moved.store
    half = store.editions / "2026-2"
    (half / "register.csv").create_bytes(b"of another")
    assert edition_names(store) == []
    contents = {"register.csv": b"ours", "edition.json": b"{}"}
    with pytest.raises(BrokenPromiseError, match="somebody publishes under this name"):
        write_folder(store, "2026-2", lambda: contents)
    assert [f.name for f in half.iterdir()] == ["register.csv"]
    assert (half / "register.csv").read_bytes() == b"of another"


def test_a_bucket_without_its_library_is_told_what_to_install(monkeypatch, tmp_path: Path):
    monkeypatch.setitem(__import__("sys").modules, "herijk.warehouse.store.bucket", None)
    with pytest.raises(MissingKnowledgeError, match=r"herijk\[s3\]"):
        storage.place("s3://roeien/lake", tmp_path)
