"""How long the commands take, measured as a user would: from the shell, on a whole archive.

    PYTHONPATH=. python -m benchmarks.commands ARCHIVE [--repeats 3] [--write FILE]
    PYTHONPATH=. python -m benchmarks.commands --growth 60 180 600 [--write FILE]

The archive is linked, not copied, and its last tow is held back, to come in later as a new one.
With `--growth` archives of so many tows in each of 17 seasons are simulated at 10 samples per
second, so that ten thousand tows fit on a disk.
`Processor` counts all processes of a command. `Memory` is the largest sum of what they held at a
time; pages that they share count once.
"""

import argparse
import contextlib
import datetime as dt
import importlib
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import polars as pl

from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from warehouse.store.store import Store

SEASONS: Final = tuple(range(2009, 2026))
GROWTH_RATE_HZ: Final = 10
MOST_MIB: Final = {1_000: 1024, 10_000: 2048}
"""What the project asks: memory of a cold rebuild with so many tows."""
SMALL: Final = WorldSettings(tuple(range(2009, 2017)), 3, 100)
READ, COLD = "only text to blocks", "rebuild, cold"
LONGEST_OF_READING: Final = 1.2
UNCOMPILED: Final = "PYTHONDONTWRITEBYTECODE"
"""With this every command compiles its modules anew, which no user's does."""
READINGS: Final = (
    *("audit", "register --due", "audit --edition", "seasons", "compare", "methods"),
)
WITHIN_S: Final = {
    "rebuild, nothing new": 2.0,
    **dict.fromkeys(READINGS, 0.8),
}
"""What the project asks: the ratio of the two, seconds by the clock."""

_READING: Final = """
import sys
from pathlib import Path
from warehouse.store.store import Store
from warehouse.derive.archive_tables import read_archive
read_archive(Store(Path(sys.argv[2])), Path(sys.argv[1]))
"""


@dataclass(frozen=True)
class Cost:
    """What a command took.

    Attributes:
        seconds: by the clock.
        processor_s: of all its processes.
        peak_mib: the largest sum of their memory.
        load: of the machine when it ended.
    """

    seconds: float
    processor_s: float
    peak_mib: float
    load: float


def cost_of(*called: object) -> Cost:
    """Runs a command."""
    start = time.perf_counter()
    process = subprocess.Popen(
        [sys.executable, *map(str, called)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={name: value for name, value in os.environ.items() if name != UNCOMPILED},
        start_new_session=True,
    )
    peak = [0.0]
    watch = threading.Thread(target=_watch, args=(process, peak))
    watch.start()
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    seconds = time.perf_counter() - start
    watch.join()
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, list(map(str, called)))
    return Cost(seconds, used.ru_utime + used.ru_stime, peak[0], os.getloadavg()[0])


def _watch(process: "subprocess.Popen[bytes]", peak: list[float]) -> None:
    while process.returncode is None:
        peak[0] = max(peak[0], sum(_held_mib(process.pid)))
        time.sleep(0.5)  # looking more often takes a tenth of a processor


def _held_mib(session: int) -> Iterator[float]:
    """Memory of each process of a session, its part of what they share (Linux)."""
    for about in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            if int(about.read_text().rpartition(")")[2].split()[3]) == session:
                shares = (about.parent / "smaps_rollup").read_text().splitlines()
                yield sum(int(one.split()[1]) for one in shares if one.startswith("Pss:")) / 2**10


def herijk(*words: object) -> Cost:
    """A command of Herijk."""
    return cost_of("-m", "herijk", *words)


def held_back(archive: Path, folder: Path) -> tuple[Path, bytes]:
    """Links an archive without the last row of its newest tow list; gives that list, whole."""
    shutil.copytree(archive, folder, copy_function=os.link)
    newest = max((folder / "sleeplijsten").glob("sleeplijst_*"))
    whole = newest.read_bytes()
    newest.unlink()
    newest.write_bytes(whole.rstrip().rpartition(b"\n")[0] + b"\n")
    return newest, whole


def rebuilds(archive: Path, folder: Path) -> dict[str, Cost]:
    """The rebuilds of an archive, and what only reading it takes."""
    mine, data = folder / "archive", folder / "data"
    newest, whole = held_back(archive, mine)
    for file in mine.rglob("*.*"):  # from here on all read it from memory
        file.read_bytes()
    again = "rebuild", "--archive", mine, "--data", data
    found = {
        READ: cost_of("-c", _READING, mine, folder / "only read"),
        COLD: herijk(*again),
        "rebuild, nothing new": herijk(*again),
    }
    newest.write_bytes(whole)
    return found | {"rebuild, one new tow": herijk(*again)}


def small_rebuild(folder: Path) -> dict[str, Cost]:
    """The first rebuild of a small archive."""
    write_simulated_archive(folder / "small", simulate_world(SMALL))
    small = "--archive", folder / "small", "--data", folder / "small data"
    return {"rebuild, a small archive": herijk("rebuild", *small)}


def readings(data: Path, repeats: int) -> dict[str, Cost]:
    """The commands that only read, after two editions were published: medians."""
    day = max(Store(data).read("tows")["tow_date"]) + dt.timedelta(days=1)
    for edition, method in (("2026-1", "as-published"), ("2026-2", "rebased")):
        herijk("publish", edition, "--method", method, "--valid-from", day,
               "--decision", "benchmark", "--data", data)  # fmt: skip
    herijk("rebuild", "--archive", data.parent / "archive", "--data", data)
    boat = Store(data).read("register").filter(pl.col("tow_id").is_not_null())["fsn_no"][0]
    commands = {
        "audit": ("audit", boat),
        "register --due": ("register", "--due"),
        "audit --edition": ("audit", boat, "--edition", "2026-2"),
        "seasons": ("seasons",),
        "compare": ("compare", "2026-1", "2026-2"),
        "methods": ("methods",),
    }
    return {
        name: _middle([herijk(*words, "--data", data) for _ in range(repeats)])
        for name, words in commands.items()
    }


def _middle(costs: list[Cost]) -> Cost:
    """The one with the median time."""
    return sorted(costs, key=lambda cost: cost.seconds)[len(costs) // 2]


def asked(found: dict[str, Cost]) -> Iterator[tuple[str, str, str, bool]]:
    """What, what was found, what is asked, and whether it holds."""
    cold, read = found[COLD], found[READ]
    ratio = cold.seconds / read.seconds
    most = f"at most {LONGEST_OF_READING:g}"
    yield f"{COLD} / {READ}", f"{ratio:.2f}", most, ratio <= LONGEST_OF_READING
    for name, limit in WITHIN_S.items():
        seconds = found[name].seconds
        yield f"{name}, seconds", f"{seconds:.2f}", f"at most {limit:g}", seconds <= limit


def machine(*modules: str) -> str:
    """What the figures were measured on, with the versions of the given modules."""
    versions = {name: str(importlib.import_module(name).__version__) for name in modules}
    facts = {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "load": f"{os.getloadavg()[0]:.1f}",
        "python": platform.python_version(),
    }
    return ", ".join(f"{key} {value}" for key, value in (facts | versions).items())


def _processor() -> str:
    about = Path("/proc/cpuinfo")
    lines = about.read_text(encoding="utf-8").splitlines() if about.exists() else []
    named = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return named[0] if named else platform.machine()


def made_by(title: str, archive: str) -> list[str]:
    """How a page of figures begins."""
    return [
        f"# {title}",
        "",
        f"Made by `python -m benchmarks.commands` on {dt.datetime.now(dt.UTC).date()}. Machine: "
        f"{machine('numpy', 'polars')}. {archive} Processor is that of all processes of a "
        "command. Memory is the largest sum of what they held at a time; pages that they share "
        "count once. Load is that of the machine when a command, or all, ended: above the number "
        "of cores, other work was going on, and processor time is the more reliable one.",
        "",
    ]


def page(found: dict[str, Cost], archive: str) -> str:
    """The page of the documentation."""
    lines = [
        *made_by("Commands from the shell", f"{archive} Reading commands: medians."),
        "| what | found | asked | holds |",
        "| --- | --- | --- | --- |",
        *(
            f"| {what} | {value} | {limit} | {'yes' if holds else '**no**'} |"
            for what, value, limit, holds in asked(found)
        ),
        "",
        "| command | seconds | processor s | peak MiB | load |",
        "| --- | --- | --- | --- | --- |",
        *(
            f"| {name} | {cost.seconds:.2f} | {cost.processor_s:.2f} | {cost.peak_mib:.0f} | "
            f"{cost.load:.1f} |"
            for name, cost in found.items()
        ),
    ]
    return "\n".join(lines) + "\n"


def measured(archive: Path, repeats: int) -> str:
    """The page about one archive."""
    with tempfile.TemporaryDirectory(dir=archive.parent) as folder:
        found = rebuilds(archive, Path(folder)) | small_rebuild(Path(folder))
        data = Path(folder) / "data"
        tows = Store(data).read("tows")
        found |= readings(data, repeats)
    rates = ", ".join(map(str, tows["sample_rate_hz"].unique().sort()))
    about = (
        f"Simulated archive of {tows.height} tows of {tows['fsn_no'].n_unique()} boats at {rates} "
        f"Hz; the small one has {len(SMALL.seasons)} seasons of {SMALL.tows_per_season} tows at "
        f"{SMALL.rate_hz} Hz."
    )
    return page(found, about)


def grown(tows_per_season: int) -> tuple[int, int, dict[str, Cost]]:
    """How many tows and boats a simulated archive has, and what each command took, once."""
    with tempfile.TemporaryDirectory() as folder:
        archive, data = Path(folder) / "simulated", Path(folder) / "data"
        world = simulate_world(WorldSettings(SEASONS, tows_per_season, GROWTH_RATE_HZ))
        write_simulated_archive(archive, world)
        found = rebuilds(archive, Path(folder)) | readings(data, repeats=1)
        tows = Store(data).read("tows")
    return tows.height, tows["fsn_no"].n_unique(), found


def growth_page(sizes: list[tuple[int, int, dict[str, Cost]]]) -> str:
    """The page about archives of several sizes."""
    about = (
        f"Simulated archives of {len(SEASONS)} seasons at {GROWTH_RATE_HZ} Hz: everything after "
        "the blocks costs what it does at 1000 Hz, reading costs less. Every command once: "
        "seconds by the clock / seconds of processor / peak MiB. At 1000 Hz: "
        "[commands.md](commands.md)."
    )
    heads = [f"{tows:,} tows, {boats:,} boats" for tows, boats, _ in sizes]
    rows = {
        name: [f"{c.seconds:.1f} / {c.processor_s:.1f} / {c.peak_mib:.0f}" for c in costs]
        for name in sizes[0][2]
        if (costs := [found[name] for *_, found in sizes])
    }
    lines = [
        *made_by("Growth with the number of tows", about),
        "| command | " + " | ".join(heads) + " |",
        "| --- |" + " --- |" * len(sizes),
        *(f"| {name} | {' | '.join(cells)} |" for name, cells in rows.items()),
        "",
        *(
            f"- Asked of a rebuild with {number:,} tows: at most {most:,} MiB. Found with "
            f"{tows:,}: {found[COLD].peak_mib:,.0f}."
            for number, most in MOST_MIB.items()
            for tows, _, found in sizes
            if number <= tows < 2 * number
        ),
    ]
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("archive", type=Path, nargs="?")
    what.add_argument("--growth", type=int, nargs="+", metavar="TOWS", help="tows per season")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--write", type=Path, metavar="FILE", help="write the page here too")
    chosen = parser.parse_args()
    if chosen.growth:
        made = growth_page([grown(tows) for tows in chosen.growth])
    else:
        made = measured(chosen.archive, chosen.repeats)
    print(made)
    if chosen.write:
        chosen.write.write_text(made, encoding="utf-8")


if __name__ == "__main__":
    main()
