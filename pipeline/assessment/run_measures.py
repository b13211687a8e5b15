"""What the checks of a tow measure of its own runs."""

from typing import Final

import polars as pl

MIN_USUAL_SCATTER: Final = 0.05
"""Least standard deviation of samples over Cw that counts as usual: half of the 10 % under which
nothing is too much (Sleepproef, R. Pot 2017, "Eerste beoordeling")."""

PER_RUN: Final = {
    "off_target_speed": "off_target",
    "log2_differs": "log2_off_m_s",
    "large_scatter_in_run": "scatter",
    "samples_scatter": "samples_scatter",
}
"""Checks of single runs, with the column of `measure_runs` that each looks at: a tow is marked for
the largest value among the runs that count."""


def summarize_runs(curves: pl.DataFrame, run_points: pl.DataFrame) -> pl.DataFrame:
    """Return how the runs that count lie about the curve and the intended speeds."""
    speed, way = pl.col("speed_m_s"), pl.col("direction")
    declared, target = pl.col("declared_speed_m_s"), pl.col("target_speed_ratio")
    on_curve = pl.col("cw_kg_m") / pl.col("fitted_cw_kg_m")
    least, most = ((speed / declared).min(), (speed / declared).max())
    return (
        measure_runs(curves, run_points)
        .with_columns(
            lowest_target=target.min().over("tow_id"), highest_target=target.max().over("tow_id")
        )
        .filter("used")
        .group_by("tow_id", maintain_order=True)
        .agg(
            pl.col(PER_RUN.values()).max(),
            unbalanced=way.cast(pl.Int32).sum().abs(),
            out_over_back=on_curve.filter(way > 0).mean() / on_curve.filter(way < 0).mean(),
            shortfall=pl.max_horizontal(
                least - pl.col("lowest_target").first(), pl.col("highest_target").first() - most
            ),
            beyond=pl.max_horizontal(least - 1, 1 - most),
            fastest_m_s=speed.max(),
        )
    )


def measure_runs(curves: pl.DataFrame, run_points: pl.DataFrame) -> pl.DataFrame:
    """Return run points with what `PER_RUN` judges, null for runs that do not count.

    Args:
        curves, run_points: the tables of one method, with all tows of a season.

    Returns:
        The rows with `season` and `declared_speed_m_s` and

        - `off_target`: distance of speed / intended speed from the median of the tow, as a ratio,
        - `log2_off_m_s`: distance of log 2 from log 1, m/s,
        - `scatter`: standard deviation of the means of F / v^2 per second over their mean,
        - `samples_scatter`: the same of the samples, over the median of all runs of the season;
          both only where the method cuts runs.
    """
    used, is_cut = pl.col("used"), pl.col("ends_ratio").is_not_null()
    on_target = pl.col("speed_m_s") / (pl.col("target_speed_ratio") * pl.col("declared_speed_m_s"))
    level = on_target.filter(used).median().over("tow_id")
    log1_m_s = pl.col("speed_m_s") / pl.col("speed_factor")
    gross = pl.col("gross_cw_kg_m")
    of_samples = pl.when(used & is_cut & (gross > 0)).then(pl.col("cw_sd") / gross)
    usual = of_samples.median().over("season").clip(lower_bound=MIN_USUAL_SCATTER)
    of_runs = {
        "off_target": (on_target / level - 1).abs(),
        "log2_off_m_s": ((pl.col("log2_ratio") - 1) * log1_m_s).abs(),
        "scatter": pl.when(is_cut & (gross > 0)).then(pl.col("cw_seconds_sd_kg_m") / gross),
        "samples_scatter": of_samples / usual,
    }
    return run_points.join(
        curves.select("tow_id", "season", "declared_speed_m_s"), on="tow_id", maintain_order="left"
    ).with_columns(**{name: pl.when(used).then(value) for name, value in of_runs.items()})
