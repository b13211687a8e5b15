"""`import herijk` notices that a room is somebody else's, and says so in one sentence."""

import subprocess
import sys

import pytest


def imported(folder):
    """Import Herijk where a folder of the user comes first on the path."""
    command = [sys.executable, "-c", "import herijk; herijk.fit"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("stranger", ["pipeline.py", "assets/__init__.py"])
def test_a_room_of_somebody_else_is_told(tmp_path, stranger):
    path = tmp_path / stranger
    path.parent.mkdir(exist_ok=True)
    path.write_text("")
    found = imported(tmp_path)
    assert found.returncode == 1
    room = stranger.removesuffix(".py").removesuffix("/__init__")
    assert f"ImportError: import {room} finds {path}, which is not Herijk's" in found.stderr


def test_a_folder_without_modules_is_nobodys(tmp_path):
    """A user's `assets/` with pictures is no package, and Python goes on looking."""
    (tmp_path / "assets").mkdir()
    assert imported(tmp_path).returncode == 0
