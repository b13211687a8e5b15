"""The tables of the consistency analysis, by name."""

import polars as pl

from pipeline.consistency.compared import compared_tows, hull_speed_statistics
from pipeline.consistency.components import variance_components
from pipeline.consistency.eras import era_shifts
from pipeline.consistency.homogeneity import pooled_curves, type_homogeneity
from pipeline.consistency.lines import newest_lines, type_lines, type_outliers
from pipeline.consistency.observed import Observed, observe
from pipeline.consistency.prediction import predicted_cw, prediction_error
from pipeline.consistency.repeats import repeat_pairs, reproducibility, told_apart
from pipeline.consistency.tow_speed import slow_tows, speed_trend


def line_tables(observed: Observed) -> dict[str, pl.DataFrame]:
    """The lines through boats of a type, for all methods: half of the work."""
    lines, points = type_lines(observed)
    return {
        "type_lines": lines,
        "type_line_points": points,
        "type_consistency": newest_lines(lines),
    }


def type_tables(observed: Observed) -> dict[str, pl.DataFrame]:
    """The other statistics of boats of a type, for all methods."""
    compared, predicted = compared_tows(observed), predicted_cw(observed)
    return {
        "compared_tows": compared,
        "hull_speed": hull_speed_statistics(compared),
        "type_outliers": type_outliers(observed),
        "type_homogeneity": type_homogeneity(observed),
        "pooled_curves": pooled_curves(observed),
        "speed_trend": speed_trend(observed),
        "predicted_cw": predicted,
        "prediction_error": prediction_error(predicted),
    }


def consistency_tables(
    curves: pl.DataFrame,
    tows: pl.DataFrame,
    boats: pl.DataFrame,
    run_points: pl.DataFrame,
    results: pl.DataFrame,
) -> dict[str, pl.DataFrame]:
    """All but the lines, for all methods in `curves`.

    Args:
        curves, tows, boats, run_points: the warehouse's tables.
        results: races, as `tow_speed.raced` takes them.
    """
    observed, pairs = observe(curves, tows, boats, run_points), repeat_pairs(curves, tows)
    components = variance_components(observed)
    return type_tables(observed) | {
        "slow_tows": slow_tows(observed, results),
        "repeat_pairs": pairs,
        "era_shifts": era_shifts(pairs, boats),
        "reproducibility": told_apart(reproducibility(pairs, observed), components),
        "variance_components": components,
    }
