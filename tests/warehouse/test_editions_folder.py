"""An edition's folder: whole or not at all, killed anywhere and on a disk that is really full."""

import subprocess
import sys

import pytest

from pipeline.errors import BrokenPromiseError
from warehouse.store.editions import list_edition_names, write_folder
from warehouse.store.files import write_folder_beside
from warehouse.store.store import Store

CONTENTS = {f"file-{n}": bytes([n]) * 5000 for n in range(6)}

KILLED_ANYWHERE = """
import os, signal, sys
from pathlib import Path
from tests.warehouse.test_editions_folder import CONTENTS
from warehouse.store.editions import list_edition_names, write_folder
from warehouse.store.store import Store

STEPS = {"open", "os.mkdir", "os.rename", "os.chmod", "os.rmdir", "os.remove", "os.listdir"}


def publish_and_die(store, step):
    seen = 0

    def count(event, _):
        nonlocal seen
        if event in STEPS:
            seen += 1
            if seen == step:
                os.kill(os.getpid(), signal.SIGKILL)

    sync = os.fsync
    os.fsync = lambda handle: (count("open", ()), sync(handle))
    sys.addaudithook(count)
    write_folder(store, "x", lambda: CONTENTS)


step, whole = 0, False
while not whole:
    step += 1
    store = Store(Path(sys.argv[1]) / str(step))
    child = os.fork()
    if child == 0:
        publish_and_die(store, step)
        os._exit(0)
    whole = os.waitpid(child, 0)[1] == 0
    names = list_edition_names(store) if store.editions.exists() else []
    assert names in ([], ["x"]), (step, names)
    if names:
        found = {f.name: f.read_bytes() for f in (store.editions / "x").iterdir()}
        assert found == CONTENTS, step
    else:
        write_folder(store, "x", lambda: CONTENTS)
    assert sorted(f.name for f in store.editions.iterdir() if f.is_dir()) == ["x"], step
print(step)
"""


@pytest.mark.more
def test_killed_at_every_step_there_is_nothing_or_all_of_it(tmp_path):
    """Every opening, syncing and renaming of a file is a place to die; a next one clears up."""
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", KILLED_ANYWHERE, str(tmp_path)],
        check=False,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 3 * len(CONTENTS)


def test_a_folder_that_cannot_be_made_is_one_sentence(tmp_path):
    store = Store(tmp_path)
    store.editions.write_text("a file in the way", encoding="utf-8")
    with pytest.raises(BrokenPromiseError, match="mend the folder, and publish again"):
        write_folder(store, "x", lambda: CONTENTS)
    store.editions.unlink()
    write_folder(store, "x", lambda: CONTENTS)
    assert list_edition_names(store) == ["x"]


def test_a_folder_is_replaced_whole_and_after_an_error_the_older_one_is_there(tmp_path):
    page = tmp_path / "site" / "page.html"

    def write(text, error=None):
        with write_folder_beside(page.parent) as beside:
            (beside / page.name).write_text(text, encoding="utf-8")
            if error:
                raise error

    write("old")
    with pytest.raises(OSError, match="full"):
        write("half", OSError("full"))
    assert page.read_text("utf-8") == "old"
    write("new")
    assert page.read_text("utf-8") == "new"
    assert list(tmp_path.iterdir()) == [page.parent]
