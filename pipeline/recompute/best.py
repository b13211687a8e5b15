"""The best estimate of each tow's Cw, beside what was measured.

All tows together give a boat's Cw at its usual speed. The bend that they give leads from there to
the declared speed of a tow. How far the hull lies from its hyperbola is added, and to the interval
what all tows share, so that repeats cannot show it (ISO 5725-1: precision is not trueness).
"""

from typing import Final

import polars as pl

from pipeline.curve import LEAST_MARGIN
from pipeline.quantiles import NORMAL
from pipeline.season_log import SeasonFactors

SHARED_BY_REPEATS: Final = ("force", "wind", "anemometer", "mass", "temperature")
"""Components of the budget that repeat tows share."""

BEND_SD: Final = 0.04
"""Spread of a boat's bend q about that of its tows and type, far from its usual speed."""


def add_best_estimates(
    curves: pl.DataFrame,
    factors: SeasonFactors | None,
    budget: pl.DataFrame,
    inputs: pl.DataFrame,
) -> pl.DataFrame:
    """Add the best estimate of Cw at the declared speed with its 95 % interval, and `cw_others`.

    `cw_best_kg_m`, `cw_best_lo_kg_m` and `cw_best_hi_kg_m` are by all tows; `cw_others_kg_m` is Cw
    as measured, with the instruments as all other boats show them. A tow of a season that is not
    determined stays as measured: only the bend of its curves would say what its log was, and no
    hull is an exact hyperbola.

    Args:
        curves: rows of the table.
        factors: season factors; None where the method does not estimate them: columns are null.
        budget: rows of the budget at the declared speed.
        inputs: of each tow there (`budget.make_budget_inputs`).
    """
    if factors is None:
        nothing = pl.lit(None, pl.Float64)
        return curves.with_columns(
            cw_best_kg_m=nothing,
            cw_best_lo_kg_m=nothing,
            cw_best_hi_kg_m=nothing,
            cw_others_kg_m=nothing,
        )
    shared = (
        budget.filter(pl.col("component").is_in(SHARED_BY_REPEATS))
        .group_by("tow_id", maintain_order=True)
        .agg(shared_variance=(pl.col("u_ratio") ** 2).sum())
    )
    estimates = _move_to_declared_speed(factors.tows.drop_nulls("factor"))
    misfits = inputs.select("tow_id", "misfit", "misfit_variance")
    joined = curves
    for frame in (estimates, shared, misfits):
        joined = joined.join(frame, on="tow_id", how="left", maintain_order="left")

    col = pl.col
    ln_change = col("best_ln_cw") - col("measured_ln_cw") + col("ln_by_bend")
    best = col("cw_kg_m") * (ln_change + col("misfit").log1p()).exp()
    added = NORMAL**2 * (col("shared_variance") + col("misfit_variance") + col("bend_variance"))
    below = ((col("best_ln_cw") - col("best_lo")) ** 2 + added).sqrt()
    above = ((col("best_hi") - col("best_ln_cw")) ** 2 + added).sqrt()
    return joined.select(
        pl.col(curves.columns),
        cw_best_kg_m=pl.coalesce(best, "cw_kg_m"),
        cw_best_lo_kg_m=pl.coalesce(best * (-below).exp(), "cw_lo_kg_m"),
        cw_best_hi_kg_m=pl.coalesce(best * above.exp(), "cw_hi_kg_m"),
        cw_others_kg_m=col("cw_kg_m") * col("others_ln_ratio").fill_null(0.0).exp(),
    )


def _move_to_declared_speed(tows: pl.DataFrame) -> pl.DataFrame:
    """Return estimates of tows with `ln_by_bend` and `bend_variance`.

    From the line's usual speed to the tow's declared one Cw changes along the boat's bend, not the
    tow's own: `ln_by_bend` is the difference in ln Cw.
    """
    # q is that of the log's curve where it reads the usual speed over exp(reference_ln).
    speed_error = pl.col("reference_ln").exp() / pl.col("factor")
    r = pl.col("q") / (1.0 + pl.col("q")) * speed_error**2
    own_bend = r / (1.0 - r)
    away = pl.col("reference_ratio") ** 2 - 1.0
    own = (1.0 - own_bend * away).clip(lower_bound=LEAST_MARGIN)
    boat = (1.0 - pl.col("bend") * away).clip(lower_bound=LEAST_MARGIN)
    return tows.select(
        "tow_id",
        "others_ln_ratio",
        "measured_ln_cw",
        "best_ln_cw",
        "best_lo",
        "best_hi",
        ln_by_bend=own.log() - boat.log(),
        bend_variance=(BEND_SD * away / boat) ** 2,
    )
