"""What registers print, compared with the archive.

Frames of the warehouse in, frames out. Does not belong here: how a number is made, and what
two methods do to it (`summaries`, `ladder`).
"""

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
