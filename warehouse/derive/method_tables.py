"""The tables of one method: all tows recomputed."""

import polars as pl

from pipeline.method.definition import Method
from pipeline.recompute.facts import with_boats, with_hand_windows
from pipeline.recompute.recompute import recompute
from pipeline.recompute.run_cache import RunCache
from pipeline.register.register import as_ruled
from pipeline.uncertainty.ensemble import tow_ensemble
from warehouse.derive.inputs import Blocks


def method_tables(
    method: Method,
    boats: pl.DataFrame,
    tows: pl.DataFrame,
    tow_runs: pl.DataFrame,
    hand_windows: pl.DataFrame,
    blocks: Blocks,
    run_cache: RunCache,
) -> dict[str, pl.DataFrame]:
    """Run points, curves, log factors, assessments and members of all tows under one method."""
    runs = blocks.of_runs(with_hand_windows(tow_runs, hand_windows))
    made = recompute(method, with_boats(tows, boats), runs, run_cache)
    ruled = as_ruled(made.curves, method.validity)
    members = tow_ensemble(method.name, made.curves, ruled, made.uncertainty_budget, made.factors)
    return {**vars(made), "ensemble": members}
