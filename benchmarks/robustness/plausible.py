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
from herijk.warehouse.build.plausible import with_doubts
from tests.worlds import run_rows, tow_rows

TRIED_A_WORLD = 6
"""Tows of a world that get a fault, one after the other."""

SILENT = 0.02
"""Error of Cw from which a tow that nobody has to look at is silently wrong."""

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

    def judged(self, blocks: RunBlocks) -> tuple[set[str], set[str], dict[str, float]]:
        """Tows that are doubted, tows that need a look, and Cw by tow.

        The checks of the curve are those of fixed coefficients; a doubted tow needs a look.
        """
        shifts = implausible(Batch.of(self.tows, blocks))
        tows = with_doubts(self.tows, shifts)
        curves = recompute(shipped_method("rebased-2015"), tows, blocks, with_bands=False).curves
        doubts = set(tows.filter(pl.col("doubts").list.len() > 0)["tow_id"])
        looks = curves.filter(pl.col("flags").list.len() > 0)["tow_id"]
        return doubts, doubts | set(looks), dict(curves.select("tow_id", "cw_kg_m").rows())


def _as_read(samples: Samples) -> Samples:
    return samples.with_columns(pl.col(pl.Float64).cast(pl.Float32))


def groups(ground: Ground, rng: np.random.Generator) -> Iterator[tuple[str, list[str]]]:
    """Single tows, those of a day, those of a season, drawn anew."""
    tows = ground.tows
    for tow in rng.choice(tows["tow_id"].to_numpy(), TRIED_A_WORLD, replace=False):
        yield "tow", [str(tow)]
    for kind, column in (("day", "tow_date"), ("season", "season")):
        parts = tows.partition_by(column)
        for place in rng.choice(len(parts), 2, replace=False):
            yield kind, parts[place]["tow_id"].to_list()


def study(worlds: int, first_seed: int) -> tuple[pl.DataFrame, pl.DataFrame]:
    """One row a fault put in, and one a sound world."""
    rows, sound = [], []
    for seed in range(first_seed, first_seed + worlds):
        ground, rng = Ground.of(seed), np.random.default_rng(seed)
        doubts, looks, right = ground.judged(ground.stacked(ground.blocks, ground.tows))
        sound.append((ground.tows.height, len(doubts), len(looks)))
        for group, tows in groups(ground, rng):
            for kind, sizes in KINDS.items():
                for size, change in sizes:
                    found, looked, cw = ground.judged(ground.with_fault(tows, change))
                    shares = [len(which & set(tows)) / len(tows) for which in (found, looked)]
                    wrong = [abs(cw[t] / right[t] - 1.0) if cw[t] and right[t] else 0 for t in tows]
                    silent = [
                        w > SILENT and t not in looked for w, t in zip(wrong, tows, strict=True)
                    ]
                    rows.append((group, kind, size, *shares, np.median(wrong), np.mean(silent)))
    names = ("group", "kind", "size", "found", "look", "wrong", "silent")
    return pl.DataFrame(rows, schema=names, orient="row"), pl.DataFrame(
        sound, schema=("tows", "doubted", "look"), orient="row"
    )


def main() -> None:
    """Prints the table."""
    worlds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    first_seed = int(sys.argv[2]) if len(sys.argv) > 2 else 101
    rows, sound = study(worlds, first_seed)
    total = sound.sum().row(0, named=True)
    print(
        f"Of {total['tows']} sound tows {total['doubted']} are doubted, {total['look']} looked at"
    )
    means = (pl.col(name).mean() for name in ("found", "look", "silent"))
    told = (
        rows.group_by("kind", "size", "group", maintain_order=True)
        .agg(*means, pl.col("wrong").median())
        .pivot("group", index=["kind", "size"], values=["found", "look", "silent", "wrong"])
    )
    for row in told.iter_rows(named=True):
        cells = [f"{row['kind']} {row['size']}".strip(), f"{row['wrong_tow']:.0%}"]
        cells += [
            f"{row[f'{what}_{group}']:.0%}"
            for group in ("tow", "day", "season")
            for what in ("found", "look", "silent")
        ]
        print(f"| {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
