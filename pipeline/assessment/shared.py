"""What the tows of a season or an archive share, though no single tow shows it.

Each is a mean or a slope over tows, 0 where chance alone makes as much of it in a share `CHANCE` of
sound archives (t test over the tows).
"""

from typing import Final

import polars as pl
import scipy

from pipeline.channels import SECOND_FILE_OFFSET

CHANCE: Final = 0.001
"""Share of sound seasons or archives in which chance alone shows as much."""

FEWEST: Final = 4
"""Fewest tows from which anything is concluded (inferred)."""

LEAST_SPREAD: Final = 0.01
"""Sum of squares of ln speed within which a tow tells a slope; runs at 90 to 110 % have 0.04."""


def unless_chance(value: pl.Expr, sd: pl.Expr, dof: pl.Expr) -> pl.Expr:
    """A number, or 0 where chance explains one as large; `sd` is its standard error."""
    quantiles = dof.map_batches(
        lambda n: pl.Series(scipy.special.stdtrit(n.to_numpy(), 1.0 - CHANCE / 2.0)),
        return_dtype=pl.Float64(),
    )
    return pl.when(value.abs() > quantiles * sd).then(value).otherwise(0.0)


def _of_season(name: str, of_tows: pl.DataFrame, curves: pl.DataFrame) -> pl.DataFrame:
    """The mean `value` of the tows of each season, for each of its tows.

    Returns:
        `tow_id` and the name; no row in a season of few tows.
    """
    value, dof = pl.col("value"), pl.col("dof")
    seasons = (
        of_tows.join(curves.select("tow_id", "season"), on="tow_id", maintain_order="left")
        .group_by("season", maintain_order=True)
        .agg(value.mean(), sd=value.std() / pl.len().sqrt(), dof=pl.len() - 1.0)
        .filter(dof + 1 >= FEWEST)
        .select("season", unless_chance(value, pl.col("sd"), dof).alias(name))
    )
    return curves.join(seasons, on="season", maintain_order="left").select("tow_id", name)


def rising_with_speed(curves: pl.DataFrame, run_points: pl.DataFrame) -> pl.DataFrame:
    """How the log's factor changes with speed, by the GPS of all its season.

    Per tow it is the slope of ln(GPS / log) by ln speed, among runs one way, in which the current
    is the same.

    Returns:
        `tow_id, log_not_linear`; no row in a season of few tows.
    """
    ways = ["tow_id", pl.col("run") > SECOND_FILE_OFFSET, "direction"]
    x, y = (pl.col(name).log() for name in ("speed_m_s", "gps_ratio"))
    x2 = pl.col("x") ** 2
    slopes = (
        run_points.filter("used", pl.col("gps_ratio") > 0)
        .select("tow_id", x=x - x.mean().over(ways), y=y - y.mean().over(ways))
        .group_by("tow_id", maintain_order=True)
        .agg(value=(pl.col("x") * pl.col("y")).sum() / x2.sum(), spread=x2.sum())
        .filter(pl.col("spread") > LEAST_SPREAD)
    )
    return _of_season("log_not_linear", slopes, curves)


def ways_apart(curves: pl.DataFrame, run_points: pl.DataFrame) -> pl.DataFrame:
    """Cw out / Cw back, less 1: the mean over the tows of a season.

    A load cell that warms up during a tow causes it, or a wrong wind correction.

    Returns:
        `tow_id, ways_differ`; no row in a season of few tows.
    """
    way, on_curve = pl.col("direction"), pl.col("cw_kg_m") / pl.col("fitted_cw_kg_m")
    ln_ratios = (
        run_points.filter("used")
        .group_by("tow_id", maintain_order=True)
        .agg(value=(on_curve.filter(way > 0).mean() / on_curve.filter(way < 0).mean()).log())
        .filter(pl.col("value").is_finite())
    )
    return _of_season("ways_differ", ln_ratios, curves).with_columns(
        pl.col("ways_differ").exp() - 1
    )
