"""Are equal boats equal? Statistics of boats of one type and of repeated tows.

Belongs here: what a table of curves says about boats of a type (`compared`, `lines`,
`homogeneity`), about the speed of the tow (`tow_speed`), about repeats (`repeats`, `eras`,
`components`) and about a boat that was only measured (`prediction`). Does not belong here: how a
curve is made, which differences matter to a race (`pipeline.register.changes`), and any judgement:
tables say, people decide.

`observed` joins the tables and carries the measuring errors; `mixed` is the one statistical model.
"""

import polars as pl

from herijk.pipeline.consistency.compared import compared_tows, hull_speed_statistics
from herijk.pipeline.consistency.components import variance_components
from herijk.pipeline.consistency.eras import ERAS, Era, era_shifts
from herijk.pipeline.consistency.homogeneity import pooled_curves, type_homogeneity
from herijk.pipeline.consistency.lines import (
    newest_lines,
    tow_outliers,
    type_consistency,
    type_lines,
    type_outliers,
)
from herijk.pipeline.consistency.observed import Observed, observe
from herijk.pipeline.consistency.prediction import predicted_cw, prediction_error
from herijk.pipeline.consistency.repeats import repeat_pairs, reproducibility, told_apart
from herijk.pipeline.consistency.tow_speed import slow_tows, speed_trend

__all__ = [
    "ERAS",
    "Era",
    "Observed",
    "compared_tows",
    "consistency_tables",
    "era_shifts",
    "hull_speed_statistics",
    "line_tables",
    "observe",
    "pooled_curves",
    "predicted_cw",
    "prediction_error",
    "repeat_pairs",
    "reproducibility",
    "slow_tows",
    "speed_trend",
    "tow_outliers",
    "type_consistency",
    "type_homogeneity",
    "type_lines",
    "type_outliers",
    "variance_components",
]


def line_tables(
    curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame, run_points: pl.DataFrame
) -> dict[str, pl.DataFrame]:
    """The lines through boats of a type, for all methods in `curves`: half of the analysis.

    Args:
        curves, tows, boats, run_points: the warehouse's tables.

    Returns:
        The frames by the name of their table.
    """
    lines, points = type_lines(observe(curves, tows, boats, run_points))
    return {
        "type_lines": lines,
        "type_line_points": points,
        "type_consistency": newest_lines(lines),
    }


def consistency_tables(
    curves: pl.DataFrame,
    tows: pl.DataFrame,
    boats: pl.DataFrame,
    run_points: pl.DataFrame,
    results: pl.DataFrame,
) -> dict[str, pl.DataFrame]:
    """The other tables of the consistency analysis, for all methods in `curves`.

    Args:
        curves, tows, boats, run_points: the warehouse's tables.
        results: races, as `tow_speed.raced` takes them.

    Returns:
        The frames by the name of their table.
    """
    observed = observe(curves, tows, boats, run_points)
    pairs = repeat_pairs(curves, tows)
    components = variance_components(observed)
    predicted = predicted_cw(observed)
    compared = compared_tows(observed)
    return {
        "compared_tows": compared,
        "hull_speed": hull_speed_statistics(compared),
        "type_outliers": type_outliers(observed),
        "type_homogeneity": type_homogeneity(observed),
        "pooled_curves": pooled_curves(observed),
        "speed_trend": speed_trend(observed),
        "slow_tows": slow_tows(observed, results),
        "repeat_pairs": pairs,
        "era_shifts": era_shifts(pairs, boats),
        "reproducibility": told_apart(reproducibility(pairs, observed), components),
        "variance_components": components,
        "predicted_cw": predicted,
        "prediction_error": prediction_error(predicted),
    }
