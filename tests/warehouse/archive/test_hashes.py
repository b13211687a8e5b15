"""The cache of hashes: fast where it may be, never wrong."""

import hashlib
import os
from pathlib import Path

import pytest

from warehouse.archive import FileHashes

OLD_NS = 1_600_000_000_000_000_000


def write_old(path: Path, content: bytes) -> None:
    path.write_bytes(content)
    os.utime(path, ns=(OLD_NS, OLD_NS))


def sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def test_an_unchanged_file_is_not_hashed_again(tmp_path: Path) -> None:
    path, cache = tmp_path / "a", FileHashes()
    write_old(path, b"one")
    assert cache.hash_file(path) == sha256(b"one")
    write_old(path, b"two")  # same size, same time: indistinguishable by design
    assert cache.hash_file(path) == sha256(b"one")


@pytest.mark.parametrize("content", [b"longer", b"two"])
def test_a_changed_file_is_hashed_again(tmp_path: Path, content: bytes) -> None:
    path, cache = tmp_path / "a", FileHashes()
    write_old(path, b"one")
    cache.hash_file(path)
    path.write_bytes(content)
    assert cache.hash_file(path) == sha256(content)


def test_a_fresh_file_is_not_remembered(tmp_path: Path) -> None:
    path, cache = tmp_path / "a", FileHashes()
    path.write_bytes(b"one")
    stamp = path.stat().st_mtime_ns
    cache.hash_file(path)
    path.write_bytes(b"two")
    os.utime(path, ns=(stamp, stamp))  # a clock too coarse to tell the two apart
    assert cache.hash_file(path) == sha256(b"two")


def test_the_cache_survives_saving_and_loading(tmp_path: Path) -> None:
    path, cache = tmp_path / "a", FileHashes()
    write_old(path, b"one")
    cache.hash_file(path)
    cache.save(tmp_path / "deep" / "hashes.json")
    assert FileHashes.load(tmp_path / "deep" / "hashes.json") == cache
    assert [entry.name for entry in (tmp_path / "deep").iterdir()] == ["hashes.json"]


@pytest.mark.parametrize("content", [None, "[]", '{"a": 1}', "{"])
def test_a_lost_or_damaged_cache_is_empty(tmp_path: Path, content: str | None) -> None:
    path = tmp_path / "hashes.json"
    if content is not None:
        path.write_text(content)
    assert FileHashes.load(path).entries == {}
