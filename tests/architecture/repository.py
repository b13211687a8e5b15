"""Where the repository's own files are, for tests about them."""

import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("herijk", "assets", "dashboards", "warehouse", "pipeline")
"""The folders of the program itself."""


def modules():
    """Every module of the program but templates, which are compiled again while others read."""
    found = []
    for package in PACKAGES:
        found += sorted((ROOT / package).rglob("*.py"))
    return [file for file in found if "compiled" not in file.parts]


def read(path):
    """A text file of the repository."""
    return (ROOT / path).read_text(encoding="utf-8")


def tracked_files():
    """Files under version control; the test is skipped where there is no git checkout."""
    if not (ROOT / ".git").exists():
        pytest.skip("not a git checkout")
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return [ROOT / name for name in listed.stdout.split("\0") if name]
