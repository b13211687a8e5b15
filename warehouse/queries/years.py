"""The register of every year, as published and as a method would have had it."""

import polars as pl

from pipeline.register.register import LINE


def summarise_years(lines: pl.DataFrame, printed: pl.DataFrame) -> pl.DataFrame:
    """Count what a method changes in the register of each year.

    Args:
        lines: rows of `register_years`.
        printed: rows of `printed_registers`.

    Returns:
        Per `year` and `method`: how many `lines` counted at its end, how many `changed`, the
        median, lowest and highest Cw / Cw as published, how many changed beyond their intervals and
        in rank; and of that year's printed register how many lines, and the median and largest
        ratio to the register as published.
    """
    summary = lines.group_by("year", "method", maintain_order=True).agg(
        lines=pl.len(),
        changed=(pl.col("change") == "changed").sum(),
        median_ratio=pl.col("cw_ratio").median(),
        lowest_ratio=pl.col("cw_ratio").min(),
        highest_ratio=pl.col("cw_ratio").max(),
        exceeds_interval=pl.col("exceeds_interval").fill_null(value=False).sum(),
        rank_changed=(pl.col("published_rank") != pl.col("rank")).sum(),
    )
    in_print = printed.filter("has_valid_curve").select(
        pl.col(LINE), year="season", printed_cw="cw_kg_m"
    )
    pairs = lines.join(in_print, on=("year",) + LINE, maintain_order="left")
    ratio = pl.col("printed_cw") / pl.col("published_cw_kg_m")
    beside_print = pairs.group_by("year", "method", maintain_order=True).agg(
        printed_lines=pl.len(),
        printed_median_ratio=ratio.median(),
        printed_largest_ratio=(ratio - 1.0).abs().max() + 1.0,
    )
    return summary.join(beside_print, on=["year", "method"], how="left", maintain_order="left")
