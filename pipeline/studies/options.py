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
NUMBERS: Final = ("cw_effect_ratio", "b_effect_ratio", "cw_sd_ratio", "b_sd_ratio")


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
    """Spread of Cw and B over all combinations of `CHOICES`, and the effect of each choice.

    Args:
        method: the method whose other options hold.
        tows: rows of the warehouse's `tows`.
        links: the method's rows of the table `tow_instruments`; none where it estimates no log.
        cache: what was found before of the same tows; added to.

    Returns:
        Sorted rows per tow and option that can matter to it: `tow_id`, `option`, `cw_effect_ratio`
        and `b_effect_ratio` (second value / first value, mean over all combinations of the others;
        null where no combination gives the number), `cw_sd_ratio` and `b_sd_ratio` (standard
        deviation over all combinations, relative; only in the row `all`).
    """
    pairs = batches([method], tows, blocks)
    choices = [c for c in CHOICES if any(c.applies(steps) for _, (steps,) in pairs)]
    corners = list(itertools.product((0, 1), repeat=len(choices)))
    sides = [{c: c.values[s] for c, s in zip(choices, corner, strict=True)} for corner in corners]
    variants = ([(b, chosen(steps, side)) for b, (steps,) in pairs] for side in sides)
    cw, slope = [], []
    for outcomes in evaluate_each(variants, cache, Instruments(links)):
        cw.append(np.concatenate([np.log(o.cw_at_declared) for o in outcomes]))
        slope.append(np.concatenate([_ln_b(o.curves.b_m_s) for o in outcomes]))
    tow_ids = pl.concat([batch.tows["tow_id"] for batch, _ in pairs])
    ln_cw, ln_b, signs = np.stack(cw), np.stack(slope), 2 * np.array(corners) - 1
    spread = {"cw_sd_ratio": ln_cw.std(axis=0), "b_sd_ratio": ln_b.std(axis=0)}
    frames = [_frame(tow_ids, ALL_OPTIONS, spread)]
    for i, choice in enumerate(choices):
        can = np.concatenate([np.full(b.size, choice.applies(steps)) for b, (steps,) in pairs])
        effect = {
            "cw_effect_ratio": np.exp(_effect(ln_cw, signs[:, i])),
            "b_effect_ratio": np.exp(_effect(ln_b, signs[:, i])),
        }
        frames.append(_frame(tow_ids, choice.name, effect).filter(can))
    effects = pl.concat(frames, how="diagonal").sort("tow_id", "option")
    return effects.select("tow_id", "option", *NUMBERS)


def beside_uncertainty(effects: pl.DataFrame, curves: pl.DataFrame) -> pl.DataFrame:
    """Adds the uncertainty of each tow, to compare the spread over options with.

    Args:
        effects: rows of `option_effects`.
        curves: the method's own rows of the table `curves`.

    Returns:
        The rows with `cw_interval_ratio` and `b_interval_ratio`, half the width of the 95 %
        intervals on the logarithm; null where there is no (upper) bound.
    """
    half = {
        f"{name}_interval_ratio": (pl.col(high) / pl.col(low)).log() / 2.0
        for name, low, high in (
            ("cw", "cw_lo_kg_m", "cw_hi_kg_m"),
            ("b", "b_lo_m_s", "b_hi_m_s"),
        )
    }
    return effects.join(
        curves.select("tow_id", **half), on="tow_id", how="left", maintain_order="left"
    )


def chosen(steps: Steps, sides: Mapping[Choice, object]) -> Steps:
    """The steps of a season with a value for each choice."""
    for choice, value in sides.items():
        step = getattr(steps, choice.step).model_copy(update={choice.option: value})
        steps = steps.model_copy(update={choice.step: step})
    return steps


def _ln_b(b_m_s: FloatArray) -> FloatArray:
    finite = np.isfinite(b_m_s)
    return np.where(finite, np.log(np.where(finite, b_m_s, 1.0)), np.nan)


def _effect(ln_values: FloatArray, sign: FloatArray) -> FloatArray:
    """Mean difference between the two sides of a choice; NaN unless every combination counts."""
    return np.asarray((ln_values * sign[:, None]).mean(axis=0) * 2.0)


def _frame(tow_ids: pl.Series, option: str, numbers: Mapping[str, FloatArray]) -> pl.DataFrame:
    return pl.DataFrame({"tow_id": tow_ids, **numbers}).select(
        "tow_id", pl.lit(option).alias("option"), pl.col(list(numbers)).fill_nan(None)
    )
