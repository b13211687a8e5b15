"""What the tows of a season or an archive share, and none of them shows by itself.

Each is a mean or a slope over tows, 0 where chance alone makes as much of it in a share `CHANCE` of
sound archives (t test over the tows).
"""

from typing import Final

import polars as pl
import scipy

from herijk.tables.keys import LINE

CHANCE: Final = 0.001
"""Share of sound seasons or archives in which chance alone shows as much."""

FEWEST: Final = 4
"""Tows that are needed before they tell (inferred)."""


def unless_chance(value: pl.Expr, sd: pl.Expr, dof: pl.Expr) -> pl.Expr:
    """A number, or 0 where chance makes as much of it; `sd` is its standard error."""
    quantiles = dof.map_batches(
        lambda n: pl.Series(scipy.special.stdtrit(n.to_numpy(), 1.0 - CHANCE / 2.0)),
        return_dtype=pl.Float64(),
    )
    return pl.when(value.abs() > quantiles * sd).then(value).otherwise(0.0)


def ways_apart(curves: pl.DataFrame, run_points: pl.DataFrame) -> pl.DataFrame:
    """Cw out over Cw back, less 1, as the tows of a season share it.

    A load cell that warms up during a tow does that, or a wind that is taken off wrongly.

    Returns:
        `tow_id, ways_differ`; no row in a season of few tows.
    """
    way, on_curve = pl.col("direction"), pl.col("cw_kg_m") / pl.col("fitted_cw_kg_m")
    ln = pl.col("ln")
    seasons = (
        run_points.filter("used")
        .group_by("tow_id", maintain_order=True)
        .agg(ln=(on_curve.filter(way > 0).mean() / on_curve.filter(way < 0).mean()).log())
        .filter(ln.is_finite())
        .join(curves.select("tow_id", "season"), on="tow_id", maintain_order="left")
        .group_by("season", maintain_order=True)
        .agg(ln.mean(), sd=ln.std() / pl.len().sqrt(), dof=pl.len() - 1.0)
        .filter(pl.col("dof") + 1 >= FEWEST)
        .with_columns(ways_differ=unless_chance(ln, pl.col("sd"), pl.col("dof")).exp() - 1)
    )
    return curves.join(seasons, on="season", maintain_order="left").select("tow_id", "ways_differ")


def rising_with_wind(curves: pl.DataFrame, run_points: pl.DataFrame) -> pl.DataFrame:
    """What the wind of a tow adds to ln Cw after the wind correction, as all tows show it.

    Waves grow with the square of the wind. The slope is that among the tows of one boat, against
    the boat's best estimate. The square of the true wind is that of the wind as felt, out and back,
    less that of the boat's speed.

    Returns:
        `tow_id, rises_with_wind`; nothing without best estimates.
    """
    felt, speed, way = pl.col("wind_m_s") ** 2, pl.col("speed_m_s") ** 2, pl.col("direction")
    excess = felt - speed
    both_ways = (excess.filter(way > 0).mean() + excess.filter(way < 0).mean()) / 2
    ln, wind2 = pl.col("ln"), pl.col("wind2")
    tows = (
        run_points.filter("used")
        .group_by("tow_id", maintain_order=True)
        .agg(wind2=both_ways.clip(0.0))
        .join(curves, on="tow_id", maintain_order="left")
        .with_columns(ln=(pl.col("cw_kg_m") / pl.col("cw_best_kg_m")).log())
        .filter(ln.is_finite(), wind2.is_finite())
    )
    within = tows.filter(pl.len().over(LINE) > 1).select(
        x=wind2 - wind2.mean().over(LINE), y=ln - ln.mean().over(LINE), line=pl.struct(LINE)
    )
    x, y = pl.col("x"), pl.col("y")
    slopes = within.select(
        slope=(x * y).sum() / (x**2).sum(),
        square=(x**2).sum(),
        yy=(y**2).sum(),
        dof=pl.len() - pl.col("line").n_unique() - 1.0,
    ).with_columns(
        sd=((pl.col("yy") - pl.col("slope") ** 2 * pl.col("square")) / pl.col("dof")).sqrt()
        / pl.col("square").sqrt()
    )
    sure = slopes.filter(pl.col("dof") + 1 >= FEWEST).select(
        sure=unless_chance(pl.col("slope"), pl.col("sd"), pl.col("dof"))
    )
    return tows.join(sure, how="cross").select(
        "tow_id", rises_with_wind=(pl.col("sure") * wind2).exp() - 1
    )
