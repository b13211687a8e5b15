"""The best estimate of each tow's Cw, beside what was measured.

All tows together tell a boat's Cw at its usual speed. The bend that they tell leads from there to
the declared speed of a tow. How far the hull lies from its hyperbola by their points is added. What
all tows share, so that repeats cannot show it, is added to the interval (ISO 5725-1: precision is
not trueness). A tow of a season that is not determined stays as measured: only the bend of its
curves would say what its log was, and no hull is an exact hyperbola.
"""

from typing import Final

import polars as pl
import polars.selectors as cs

from pipeline.curve import LEAST_MARGIN
from pipeline.quantiles import NORMAL
from pipeline.season_log import SeasonFactors

BEST: Final = ("cw_best_kg_m", "cw_best_lo_kg_m", "cw_best_hi_kg_m")

NOT_SEEN_BY_REPEATS: Final = ("force", "wind", "anemometer", "mass", "temperature")
"""Components of the budget that repeat tows share."""

OTHERS: Final = "cw_others_kg_m"

BEND_SD: Final = 0.04
"""Spread of a boat's bend q about that of its tows and type, far from its usual speed."""


def with_best(
    curves: pl.DataFrame,
    estimated: SeasonFactors | None,
    budget: pl.DataFrame,
    facts: pl.DataFrame,
) -> pl.DataFrame:
    """Curves with `BEST`: Cw at the declared speed by all tows together, with its 95 % interval.

    And with `OTHERS`: Cw as measured, with the instruments as all other boats show them.

    Args:
        curves: rows of the table.
        estimated: what all tows say; None where the method does not ask it: the columns are null.
        budget: rows of the budget at the declared speed.
        facts: of each tow there, with how far its hull lies from its curve.
    """
    if estimated is None:
        return curves.with_columns(pl.lit(None, pl.Float64).alias(n) for n in (*BEST, OTHERS))
    shared = (
        budget.filter(pl.col("component").is_in(NOT_SEEN_BY_REPEATS))
        .group_by("tow_id", maintain_order=True)
        .agg((pl.col("u_ratio") ** 2).sum().alias("shared"))
    )
    # A tow of a season that is not determined has no factor.
    known = _to_declared(estimated.tows.drop_nulls("factor"))
    joined = (
        curves.join(known, on="tow_id", how="left", maintain_order="left")
        .join(shared, on="tow_id", how="left", maintain_order="left")
        .join(
            facts.select("tow_id", "misfit", "misfit_variance"),
            on="tow_id",
            how="left",
            maintain_order="left",
        )
    )
    moved = (
        pl.col("best_ln_cw")
        - pl.col("measured_ln_cw")
        + pl.col("by_bend")
        + pl.col("misfit").log1p()
    )
    best = pl.col("cw_kg_m") * moved.exp()

    def half(end: str) -> pl.Expr:
        own = pl.col(end) - pl.col("best_ln_cw")
        beside = pl.col("shared") + pl.col("misfit_variance") + pl.col("bend_variance")
        return (own**2 + NORMAL**2 * beside).sqrt()

    by_all = (best, best * (-half("best_lo")).exp(), best * half("best_hi").exp())
    measured = ("cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m")
    return joined.select(
        *curves.columns,
        *(
            pl.coalesce(values, alone).alias(name)
            for name, values, alone in zip(BEST, by_all, measured, strict=True)
        ),
        (pl.col("cw_kg_m") * pl.col("others_ln_ratio").fill_null(0.0).exp()).alias(OTHERS),
    )


def _to_declared(tows: pl.DataFrame) -> pl.DataFrame:
    """From the line's usual speed to the declared one along the boat's bend, not the tow's own.

    Returns:
        The estimates of tows with `by_bend`, what that changes of ln Cw, and `bend_variance`.
    """
    # q is that of the log's curve where it reads the usual speed over exp(reference_ln).
    off = pl.col("reference_ln").exp() / pl.col("factor")
    r = pl.col("q") / (1.0 + pl.col("q")) * off**2
    away = pl.col("reference_ratio") ** 2 - 1.0
    own, boat = (
        (1.0 - q * away).clip(lower_bound=LEAST_MARGIN) for q in (r / (1.0 - r), pl.col("bend"))
    )
    return tows.select(
        "tow_id",
        "others_ln_ratio",
        "measured_ln_cw",
        cs.starts_with("best_"),
        by_bend=own.log() - boat.log(),
        bend_variance=(BEND_SD * away / boat) ** 2,
    )
