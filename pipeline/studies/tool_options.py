"""The options of the tool of 2015: all combinations of what its screen let one tick.

"Razende Snol 2014, bepaalde combinaties van opties" (presentation 2015) shows some; here are all
sixteen, each with the log's speed as read and as the method corrects it. Some ticks are known to be
wrong; this is what they did, not a vote (`options`).
"""

import itertools
from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np
import polars as pl

from pipeline.blocks.run_blocks import RunBlocks
from pipeline.method.definition import Method, Steps
from pipeline.recompute.outcome import Outcome
from pipeline.recompute.recompute import batches, evaluate_each
from pipeline.recompute.run_cache import RunCache
from pipeline.recompute.season_factors import Instruments
from pipeline.studies.options import ALL_OPTIONS, Choice, chosen

TICKS: Final = {
    "optimisation": Choice("wind", "coefficients", ("fixed", "per_run")),
    "trimming": Choice("window", "rule", ("all", "steady")),
    "vane": Choice("wind", "averaging_s", (0, 3)),
    "b_from_length": Choice("curve", "b", ("free", "hull_speed")),
}
"""By column: "Optimalisatie", "Afkappen", "WindVaanCorrectie", "B uit sloeplengte"."""

SPEED_NAMES: Final = ("as_read", "dgps", "multiply", "divide", "estimated")
AS_READ, DGPS, MULTIPLY, DIVIDE, ESTIMATED = SPEED_NAMES

SPEEDS: Final = {
    "dgps": (AS_READ, DGPS),
    "correction": (AS_READ, MULTIPLY),
    "operation": (MULTIPLY, DIVIDE),
    "estimate": (AS_READ, ESTIMATED),
}
"""Pairs of speeds, by the name of what makes the second of the first."""


def option_curves(
    method: Method,
    tows: pl.DataFrame,
    blocks: RunBlocks,
    links: pl.DataFrame,
    cache: RunCache,
) -> pl.DataFrame:
    """Curves of every tow under all combinations of `TICKS` and the speeds of its season.

    Args:
        method: the method whose other options hold.
        tows, blocks, links, cache: as `options.option_effects` takes them.

    Returns:
        Sorted rows per tow, speed and combination: `tow_id, speed`, a column for each tick,
        `a_kg_m, b_m_s` (null where resistance does not rise) and `cw_kg_m` at the declared speed;
        combinations that give no curve are left out.
    """
    pairs = batches([method], tows, blocks)
    corners = itertools.product((False, True), repeat=len(TICKS))
    ticks = [dict(zip(TICKS, corner, strict=True)) for corner in corners]
    read = [(speed, batch, way) for batch, (steps,) in pairs for speed, way in speeds(steps)]
    variants = ([(batch, _ticked(way, ticked)) for _, batch, way in read] for ticked in ticks)
    frames = [
        _curves(one).with_columns(
            pl.lit(speed).alias("speed"),
            *(pl.lit(value).alias(name) for name, value in ticked.items()),
        )
        for ticked, outcomes in zip(
            ticks, evaluate_each(variants, cache, Instruments(links)), strict=True
        )
        for (speed, *_), one in zip(read, outcomes, strict=True)
    ]
    key = ["tow_id", "speed", *TICKS]
    return pl.concat(frames).select(*key, "a_kg_m", "b_m_s", "cw_kg_m").sort(key)


def _ticked(steps: Steps, ticked: Mapping[str, bool]) -> Steps:
    return chosen(steps, {choice: choice.values[ticked[name]] for name, choice in TICKS.items()})


def speeds(steps: Steps) -> Iterator[tuple[str, Steps]]:
    """The log as it reads, and each way in which a season's method makes a true speed of it."""
    log = Choice("speed", "correction", ("none", steps.speed.correction))
    gps = Choice("calibration", "rule", ("none", steps.calibration.rule))
    yield AS_READ, chosen(steps, {log: "none", gps: "none"})
    if steps.calibration.rule != "none":
        yield DGPS, chosen(steps, {log: "none"})
    if steps.speed.correction == "estimated":
        yield ESTIMATED, steps
    if steps.speed.correction == "prescribed":
        # Multiply by 1 + p, or divide by 1 - p.
        multiply = steps.speed.factor
        factor = Choice("speed", "factor", (multiply, 1.0 / (2.0 - multiply)))
        for way, value in zip((MULTIPLY, DIVIDE), factor.values, strict=True):
            yield way, chosen(steps, {gps: "none", factor: value})


def _curves(outcome: Outcome) -> pl.DataFrame:
    cw, b = outcome.cw_at_declared, outcome.curves.b_m_s
    frame = pl.DataFrame(
        {
            "tow_id": outcome.batch.tows["tow_id"],
            "a_kg_m": outcome.curves.a_kg_m,
            "b_m_s": np.where(np.isfinite(b), b, np.nan),
            "cw_kg_m": cw,
        }
    )
    return frame.filter(np.isfinite(cw)).with_columns(pl.col("b_m_s").fill_nan(None))


def tick_effects(curves: pl.DataFrame) -> pl.DataFrame:
    """What each tick and each speed does to a tow, over all combinations of the others.

    Args:
        curves: rows of `option_curves`.

    Returns:
        Rows as of `options.option_effects`, options named as in `TICKS` and `SPEEDS`; an effect is
        null unless every combination counts.
    """
    logs = curves.with_columns(cw=pl.col("cw_kg_m").log(), n=pl.len().over("tow_id", "speed"))
    whole = logs.filter(pl.col("n") == 2 ** len(TICKS))
    ticks = [_effect(whole, name, pl.col(name)) for name in TICKS]
    pairs = [
        _effect(whole.filter(pl.col("speed").is_in(pair)), name, pl.col("speed") == pair[1])
        for name, pair in SPEEDS.items()
    ]
    spread = whole.group_by("tow_id", maintain_order=True).agg(
        pl.lit(ALL_OPTIONS).alias("option"), pl.col("cw").std(ddof=0).alias("cw_sd_ratio")
    )
    return pl.concat([*ticks, *pairs, spread], how="diagonal").sort("tow_id", "option")


def _effect(logs: pl.DataFrame, name: str, on: pl.Expr) -> pl.DataFrame:
    """Second value / first value of Cw; tows without both are left out."""
    cw = pl.col("cw")
    means = logs.group_by("tow_id", maintain_order=True).agg(
        pl.lit(name).alias("option"),
        (cw.filter(on).mean() - cw.filter(~on).mean()).exp().alias("cw_effect_ratio"),
        both=on.any() & (~on).any(),
    )
    return means.filter("both").drop("both")
