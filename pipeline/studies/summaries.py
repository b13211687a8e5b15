"""What many tows have in common, one row per season, step or code: medians, means and counts.

Frames of the warehouse in, frames out. What pages and commands say about a season or an archive is
computed here once, so that it is the same number everywhere. Statistics with an interval are in
`pipeline.consistency`.
"""

from typing import Final

import polars as pl

ALL_SEASONS: Final = "all"
MIDDLE: Final = (0.05, 0.95)
"""Quantiles that bound the middle 90 %."""


def season_changes(curves: pl.DataFrame, first: str) -> pl.DataFrame:
    """Cw of each method / Cw of the first method, of the same tow: median and range per season.

    Args:
        curves: rows of the table `curves` of several methods.
        first: name of the method that the others are compared with.

    Returns:
        `method, from_method, season, tows, median_ratio, lowest_ratio, highest_ratio`.
    """
    known = curves.drop_nulls("cw_kg_m")
    old = known.filter(pl.col("method") == first).select("tow_id", old="cw_kg_m")
    ratio = pl.col("cw_kg_m") / pl.col("old")
    return (
        known.filter(pl.col("method") != first)
        .join(old, on="tow_id", maintain_order="left")
        .group_by("method", "season", maintain_order=True)
        .agg(
            pl.lit(first).alias("from_method"),
            pl.len().alias("tows"),
            ratio.median().alias("median_ratio"),
            ratio.min().alias("lowest_ratio"),
            ratio.max().alias("highest_ratio"),
        )
    )


def season_ladder(correction_steps: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Factor on Cw of each step of a ladder, per season: the geometric mean, so steps multiply.

    Args:
        correction_steps: their start (position 0) is left out.
        tows: `tow_id, season`.

    Returns:
        `from_method, to_method, season, position, step, tows, factor`.
    """
    # In one order, so that sums have the same bytes.
    ordered = correction_steps.filter(pl.col("position") > 0).sort("tow_id")
    return (
        ordered.join(tows.select("tow_id", "season"), on="tow_id", maintain_order="left")
        .group_by("from_method", "to_method", "season", "position", "step", maintain_order=True)
        .agg(pl.len().alias("tows"), pl.col("factor").log().mean().exp().alias("factor"))
    )


def option_summary(option_effects: pl.DataFrame) -> pl.DataFrame:
    """How much each option moves Cw: median and the middle 90 % of tows.

    Args:
        option_effects: the table of that name.

    Returns:
        `method, study, option, tows, median_ratio, lo_ratio, hi_ratio`.
    """
    ratio = pl.col("cw_effect_ratio")
    lo, hi = (ratio.quantile(q, "linear") for q in MIDDLE)
    return option_effects.group_by("method", "study", "option", maintain_order=True).agg(
        pl.len().alias("tows"),
        ratio.median().alias("median_ratio"),
        lo.alias("lo_ratio"),
        hi.alias("hi_ratio"),
    )


def quality_counts(curves: pl.DataFrame, run_points: pl.DataFrame) -> pl.DataFrame:
    """How many curves have each status and flag, and how many runs do not count, and why.

    Args:
        curves, run_points: the tables of that name.

    Returns:
        `method, kind` (status, flag or run)`, code, scope` (a season, or all)`, number`.
    """
    key = ("method", "season")
    flags = curves.select(*key, code="flags").explode("code").drop_nulls("code")
    seasons = curves.select(*key, "tow_id")
    unused = run_points.filter(~pl.col("used")).join(
        seasons, on=["method", "tow_id"], maintain_order="left"
    )
    kinds = {
        "status": curves.select(*key, code="status"),
        "flag": flags,
        "run": unused.select(*key, code="reason"),
    }
    events = pl.concat(rows.with_columns(kind=pl.lit(kind)) for kind, rows in kinds.items())
    of_season = events.with_columns(scope=pl.col("season").cast(pl.String))
    of_all = events.with_columns(scope=pl.lit(ALL_SEASONS))
    both = pl.concat([of_season, of_all])
    return both.group_by("method", "kind", "code", "scope", maintain_order=True).agg(
        pl.len().alias("number")
    )


def check_counts(assessments: pl.DataFrame) -> pl.DataFrame:
    """On how many tows each check was made, and how often what it saw lay beyond its limit.

    Args:
        assessments: the table of that name.

    Returns:
        `method, check, severity, tows, beyond`.
    """
    return assessments.group_by("method", "check", "severity", maintain_order=True).agg(
        pl.len().alias("tows"), pl.col("flagged").sum().alias("beyond")
    )


SUMS: Final = ("log1_v", "gps", "gps_n", "force", "wind_v", "wind_sin", "wind_cos")
"""The sums that `second_means` takes."""


def second_means(blocks: pl.DataFrame) -> pl.DataFrame:
    """Means over every second of every run: what the instruments said.

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
