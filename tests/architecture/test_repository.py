"""What the repository may hold: small files, locks that agree and name no host."""

import re

import pytest

from tests.architecture.repository import ROOT, read, tracked_files

MB = 1_000_000
LOCKED = re.compile(r"^([a-z0-9][a-z0-9._-]*)==(\S+)", re.MULTILINE)

LOCKS = ("requirements-uv.lock", "requirements.lock", "requirements-dev.lock")
"""What installs the others, what a user needs, and what tests and checks need besides."""


def test_no_large_file_is_tracked():
    large = [f.name for f in tracked_files() if f.is_file() and f.stat().st_size > MB]
    assert large == []


def test_what_is_made_is_not_tracked():
    made = {"data", "demo", "archive", ".venv"}
    assert [f for f in tracked_files() if f.relative_to(ROOT).parts[0] in made] == []


@pytest.mark.parametrize("lock", LOCKS)
def test_a_lock_names_no_index(lock):
    text = read(lock)
    assert "://" not in text
    assert not re.search(r"^\s*-", re.sub(r"^\s+--hash=", "", text, flags=re.MULTILINE), re.M)


def test_every_dependency_is_locked():
    locked = {name for name, _ in LOCKED.findall(read("requirements-dev.lock"))}
    project = read("pyproject.toml")
    needed = set(
        re.findall(r'^  "([a-z0-9-]+)', project[: project.index("[project.scripts]")], re.M)
    )
    assert {"numpy", "dagster", "ruff"} <= needed
    assert needed - locked - {"herijk"} == set()


def test_the_locks_agree():
    *others, develop = (dict(LOCKED.findall(read(lock))) for lock in LOCKS)
    for lock in others:
        assert {name: develop.get(name) for name in lock} == lock
