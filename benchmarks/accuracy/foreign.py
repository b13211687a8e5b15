"""Worlds that neither the simulator nor any issue names: what `rebased` makes of them.

    PYTHONPATH=. python -m benchmarks.accuracy.foreign [archives]

The readings of clean archives are changed after they were simulated, so that a world takes a
function. Run it after a change of the model: none of these faults is among its unknowns.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"  # read when numpy is imported
os.environ["OPENBLAS_NUM_THREADS"] = "1"
os.environ["POLARS_MAX_THREADS"] = "1"

import sys
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import polars as pl

from benchmarks.accuracy.score import score, table
from benchmarks.accuracy.worlds import FIRST_SEED, recomputed, simulated
from pipeline.blocks.run_blocks import AIR_SUMS
from tests.worlds import Measured

CLEAN = "clean"
BEFORE_DGPS, ONE_SEASON = 2014, 2016
POWERS = {"v": (0, 1, 0), "inv_v2": (0, -2, 0), "cw": (1, -2, 0), "cw2": (2, -4, 0)}
"""Powers of force, log speed and wind speed in the sums of a speed source; the rest is air."""


Factor = np.ndarray | float


def reading(
    world: Measured,
    force: Factor = 1.0,
    log: Factor = 1.0,
    wind: Factor = 1.0,
    gps: Factor = 1.0,
) -> Measured:
    """The same world with readings times a factor per run."""
    *readings, gps_factor = (
        np.broadcast_to(x, world.blocks.runs.height)[:, None] for x in (force, log, wind, gps)
    )
    sums = {}
    for name, values in world.blocks.sums.items():
        source, _, quantity = name.partition("_")
        if source in ("log1", "log2"):
            powers = POWERS.get(quantity, (0, -2, 2))
        else:
            air = 2 if name in AIR_SUMS else int(name in ("wind_v", "wind_x", "wind_y"))
            powers = (int(name == "force"), 0, air)
        sums[name] = values * np.prod([x**n for x, n in zip(readings, powers, strict=True)], axis=0)
    sums["gps"] = sums["gps"] * gps_factor
    return replace(world, blocks=replace(world.blocks, sums=sums))


def runs(world: Measured) -> pl.DataFrame:
    """Runs with the facts of their tow, in the order of the blocks."""
    facts = world.tows.select("tow_id", "season", "fsn_no").with_row_index("tow")
    return world.blocks.runs.join(facts, on="tow_id", maintain_order="left")


def log_by_speed(world: Measured, _: np.random.Generator) -> Measured:
    """Until 2013 the log reads 1 % too little at 90 % of the speed, 1 % too much at 110 %."""
    factor = pl.col("target_speed_ratio") ** 0.1
    old = pl.when(pl.col("season") < BEFORE_DGPS).then(factor).otherwise(1.0)
    return reading(world, log=runs(world).select(old).to_series().to_numpy())


def hysteresis(world: Measured, _: np.random.Generator) -> Measured:
    """In one season the load cell reads 3 % too much on the way back."""
    back = (pl.col("direction") < 0) & (pl.col("season") == ONE_SEASON)
    return reading(
        world, force=1.0 + 0.03 * runs(world).select(back).to_series().cast(float).to_numpy()
    )


def salt(world: Measured, rng: np.random.Generator) -> Measured:
    """A fifth of the tows is done in water that is 2.5 % heavier."""
    heavier = 1.0 + 0.025 * (rng.random(world.tows.height) < 0.2)
    return reading(world, force=heavier[runs(world)["tow"].to_numpy()])


def shadow(world: Measured, _: np.random.Generator) -> Measured:
    """The anemometer reads 0.7 of the wind that comes from one side."""
    sideways = world.blocks.sums["wind_y"].sum(axis=1)
    return reading(world, wind=np.where(sideways < 0.0, 0.7, 1.0))


def standards(world: Measured, rng: np.random.Generator) -> Measured:
    """What is assumed and the simulator does not draw: 0.2 % each per archive, season and boat."""
    rows = runs(world)
    whose = [np.zeros(rows.height, int), *(rows[n].rank("dense") - 1 for n in ("season", "fsn_no"))]
    errors = [0.002 * rng.standard_normal(rows.height)[np.asarray(place)] for place in whose]
    return reading(world, force=np.exp(np.sum(errors, axis=0)))


def aged(world: Measured, ln_ratio: dict[str, np.ndarray]) -> Measured:
    """The same world with boats whose ln Cw has changed by so much in each season."""
    lines = world.tows.select("fsn_no", pl.col("season") - world.tows["season"].min())
    ratio = np.exp([ln_ratio[boat][year] for boat, year in lines.iter_rows()])
    changed = world.tows.select("tow_id", pl.Series("ratio", ratio))
    truth = world.truth.join(changed, on="tow_id", maintain_order="left")
    true = truth.with_columns(pl.col("cw_at_15c_kg_m") * pl.col("ratio")).drop("ratio")
    return replace(reading(world, force=ratio[runs(world)["tow"].to_numpy()]), truth=true)


def boats_and_years(world: Measured) -> tuple[list[str], int]:
    """The boats in order, and the number of seasons from the first to the last."""
    season = world.tows["season"].unique()
    return world.tows["fsn_no"].unique().sort().to_list(), season.max() - season.min() + 1


def uneven_ageing(world: Measured, rng: np.random.Generator) -> Measured:
    """Half of the boats get 2 % worse a year, the others do not."""
    boats, years = boats_and_years(world)
    worse = rng.random(len(boats)) < 0.5
    return aged(world, {b: 0.02 * w * np.arange(years) for b, w in zip(boats, worse, strict=True)})


def drifting(world: Measured, rng: np.random.Generator) -> Measured:
    """Every boat drifts by 1 % a year, this way or that."""
    boats, years = boats_and_years(world)
    return aged(world, {b: 0.01 * rng.standard_normal(years).cumsum() for b in boats})


def days(world: Measured, rng: np.random.Generator) -> Measured:
    """On each day the load cell reads 1 % too much or too little."""
    day = world.tows["tow_date"].rank("dense").to_numpy() - 1
    force = np.exp(0.01 * rng.standard_normal(day.max() + 1)[day])
    return reading(world, force=force[runs(world)["tow"].to_numpy()])


FOREIGN: dict[str, Callable[[Measured, np.random.Generator], Measured]] = {
    change.__name__: change
    for change in (
        *(log_by_speed, hysteresis, salt, shadow, standards),
        *(uneven_ageing, drifting, days),
    )
}


def main() -> None:
    """Prints the table."""
    archives = int(sys.argv[1]) if len(sys.argv) > 1 else 10
    records = []
    for name, change in FOREIGN.items():
        for seed in range(FIRST_SEED, FIRST_SEED + archives):
            world = change(simulated(CLEAN, seed), np.random.default_rng(seed))
            tables = recomputed(world, equal_boats=False)
            records += [{"world": name, **row} for row in score(CLEAN, tables, world.truth)]
    print("\n".join(table(pl.DataFrame(records, infer_schema_length=None))))


if __name__ == "__main__":
    main()
