"""The tables of the consistency analysis, by name."""

import polars as pl

from pipeline.consistency.compared import compared_tows, hull_speed_statistics
from pipeline.consistency.homogeneity import pooled_curves, type_homogeneity
from pipeline.consistency.lines import type_lines
from pipeline.consistency.observed import Observed
from pipeline.consistency.outliers import type_outliers
from pipeline.consistency.prediction import predicted_cw, prediction_error
from pipeline.consistency.tow_speed import speed_trend


def line_tables(observed: Observed) -> dict[str, pl.DataFrame]:
    """The lines through boats of a type, for all methods."""
    lines, points = type_lines(observed)
    return {"type_lines": lines, "type_line_points": points}


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
