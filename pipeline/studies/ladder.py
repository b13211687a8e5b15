"""The ladder: what each step of a method changes, one at a time, in factors that multiply.

From one method to another the options of one step after the other are exchanged, in a fixed order,
and every tow is recomputed, with what both ends estimate of instruments: so the factor of a step
is what it does on top of those before it.
What a step does is in its own module.
"""

from collections.abc import Sequence

import numpy as np
import polars as pl

from pipeline.blocks.run_blocks import RunBlocks
from pipeline.method.definition import Method
from pipeline.method.options import START, STEP_ORDER
from pipeline.recompute.computed import Computed
from pipeline.recompute.plan import Plan
from pipeline.recompute.recompute import estimate_season_factors, evaluate
from pipeline.recompute.run_cache import RunCache


def ladder(
    from_method: Method,
    to_method: Method,
    tows: pl.DataFrame,
    blocks: RunBlocks,
    links: tuple[pl.DataFrame | None, pl.DataFrame | None] | None = None,
    cache: RunCache | None = None,
) -> pl.DataFrame:
    """Return the effect of each step on every tow's Cw at the declared speed.

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
    cache = cache or RunCache()
    old = Plan.from_method(from_method, tows, blocks, cache)
    new = Plan.from_method(to_method, tows, blocks, cache)
    of_old, of_new = links or (_estimate_instruments(old), _estimate_instruments(new))
    rungs: list[Computed] = []
    for count in range(len(STEP_ORDER) + 1):
        plan = exchange_steps(old, new, STEP_ORDER[:count])
        if count > 1 and plan.steps == rungs[-1].plan.steps:  # both methods have this step alike
            rungs.append(rungs[-1])
        else:
            rungs.append(evaluate(plan, of_new if count else of_old))
    return _add_factors(rungs).sort("tow_id", "position")


def _estimate_instruments(plan: Plan) -> pl.DataFrame | None:
    """Return rows of `tow_instruments`; None where no log is to be estimated, or none can be."""
    if not any(steps.speed.correction == "estimated" for steps in plan.steps):
        return None
    estimated = estimate_season_factors(plan)
    return None if estimated is None else estimated.tows


def exchange_steps(old: Plan, new: Plan, exchanged: Sequence[str]) -> Plan:
    """Return the old steps of each tow, those named `exchanged` being the new."""
    pairs, which = np.unique([old.which, new.which], axis=1, return_inverse=True)
    steps = []
    for before, after in pairs.T.tolist():
        of_new = {step: getattr(new.steps[after], step) for step in exchanged}
        steps.append(old.steps[before].model_copy(update=of_new))
    return Plan(old.tows, tuple(steps), which.ravel(), old.cache)


def _add_factors(rungs: list[Computed]) -> pl.DataFrame:
    """Return the curves of every tow after each rung, and the factor on the rung before."""
    cw = np.stack([one.cw_at_declared for one in rungs])
    sound = np.isfinite(cw[0]) & np.isfinite(cw[-1])
    for rung in range(1, len(cw)):
        cw[rung] = np.where(np.isfinite(cw[rung]), cw[rung], cw[rung - 1])
    cw_known = cw[:, sound]
    factor = np.vstack([np.ones(cw_known.shape[1]), cw_known[1:] / cw_known[:-1]])
    tow_ids = rungs[0].tows.frame["tow_id"].filter(pl.Series(sound))
    steps = (START,) + STEP_ORDER
    return pl.DataFrame(
        {
            "tow_id": pl.concat([tow_ids] * len(steps)),
            "position": np.repeat(np.arange(len(steps), dtype=np.int8), cw_known.shape[1]),
            "step": np.repeat(np.array(steps), cw_known.shape[1]),
            "factor": factor.ravel(),
            "cw_kg_m": cw_known.ravel(),
        }
    )
