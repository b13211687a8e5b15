"""The sensitivity study: how much do choices matter that are a matter of judgement.

A full factorial over options that a careful person could choose either way, on top of a method.
Options that are known to be wrong (searching wind coefficients run by run) are history, not a vote,
and take no part: they belong to the options of the tool of 2015 (`tool_options`).
"""

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray
from pipeline.blocks.run_blocks import RunBlocks
from pipeline.method.definition import Method, Steps
from pipeline.recompute.recompute import batches, evaluate_each
from pipeline.recompute.run_cache import RunCache
from pipeline.recompute.season_factors import Instruments

ALL_OPTIONS: Final = "all"


@dataclass(frozen=True)
class Choice:
    """One option of a step with the two values between which judgement may choose."""

    step: str
    option: str
    values: tuple[Any, Any]

    @property
    def name(self) -> str:
        """As written in a method file."""
        return f"{self.step}.{self.option}"

    def applies(self, steps: Steps) -> bool:
        """Whether it can matter: a prescribed factor, where the log is corrected by it."""
        return self.name != FACTOR or steps.speed.correction == "prescribed"


FACTOR: Final = "speed.factor"

CHOICES: Final = (
    Choice("window", "force_ends_ratio", (0.1, 0.05)),
    Choice("speed", "factor", (1.06, 1 / 0.94)),
    Choice("run_point", "estimator", ("mean_of_ratios", "ratio_of_means")),
    Choice("wind", "coefficients", ("fixed", "archive")),
    Choice("wind", "averaging_s", (0, 3)),
    Choice("curve", "b", ("capped", "free")),
)
"""The curve comes last, so that it varies fastest (`evaluate_each`)."""


def option_effects(
    method: Method,
    tows: pl.DataFrame,
    blocks: RunBlocks,
    links: pl.DataFrame,
    cache: RunCache,
) -> pl.DataFrame:
    """Spread of Cw over all combinations of `CHOICES`, and the effect of each choice.

    Args:
        method: the method whose other options hold.
        tows: rows of the warehouse's `tows`.
        links: the method's rows of the table `tow_instruments`; none where it estimates no log.
        cache: what was found before of the same tows; added to.

    Returns:
        Sorted rows per tow and option that can matter to it: `tow_id`, `option`, `cw_effect_ratio`
        (second value / first value, mean over all combinations of the others; null where one of
        them gives no curve) and `cw_sd_ratio` (standard deviation over all combinations, relative;
        only in the row `all`).
    """
    pairs = batches([method], tows, blocks)
    choices = [c for c in CHOICES if any(c.applies(steps) for _, (steps,) in pairs)]
    corners = list(itertools.product((0, 1), repeat=len(choices)))
    sides = [{c: c.values[s] for c, s in zip(choices, corner, strict=True)} for corner in corners]
    variants = ([(b, chosen(steps, side)) for b, (steps,) in pairs] for side in sides)
    ln_cw = np.stack(
        [
            np.concatenate([np.log(o.cw_at_declared) for o in outcomes])
            for outcomes in evaluate_each(variants, cache, Instruments(links))
        ]
    )
    tow_ids = pl.concat([batch.tows["tow_id"] for batch, _ in pairs])
    signs = 2 * np.array(corners) - 1
    frames = [_frame(tow_ids, ALL_OPTIONS, "cw_sd_ratio", ln_cw.std(axis=0))]
    for i, choice in enumerate(choices):
        can = np.concatenate([np.full(b.size, choice.applies(steps)) for b, (steps,) in pairs])
        effect = np.exp((ln_cw * signs[:, i, None]).mean(axis=0) * 2.0)
        frames.append(_frame(tow_ids, choice.name, "cw_effect_ratio", effect).filter(can))
    effects = pl.concat(frames, how="diagonal").sort("tow_id", "option")
    return effects.select("tow_id", "option", "cw_effect_ratio", "cw_sd_ratio")


def chosen(steps: Steps, sides: Mapping[Choice, object]) -> Steps:
    """The steps of a season with a value for each choice."""
    for choice, value in sides.items():
        step = getattr(steps, choice.step).model_copy(update={choice.option: value})
        steps = steps.model_copy(update={choice.step: step})
    return steps


def _frame(tow_ids: pl.Series, option: str, name: str, numbers: FloatArray) -> pl.DataFrame:
    return pl.DataFrame({"tow_id": tow_ids, name: numbers}).select(
        "tow_id", pl.lit(option).alias("option"), pl.col(name).fill_nan(None)
    )
