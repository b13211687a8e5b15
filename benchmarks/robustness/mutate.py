"""Puts hundreds of faults in an archive: each is said in the quarantine, or moves no number.

    python benchmarks/robustness/mutate.py [faults] [seed]

In each round most tows of a season get a fault (`faults`), and the archive is read again and the
methods applied. Of a faulty tow something must be set aside (seconds, a run or all of it), or it
has exactly the rows it had before in every table; a tow without a fault must have exactly those,
and nothing of it set aside.
"""

import datetime as dt
import random
import shutil
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import polars as pl

from benchmarks.robustness.faults import spoil_bytes, spoil_row, spoil_samples
from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from pipeline.method.definition import shipped_method
from warehouse.derive.archive_tables import read_archive
from warehouse.derive.recomputing import ArchiveRuns, recompute_archive
from warehouse.store.store import Store

WORLD = WorldSettings(seasons=(2009,), tows_per_season=20, rate_hz=20, seed=3)
LIST = "sleeplijsten/sleeplijst_2009.csv"
METHODS = ("as-published", "rebased-2015")
SEEN = dt.date(2026, 11, 21)
WHOLE = 2
"""Tows of a round that get no fault."""

JUDGED = ("status", "flags", "doubts", "unusual", "list_line")
"""Judged against other tows, or where a row stands: no number."""


class Fault(NamedTuple):
    """A fault: what it is, in which tow, and at which byte of its file or row it begins."""

    kind: str
    tow_id: str
    place: int


@dataclass
class Findings:
    """What became of the faults.

    Attributes:
        faults: all different ones.
        aside: faults whose tow was set aside, by kind.
        harmless: faults whose tow has exactly the rows it had, by kind.
        wrong: tows with other numbers, and tows set aside without a fault.
    """

    faults: set[Fault] = field(default_factory=set)
    aside: Counter[str] = field(default_factory=Counter)
    harmless: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)


Rows = dict[str, dict[str, pl.DataFrame]]
"""By table and tow."""


class Ground:
    """An archive, and what is made of it without Dagster."""

    def __init__(self, root: Path) -> None:
        self.root, self.archive, self.store = root, root / "archive", Store(root / "data")
        write_simulated_archive(self.archive, simulate_world(WORLD))
        self.whole = root / "whole"
        shutil.copytree(self.archive, self.whole)
        self.clean, aside = self.read()
        assert not aside
        listed = self.store.read("listed_tows")
        self.files = dict(listed.select("tow_id", "samples_path").iter_rows())

    def read(self) -> tuple[Rows, set[str]]:
        """Rows of each tow in each table, and the tows of which something is set aside."""
        store = self.store
        read_archive(store, self.archive, SEEN)
        inputs = ("boats", "tows", "tow_runs", "hand_windows", "blocks")
        archive = ArchiveRuns(**{name: store.read(name) for name in inputs})
        made = recompute_archive([shipped_method(name) for name in METHODS], archive)
        assert made.failures.is_empty()
        found = {"tows": made.tows, "tow_runs": made.tow_runs}
        for table in ("run_points", "curves"):
            for name in METHODS:
                found[f"{table} {name}"] = made.tables[table].filter(method=name)
        aside = set(store.read("quarantine")["tow_id"].drop_nulls())
        return {name: _by_tow(frame) for name, frame in found.items()}, aside

    def mutate(self, chosen: random.Random) -> list[Fault]:
        """Makes the archive whole and puts a fault in most tows."""
        shutil.rmtree(self.archive)
        shutil.copytree(self.whole, self.archive)
        listed = self.archive / LIST
        lines = listed.read_text("cp1252").split("\n")
        rows = [i for i, line in enumerate(lines) if line.startswith("2009-")]
        faults = []
        for i in sorted(chosen.sample(rows, len(rows) - WHOLE)):
            cells = lines[i].split(";")
            file, how = self.archive / self.files[cells[0]], chosen.random()
            if how < 0.75:
                before = file.read_bytes()
                kind = (spoil_samples if how < 0.65 else spoil_bytes)(chosen, file)
                place = first_difference(before, file.read_bytes())
            else:
                before = lines[i].encode()
                lines[i], kind = spoil_row(chosen, lines[i])
                place = first_difference(before, lines[i].encode())
            if place is not None:
                faults.append(Fault(kind, cells[0], place))
        listed.write_text("\n".join(lines), "cp1252")
        return faults


def _by_tow(frame: pl.DataFrame) -> dict[str, pl.DataFrame]:
    dropped = [c for c in frame.columns if c in JUDGED or c.endswith("sha256")]
    parts = frame.drop(dropped).partition_by("tow_id", as_dict=True, maintain_order=True)
    return {str(tow_id): part for (tow_id,), part in parts.items()}


def first_difference(one: bytes, other: bytes) -> int | None:
    """The first byte at which two texts differ; None for equal ones."""
    if one == other:
        return None
    shared = min(len(one), len(other))
    return next((i for i in range(shared) if one[i] != other[i]), shared)


def mutate(root: Path, faults: int, seed: int, tell: Callable[[str], None] = print) -> Findings:
    """Puts faults in the archive, round after round, until there were enough different ones."""
    ground, found, chosen = Ground(root), Findings(), random.Random(seed)
    while len(found.faults) < faults:
        spoiled = ground.mutate(chosen)
        rows, aside = ground.read()
        _judge(ground.clean, rows, aside, {f.tow_id: f for f in spoiled}, found)
        found.faults |= set(spoiled)
        tell(f"{len(found.faults)} of {faults} faults, {len(found.wrong)} wrong")
    return found


def _judge(
    clean: Rows, rows: Rows, aside: set[str], spoiled: dict[str, Fault], found: Findings
) -> None:
    for tow_id in clean["tows"]:
        fault = spoiled.get(tow_id)
        other = [
            name
            for name, before in clean.items()
            if not _same(before.get(tow_id), rows[name].get(tow_id))
        ]
        if tow_id in aside:
            if fault is None:
                found.wrong.append(f"{tow_id} is set aside without a fault")
            else:
                found.aside[fault.kind] += 1
        elif other:
            found.wrong.append(f"{fault or tow_id} has other rows in {', '.join(other)}")
        elif fault is not None:
            found.harmless[fault.kind] += 1


def _same(one: pl.DataFrame | None, other: pl.DataFrame | None) -> bool:
    return one is other or (one is not None and other is not None and one.equals(other))


def main() -> None:
    """Runs the suite and prints the figures; exit status 1 when a fault got through."""
    faults = int(sys.argv[1]) if len(sys.argv) > 1 else 300
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    with tempfile.TemporaryDirectory() as folder:
        found = mutate(Path(folder), faults, seed, lambda line: print(line, flush=True))
    for kind in sorted(found.aside | found.harmless):
        aside, harmless = found.aside[kind], found.harmless[kind]
        print(f"  {kind:32} set aside {aside:4}, harmless {harmless:4}")
    print(
        f"seed {seed}: {len(found.faults)} different faults; set aside {found.aside.total()}, "
        f"harmless {found.harmless.total()}, wrong {len(found.wrong)}"
    )
    print("\n".join(found.wrong[:50]) or "every other row identical")
    sys.exit(bool(found.wrong))


if __name__ == "__main__":
    main()
