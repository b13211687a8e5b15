"""The ladder: what each step of a method changes, one at a time, in factors that multiply.

From one method to another the options of one step after the other are exchanged, in a fixed order,
and every tow is recomputed, with what both ends estimate of instruments: so the factor of a step
is what it does on top of those before it.
What a step does is in its own module.
"""

from typing import Final

import numpy as np
import polars as pl

from pipeline.blocks.batch import Batch
from pipeline.blocks.run_blocks import RunBlocks
from pipeline.method.definition import Method, Steps
from pipeline.recompute.computed import Computed
from pipeline.recompute.recompute import batches, evaluate, season_factors
from pipeline.recompute.run_cache import RunCache
from pipeline.recompute.season_factors import is_estimated

STEP_ORDER: Final = (
    "speed",
    "force",
    "window",
    "runs",
    "calibration",
    "run_point",
    "wind",
    "temperature",
    "unrecorded",
    "curve",
)
"""The order in which steps are exchanged: that of the computation, and of the history."""

START: Final = "start"


def ladder(
    from_method: Method,
    to_method: Method,
    tows: pl.DataFrame,
    blocks: RunBlocks,
    links: tuple[pl.DataFrame | None, pl.DataFrame | None] | None = None,
    cache: RunCache | None = None,
) -> pl.DataFrame:
    """The effect of each step on every tow's Cw at the declared speed.

    Where an intermediate method gives no curve, its change is counted with the next step that does;
    a tow without a curve under either method has no ladder.

    Args:
        from_method, to_method: the ends of the ladder.
        tows: rows of the warehouse's `tows`.
        links: log factors of both methods, where they were estimated before: their rows of the
            table `tow_instruments`; None for a method that estimates none.
        cache: what was found before of the same tows; added to.

    Returns:
        Sorted rows `tow_id`, `position` (0 is the start), `step`, `factor` (Cw after / before the
        step; 1 at the start) and `cw_kg_m` (after it). The factors of a tow multiply to its total.
    """
    pairs = batches([from_method, to_method], tows, blocks)
    cache = RunCache() if cache is None else cache
    of_old, of_new = links or (
        _instruments([(batch, steps[end]) for batch, steps in pairs], cache) for end in (0, 1)
    )
    rungs: list[list[Computed]] = []
    mixed: list[Steps] = []
    for count in range(len(STEP_ORDER) + 1):
        before, mixed = mixed, [_mixed(old, new, count) for _, (old, new) in pairs]
        if count > 1 and mixed == before:  # both methods have this step alike
            rungs.append(rungs[-1])
            continue
        plans = [(batch, steps) for (batch, _), steps in zip(pairs, mixed, strict=True)]
        rungs.append(evaluate(plans, cache, of_new if count else of_old))
    parts = [_rungs_of_batch(list(computed)) for computed in zip(*rungs, strict=True)]
    return pl.concat(parts).sort("tow_id", "position")


def _instruments(plans: list[tuple[Batch, Steps]], cache: RunCache) -> pl.DataFrame | None:
    asked = any(is_estimated(steps) for _, steps in plans)
    estimated = season_factors(plans, cache) if asked else None
    return None if estimated is None else estimated.tows


def _mixed(old: Steps, new: Steps, count: int) -> Steps:
    """The old steps with the first `count` of `STEP_ORDER` taken from the new."""
    return old.model_copy(update={step: getattr(new, step) for step in STEP_ORDER[:count]})


def _rungs_of_batch(computed: list[Computed]) -> pl.DataFrame:
    cw = np.stack([one.cw_at_declared for one in computed])
    sound = np.isfinite(cw[0]) & np.isfinite(cw[-1])
    for rung in range(1, len(cw)):
        cw[rung] = np.where(np.isfinite(cw[rung]), cw[rung], cw[rung - 1])
    cw_known = cw[:, sound]
    factor = np.vstack([np.ones(cw_known.shape[1]), cw_known[1:] / cw_known[:-1]])
    tow_ids = computed[0].batch.tows["tow_id"].filter(pl.Series(sound))
    steps = (START, *STEP_ORDER)
    return pl.DataFrame(
        {
            "tow_id": pl.concat([tow_ids] * len(steps)),
            "position": np.repeat(np.arange(len(steps), dtype=np.int8), cw_known.shape[1]),
            "step": np.repeat(np.array(steps), cw_known.shape[1]),
            "factor": factor.ravel(),
            "cw_kg_m": cw_known.ravel(),
        }
    )
