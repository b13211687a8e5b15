"""Imports go down only: the contracts of pyproject.toml hold, and the check can fail."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from tests.architecture.repository import PACKAGES, ROOT

CHECK = [sys.executable, "-c", "from importlinter.cli import lint_imports; exit(lint_imports())"]
KEYS = ("layers", "source_modules", "forbidden_modules")

THREADS = """
import os
import polars as pl
import assets.definitions, herijk.cli.main, dashboards.site.render, herijk.library
imported = len(os.listdir("/proc/self/task"))
pl.DataFrame({"x": [1]}).lazy().select("x").collect()
print(imported, len(os.listdir("/proc/self/task")))
"""
"""How many threads there are when all is imported, and when Polars has computed something."""


def contracts_kept(folder):
    return subprocess.run(CHECK, cwd=folder, capture_output=True, text=True, check=False)


def named_in(contract):
    """The modules that a contract names; a layer can hold several, within containers."""
    containers = contract.get("containers", [])
    layers = (layer for key in KEYS for layer in contract.get(key, []))
    names = [name for layer in layers for name in re.split(" [|:] ", layer)]
    return [*containers, *(f"{room}.{name}" for room in containers for name in names)] or names


def small_project(folder, **sources):
    """A project with the real contracts and empty modules in the places that they name."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    (folder / "pyproject.toml").write_text(text[text.index("[tool.importlinter]") :])
    contracts = tomllib.loads(text)["tool"]["importlinter"]["contracts"]
    modules = (module for contract in contracts for module in named_in(contract))
    for module in {*PACKAGES, *(m for m in modules if m.startswith(PACKAGES))}:
        place = folder.joinpath(*module.split("."))
        place.mkdir(parents=True, exist_ok=True)
        (place / "__init__.py").write_text(sources.get(place.name, ""))
    return folder


def test_contracts_hold():
    found = contracts_kept(ROOT)
    assert found.returncode == 0, found.stdout


def test_empty_rooms_keep_the_contracts(tmp_path):
    found = contracts_kept(small_project(tmp_path))
    assert found.returncode == 0, found.stdout


def test_an_import_upwards_is_found(tmp_path):
    found = contracts_kept(small_project(tmp_path, pipeline="import warehouse"))
    assert found.returncode == 1
    assert "pipeline -> warehouse" in found.stdout


def test_an_import_upwards_in_the_archive_is_found(tmp_path):
    found = contracts_kept(small_project(tmp_path, files="import warehouse.archive.lists"))
    assert found.returncode == 1
    assert "warehouse.archive.files -> warehouse.archive.lists" in found.stdout


def test_a_file_in_the_pipeline_is_found(tmp_path):
    found = contracts_kept(small_project(tmp_path, pipeline="import pathlib"))
    assert found.returncode == 1
    assert "pipeline -> pathlib" in found.stdout


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="threads are counted on Linux")
def test_importing_computes_nothing():
    """A process forked after Polars has threads waits for them for ever."""
    found = subprocess.run(
        [sys.executable, "-c", THREADS], cwd=ROOT, capture_output=True, text=True, check=True
    )
    imported, computed = map(int, found.stdout.split())
    assert imported < computed
