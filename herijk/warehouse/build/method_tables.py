"""The tables of one method: all tows recomputed."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import polars as pl

from herijk.pipeline.blocks.run_blocks import RunBlocks
from herijk.pipeline.recompute.facts import with_boats, with_hand_windows
from herijk.pipeline.recompute.recompute import recompute
from herijk.pipeline.recompute.run_cache import RunCache
from herijk.pipeline.register.register import as_ruled
from herijk.pipeline.uncertainty.ensemble import tow_ensemble

if TYPE_CHECKING:
    from herijk.warehouse.build.inputs import Inputs

RUNS: Final = ("boats", "tows", "tow_runs", "hand_windows", "blocks")
"""The tables that a method is applied to."""


def method_tables(inputs: "Inputs") -> dict[str, pl.DataFrame]:
    """Run points, curves, log factors, assessments and members of all tows under one method."""
    (method,) = inputs.methods
    tows = with_boats(inputs["tows"], inputs["boats"])
    with run_cache(inputs) as cache:
        made = recompute(method, tows, blocks_of(inputs), cache)
    ruled = as_ruled(made.curves, method.validity)
    members = tow_ensemble(method.name, made.curves, ruled, made.uncertainty_budget, made.factors)
    return {**vars(made), "ensemble": members}


@contextmanager
def run_cache(inputs: "Inputs") -> Iterator[RunCache]:
    """What this process has computed of the runs, as long as these do not change."""
    cache = _cache_of(inputs.made_from(*RUNS))
    try:
        yield cache
    finally:
        cache.let_go()


@lru_cache(maxsize=1)
def _cache_of(_: str) -> RunCache:
    return RunCache()


def blocks_of(inputs: "Inputs") -> RunBlocks:
    """The runs of all sound tows as arrays, with the windows given by hand."""
    runs = with_hand_windows(inputs["tow_runs"], inputs["hand_windows"])
    return inputs.run_blocks(runs)


def tows_without_curve_row(inputs: "Inputs", made: Mapping[str, pl.DataFrame]) -> list[str]:
    """Tows that have no row in `curves`: there are none."""
    lost = inputs["tows"].join(made["curves"], on="tow_id", how="anti")
    return list(lost["tow_id"])
