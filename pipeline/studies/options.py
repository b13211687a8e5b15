"""How much options matter: what a careful person could choose, and what the tool of 2015 let tick.

Both are full factorials on top of a method: every tow under all combinations of some choices, and
of each choice its mean effect over all combinations of the others. What is known to be wrong
(searching wind coefficients run by run) is history, not a vote, and takes part in the second only:
"Razende Snol 2014, bepaalde combinaties van opties" (presentation 2015) shows some of its
combinations; here are all.
"""

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Final

import polars as pl

from pipeline import curve
from pipeline.blocks.run_blocks import RunBlocks
from pipeline.hull import hull_speed_m_s
from pipeline.method.definition import Method
from pipeline.method.options import Steps
from pipeline.recompute.computed import Computed
from pipeline.recompute.plan import Plan
from pipeline.recompute.recompute import evaluate
from pipeline.recompute.run_cache import RunCache

FACTOR: Final = "speed.factor"
B: Final = "curve.b"

CHOICES: Final[dict[str, tuple[object, object]]] = {
    FACTOR: (1.06, 1 / 0.94),
    "run_point.estimator": ("mean_of_ratios", "ratio_of_robust_means"),
    "wind.averaging_s": (0, 3),
    B: ("capped", "free"),
}
"""Of judgement: two values of an option."""

B_FROM_LENGTH: Final = "b_from_length"
TICKS: Final[dict[str, tuple[str, tuple[object, object]]]] = {
    "optimisation": ("wind.coefficients", ("fixed", "per_run")),
    "trimming": ("window.rule", ("all", "steady")),
    "vane": ("wind.averaging_s", (0, 3)),
    B_FROM_LENGTH: (B, ("free", "hull speed")),
}
"""By column, the option and its values without and with the tick: "Optimalisatie", "Afkappen",
"WindVaanCorrectie", "B uit sloeplengte"."""

AS_READ, DGPS, MULTIPLY, DIVIDE, ESTIMATED = "as_read", "dgps", "multiply", "divide", "estimated"

SPEEDS: Final = {
    "dgps": (AS_READ, DGPS),
    "correction": (AS_READ, MULTIPLY),
    "operation": (MULTIPLY, DIVIDE),
    "estimate": (AS_READ, ESTIMATED),
}
"""Pairs of speeds, by the name of what makes the second of the first."""


def option_effects(
    method: Method, tows: pl.DataFrame, blocks: RunBlocks, links: pl.DataFrame, cache: RunCache
) -> pl.DataFrame:
    """Return the effect of each of `CHOICES` over all combinations of the others.

    Args:
        method: the method whose other options hold.
        tows: rows of the warehouse's `tows`.
        links: the method's rows of the table `tow_instruments`; none where it estimates no log.
        cache: what was found before of the same tows; added to.

    Returns:
        Sorted rows per tow and option that can matter to it: `tow_id`, `option` and
        `cw_effect_ratio` (second value / first value, mean over all combinations of the others). A
        tow that one of the combinations leaves without a curve has no rows, nor has one whose log
        is estimated: another option would also move the factor of its season.
    """
    plan = Plan.from_method(method, tows, blocks, cache)
    can = pl.Series(plan.options.speed.correction == "prescribed")
    names = [name for name in CHOICES if name != FACTOR or can.any()]
    crossed = {name: (name, CHOICES[name]) for name in names if name != B}
    capped = plan.replace_steps(lambda steps: replace_options(steps, {B: "capped"}))
    frames = []
    for flags, computed in _evaluate_combinations(capped, crossed, links):
        frames.append(_tabulate_curves(computed, computed.curves, flags | {B: False}))
        frames.append(_tabulate_curves(computed, computed.free, flags | {B: True}))
    is_estimated = pl.Series(plan.options.speed.correction == "estimated")
    own_log = plan.tows.frame["tow_id"].filter(~is_estimated)
    whole = _select_complete(pl.concat(frames), ["tow_id"], len(names)).filter(
        pl.col("tow_id").is_in(own_log.implode())
    )
    prescribed = plan.tows.frame["tow_id"].filter(can)
    effects = []
    for name in names:
        concerned = whole
        if name == FACTOR:
            concerned = whole.filter(pl.col("tow_id").is_in(prescribed.implode()))
        effects.append(_compute_effect(concerned, name))
    return pl.concat(effects).sort("tow_id", "option")


def option_curves(
    method: Method, tows: pl.DataFrame, blocks: RunBlocks, links: pl.DataFrame, cache: RunCache
) -> pl.DataFrame:
    """Return curves of every tow under all combinations of `TICKS` and the speeds of its season.

    Args:
        method, tows, blocks, links, cache: as `option_effects` takes them.

    Returns:
        Sorted rows per tow, speed and combination: `tow_id, speed`, a column for each tick,
        `a_kg_m, b_m_s` (null where resistance does not rise) and `cw_kg_m` at the declared speed;
        combinations that give no curve are left out.
    """
    plan = Plan.from_method(method, tows, blocks, cache)
    crossed = {name: choice for name, choice in TICKS.items() if name != B_FROM_LENGTH}
    frames = []
    for speed, tow_ids, way in _list_speeds(plan):
        for flags, computed in _evaluate_combinations(way, crossed, links):
            hull_speed = hull_speed_m_s(computed.tows.get_of_tows("waterline_length_m"))
            by_length = curve.fit_given_b(computed.points, hull_speed)
            free = _tabulate_curves(computed, computed.free, flags | {B_FROM_LENGTH: False})
            tied = _tabulate_curves(computed, by_length, flags | {B_FROM_LENGTH: True})
            both = pl.concat([free, tied]).filter(pl.col("tow_id").is_in(tow_ids.implode()))
            frames.append(both.with_columns(speed=pl.lit(speed)))
    key = ["tow_id", "speed"] + list(TICKS)
    return pl.concat(frames).select(key + ["a_kg_m", "b_m_s", "cw_kg_m"]).sort(key)


def cross_ticks(curves: pl.DataFrame) -> pl.DataFrame:
    """Return the effect of each tick and each speed on a tow, over all combinations of the others.

    Args:
        curves: rows of `option_curves`.

    Returns:
        Rows as of `option_effects`, options named as in `TICKS` and `SPEEDS`; of speeds under which
        every combination gives a curve.
    """
    whole = _select_complete(curves, ["tow_id", "speed"], len(TICKS))
    effects = [_compute_effect(whole, name) for name in TICKS]
    for name, (first, second) in SPEEDS.items():
        pair = whole.filter(pl.col("speed").is_in([first, second]))
        effects.append(_compute_effect(pair, name, pl.col("speed") == second))
    return pl.concat(effects).sort("tow_id", "option")


def _list_speeds(plan: Plan) -> Iterator[tuple[str, pl.Series, Plan]]:
    """Yield each speed, the tows that have it, and a plan under which they do."""
    ways = [_list_ways(steps) for steps in plan.steps]
    for speed in (AS_READ, DGPS, MULTIPLY, DIVIDE, ESTIMATED):
        there = plan.tows.frame["tow_id"].filter([speed in ways[one] for one in plan.which])
        if there.len():
            steps = tuple(way.get(speed, way[AS_READ]) for way in ways)
            yield speed, there, replace(plan, steps=steps)


def _list_ways(steps: Steps) -> dict[str, Steps]:
    """Return the log as it reads, and each way in which a method makes a true speed of it."""
    as_read, no_gps = {"speed.correction": "none"}, {"calibration.rule": "none"}
    ways = {AS_READ: replace_options(steps, as_read | no_gps)}
    if steps.calibration.rule != "none":
        ways[DGPS] = replace_options(steps, as_read)
    if steps.speed.correction == "estimated":
        ways[ESTIMATED] = steps
    if steps.speed.correction == "prescribed":
        # Multiply by 1 + p, or divide by 1 - p.
        ways[MULTIPLY] = replace_options(steps, no_gps)
        ways[DIVIDE] = replace_options(steps, no_gps | {FACTOR: 1.0 / (2.0 - steps.speed.factor)})
    return ways


def replace_options(steps: Steps, values: Mapping[str, object]) -> Steps:
    """Return the steps of a season with other values of some options."""
    for name, value in values.items():
        step, option = name.split(".")
        changed = getattr(steps, step).model_copy(update={option: value})
        steps = steps.model_copy(update={step: changed})
    return steps


def _evaluate_combinations(
    plan: Plan,
    crossed: Mapping[str, tuple[str, tuple[object, object]]],
    links: pl.DataFrame,
) -> Iterator[tuple[dict[str, bool], Computed]]:
    """Yield all combinations of choices: which are on, and the curves under them."""
    for corner in itertools.product((False, True), repeat=len(crossed)):
        flags = dict(zip(crossed, corner, strict=True))
        values = {}
        for name, is_on in flags.items():
            option, choices = crossed[name]
            values[option] = choices[is_on]
        yield flags, evaluate(plan.replace_steps(partial(replace_options, values=values)), links)


def _tabulate_curves(
    computed: Computed, curves: curve.Curves, flags: Mapping[str, bool]
) -> pl.DataFrame:
    """Return the curves of tows that have one, with a column for each choice that is on or off."""
    cw = computed.cw_at(1.0, curves)
    frame = pl.DataFrame(
        {
            "tow_id": computed.tows.frame["tow_id"],
            "a_kg_m": curves.a_kg_m,
            "b_m_s": curves.b_m_s,
            "cw_kg_m": cw,
        }
    )
    b = pl.col("b_m_s")
    return frame.filter(pl.col("cw_kg_m").is_finite()).with_columns(
        pl.when(b.is_finite()).then(b).alias("b_m_s"),
        **{name: pl.lit(is_on) for name, is_on in flags.items()},
    )


def _select_complete(curves: pl.DataFrame, key: list[str], choices: int) -> pl.DataFrame:
    """Return curves of the tows of which every combination gives one, with `ln_cw`."""
    every = pl.len().over(key) == 2**choices
    return curves.filter(every).with_columns(ln_cw=pl.col("cw_kg_m").log())


def _compute_effect(whole: pl.DataFrame, name: str, on: pl.Expr | None = None) -> pl.DataFrame:
    """Return the ratio of the second to the first Cw of each tow that has both."""
    on, ln_cw = pl.col(name) if on is None else on, pl.col("ln_cw")
    means = whole.group_by("tow_id", maintain_order=True).agg(
        pl.lit(name).alias("option"),
        (ln_cw.filter(on).mean() - ln_cw.filter(~on).mean()).exp().alias("cw_effect_ratio"),
        both=on.any() & (~on).any(),
    )
    return means.filter("both").drop("both")
