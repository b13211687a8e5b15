"""What many tows have in common, what their instruments said, and what was printed of them.

Frames of the warehouse in, frames out. Counts, and means of what a table already holds, are views
of the database (`pipeline.tables.views`); statistics with an interval are in
`pipeline.consistency`.
"""

from typing import Final

import polars as pl

from pipeline.method.definition import Method
from pipeline.races.power import compute_line_cw
from pipeline.tables.keys import LINE


def season_changes(curves: pl.DataFrame, first_method: Method) -> pl.DataFrame:
    """Return median and range per season of Cw of each method over Cw of the first.

    Takes rows of `curves` of several methods; gives rows of the table `season_changes`.
    """
    first, known = first_method.name, curves.drop_nulls("cw_kg_m")
    ratio = pl.col("cw_kg_m") / pl.col("old")
    return (
        known.filter(pl.col("method") != first)
        .join(
            known.filter(method=first).select("tow_id", old="cw_kg_m"),
            on="tow_id",
            maintain_order="left",
        )
        .group_by("method", "season", maintain_order=True)
        .agg(
            pl.lit(first).alias("from_method"),
            pl.len().alias("tows"),
            ratio.median().alias("median_ratio"),
            ratio.min().alias("lowest_ratio"),
            ratio.max().alias("highest_ratio"),
        )
    )


def print_reproduction(
    printed_registers: pl.DataFrame, curves: pl.DataFrame, tows: pl.DataFrame
) -> pl.DataFrame:
    """Return A, B and Cw of each tow as printed and by each method, at the printed speed.

    Args:
        printed_registers: lines of registers as printed; of a tow in several the first counts.
        curves: the table of that name.
        tows: `tow_id, tow_date` and the line.

    Returns:
        Rows of the table `print_reproduction`; a printed line without a tow in the archive has
        none.
    """
    of_tow = (
        printed_registers.filter("has_valid_curve")
        .sort("season")
        .join(
            tows.select("tow_id", "tow_date", pl.col(LINE)),
            on=("tow_date",) + LINE,
            maintain_order="left",
        )
        .unique("tow_id", keep="first", maintain_order=True)
        .select(
            "tow_id",
            pl.col("season").alias("printed_in"),
            pl.col("declared_speed_m_s").alias("speed_m_s"),
            pl.col("a_kg_m").alias("printed_a_kg_m"),
            pl.col("b_m_s").alias("printed_b_m_s"),
            pl.col("cw_kg_m").alias("printed_cw_kg_m"),
        )
    )
    compared = (
        curves.drop_nulls("cw_kg_m")
        .select(
            "method",
            "tow_id",
            "season",
            pl.col(LINE),
            "a_kg_m",
            "b_m_s",
            "cw_kg_m",
            "declared_speed_m_s",
        )
        .join(of_tow, on="tow_id", maintain_order="left")
    )
    there = compute_line_cw(compared, compared["speed_m_s"])
    known = pl.when(pl.Series(there).is_finite()).then(pl.Series(there))
    return (
        compared.with_columns(known.alias("cw_kg_m"))
        .with_columns((pl.col("printed_cw_kg_m") / pl.col("cw_kg_m")).alias("cw_ratio"))
        .drop("declared_speed_m_s")
        .sort("method", "tow_id")
    )


SUMS: Final = ("log1_v", "gps", "gps_n", "force", "wind_v", "wind_sin", "wind_cos")
"""The sums that `second_means` takes."""


def second_means(blocks: pl.DataFrame) -> pl.DataFrame:
    """Return the mean of each channel over every second of every run.

    Args:
        blocks: rows of `pipeline.blocks.sums.block_sums` with `tow_id`.

    Returns:
        `tow_id, run, second, speed_m_s` (log 1)`, gps_m_s` (null without GPS)`, force_n, wind_m_s,
        wind_angle_deg` (circular mean).
    """
    angle = pl.arctan2("wind_sin", "wind_cos").degrees() % 360.0
    return blocks.filter(pl.col("n") > 0).select(
        "tow_id",
        "run",
        "second",
        speed_m_s=pl.col("log1_v") / pl.col("n"),
        gps_m_s=pl.when(pl.col("gps_n") > 0).then(pl.col("gps") / pl.col("gps_n")),
        force_n=pl.col("force") / pl.col("n"),
        wind_m_s=pl.col("wind_v") / pl.col("n"),
        wind_angle_deg=angle,
    )
