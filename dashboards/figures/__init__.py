"""Figures: functions from a frame to a chart, the same for every place that shows them.

A figure draws the columns it names and computes nothing; its Vega-Lite does not depend on what the
frame holds, so that one specification serves every boat. Axis titles carry units; colours are
Okabe and Ito's, which colour-blind people tell apart, and a shape or dash says the same in print.
Does not belong here: reading tables, pages, and texts (`words`).
"""

from collections.abc import Callable
from typing import Final

import altair as alt
import polars as pl
import vl_convert

from dashboards import drawn
from dashboards.figures import (
    boat,
    compared,
    corrections,
    quality,
    reproducibility,
    slides,
    tool,
    types,
)
from pipeline.messages import Say, speaker

alt.data_transformers.disable_max_rows()  # an archive of 1,000 tows has more than 5,000 rows

Figure = Callable[[pl.DataFrame, Say], alt.TopLevelMixin]

FIGURES: Final[dict[str, Figure]] = {
    "resistance_curve": boat.resistance_curve,
    "curves_compared": compared.curves_compared,
    "history": boat.history,
    "traces": boat.traces,
    "out_and_back": boat.out_and_back,
    "wind": boat.wind,
    "budget": boat.budget,
    "b_weight": types.against("b", "weight"),
    "b_speed": types.against("b", "speed"),
    "a_weight": types.against("a", "weight"),
    "cw_standard_weight": types.against("cw_standard", "weight"),
    "cw_standard_speed": types.against("cw_standard", "speed"),
    "boats_compared": compared.boats_compared,
    "shared_bend": types.shared_bend,
    "log_factors": corrections.log_factors,
    "ladder": corrections.season_ladder,
    "season_change": corrections.season_change,
    "options": corrections.sensitivity_study,
    "reproducibility": reproducibility.spread,
    "eras": reproducibility.era_shifts,
    "repeats": reproducibility.repeat_pairs,
    "components": reproducibility.components,
    "predicted": reproducibility.predicted,
    "changes": reproducibility.register_changes,
    "race_ranks": reproducibility.race_ranks,
    "statuses": quality.statuses,
    "slide_hull_speed": slides.b_and_hull_speed,
    "slide_towed_at": slides.towed_at,
    "slide_raced_beyond": slides.raced_beyond,
    "slide_boat_years": slides.boat_years,
    "slide_ticks": tool.ticks,
    "slide_tick_effects": tool.tick_effects,
    "run_statistics": tool.run_statistics,
    **{
        f"slide_{quantity}_{explaining}": slides.against(quantity, explaining)
        for quantity in slides.QUANTITIES
        for explaining in slides.EXPLAINING
    },
}
"""Every figure by name."""


def png(name: str, frame: pl.DataFrame, language: str) -> bytes:
    """A figure as a picture, for places that show no Vega."""
    svg = drawn.svg(FIGURES[name](frame, speaker(language)).to_dict(), language)
    return bytes(vl_convert.svg_to_png(svg, scale=2.0))


def drop(part: object, *keys: str) -> None:
    """Takes out of a specification what a picture cannot keep: links, tooltips."""
    if isinstance(part, dict):
        for key in keys:
            part.pop(key, None)
    for inner in (
        part.values() if isinstance(part, dict) else part if isinstance(part, list) else ()
    ):
        drop(inner, *keys)
