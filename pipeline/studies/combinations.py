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

NOTHING_ON: Final = "none"
"""Name of the combination that is the first method."""

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
    pairs = set(zip(old.which.tolist(), new.which.tolist(), strict=True))
    return [
        group
        for group, steps in STEP_GROUPS.items()
        if any(
            getattr(old.steps[before], step) != getattr(new.steps[after], step)
            for before, after in pairs
            for step in steps
        )
    ]


def list_combinations(switches: Sequence[str]) -> list[list[str]]:
    """Return what is on in every combination; switch i is where the place has bit i set."""
    return [
        [switch for bit, switch in enumerate(switches) if place >> bit & 1]
        for place in range(2 ** len(switches))
    ]


def name_combination(on: Sequence[str]) -> str:
    """Return the name of a combination: what is on, joined by `+`, or `NOTHING_ON`."""
    return "+".join(on) or NOTHING_ON


def find_switches(combinations: Collection[str]) -> list[str]:
    """Return the switches that the names of combinations are made of, in the order of the steps."""
    return [group for group in STEP_GROUPS if group in combinations]


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
