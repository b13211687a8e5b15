"""Wrong but plausible: which faults of units, scales, offsets, swaps and mix-ups are found.

    python benchmarks/robustness/plausible.py try SEED PART FILE
    python benchmarks/robustness/plausible.py table FILE...

`try` takes a minute or two for one simulated archive and every eighth fault of the list, from PART
(0 to 7) on; FILE is Parquet. `table` prints what was found in all files.

One fault at a time is put into a tow, a day or a season of an archive, or into the only tow of a
boat, by what a reader would make of it: samples are judged as when they are read, then added up;
tows that nothing happened to keep their sums. All checks follow, and the method `rebased`. A fault
is told where its tow is set aside or needs a look, its season's instruments do, or the change of
the boat's later tow against this one does. It is silent where Cw of the tow, or of any other, is
more than 2 % off and nobody is told.
"""

import sys
from collections.abc import Callable, Iterator, Mapping
from copy import copy
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice
from typing import Final

import numpy as np
import polars as pl

from herijk.simulate import simulate_tow, simulate_world
from herijk.simulate.worlds import world_settings
from pipeline.blocks.run_blocks import stack_blocks
from pipeline.blocks.sums import block_sums
from pipeline.errors import DefectiveInputError
from pipeline.method.definition import shipped_method
from pipeline.recompute.recompute import recompute
from pipeline.tables.keys import LINE
from tests.worlds import run_rows, tow_rows
from warehouse.archive.plausibility.judge import judge_samples
from warehouse.derive.archive_tables import judged_tows

TOWS, DAYS, SEASONS, NEW = 3, 1, 1, 2
"""How many get each fault in one archive."""
GROUPS: Final = ("tow", "day", "season", "new")
PARTS: Final = 8
"""Of the list of faults, so that each takes minutes."""
WORLD: Final = "clean"
"""Nothing else is wrong in it, so what needs a look is the fault's."""
RATE_HZ: Final = 20
SILENT: Final = 0.02
"""Error of Cw from which a tow that nobody has to look at is silently wrong."""
METHOD: Final = "rebased"

FORCE, WIND, ANGLE = "force_n", "wind_speed_m_s", "wind_angle_deg"
LOG1, LOG2, GPS = SPEEDS = ("log1_m_s", "log2_m_s", "gps_m_s")

Samples = pl.DataFrame
Change = Callable[[Samples], Samples]


@dataclass(frozen=True)
class Tried:
    """The part of an archive that a fault is put into: its tows and their samples."""

    tows: pl.DataFrame
    samples: Mapping[str, Samples]

    def changed(self, change: Change) -> "Tried":
        """With other samples."""
        return replace(self, samples={tow: change(s) for tow, s in self.samples.items()})

    def listed(self, **columns: pl.Expr) -> "Tried":
        """With other cells in the tow list."""
        return replace(self, tows=self.tows.with_columns(**columns))


Fault = Callable[["Ground", Tried], Tried]


def times(columns: tuple[str, ...], factor: float) -> Fault:
    """A gain or another unit."""
    return _each(lambda samples: samples.with_columns(pl.col(c) * factor for c in columns))


def plus(column: str, size: float) -> Fault:
    """A zero that is off."""
    return _each(lambda samples: samples.with_columns(pl.col(column) + size))


def turned(degrees: float) -> Fault:
    """A vane that was fitted askew."""
    return _each(lambda samples: samples.with_columns((pl.col(ANGLE) + degrees) % 360.0))


def exchanged(one: str, other: str) -> Fault:
    """Two columns under each other's header, where both are measured."""

    def change(samples: Samples) -> Samples:
        there = samples[one].null_count() + samples[other].null_count() == 0
        return samples.rename({one: other, other: one}) if there else samples

    return _each(change)


def runs_as(order: tuple[int, ...]) -> Fault:
    """Runs in another order than the list says."""

    def change(samples: Samples) -> Samples:
        number = pl.col("run").replace_strict(range(1, 7), order, return_dtype=pl.Int8)
        return samples.with_columns(number).sort("run", maintain_order=True)

    return _each(change)


def in_list(column: str, ratio: float) -> Fault:
    """A number of the tow list that is off."""
    return lambda _, tried: tried.listed(**{column: pl.col(column) * ratio})


def other_file(kind: str, exchange: bool) -> Fault:
    """The samples of another tow: of any, of that day, of the same type, or of the boat itself.

    Args:
        kind: column in which the other tow is the same.
        exchange: each got the other's samples; else the other keeps its own as well.
    """

    def fault(ground: "Ground", tried: Tried) -> Tried:
        (tow,) = tried.tows["tow_id"]
        same = ground.tows.filter(pl.col(kind) == tried.tows[kind], pl.col("tow_id") != tow)
        if same.is_empty():
            return tried
        other = same["tow_id"][same.height // 2]
        if not exchange:
            return replace(tried, samples={tow: ground.samples[other]})
        both = ground.tows.filter(pl.col("tow_id").is_in([tow, other]))
        return Tried(both, {tow: ground.samples[other], other: ground.samples[tow]})

    return fault


def _each(change: Change) -> Fault:
    return lambda _, tried: tried.changed(change)


def _percent(ratio: float) -> str:
    return f"{100 * (ratio - 1):+.0f} %"


def _scales(columns: tuple[str, ...], *ratios: float) -> dict[str, Fault]:
    return {_percent(k): times(columns, k) for k in ratios}


def _zeros(column: str, unit: str, *sizes: float) -> dict[str, Fault]:
    return {f"{n:+g} {unit}": partial(plus, column)(n) for n in sizes}


OF_INSTRUMENTS: dict[str, dict[str, Fault]] = {
    "force": {
        "in kgf": times((FORCE,), 1 / 9.80665),
        "in lbf": times((FORCE,), 1 / 4.4482216),
        "in kN": times((FORCE,), 1e-3),
    },
    "force, scale": _scales((FORCE,), 0.5, 0.7, 0.85, 0.9, 0.95, 1.03, 1.05, 1.1, 1.15, 1.3, 2.0),
    "force, zero": _zeros(FORCE, "N", -50, -20, -10, 10, 20, 50, 100),
    "wind": {
        "in km/h": times((WIND,), 3.6),
        "in knots": times((WIND,), 1.943844),
        "angle in radians": _each(lambda s: s.with_columns(pl.col(ANGLE).radians())),
    },
    "wind, scale": _scales((WIND,), 0.5, 0.7, 1.3, 1.6),
    "vane turned": {f"{a} degrees": turned(a) for a in (10, 20, 45, 90, 180)},
    "speeds": {
        "in km/h": times(SPEEDS, 3.6),
        "in knots": times(SPEEDS, 1.943844),
        "log 1 in knots": times((LOG1,), 1.943844),
    },
    "log 1, scale": _scales((LOG1,), 0.94, 0.97, 0.99, 1.01, 1.03, 1.06),
    "both logs, scale": _scales((LOG1, LOG2), 0.97, 1.03),
    "GPS, scale": _scales((GPS,), 0.97, 0.99, 1.01, 1.03),
    "all speeds, scale": _scales(SPEEDS, 0.94, 0.97, 0.99, 1.01, 1.03, 1.06),
    "log 1, zero": _zeros(LOG1, "m/s", -0.05, 0.05, 0.1),
    "columns exchanged": {
        "log 1 and 2": exchanged(LOG1, LOG2),
        "log 1 and GPS": exchanged(LOG1, GPS),
        "log 1 and wind": exchanged(LOG1, WIND),
        "force and wind": exchanged(FORCE, WIND),
    },
}
"""What one instrument does to a tow, all tows of a day or of a season."""

OF_A_TOW: dict[str, dict[str, Fault]] = {
    "runs": {
        "out and back exchanged": runs_as((4, 5, 6, 1, 2, 3)),
        "in the order of 110, 100, 90 %": runs_as((3, 2, 1, 6, 5, 4)),
        "run 1 and 6 exchanged": runs_as((6, 2, 3, 4, 5, 1)),
    },
    "samples copied": {
        "of another boat of that day": other_file("tow_date", exchange=False),
        "of the boat's other tow": other_file("fsn_no", exchange=False),
    },
    "samples exchanged": {
        "with another boat of that day": other_file("tow_date", exchange=True),
        "with a boat of the same type": other_file("boat_type", exchange=True),
        "with the boat's other tow": other_file("fsn_no", exchange=True),
    },
    "declared speed": {_percent(k): in_list("declared_speed_m_s", k) for k in (0.9, 0.95, 1.05)},
    "length": {_percent(k): in_list("waterline_length_m", k) for k in (0.9, 1.1)},
    "breadth": {_percent(k): in_list("beam_m", k) for k in (0.5, 2.0)},
    "weight": {_percent(k): in_list("weight_kg", k) for k in (0.8, 1.2)},
}
"""What a person mixes up for one tow."""


@dataclass(frozen=True)
class Result:
    """What people get of an archive: Cw by tow, at its right declared speed, and who needs a look.

    Attributes:
        cw: of tows that are not set aside and have a curve.
        set_aside, look: tows.
        alarm: seasons whose instruments need a look.
    """

    cw: Mapping[str, float]
    set_aside: set[str]
    look: set[str]
    alarm: set[int]


class Ground:
    """A simulated archive: its samples, and its blocks by tow."""

    def __init__(self, seed: int) -> None:
        settings = world_settings(WORLD, tows_per_season=12, rate_hz=RATE_HZ, seed=seed)
        world = simulate_world(settings)
        types = {t.tow_id: t.boat.boat_type.name for t in world.tows}
        self.tows = tow_rows(world).with_columns(
            pl.col("tow_id").replace_strict(types).alias("boat_type"),
            samples_path=pl.col("tow_id") + ".csv",
            second_path=pl.lit(None, pl.String),
            runs_set_aside=pl.lit(0),
        )
        self.samples = {t.tow_id: simulate_tow(world, t)[0] for t in world.tows}
        self.runs = run_rows(self.tows).with_columns(planned_s=50.0)
        self.blocks = {tow: _summed(tow, samples) for tow, samples in self.samples.items()}
        self.right = self.result(Tried(self.tows.clear(), {}))

    def with_only(self, tow: str) -> "Ground":
        """The archive in which this is its boat's only tow."""
        other = copy(self)
        boat = self.tows.filter(tow_id=tow)["fsn_no"]
        other.tows = self.tows.filter((pl.col("tow_id") == tow) | ~pl.col("fsn_no").is_in(boat))
        other.right = other.result(Tried(self.tows.clear(), {}))
        return other

    def part(self, tows: list[str]) -> Tried:
        """Some tows as they are."""
        return Tried(
            self.tows.filter(pl.col("tow_id").is_in(tows)), {tow: self.samples[tow] for tow in tows}
        )

    def result(self, tried: Tried) -> Result:
        """The archive with these tows in place of its own, read, judged and recomputed."""
        tows = pl.concat([self.tows.join(tried.tows, on="tow_id", how="anti"), tried.tows])
        tows, blocks, unreadable = tows.sort("tow_date", "tow_id"), dict(self.blocks), set()
        lost: dict[str, int] = {}
        for tow in tried.tows.iter_rows(named=True):
            tow_id = tow["tow_id"]
            try:
                read = judge_samples(_as_read(tried.samples[tow_id]), tow, self.runs)
            except DefectiveInputError:
                unreadable.add(tow_id)
                continue
            lost[tow_id] = sum(fault.lost == "run" for fault in read.faults)
            blocks[tow_id] = _summed(tow_id, read.samples)
        sound = tows.filter(~pl.col("tow_id").is_in(unreadable)).with_columns(
            runs_set_aside=pl.col("tow_id").replace_strict(lost, default=0)
        )
        together = pl.concat([blocks[tow] for tow in sound["tow_id"]])
        runs = self.runs.join(together, on=["tow_id", "run"], how="semi")
        kept, _ = judged_tows(sound, stack_blocks(together, runs), together)
        stacked = stack_blocks(together, runs.join(kept, on="tow_id", how="semi"))
        made = recompute(shipped_method(METHOD), kept, stacked, with_bands=False)
        return Result(
            self._cw(made.curves),
            set(self.tows["tow_id"]) - set(kept["tow_id"]),
            set(made.curves.filter(pl.col("flags").list.len() > 0)["tow_id"]),
            set(made.season_diagnosis.filter("alarm")["season"]),
        )

    def _cw(self, curves: pl.DataFrame) -> dict[str, float]:
        """Cw at the declared speed that is right."""
        right = self.tows.select("tow_id", v="declared_speed_m_s")
        s = (1 - pl.col("a_kg_m") / pl.col("cw_kg_m")) / pl.col("declared_speed_m_s") ** 2
        cw = pl.col("a_kg_m") / (1 - s * pl.col("v") ** 2)
        known = curves.drop_nulls("cw_kg_m").join(right, on="tow_id")
        return dict(known.select("tow_id", cw).iter_rows())

    def groups(self, rng: np.random.Generator) -> Iterator[tuple[str, "Ground", list[str]]]:
        """Single tows, those of a day, those of a season, and tows of boats that have no other."""
        for tow in rng.choice(self.tows["tow_id"].to_numpy(), TOWS, replace=False):
            yield "tow", self, [str(tow)]
        for kind, column, number in (("day", "tow_date", DAYS), ("season", "season", SEASONS)):
            parts = self.tows.partition_by(column)
            for place in rng.choice(len(parts), number, replace=False):
                yield kind, self, parts[place]["tow_id"].to_list()
        for tow in rng.choice(self.tows["tow_id"].to_numpy(), NEW, replace=False):
            yield "new", self.with_only(str(tow)), [str(tow)]

    def compared(self, tried: Tried) -> list[tuple[bool, bool, bool, float, float]]:
        """Of each tow with the fault and each other that is off: whether it has the fault, is set
        aside, is told; how far Cw is off; and from where on the program says that it sees that."""
        found, right = self.result(tried), self.right
        season = dict(self.tows.select("tow_id", "season").iter_rows())
        crew = {row[0]: row[1:] for row in self.tows.select("tow_id", *LINE).iter_rows()}
        told = found.set_aside | found.look
        by_crew = {crew[tow] for tow in found.look - right.look}
        mine = set(tried.tows["tow_id"])
        rows = []
        for tow in sorted(right.cw.keys() - right.set_aside):
            off = abs(found.cw.get(tow, np.nan) / right.cw[tow] - 1.0)
            alarm = season[tow] in found.alarm - right.alarm
            if tow in mine or off > SILENT:
                is_told = tow in told or crew[tow] in by_crew or alarm or not np.isfinite(off)
                rows.append((tow in mine, tow in found.set_aside, is_told, off))
        return rows


def _as_read(samples: Samples) -> Samples:
    return samples.with_columns(pl.col(pl.Float64).cast(pl.Float32))


def _summed(tow: str, samples: Samples) -> pl.DataFrame:
    return block_sums(samples, RATE_HZ).select(pl.lit(tow).alias("tow_id"), pl.all())


def all_faults() -> Iterator[tuple[str, str, Fault, tuple[str, ...]]]:
    """Every fault: kind, size, what it does, and the groups of tows that may have it."""
    for faults, groups in ((OF_INSTRUMENTS, GROUPS), (OF_A_TOW, ("tow",))):
        for kind, sizes in faults.items():
            for size, fault in sizes.items():
                yield kind, size, fault, groups


def study(seed: int, part: int) -> Iterator[pl.DataFrame]:
    """Rows of every eighth fault in one archive, one per tow that has it or is off."""
    ground, rng = Ground(seed), np.random.default_rng(seed)
    yield pl.DataFrame({"kind": ["none"], "off": [len(ground.right.look) / ground.tows.height]})
    groups = list(ground.groups(rng))
    for kind, size, fault, kinds in islice(all_faults(), part, None, PARTS):
        for group, archive, tows in groups:
            if group in kinds:
                rows = archive.compared(fault(archive, archive.part(tows)))
                yield pl.DataFrame(rows, ["mine", "aside", "told", "off"], orient="row").select(
                    pl.all(), kind=pl.lit(kind), size=pl.lit(size), group=pl.lit(group)
                )


def table(rows: pl.DataFrame) -> Iterator[str]:
    """Lines of the table of docs/operations.md, in the order of the faults."""
    for kind, size, _, groups in all_faults():
        part = rows.filter(kind=kind, size=size)
        if part.is_empty():
            continue
        off = part.filter("mine", pl.col("off").is_finite(), group="tow", aside=False)["off"]
        cells = [f"{kind} {size}", f"{off.median():.1%}" if off.len() else "-"]
        cells += [_told(part.filter("mine", group=g)) if g in groups else "" for g in GROUPS]
        cells.append(str(part.filter(~pl.col("mine") & ~pl.col("told")).height))
        yield f"| {' | '.join(cells)} |"


def _told(tows: pl.DataFrame) -> str:
    """Share of the tows that are told, and that are silently wrong."""
    if tows.is_empty():
        return ""
    silent = ~pl.col("told") & (pl.col("off") > SILENT)
    shares = tows.select(pl.col("told").mean(), silent.mean().alias("silent")).row(0)
    return " / ".join(f"{share:.0%}" for share in shares)


def main() -> None:
    """Does what the arguments say."""
    what, *rest = sys.argv[1:]
    if what == "try":
        found = pl.concat(study(int(rest[0]), int(rest[1])), how="diagonal")
        found.write_parquet(rest[2])
        return
    rows = pl.concat([pl.read_parquet(file) for file in rest], how="diagonal")
    clean = rows.filter(kind="none")
    print(f"{clean.height} archives; need a look without a fault: {clean['off'].mean():.1%}")
    print("\n".join(table(rows)))


if __name__ == "__main__":
    main()
