"""Imports go down only: the contracts of pyproject.toml hold, and the check can fail."""

import subprocess
import sys

from tests.architecture.repository import ROOT

CHECK = [sys.executable, "-c", "from importlinter.cli import lint_imports; exit(lint_imports())"]


def contracts_kept(folder):
    return subprocess.run(CHECK, cwd=folder, capture_output=True, text=True, check=False)


def small_project(folder, **sources):
    """A project with the real contracts and almost empty rooms."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    (folder / "pyproject.toml").write_text(text[text.index("[tool.importlinter]") :])
    for room in ("herijk", "pipeline", "warehouse", "assets", "dashboards"):
        (folder / room).mkdir()
        (folder / room / "__init__.py").write_text(sources.get(room, ""))
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


def test_a_file_in_the_pipeline_is_found(tmp_path):
    found = contracts_kept(small_project(tmp_path, pipeline="import pathlib"))
    assert found.returncode == 1
    assert "pipeline -> pathlib" in found.stdout
