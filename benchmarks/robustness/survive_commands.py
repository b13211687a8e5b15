"""Kills publish, verify and serve with signal 9 at random moments, and lets each do its work again.

    python benchmarks/robustness/survive_commands.py [kills] [seed]

Each kill is of a process of its own on a copy of one data folder. After a killed `publish` there is
no edition or a whole one; publishing again gives the register of an undisturbed edition, and
`verify` finds nothing. After a killed `verify` no file is another one. After a killed `serve`,
with all its processes, a rebuild gives the tables of an undisturbed one, and `serve` shows the site
again.
"""

import hashlib
import os
import random
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from shutil import copytree, rmtree

from assets.rebuild import rebuild
from benchmarks.robustness.survive import METHODS, ROOT, WORLD, digests
from herijk.simulate import simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from tests.quiet import Quiet
from warehouse.store.editions import read_edition
from warehouse.store.store import Store, table_digest

EDITION = "2018-1"
ORDER = ("publish", "verify", "publish", "verify", "serve")
LONGER = 1.2
"""So many times as long as an undisturbed command may the kill be away."""
SERVE_S = 25.0
PATIENCE_S = 120.0


@dataclass
class Outcome:
    """What was seen: kills, commands that were done before the signal, and what was lost."""

    kills: Counter[str] = field(default_factory=Counter)
    too_late: Counter[str] = field(default_factory=Counter)
    lost: list[str] = field(default_factory=list)


class Ground:
    """An archive with its data folder, never touched, and a copy to try on."""

    def __init__(self, root: Path) -> None:
        self.archive, self.whole, self.data = root / "archive", root / "whole", root / "data"
        write_simulated_archive(self.archive, simulate_world(WORLD))
        rebuild(self.archive, self.whole, METHODS, Quiet())
        self.tables = digests(self.whole)
        self.fresh()
        self.seconds = {}
        for command in ("publish", "verify"):
            begin = time.monotonic()
            self.run(command)
            self.seconds[command] = time.monotonic() - begin
        self.register = self.published()
        self.seconds["serve"] = SERVE_S

    def fresh(self) -> None:
        """The copy as it was; runs that a copy remembers belong to the folder copied."""
        rmtree(self.data, ignore_errors=True)
        copytree(self.whole, self.data)

    def arguments(self, command: str) -> list[str]:
        """The command line."""
        more = {
            "publish": [EDITION, "--valid-from", "2018-01-01", "--decision", "SKC",
                        "--method", METHODS[0], "--published-on", "2018-01-01"],
            "verify": [],
            "serve": ["--archive", str(self.archive), "--port", str(_free_port())],
        }[command]  # fmt: skip
        return [sys.executable, "-m", "herijk", command, *more, "--data", str(self.data)]

    def run(self, command: str) -> int:
        """Lets a command do its work; its exit status."""
        arguments = self.arguments(command)
        return subprocess.run(arguments, cwd=ROOT, capture_output=True, check=False).returncode

    def published(self) -> str:
        """The register of the edition."""
        return table_digest(read_edition(Store(self.data), EDITION).register)

    def files(self) -> dict[str, str]:
        """Hashes of what no reader may change."""
        kept = (f for f in self.data.rglob("*") if f.is_file() and "dagster" not in f.parts)
        return {str(f): hashlib.sha256(f.read_bytes()).hexdigest() for f in sorted(kept)}

    def kill(self, command: str, after_s: float) -> bool:
        """Kills a command, and all its processes, after so long; whether it was at work."""
        process = subprocess.Popen(
            self.arguments(command), cwd=ROOT, start_new_session=True,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        time.sleep(after_s)
        at_work = process.poll() is None
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        return at_work


def after_publish(ground: Ground) -> str | None:
    """What is wrong after a killed publish."""
    there = (ground.data / "editions" / EDITION).exists()
    if not there and ground.run("publish") != 0:
        return "cannot be published again"
    if ground.published() != ground.register:
        return "another register"
    return None if ground.run("verify") == 0 else "verify finds something"


def after_verify(ground: Ground, before: dict[str, str]) -> str | None:
    """What is wrong after a killed verify."""
    if ground.files() != before:
        return "another file"
    return None if ground.run("verify") == 0 else "verify finds something"


def after_serve(ground: Ground) -> str | None:
    """What is wrong after a killed serve."""
    rebuild(ground.archive, ground.data, METHODS, Quiet())
    if digests(ground.data) != ground.tables:
        return "other tables"
    arguments = ground.arguments("serve")
    page = f"http://127.0.0.1:{int(arguments[arguments.index('--port') + 1]) + 1}/site/index.html"
    process = subprocess.Popen(
        arguments, cwd=ROOT, start_new_session=True,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        return None if _answers(page) else "serve does not come back"
    finally:
        process.terminate()
        process.wait(timeout=PATIENCE_S)


def _answers(page: str) -> bool:
    begin = time.monotonic()
    while time.monotonic() - begin < PATIENCE_S:
        with suppress(OSError), urllib.request.urlopen(page, timeout=5) as answer:  # noqa: S310
            return bool(answer.status == 200)
        time.sleep(0.5)
    return False


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def survive(root: Path, kills: int, seed: int, tell: Callable[[str], None] = print) -> Outcome:
    """Kills the commands in turn."""
    chosen, found, ground = random.Random(seed), Outcome(), Ground(root)
    tried = 0
    while found.kills.total() < kills:
        command = ORDER[tried % len(ORDER)]
        tried += 1
        ground.fresh()
        if command == "verify":
            ground.run("publish")
        before = ground.files()
        in_time = ground.kill(command, chosen.uniform(0.0, LONGER * ground.seconds[command]))
        (found.kills if in_time else found.too_late)[command] += 1
        wrong = {
            "publish": lambda: after_publish(ground),
            "verify": lambda before=before: after_verify(ground, before),
            "serve": lambda: after_serve(ground),
        }[command]()
        if wrong:
            found.lost.append(f"{command}: {wrong}")
        tell(f"{found.kills.total()} of {kills} kills, {command}: {wrong or 'nothing lost'}")
    return found


def main() -> None:
    """Prints the figures; exit status 1 when anything was lost."""
    kills = int(sys.argv[1]) if len(sys.argv) > 1 else 50
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    with tempfile.TemporaryDirectory() as folder:
        begin = time.monotonic()
        found = survive(Path(folder), kills, seed, lambda line: print(line, flush=True))
    print(f"seed {seed}; {time.monotonic() - begin:.0f} s")
    print(f"kills: {dict(found.kills)}; too late: {dict(found.too_late)}")
    print("\n".join(found.lost) or "nothing lost")
    sys.exit(bool(found.lost))


if __name__ == "__main__":
    main()
