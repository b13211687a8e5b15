"""Figures: functions from a frame to a chart, the same for every place that shows them.

A figure draws the columns it names and computes nothing; its Vega-Lite does not depend on what the
frame holds, so that one specification serves every boat. Axis titles carry units; colours are
Okabe and Ito's, which colour-blind people tell apart, and a shape or dash says the same in print.
Does not belong here: reading tables, pages, and texts (`dashboards.words`).
"""

from collections.abc import Callable
from typing import Final

import altair as alt
import polars as pl

from dashboards.figures import boat, corrections, quality, reproducibility, types
from dashboards.words import Say

Figure = Callable[[pl.DataFrame, Say], alt.TopLevelMixin]

FIGURES: Final[dict[str, Figure]] = {
    "resistance_curve": boat.resistance_curve,
    "history": boat.history,
    "traces": boat.traces,
    "out_and_back": boat.out_and_back,
    "wind": boat.wind,
    "b_weight": types.b_against_weight,
    "b_speed": types.b_against_speed,
    "cw_weight": types.cw_against_weight,
    "cw_speed": types.cw_against_speed,
    "a_weight": types.a_against_weight,
    "cw_standard_weight": types.cw_standard_against_weight,
    "cw_standard_speed": types.cw_standard_against_speed,
    "shared_bend": types.shared_bend,
    "log_factors": corrections.log_factors,
    "ladder": corrections.season_ladder,
    "season_change": corrections.season_change,
    "options": corrections.option_study,
    "reproducibility": reproducibility.spread,
    "eras": reproducibility.era_shifts,
    "repeats": reproducibility.repeat_pairs,
    "components": reproducibility.components,
    "predicted": reproducibility.predicted,
    "changes": reproducibility.register_changes,
    "statuses": quality.statuses,
}
"""Every figure by name."""
