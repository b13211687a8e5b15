"""The tables of the warehouse, each declared once: names, dtypes, units, ranges and meaning.

Other programs rely on these names; a column may be added, none is renamed or dropped without a
line in the changelog. Units are in the names (SI); ratios are ratios. What a number means
physically is explained in the module that computes it; how tables are stored is in
`warehouse.store.store`.
"""

from typing import Final

import polars as pl

from herijk.tables import (
    archive,
    consistency,
    curves,
    editions,
    register,
    runs,
    season_log,
    studies,
)
from herijk.tables.declare import dy

TABLES: Final[dict[str, type[dy.Schema]]] = {
    "boats": archive.Boats,
    "seasons": archive.Seasons,
    "tows": archive.Tows,
    "tow_runs": archive.TowRuns,
    "hand_windows": archive.HandWindows,
    "run_points": runs.RunPoints,
    "curves": curves.Curves,
    "curve_points": curves.CurvePoints,
    "assessments": curves.Assessments,
    "log_factors": season_log.LogFactors,
    "season_links": season_log.SeasonLinks,
    "retow_choice": season_log.RetowChoice,
    "season_steps": season_log.SeasonSteps,
    "season_diagnosis": season_log.SeasonDiagnosis,
    "tow_instruments": season_log.TowInstruments,
    "best_estimate_weights": season_log.BestEstimateWeights,
    "uncertainty_budget": curves.UncertaintyBudget,
    "ensemble": curves.Ensemble,
    "register": register.Register,
    "due_list": register.DueList,
    "editions": editions.Editions,
    "register_history": register.RegisterHistory,
    "register_changes": register.RegisterChanges,
    "race_changes": register.RaceChanges,
    "correction_steps": studies.CorrectionSteps,
    "option_effects": studies.OptionEffects,
    "option_curves": studies.OptionCurves,
    "season_changes": studies.SeasonChanges,
    "season_ladder": studies.SeasonLadder,
    "option_summary": studies.OptionSummary,
    "quality_counts": studies.QualityCounts,
    "check_counts": studies.CheckCounts,
    "promise": studies.Promise,
    "print_reproduction": studies.PrintReproduction,
    "print_summary": studies.PrintSummary,
    "run_statistics": studies.RunStatistics,
    "trace_seconds": archive.TraceSeconds,
    "type_consistency": consistency.TypeConsistency,
    "type_lines": consistency.TypeLines,
    "type_line_points": consistency.TypeLinePoints,
    "compared_tows": consistency.ComparedTows,
    "hull_speed": consistency.HullSpeed,
    "type_outliers": consistency.TypeOutliers,
    "type_homogeneity": consistency.TypeHomogeneity,
    "pooled_curves": consistency.PooledCurves,
    "speed_trend": consistency.SpeedTrend,
    "slow_tows": consistency.SlowTows,
    "repeat_pairs": consistency.RepeatPairs,
    "era_shifts": consistency.EraShifts,
    "reproducibility": consistency.Reproducibility,
    "variance_components": consistency.VarianceComponents,
    "predicted_cw": consistency.PredictedCw,
    "prediction_error": consistency.PredictionError,
    "quarantine": archive.Quarantine,
    "methods": editions.Methods,
    "lineage": editions.Lineage,
}

ABOUT: Final[dict[str, type[dy.Schema]]] = {"about": archive.About, "contents": archive.Contents}
"""Tables of the database about itself."""


def ordered(name: str, frame: pl.DataFrame) -> pl.DataFrame:
    """The declared columns of a table, in order, sorted by its key."""
    schema = TABLES[name]
    return frame.select(schema.column_names()).sort(schema.primary_key() or schema.column_names())


def conform(name: str, frame: pl.DataFrame) -> pl.DataFrame:
    """The same, checked.

    Whole numbers get the declared width: counts come wider than they are kept.

    Raises:
        dataframely.exc.ValidationError, SchemaError: the frame is not what was declared.
    """
    schema = TABLES[name]
    whole = [
        pl.col(column).cast(declared.dtype)
        for column, declared in schema.columns().items()
        if declared.dtype.is_integer() and frame.schema[column].is_integer()
    ]
    return schema.validate(ordered(name, frame.with_columns(whole)))
