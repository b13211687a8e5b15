"""Whether equal boats are equal: lines, outliers and trends of each type, and repeated tows."""

import dagster as dg
import polars as pl

from assets.lake import incremental, outs
from pipeline.consistency import (
    compared,
    components,
    eras,
    homogeneity,
    lines,
    outliers,
    prediction,
    repeats,
    tow_speed,
)
from pipeline.consistency.observed import observe_trusted, of_trusted


@dg.multi_asset(outs=outs("type_lines", "type_line_points"), can_subset=True)
@incremental(may_fail=True)
def lines_of_types(
    curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame, run_points: pl.DataFrame
) -> dict[str, pl.DataFrame]:
    """The line through the boats of a type, and its points."""
    found, points = lines.type_lines(observe_trusted(curves, tows, boats, run_points))
    return {"type_lines": found, "type_line_points": points}


@dg.asset
@incremental(may_fail=True)
def compared_tows(
    curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame, run_points: pl.DataFrame
) -> pl.DataFrame:
    """Each tow against the other boats of its type."""
    return compared.compared_tows(observe_trusted(curves, tows, boats, run_points))


@dg.asset
@incremental(may_fail=True)
def hull_speed(compared_tows: pl.DataFrame) -> pl.DataFrame:
    """How Cw grows with hull speed within a type."""
    return compared.hull_speed_statistics(compared_tows)


@dg.asset
@incremental(may_fail=True)
def type_outliers(
    curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame, run_points: pl.DataFrame
) -> pl.DataFrame:
    """Tows that are far from the others of their type."""
    return outliers.type_outliers(observe_trusted(curves, tows, boats, run_points))


@dg.asset
@incremental(may_fail=True)
def type_homogeneity(
    curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame, run_points: pl.DataFrame
) -> pl.DataFrame:
    """Whether boats of a type differ by more than their measuring errors."""
    return homogeneity.type_homogeneity(observe_trusted(curves, tows, boats, run_points))


@dg.asset
@incremental(may_fail=True)
def pooled_curves(
    curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame, run_points: pl.DataFrame
) -> pl.DataFrame:
    """One curve for all boats of a type."""
    return homogeneity.pooled_curves(observe_trusted(curves, tows, boats, run_points))


@dg.asset
@incremental(may_fail=True)
def speed_trend(
    curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame, run_points: pl.DataFrame
) -> pl.DataFrame:
    """How Cw depends on the speed at which a boat was towed."""
    return tow_speed.speed_trend(observe_trusted(curves, tows, boats, run_points))


@dg.asset
@incremental(may_fail=True)
def predicted_cw(
    curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame, run_points: pl.DataFrame
) -> pl.DataFrame:
    """Cw as the other boats predict it."""
    return prediction.predicted_cw(observe_trusted(curves, tows, boats, run_points))


@dg.asset
@incremental(may_fail=True)
def prediction_error(predicted_cw: pl.DataFrame) -> pl.DataFrame:
    """How well boats predict each other."""
    return prediction.prediction_error(predicted_cw)


@dg.asset
@incremental(may_fail=True)
def variance_components(
    curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame, run_points: pl.DataFrame
) -> pl.DataFrame:
    """Standard deviations of ln Cw by cause, over the fleet and within types, per method."""
    return components.variance_components(observe_trusted(curves, tows, boats, run_points))


@dg.asset
@incremental(may_fail=True)
def slow_tows(
    curves: pl.DataFrame,
    tows: pl.DataFrame,
    boats: pl.DataFrame,
    run_points: pl.DataFrame,
    listed_races: pl.DataFrame,
) -> pl.DataFrame:
    """Tows whose curve is used where it was not measured."""
    return tow_speed.slow_tows(observe_trusted(curves, tows, boats, run_points), listed_races)


@dg.asset
@incremental(may_fail=True)
def repeat_pairs(curves: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Boats and crews that were towed again."""
    return repeats.repeat_pairs(of_trusted(curves, tows), tows)


@dg.asset
@incremental(may_fail=True)
def era_shifts(repeat_pairs: pl.DataFrame, boats: pl.DataFrame) -> pl.DataFrame:
    """Shift of Cw from the tows of an era to the next tow of the same boat and crew."""
    return eras.era_shifts(repeat_pairs, boats)


@dg.asset
@incremental(may_fail=True)
def reproducibility(
    repeat_pairs: pl.DataFrame,
    curves: pl.DataFrame,
    tows: pl.DataFrame,
    boats: pl.DataFrame,
    run_points: pl.DataFrame,
) -> pl.DataFrame:
    """Standard deviation of one tow from repeat pairs, per method and era."""
    return repeats.reproducibility(repeat_pairs, observe_trusted(curves, tows, boats, run_points))
