"""Days of a season that differ: two load cells used in turn, a zero that was wrong one morning.

One-way analysis of variance, with the day as the group, of each tow against the best estimate of
its boat, which rests on the boat's tows of other days too. The variance within days is shrunk
towards that of other seasons, as a season may have few tows per day
(Smyth 2004, Statistical Applications in Genetics and Molecular Biology 3, the moderated F).
"""

from typing import Final

import polars as pl
import scipy

from pipeline.assessment.shared import CHANCE
from pipeline.tables.keys import LINE

PRIOR_DOF: Final = 10
"""Degrees of freedom with which other seasons count (inferred)."""


def days_apart(curves: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Standard deviation of ln Cw that the tows of one day share, in the season of each tow.

    Args:
        curves: curves of one method, with best estimates.
        tows: rows of `tows`.

    Returns:
        `tow_id, days_differ`: 0 where chance explains it; no row in a season of one day.
    """
    ratio, ln, n = pl.col("cw_kg_m") / pl.col("cw_best_kg_m"), pl.col("ln"), pl.col("n")
    days = (
        curves.filter(pl.len().over(LINE) > 1)
        .select("tow_id", "season", "calibration_factor", ln=ratio.log())
        .filter(ln.is_finite())
        .join(tows.select("tow_id", "tow_date"), on="tow_id", maintain_order="left")
        .group_by("season", "tow_date", maintain_order=True)
        .agg(
            pl.len().cast(pl.Float64).alias("n"),
            mean=ln.mean(),
            within=((ln - ln.mean()) ** 2).sum(),
            calibrated=pl.col("calibration_factor").is_not_null().any(),
        )
    )
    middle = (n * pl.col("mean")).sum() / n.sum()
    seasons = (
        days.group_by("season", maintain_order=True)
        .agg(
            pl.col("within").sum(),
            pl.col("calibrated").any(),
            between=(n * (pl.col("mean") - middle) ** 2).sum(),
            between_dof=pl.len() - 1.0,
            within_dof=n.sum() - pl.len(),
            per_day=(n.sum() - (n**2).sum() / n.sum()) / (pl.len() - 1.0),
        )
        .filter(pl.col("between_dof") > 0, pl.col("within_dof") > 0)
        .with_columns(usual=(pl.col("within") / pl.col("within_dof")).median().over("calibrated"))
        .with_columns(
            variance=(pl.col("within") + PRIOR_DOF * pl.col("usual"))
            / (pl.col("within_dof") + PRIOR_DOF),
            mean_square=pl.col("between") / pl.col("between_dof"),
        )
    )
    chance = scipy.special.fdtrc(
        seasons["between_dof"].to_numpy(),
        seasons["within_dof"].to_numpy() + PRIOR_DOF,
        (seasons["mean_square"] / seasons["variance"]).to_numpy(),
    )
    shared = ((pl.col("mean_square") - pl.col("variance")) / pl.col("per_day")).clip(0.0).sqrt()
    sure = pl.when(pl.Series(chance) < CHANCE).then(shared).otherwise(0.0)
    return curves.join(
        seasons.select("season", days_differ=sure), on="season", maintain_order="left"
    ).select("tow_id", "days_differ")
