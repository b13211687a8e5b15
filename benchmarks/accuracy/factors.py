"""How near season log factors come to the truth, and how often their intervals hold.

    PYTHONPATH=. python benchmarks/accuracy/factors.py [worlds]

Each world has ten seasons of 24 tows at 20 Hz and goes from samples to `log_factors` and
`season_steps`, as an archive does. "clean" and "history" worlds are those of `methods.py`. 64
worlds give 320 factors per line. Many more worlds, without samples, are in `season.py`.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"  # one process a core; read when numpy is imported
os.environ["OPENBLAS_NUM_THREADS"] = "1"
os.environ["POLARS_MAX_THREADS"] = "1"

import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from multiprocessing import get_context

import numpy as np
import polars as pl

from herijk.simulate import Defects, WorldSettings
from pipeline.method.definition import shipped_method
from pipeline.recompute.recompute import recompute
from tests.worlds import Measured, measure, with_force_error

SEASONS = tuple(range(2009, 2019))
OLD = (2009, 2010, 2011)
FIRST_SEED = {"clean": 4000, "history": 5000}
LIMIT = {"clean": 0.005, "history": 0.008}
FORCE_ERROR = 1.16
WITH_FORCE_ERROR = (2010, 2016)
GOOD_LOG = 2010


def defects(kind: str, good_log: int | None, season: int) -> Defects:
    """What is wrong in a season of that kind of world; one season may have a log without error."""
    wrong = getattr(Defects, kind)(season)
    return replace(wrong, log_season_factor=(1.0, 1.0)) if season == good_log else wrong


def archive(kind: str, seed: int, good_log: int | None = None) -> Measured:
    return measure(WorldSettings(SEASONS, 24, 20, seed, partial(defects, kind, good_log)))


def found(kind: str, number: int) -> tuple[pl.DataFrame, pl.DataFrame]:
    """Factors beside the true ones, and causes beside the planted ones."""
    seed = FIRST_SEED[kind] + number
    world = archive(kind, seed)
    made = recompute(shipped_method("rebased"), world.tows, world.blocks, with_bands=False)
    truth = world.truth.group_by("season").agg(pl.col("log_factor").log().mean().exp())
    causes = [made.season_steps.with_columns(planted=pl.lit("log"))]
    other = archive(kind, seed, GOOD_LOG)
    for season in WITH_FORCE_ERROR:
        faulty = with_force_error(other, season, FORCE_ERROR)
        steps = recompute(
            shipped_method("rebased"), faulty.tows, faulty.blocks, with_bands=False
        ).season_steps
        causes.append(steps.with_columns(planted=pl.lit(f"force {season}")))
    return made.log_factors.join(truth, on="season"), pl.concat(causes)


def report_factors(kind: str, factors: pl.DataFrame) -> None:
    inside = pl.col("log_factor").is_between("lo", "hi")
    error = 100 * (pl.col("factor") / pl.col("log_factor") - 1.0)
    rows = factors.drop_nulls("lo").with_columns(inside.alias("inside"), error.alias("error"))
    old = rows.filter(pl.col("season") <= 2011)["error"]
    rmse = float(np.sqrt((old**2).mean()))
    mark = " " if rmse <= 100 * LIMIT[kind] else "!"
    print(
        f"{mark} {kind}: log error of 2009-2011 in percentage points of speed: RMSE {rmse:.2f}, "
        f"worst {old.abs().max():.2f}, of {old.len()} (at least {100 * LIMIT[kind]:.1f})"
    )
    for source, group in rows.group_by("source", maintain_order=True):
        share = group["inside"].mean()
        mark = " " if 0.90 <= share <= 0.99 else "!"
        by_season = group.group_by("season").agg(pl.col("inside").mean()).sort("season")
        print(
            f"{mark} {kind}: 95 % intervals hold the truth, {source[0]}: {share:.1%} of "
            f"{group.height} (at least 90-99 %); by season "
            + " ".join(f"{season}: {held:.0%}" for season, held in by_season.rows())
        )


def report_causes(kind: str, causes: pl.DataFrame) -> None:
    print(f"  {kind}: cause named, share of the worlds")
    for planted, season in (
        *(("log", s) for s in OLD),
        *((f"force {s}", s) for s in WITH_FORCE_ERROR),
    ):
        named = causes.filter(planted=planted, season=season)["cause"]
        shares = named.value_counts(sort=True, normalize=True).rows()
        print(
            f"    {planted:14s} {season}  "
            + ", ".join(f"{cause} {share:.0%}" for cause, share in shares)
        )
    calm = causes.filter((pl.col("planted") == "log") & (pl.col("season") >= 2014))["cause"]
    print(f"    nothing        2014 on  none {(calm == 'none').mean():.0%} of {calm.len()} seasons")


def main() -> None:
    worlds = int(sys.argv[1]) if len(sys.argv) > 1 else 64
    print(f"{worlds} archives of each kind, {len(SEASONS)} seasons of 24 tows")
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        for kind in FIRST_SEED:
            factors, causes = zip(*pool.map(partial(found, kind), range(worlds)), strict=True)
            report_factors(kind, pl.concat(factors))
            report_causes(kind, pl.concat(causes))


if __name__ == "__main__":
    main()
