"""Wrong but plausible: which faults of units, scales and offsets are found, from which size on.

    python benchmarks/robustness/plausible.py [worlds] [first seed]

Each fault is put into the samples of one tow, one day or one season of a simulated archive, and the
archive is judged with it. Printed per kind and size, as a table for docs/operations.md: how far Cw
of a tow is then wrong, and how many of the faults are found; and how many tows of the sound
archives are doubted.
"""

import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
import polars as pl

from herijk.pipeline.assessment.plausibility import implausible
from herijk.pipeline.blocks.batch import Batch
from herijk.pipeline.blocks.run_blocks import RunBlocks, stack_blocks
from herijk.pipeline.blocks.sums import block_sums
from herijk.pipeline.method.definition import shipped_method
from herijk.pipeline.recompute.recompute import recompute
from herijk.simulate import WorldSettings, simulate_tow, simulate_world
from tests.worlds import run_rows, tow_rows

TRIED_A_WORLD = 6
"""Tows of a world that get a fault, one after the other."""

FORCE, WIND, ANGLE = "force_n", "wind_speed_m_s", "wind_angle_deg"
SPEEDS = ("log1_m_s", "log2_m_s", "gps_m_s")

Samples = pl.DataFrame
Change = Callable[[Samples], Samples]


def times(columns: tuple[str, ...], factor: float) -> Change:
    """A gain or another unit."""
    return lambda samples: samples.with_columns(pl.col(c) * factor for c in columns)


def plus(column: str, size: float) -> Change:
    """A zero that is off."""
    return lambda samples: samples.with_columns(pl.col(column) + size)


def turned(degrees: float) -> Change:
    """A vane that was fitted askew."""
    return lambda samples: samples.with_columns((pl.col(ANGLE) + degrees) % 360.0)


def in_radians(samples: Samples) -> Samples:
    """Angles in radians under a header of degrees."""
    return samples.with_columns(pl.col(ANGLE).radians())


KINDS: dict[str, list[tuple[str, Change]]] = {
    "force in kgf": [("", times((FORCE,), 1 / 9.80665))],
    "force in daN": [("", times((FORCE,), 0.1))],
    "force in lbf": [("", times((FORCE,), 1 / 4.4482216))],
    "force in kN": [("", times((FORCE,), 1e-3))],
    "force, scale": [
        (f"{100 * (k - 1):+.0f} %", times((FORCE,), k)) for k in (0.5, 0.7, 0.85, 1.15, 1.3, 2.0)
    ],
    "force, zero": [
        (f"{n:+.0f} N", partial(plus, FORCE)(float(n))) for n in (-100, -50, 50, 100, 150)
    ],
    "wind in km/h": [("", times((WIND,), 3.6))],
    "wind in knots": [("", times((WIND,), 1.943844))],
    "wind, scale": [(f"{100 * (k - 1):+.0f} %", times((WIND,), k)) for k in (0.5, 0.7, 1.3, 1.6)],
    "wind angle in radians": [("", in_radians)],
    "vane turned by": [(f"{a} degrees", turned(a)) for a in (10, 20, 45, 90, 180)],
    "all speeds, scale": [
        (f"{100 * (k - 1):+.0f} %", times(SPEEDS, k)) for k in (0.94, 0.97, 1.03, 1.06)
    ],
}


@dataclass
class Ground:
    """A simulated archive: its samples, and its blocks by tow."""

    tows: pl.DataFrame
    samples: dict[str, Samples]
    blocks: dict[str, pl.DataFrame]
    rate_hz: int

    @classmethod
    def of(cls, seed: int) -> "Ground":
        world = simulate_world(WorldSettings(tows_per_season=12, rate_hz=20, seed=seed))
        types = {t.tow_id: t.boat.boat_type.name for t in world.tows}
        tows = tow_rows(world)
        typed = tows.with_columns(pl.col("tow_id").replace_strict(types).alias("boat_type"))
        samples = {t.tow_id: simulate_tow(world, t)[0] for t in world.tows}
        ground = cls(typed, samples, {}, world.settings.rate_hz)
        ground.blocks = {tow: ground.summed(samples[tow], tow) for tow in samples}
        return ground

    def summed(self, samples: Samples, tow: str) -> pl.DataFrame:
        """Blocks of a tow."""
        return block_sums(samples, self.rate_hz).select(pl.lit(tow).alias("tow_id"), pl.all())

    def with_fault(self, tows: list[str], change: Change) -> RunBlocks:
        """The whole archive, with a fault in these tows."""
        faulty = {tow: self.summed(_as_read(change(self.samples[tow])), tow) for tow in tows}
        return self.stacked(self.blocks | faulty, self.tows)

    def stacked(self, blocks: dict[str, pl.DataFrame], tows: pl.DataFrame) -> RunBlocks:
        """Runs of the given tows."""
        return stack_blocks(pl.concat([blocks[t] for t in tows["tow_id"]]), run_rows(tows))

    def cw(self, tow: str, blocks: RunBlocks) -> float:
        """Cw of one tow by itself, under fixed coefficients; NaN without a curve."""
        alone = self.tows.filter(pl.col("tow_id") == tow)
        runs = blocks.take((blocks.runs["tow_id"] == tow).to_numpy())
        found = recompute(shipped_method("rebased-2015"), alone, runs, with_bands=False)
        value = found.curves["cw_kg_m"][0]
        return float("nan") if value is None else value


def _as_read(samples: Samples) -> Samples:
    return samples.with_columns(pl.col(pl.Float64).cast(pl.Float32))


def doubted(ground: Ground, blocks: RunBlocks) -> set[str]:
    """Tows that the archive rules out."""
    found = implausible(Batch.of(ground.tows, blocks))
    return {tow for shift in found for tow in shift.tows}


def groups(ground: Ground, rng: np.random.Generator) -> Iterator[tuple[str, list[str]]]:
    """Single tows, those of a day, those of a season, drawn anew."""
    tows = ground.tows
    for tow in rng.choice(tows["tow_id"].to_numpy(), TRIED_A_WORLD, replace=False):
        yield "tow", [str(tow)]
    for kind, column in (("day", "tow_date"), ("season", "season")):
        parts = tows.partition_by(column)
        for place in rng.choice(len(parts), 2, replace=False):
            yield kind, parts[place]["tow_id"].to_list()


def study(worlds: int, first_seed: int) -> tuple[pl.DataFrame, float, int]:
    """One row a fault put in; the share of sound tows doubted, and how many there were."""
    rows, doubts, sound = [], 0, 0
    for seed in range(first_seed, first_seed + worlds):
        ground, rng = Ground.of(seed), np.random.default_rng(seed)
        whole = ground.stacked(ground.blocks, ground.tows)
        before = doubted(ground, whole)
        doubts, sound = doubts + len(before), sound + ground.tows.height
        for group, tows in groups(ground, rng):
            for kind, sizes in KINDS.items():
                for size, change in sizes:
                    blocks = ground.with_fault(tows, change)
                    found = len(doubted(ground, blocks) & set(tows)) / len(tows)
                    wrong = ground.cw(tows[0], blocks) / ground.cw(tows[0], whole) - 1.0
                    rows.append((group, kind, size, found, abs(wrong)))
    names = ("group", "kind", "size", "found", "wrong")
    return pl.DataFrame(rows, schema=names, orient="row"), doubts / sound, sound


def main() -> None:
    """Prints the table."""
    worlds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    first_seed = int(sys.argv[2]) if len(sys.argv) > 2 else 101
    rows, share, sound = study(worlds, first_seed)
    print(f"{share:.1%} of {sound} sound tows are doubted")
    told = (
        rows.group_by("kind", "size", "group", maintain_order=True)
        .agg(pl.col("found").mean(), pl.len(), pl.col("wrong").fill_nan(None).median())
        .pivot("group", index=["kind", "size"], values=["found", "wrong"])
    )
    for row in told.iter_rows(named=True):
        wrong = row["wrong_tow"]
        print(
            f"| {row['kind']} {row['size']} | {'-' if wrong is None else f'{wrong:.0%}'} "
            f"| {row['found_tow']:.0%} | {row['found_day']:.0%} | {row['found_season']:.0%} |"
        )


if __name__ == "__main__":
    main()
