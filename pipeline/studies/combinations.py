"""The vote, part by part: every tow under every combination of what two methods have otherwise.

A group of `STEP_GROUPS` is a switch: off, its steps are those of the first method; on, those of the
proposed one. Nothing on is the first method itself, and everything on the proposed one.
"""

from collections.abc import Collection, Mapping, Sequence
from typing import Final

import polars as pl

from pipeline.blocks.run_blocks import RunBlocks
from pipeline.method.definition import Method
from pipeline.method.options import STEP_GROUPS
from pipeline.recompute.computed import Computed
from pipeline.recompute.plan import Plan
from pipeline.recompute.recompute import evaluate
from pipeline.recompute.run_cache import RunCache
from pipeline.register.register import choose_default_method, list_shown_methods
from pipeline.studies.ladder import exchange_steps
from pipeline.studies.switches import find_switches, list_combinations, name_combination

INSTRUMENTS: Final = "instruments"
"""The group of steps that applies what was estimated of logs and load cells."""


def choose_ends(methods: Sequence[Method]) -> tuple[Method, Method] | None:
    """Return the method that the others are compared with, and the one that is put to the vote.

    The latter is the one that is shown first. None where they are the same.
    """
    shown = list_shown_methods([method.name for method in methods])
    proposed = next(one for one in methods if one.name == choose_default_method(shown))
    return None if proposed == methods[0] else (methods[0], proposed)


def compute_combinations(
    from_method: Method,
    to_method: Method,
    tows: pl.DataFrame,
    blocks: RunBlocks,
    links: Mapping[str, pl.DataFrame],
    cache: RunCache | None = None,
) -> pl.DataFrame:
    """Compute the curve of every tow under every combination of switches.

    Args:
        from_method, to_method: the ends: nothing on and everything on.
        tows: rows of the warehouse's `tows`.
        blocks: their runs.
        links: log factors by method: rows of `tow_instruments`; none of one that estimates none.
        cache: what was found before of the same tows; added to.

    Returns:
        Rows `combination` (see `name_combination`), `tow_id`, `a_kg_m`, `b_m_s` (null where it is
        not determined) and `cw_kg_m` at the declared speed, of tows that have a curve.
    """
    cache = cache or RunCache()
    old = Plan.from_method(from_method, tows, blocks, cache)
    new = Plan.from_method(to_method, tows, blocks, cache)
    switches = list_switches(old, new)
    frames = []
    for on in list_combinations(switches):
        plan = exchange_steps(old, new, [step for group in on for step in STEP_GROUPS[group]])
        instruments = to_method if uses_new_instruments(on, switches) else from_method
        curves = _tabulate_curves(evaluate(plan, links[instruments.name]))
        frames.append(curves.with_columns(combination=pl.lit(name_combination(on))))
    return pl.concat(frames)


def list_switches(old: Plan, new: Plan) -> list[str]:
    """Return the groups of steps that some tow has otherwise under the new plan."""
    changed = set()
    for before, after in set(zip(old.which.tolist(), new.which.tolist(), strict=True)):
        for group, steps in STEP_GROUPS.items():
            of_group = set(steps)
            was = old.steps[before].model_dump(include=of_group)
            if was != new.steps[after].model_dump(include=of_group):
                changed.add(group)
    return find_switches(changed)


def uses_new_instruments(on: Collection[str], switches: Collection[str]) -> bool:
    """Return whether a combination takes what the proposed method estimates of instruments.

    The estimate belongs to the steps that apply it. Where both methods have these alike, it belongs
    to all that is on.
    """
    return INSTRUMENTS in on if INSTRUMENTS in switches else bool(on)


def _tabulate_curves(computed: Computed) -> pl.DataFrame:
    """Return the curves of the tows that have one."""
    b_m_s = pl.Series(computed.curves.b_m_s)
    frame = pl.DataFrame(
        {
            "tow_id": computed.tows.frame["tow_id"],
            "a_kg_m": computed.curves.a_kg_m,
            "b_m_s": pl.select(pl.when(b_m_s.is_finite()).then(b_m_s)).to_series(),
            "cw_kg_m": computed.cw_at_declared,
        }
    )
    return frame.filter(pl.col("cw_kg_m").is_finite())
