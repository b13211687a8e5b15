"""The register: which tow counts for a boat and crew, and until when.

Here the rule of validity and the choice of the newest sound tow. Freezing an edition, and people's
decisions, belong to `warehouse.editions`. A boat without a valid tow is listed as such: the pair
A, B with Cw = 1 of the old spreadsheet never comes back.
"""

import datetime as dt
from typing import Final

import polars as pl

VALID_YEARS: Final = 5
"""A tow counts until the end of the fifth calendar year after it (FSN notice, January 2013)."""

LINE: Final = ("fsn_no", "rowers", "crew_class")
CURVE_COLUMNS: Final = (
    "tow_id",
    "tow_date",
    "valid_until",
    "declared_speed_m_s",
    "a_kg_m",
    "b_m_s",
    "cw_kg_m",
    "cw_lo_kg_m",
    "cw_hi_kg_m",
)


def draft_name(method: str) -> str:
    """Name of the unpublished edition that a method would give."""
    return f"concept-{method}"


def draft_register(
    curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame, on_date: dt.date
) -> pl.DataFrame:
    """One line per boat and crew under one method: the newest sound tow, valid or not.

    Args:
        curves: rows of the warehouse's `curves` of one method.
        tows: rows of `tows`.
        boats: listed boats with `fsn_no`, `rowers`, `crew_class`; those never towed are listed too.
        on_date: the day on which validity is judged.

    Returns:
        Rows of the table `register`, with status `valid`, `expired`, `rejected` (towed, but no tow
        gives a curve) or `never_towed`.
    """
    dated = curves.join(tows.select("tow_id", "tow_date"), on="tow_id").with_columns(
        pl.date(pl.col("tow_date").dt.year() + VALID_YEARS, 12, 31).alias("valid_until")
    )
    newest = (
        dated.filter(pl.col("status") != "rejected")
        .sort("tow_date", "tow_id")
        .group_by(LINE, maintain_order=True)
        .last()
        .with_columns(
            pl.when(pl.col("valid_until") >= on_date)
            .then(pl.lit("valid"))
            .otherwise(pl.lit("expired"))
            .alias("status")
        )
        .select(*LINE, *CURVE_COLUMNS, "status")
    )
    return pl.concat([newest, *_lines_without_curve(newest, curves, boats)], how="diagonal").sort(
        LINE
    )


def _lines_without_curve(
    newest: pl.DataFrame, curves: pl.DataFrame, boats: pl.DataFrame
) -> list[pl.DataFrame]:
    rejected = curves.select(LINE).unique().join(newest, on=LINE, how="anti")
    towed = curves.select("fsn_no").unique()
    crews = boats.drop_nulls(["rowers", "crew_class"]).select(LINE)
    never = crews.join(towed, on="fsn_no", how="anti")
    return [
        rejected.with_columns(pl.lit("rejected").alias("status")),
        never.with_columns(pl.lit("never_towed").alias("status")),
    ]
