"""Are equal boats equal: what `pipeline.consistency` says of every method."""

import polars as pl

from pipeline.consistency import repeats, tables, tow_speed
from pipeline.consistency.components import variance_components
from pipeline.consistency.observed import Observed, of_trusted


def type_tables(observed: Observed) -> dict[str, pl.DataFrame]:
    """The statistics of every boat type under one method, but for its lines."""
    components = {"variance_components": variance_components(observed)}
    return tables.type_tables(observed) | components


def slow_tows(observed: Observed, listed_races: pl.DataFrame) -> pl.DataFrame:
    """Tows that were towed more slowly than the boat is rowed."""
    return tow_speed.slow_tows(observed, listed_races)


def repeat_pairs(curves: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Boats and crews that were towed again."""
    return repeats.repeat_pairs(of_trusted(curves, tows), tows)


def reproducibility(repeat_pairs: pl.DataFrame, observed: Observed) -> pl.DataFrame:
    """How far a measurement can be repeated."""
    return repeats.reproducibility(repeat_pairs, observed)
