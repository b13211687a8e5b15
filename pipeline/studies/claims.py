"""What the texts print, compared with the archive: registers, and the tool's figures.

Frames of the warehouse in, frames out. Does not belong here: how a number is made, and what
two methods do to it (`summaries`, `ladder`).
"""

from typing import Final

import polars as pl

from pipeline.curve import cw
from pipeline.races.power import curve_of_lines
from pipeline.tables.keys import LINE


def print_reproduction(
    printed_registers: pl.DataFrame, curves: pl.DataFrame, tows: pl.DataFrame
) -> pl.DataFrame:
    """Printed A, B and Cw of each tow next to those of each method, at the printed speed.

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
            tows.select("tow_id", "tow_date", *LINE), on=["tow_date", *LINE], maintain_order="left"
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
            "method", "tow_id", "season", *LINE, "a_kg_m", "b_m_s", "cw_kg_m", "declared_speed_m_s"
        )
        .join(of_tow, on="tow_id", maintain_order="left")
    )
    there = cw(*curve_of_lines(compared), compared["speed_m_s"])
    known = pl.when(pl.Series(there).is_finite()).then(pl.Series(there))
    return (
        compared.with_columns(known.alias("cw_kg_m"))
        .with_columns((pl.col("printed_cw_kg_m") / pl.col("cw_kg_m")).alias("cw_ratio"))
        .drop("declared_speed_m_s")
        .sort("method", "tow_id")
    )


CHANNELS: Final = {
    "log1": "log1_v",
    "log2": "log2_v",
    "gps": "gps",
    "force": "force",
    "wind": "wind_v",
    "cw": "log1_cw",
}


def run_statistics(blocks: pl.DataFrame) -> pl.DataFrame:
    """The tool's figures of a run: mean, sd, median, their ratios, and speed / log 1.

    The tool took them over 50,000 samples; here over means of a second, which leaves out what
    swings faster. The mean is the same.

    Args:
        blocks: rows of `pipeline.blocks.sums.block_sums` with `tow_id`.

    Returns:
        Rows of the table `run_statistics`, one per tow, run and channel that was recorded.
    """
    key = ["tow_id", "run"]
    value = pl.col("value")
    of_channels = [  # one at a time: all of them are several times as large as the blocks
        blocks.select(*key, n="gps_n" if name == "gps" else "n", value=column)
        .filter(pl.col("n") > 0)
        .with_columns(value / pl.col("n"))
        .group_by(key, maintain_order=True)
        .agg(
            pl.lit(name).alias("channel"),
            value.mean().alias("mean"),
            value.std().fill_null(0.0).alias("sd"),
            value.median().alias("median"),
        )
        for name, column in CHANNELS.items()
    ]
    log1 = pl.col("mean").filter(pl.col("channel") == "log1").first().over(key)
    is_speed = pl.col("channel").is_in(["log1", "log2", "gps"])
    return (
        pl.concat(of_channels)
        .sort(*key, "channel")
        .with_columns(
            pl.when(pl.col("mean") > 0).then(pl.col("sd") / pl.col("mean")).alias("sd_ratio"),
            pl.when(pl.col("mean") > 0)
            .then(pl.col("median") / pl.col("mean"))
            .alias("median_ratio"),
            pl.when(is_speed & (log1 > 0)).then(pl.col("mean") / log1).alias("log1_ratio"),
        )
    )
