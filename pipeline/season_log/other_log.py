"""The factor of the log that a method does not use, from that of the log it does use.

Both logs are on board in every run, so the ratio of their means says what the other one's factor
is. Nothing of how the first one's is estimated.
"""

import numpy as np
import polars as pl

from pipeline.quantiles import t_quantile
from pipeline.season_log.estimate import SeasonFactors
from pipeline.season_log.network import GROUP

OTHER_LOG = "other log"
FEWEST_TOWS = 2


def other_log_factors(estimated: SeasonFactors) -> pl.DataFrame:
    """Factors of the log beside the one in use, by season and part of it.

    Args:
        estimated: the season factors; its tows with `other_log`, `other_part` and `other_ln_ratio`,
            ln(log in use / other log), null where there is no other or it did not turn.

    Returns:
        `season, part, log, source, n_tows, n_links` (0), `component, factor, lo, hi, ln_sd, dof`;
        no row where fewer than two tows tell.
    """
    own = estimated.factors.drop_nulls("factor").select(
        *GROUP, "component", "ln_sd", "dof", pl.col("factor").log().alias("ln_own")
    )
    rows = (
        estimated.tows.filter(~pl.col("anchored"))
        .drop_nulls("other_ln_ratio")
        .join(own, on=GROUP, maintain_order="left")
        .with_columns((pl.col("ln_own") + pl.col("other_ln_ratio")).alias("ln_factor"))
        .group_by("season", part="other_part", log="other_log", maintain_order=True)
        .agg(
            pl.len().alias("n_tows"),
            pl.col("component", "ln_sd", "dof").first(),
            pl.col("ln_factor").mean(),
            (pl.col("ln_factor").var() / pl.len()).alias("ratio_variance"),
        )
        .filter(pl.col("n_tows") >= FEWEST_TOWS)
        .sort(GROUP)
    )
    own_variance, ratio_variance = pl.col("ln_sd") ** 2, pl.col("ratio_variance")
    spread = own_variance**2 / pl.col("dof") + ratio_variance**2 / (pl.col("n_tows") - 1)
    variance = own_variance + ratio_variance
    rows = rows.with_columns(variance.sqrt().alias("ln_sd"), (variance**2 / spread).alias("dof"))
    quantile = t_quantile(rows["dof"].to_numpy())
    half = np.asarray(quantile) * rows["ln_sd"].to_numpy()
    return rows.select(
        *GROUP,
        pl.lit(OTHER_LOG).alias("source"),
        "n_tows",
        pl.lit(0).alias("n_links"),
        "component",
        pl.col("ln_factor").exp().alias("factor"),
        (pl.col("ln_factor") - pl.Series(half)).exp().alias("lo"),
        (pl.col("ln_factor") + pl.Series(half)).exp().alias("hi"),
        "ln_sd",
        "dof",
    )
