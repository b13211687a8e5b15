"""Archives drawn at random: what `rebased` makes of faults and gaps that nobody put together.

    PYTHONPATH=. python -m benchmarks.accuracy.drawn [archives]

Each is a named world of which a part of the tows or boats is left, without some seasons, with GPS
or wind missing in some seasons and tows, and with up to two faults of `benchmarks.accuracy.foreign`
on top. An archive takes a second or two, and ten once to simulate it.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"  # read when numpy is imported
os.environ["OPENBLAS_NUM_THREADS"] = "1"
os.environ["POLARS_MAX_THREADS"] = "1"

import sys
from dataclasses import replace

import numpy as np
import polars as pl

from benchmarks.accuracy.foreign import CLEAN, FOREIGN
from benchmarks.accuracy.score import score, table
from benchmarks.accuracy.worlds import FIRST_SEED, ONLY_FROM_FILES, recomputed, simulated
from herijk.simulate import WORLDS
from pipeline.arrays import BoolArray
from tests.worlds import Measured, find_tows_without_gps, without_wind

SEEDS = 20
FIRST_DRAW = 50_000
FEWEST_TOWS = 5


def drawn(rng: np.random.Generator) -> Measured:
    """A random archive of at least `FEWEST_TOWS` tows."""
    names = [name for name in WORLDS if name not in ONLY_FROM_FILES]
    whole = simulated(str(rng.choice(names)), FIRST_SEED + int(rng.integers(SEEDS)))
    keep = _some(whole.tows, rng) & ~_in_seasons(whole.tows, 0.1, rng)
    if keep.sum() < FEWEST_TOWS:
        return drawn(rng)
    world = _of_tows(whole, keep)
    few = rng.random(world.tows.height) < rng.choice([0.0, 0.0, 0.1, 0.3])
    world = find_tows_without_gps(world, few | _in_seasons(world.tows, 0.15, rng))
    world = without_wind(world, _in_seasons(world.tows, 0.08, rng))
    for fault in rng.choice(list(FOREIGN), size=rng.choice([0, 1, 1, 2]), replace=False):
        world = FOREIGN[str(fault)](world, rng)
    return world


def _some(tows: pl.DataFrame, rng: np.random.Generator) -> BoolArray:
    """All tows, or a share of the tows or of the boats."""
    share = rng.choice([1.0, 1.0, 0.6, 0.35, 0.15])
    by = "tow_id" if rng.random() < 0.5 else "fsn_no"
    names = tows[by].unique().sort()
    kept = names.filter(pl.Series(rng.random(len(names)) < share))
    return tows[by].is_in(kept.implode()).to_numpy()


def _in_seasons(tows: pl.DataFrame, share: float, rng: np.random.Generator) -> BoolArray:
    """Tows of seasons of which each is chosen with that chance."""
    seasons = tows["season"].unique().sort()
    chosen = seasons.filter(pl.Series(rng.random(len(seasons)) < share))
    return tows["season"].is_in(chosen.implode()).to_numpy()


def _of_tows(world: Measured, keep: BoolArray) -> Measured:
    kept = world.tows.filter(pl.Series(keep)).select("tow_id")
    frames = {
        name: getattr(world, name).join(kept, on="tow_id", how="semi", maintain_order="left")
        for name in ("tows", "runs", "truth")
    }
    mine = world.blocks.runs["tow_id"].is_in(kept["tow_id"].implode()).to_numpy()
    return replace(world, **frames, blocks=world.blocks.take(mine))


def main() -> None:
    """Prints the table, by size of the archive."""
    archives = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    records = []
    for number in range(FIRST_DRAW, FIRST_DRAW + archives):
        world = drawn(np.random.default_rng(number))
        size = next((most for most in (50, 150) if world.tows.height <= most), 240)
        tables = recomputed(world, equal_boats=False)
        found = score(CLEAN, tables, world.truth)
        records += [{"world": f"up to {size} tows", **row} for row in found]
    print("\n".join(table(pl.DataFrame(records, infer_schema_length=None).sort("world"))))


if __name__ == "__main__":
    main()
