"""Kills a rebuild with signal 9 at random moments, and looks whether anything was lost.

    python benchmarks/robustness/survive.py [kills] [seed]

The archive changes to and fro between two states. Each time a rebuild is killed at a random moment
and then run again: the tables must be those of a rebuild that nobody disturbed. Meanwhile a reader
in another process opens the database and the site every second; it must see one state or the other,
whole, and never an error. Each rebuild to be killed is a process of its own that has
imported everything and waits for its turn, so that moments in the work itself are hit.
"""

import os
import random
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import dashboards.site.render  # noqa: F401 - takes a second, and victims are killed by the clock
from assets.rebuild import rebuild
from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from warehouse.store.database import open_database
from warehouse.store.files import TEMPORARY_PREFIX
from warehouse.store.store import Store, fingerprint, table_digest

ROOT = Path(__file__).parents[2]
MYSELF = (sys.executable, "-m", "benchmarks.robustness.survive")
METHODS = ("rebased-2015",)
WORLD = WorldSettings(seasons=(2009, 2014), tows_per_season=4, rate_hz=20, seed=3)
STATES = ("archive-a", "archive-b")
SETTLED = 10.0
"""Seconds: how long ago files seem to be written, so that their hashes are remembered."""
PAUSE_S = 1.0
LONGER = 1.5
"""So many times as long as the last undisturbed rebuild may one take that does everything first."""


@dataclass
class Outcome:
    """What was seen.

    Attributes:
        kills: rebuilds that were killed.
        too_late: rebuilds that were done before the signal came; not counted as kills.
        different: reruns whose tables are not those of an undisturbed rebuild.
        at: kills by the newest thing in the data folder when the process died.
        reads: what the reader saw, counted.
    """

    kills: int = 0
    too_late: int = 0
    different: int = 0
    at: Counter[str] = field(default_factory=Counter)
    reads: Counter[str] = field(default_factory=Counter)

    @property
    def bad_reads(self) -> set[str]:
        """What no reader may see."""
        return self.reads.keys() - {*STATES, "site whole"}


def digests(data: Path) -> str:
    """One hash of all tables as a reader of the database gets them."""
    with open_database(Store(data).database) as db:
        db.execute("SET threads = 1")
        names = [row[2] for row in db.execute("SHOW ALL TABLES").fetchall()]
        frames = {name: db.sql(f'SELECT * FROM "{name}"').pl() for name in names}
    return fingerprint({name: table_digest(frame) for name, frame in sorted(frames.items())})


class Victim:
    """A process that waits to be told to rebuild, and is killed while it does."""

    def __init__(self, archive: Path, data: Path) -> None:
        self.process = subprocess.Popen(
            [*MYSELF, "--rebuild", archive, data],
            cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip

    def kill_after(self, seconds: float) -> bool:
        """Has it rebuild for so long, and kills it; whether it was still at work."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdout.readline()
        self.process.stdin.write("go\n")
        self.process.stdin.flush()
        time.sleep(seconds)
        self.process.kill()
        status = self.process.wait()
        self.process.stdin.close()
        self.process.stdout.close()
        if status > 0:
            raise RuntimeError("a rebuild failed by itself")
        return status == -signal.SIGKILL


def be_victim(archive: Path, data: Path) -> None:
    """Waits for the word, and rebuilds."""
    print("ready", flush=True)
    sys.stdin.readline()
    rebuild(archive, data, METHODS)


class Ground:
    """Two states of an archive, the tables of each, and a data folder to try on."""

    def __init__(self, root: Path) -> None:
        self.root, self.data, self.archive = root, root / "data", root / "archive"
        first, second = (root / name for name in STATES)
        write_simulated_archive(first, simulate_world(WORLD))
        shutil.copytree(first, second)
        _change(second)
        for file in (f for state in (first, second) for f in state.rglob("*")):
            os.utime(file, (time.time() - SETTLED,) * 2)
        self.expected = {}
        for name in reversed(STATES):
            self.switch(name)
            fresh = root / f"undisturbed-{name}"
            self.expected[name] = self.rebuild(fresh)
        assert len(set(self.expected.values())) == len(STATES)
        shutil.copytree(fresh, self.data)

    def switch(self, name: str) -> None:
        """Makes the archive be in a state; it is a link, so it happens at once."""
        link = self.root / "link"
        link.symlink_to(name)
        link.replace(self.archive)

    def rebuild(self, data: Path) -> str:
        """Rebuilds undisturbed and notes how long that took; gives the hash of the tables."""
        begin = time.monotonic()
        rebuild(self.archive, data, METHODS)
        self.seconds = time.monotonic() - begin
        return digests(data)


def _change(archive: Path) -> None:
    """Spoils one tow and changes the weight of another."""
    file = min((archive / "meetdata_2009").iterdir())
    file.write_bytes(file.read_bytes()[:-7] + b"x")
    path = archive / "sleeplijsten/sleeplijst_2014.csv"
    lines = path.read_text("utf-8").split("\n")
    path.write_text("\n".join([*lines[:2], *lines[3:]]), "utf-8")


def survive(root: Path, kills: int, seed: int, tell: Callable[[str], None] = print) -> Outcome:
    """Kills rebuilds at random moments, and compares the tables after each rerun."""
    chosen, outcome, ground = random.Random(seed), Outcome(), Ground(root)
    reader = subprocess.Popen(
        [*MYSELF, "--read", ground.data, *ground.expected.values()],
        cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    victim, state = Victim(ground.archive, ground.data), 0
    while outcome.kills < kills:
        state = 1 - state
        ground.switch(STATES[state])
        after_s = chosen.uniform(0.0, LONGER * ground.seconds)
        if victim.kill_after(after_s):
            outcome.kills += 1
            outcome.at[newest(ground.data)] += 1
        else:
            outcome.too_late += 1
        if outcome.kills < kills:
            victim = Victim(ground.archive, ground.data)  # makes itself ready during the rerun
        outcome.different += ground.rebuild(ground.data) != ground.expected[STATES[state]]
        tell(f"{outcome.kills} of {kills} kills, {outcome.different} with other tables")
    said, _ = reader.communicate("stop\n", timeout=120)
    outcome.reads.update({what: int(n) for what, n in map(_cells, said.splitlines())})
    return outcome


def newest(data: Path) -> str:
    """The newest thing in the data folder, as far as it says how far the rebuild was."""
    files = [
        file
        for file in data.rglob("*")
        if file.is_file()
        and "dagster" not in file.parts
        and not file.name.startswith(TEMPORARY_PREFIX)
    ]
    parts = max(files, key=lambda f: f.stat().st_mtime_ns).relative_to(data).parts
    return "/".join(parts[:3]) if parts[0] == "lake" else parts[0]


def _cells(line: str) -> list[str]:
    return line.split("\t")


def read_until_stopped(data: Path, expected: list[str]) -> None:
    """Opens database and site over and over; prints how often each thing was seen."""
    seen: Counter[str] = Counter()
    names = dict(zip(expected, STATES, strict=True))
    while not _told_to_stop():
        try:
            seen[names.get(digests(data), "neither state")] += 1
            page = (data / "site" / "index.html").read_text("utf-8")
            seen["site whole" if page.rstrip().endswith("</html>") else "site cut off"] += 1
        except Exception as error:
            seen[f"error: {type(error).__name__}: {str(error)[:80]}".replace("\t", " ")] += 1
    for what, number in sorted(seen.items()):
        print(f"{what}\t{number}")


def _told_to_stop() -> bool:
    """Also a pause between two looks, so that the rebuild gets a share of the machine."""
    return bool(select.select([sys.stdin], [], [], PAUSE_S)[0])


def main() -> None:
    """Runs the suite and prints the figures; exit status 1 when anything was lost."""
    if sys.argv[1:2] == ["--read"]:
        read_until_stopped(Path(sys.argv[2]), sys.argv[3:])
        return
    if sys.argv[1:2] == ["--rebuild"]:
        be_victim(Path(sys.argv[2]), Path(sys.argv[3]))
        return
    kills = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    with tempfile.TemporaryDirectory() as folder:
        begin = time.monotonic()
        outcome = survive(Path(folder), kills, seed, lambda line: print(line, flush=True))
    print(f"seed {seed}; {time.monotonic() - begin:.0f} s")
    print(
        f"kills: {outcome.kills}, reruns with other tables: {outcome.different}; "
        f"too late: {outcome.too_late}"
    )
    print("killed after writing: " + ", ".join(f"{k} {n}" for k, n in outcome.at.most_common()))
    print("reader: " + ", ".join(f"{k} {n}" for k, n in sorted(outcome.reads.items())))
    sys.exit(bool(outcome.different or outcome.bad_reads))


if __name__ == "__main__":
    main()
