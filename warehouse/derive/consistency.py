"""Are equal boats equal: what `pipeline.consistency` says of every method."""

import polars as pl

from pipeline.consistency import repeats, tables, tow_speed
from pipeline.consistency.components import variance_components
from pipeline.consistency.observed import Observed, observe, of_trusted
from pipeline.method.definition import Method


def line_tables(
    method: Method,
    curves: pl.DataFrame,
    run_points: pl.DataFrame,
    tows: pl.DataFrame,
    boats: pl.DataFrame,
) -> dict[str, pl.DataFrame]:
    """Lines through the boats of every type under one method."""
    return tables.line_tables(_observed(_of(method, curves), run_points, tows, boats))


def type_tables(
    method: Method,
    curves: pl.DataFrame,
    run_points: pl.DataFrame,
    tows: pl.DataFrame,
    boats: pl.DataFrame,
) -> dict[str, pl.DataFrame]:
    """Are equal boats equal: the other statistics of every boat type under one method."""
    observed = _observed(_of(method, curves), run_points, tows, boats)
    components = {"variance_components": variance_components(observed)}
    return tables.type_tables(observed) | components


def slow_tows(
    curves: pl.DataFrame,
    run_points: pl.DataFrame,
    tows: pl.DataFrame,
    boats: pl.DataFrame,
    listed_races: pl.DataFrame,
) -> pl.DataFrame:
    """Tows that were towed more slowly than the boat is rowed."""
    observed = _observed(curves, run_points, tows, boats)
    return tow_speed.slow_tows(observed, listed_races)


def repeat_pairs(curves: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Boats and crews that were towed again."""
    return repeats.repeat_pairs(of_trusted(curves, tows), tows)


def reproducibility(
    repeat_pairs: pl.DataFrame,
    curves: pl.DataFrame,
    run_points: pl.DataFrame,
    tows: pl.DataFrame,
    boats: pl.DataFrame,
) -> pl.DataFrame:
    """How far a measurement can be repeated."""
    return repeats.reproducibility(repeat_pairs, _observed(curves, run_points, tows, boats))


def _of(method: Method, frame: pl.DataFrame) -> pl.DataFrame:
    return frame.filter(pl.col("method") == method.name)


def _observed(
    curves: pl.DataFrame, run_points: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame
) -> Observed:
    """Of tows that are trusted."""
    return observe(of_trusted(curves, tows), tows, boats, of_trusted(run_points, tows))
