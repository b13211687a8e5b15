"""Recompute of every shipped method over a thousand tows with blocks present, by method.

    PYTHONPATH=. python benchmarks/recompute.py [tows]

Blocks are those of 40 simulated tows at 20 Hz, repeated: the number of samples in a block does not
matter to a recompute. Every copy has boats of its own, so that the network of repeat tows grows
with the tows. `rebased` has the network and all intervals in it; the members of its ensemble stand
apart.
"""

import platform
import resource
import statistics
import sys
import time

import numpy as np
import polars as pl

from pipeline.blocks import SUM_NAMES, stack_blocks
from pipeline.ensemble import as_frame, register_ensemble
from pipeline.method import shipped_method, shipped_methods
from pipeline.recompute import recompute
from pipeline.simulate import WorldSettings
from tests.worlds import measure

REPEATS = 5
SEASONS = (2009, 2010, 2012, 2014, 2015, 2016, 2017, 2018)


def repeated(times):
    """Tows, blocks and runs of a world, `times` times over under other names."""
    held = measure(WorldSettings(SEASONS, 5, 20))
    rows, seconds = np.nonzero(held.blocks.n > 0)
    keys = held.blocks.runs.select("tow_id", "run")[rows]
    blocks = keys.with_columns(
        pl.Series("second", seconds.astype(np.int16)),
        pl.Series("n", held.blocks.n[rows, seconds]),
        *(pl.Series(name, held.blocks[name][rows, seconds]) for name in SUM_NAMES),
    )

    def copies(frame):
        name = pl.col("tow_id")
        return pl.concat(frame.with_columns(name + f"-{k:03d}") for k in range(times))

    boat = pl.col("fsn_no") + "-" + pl.col("tow_id").str.slice(-3)
    return copies(held.tows).with_columns(boat), copies(blocks), copies(held.runs)


def main():
    tows_wanted = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    tows, blocks, runs = repeated(tows_wanted // (len(SEASONS) * 5))
    start = time.perf_counter()
    stacked = stack_blocks(blocks, runs)
    print(f"python {platform.python_version()}, polars {pl.__version__}, numpy {np.__version__}")
    print(f"{tows.height} tows, {runs.height} runs, {blocks.height} blocks; median of {REPEATS}")
    print(f"  stacking blocks  {time.perf_counter() - start:8.3f} s")
    total = 0.0
    for name in shipped_methods():
        method, times = shipped_method(name), []
        for _ in range(REPEATS):
            start = time.perf_counter()
            recompute(method, tows, stacked)
            times.append(time.perf_counter() - start)
        median = statistics.median(times)
        total += median
        print(f"  {name:16} {median:8.3f} s")
    print(f"  all methods      {total:8.3f} s")
    made = recompute(shipped_method("rebased"), tows, stacked)
    start = time.perf_counter()
    lines = made.curves.drop_nulls("cw_kg_m").select("tow_id", "cw_kg_m")
    members = register_ensemble(lines, made.uncertainty_budget, made.factors)
    as_frame(lines, members)
    print(f"  {len(members)} members      {time.perf_counter() - start:8.3f} s")
    print(
        f"  peak memory      {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:8.0f} MiB"
    )


if __name__ == "__main__":
    main()
