"""Figures of two methods laid over each other."""

from typing import Any

import altair as alt
import polars as pl

from dashboards.figures.style import (
    HEIGHT,
    OKABE_ITO,
    SHAPES,
    WIDTH,
    Drawing,
    colour,
    methods_named,
    number,
    tips,
)
from pipeline.messages import Say
from pipeline.method.definition import COMPLETE


def curves_compared(frame: pl.DataFrame, say: Say) -> Drawing:
    """A tow's curve and run points under two methods, with the interval at the declared speed.

    Args:
        frame: rows of `kind` line, point and declared
            (`warehouse.queries.scenario.Scenario.boat_figure`).
        say: gives texts.
    """
    x = number(alt.X, "speed_m_s", say("Speed through water [m/s]"))
    y = number(alt.Y, "cw_kg_m", say("Cw [kg/m]"))
    low, high = alt.Y("cw_lo_kg_m:Q", title=say("Cw [kg/m]")), alt.Y2("cw_hi_kg_m:Q")
    # What as-published and a scenario look like in the figures of all methods.
    ink, marks = (alt.Scale(range=[looks[0], looks[4]]) for looks in (OKABE_ITO, SHAPES))
    dashes = alt.Scale(range=[[5, 4], [1, 0]])
    # One legend, that of the points: colour and dash of the lines would each have their own.
    colour = alt.Color("method:N", scale=ink, sort=None, legend=None)
    dash = alt.StrokeDash("method:N", scale=dashes, sort=None, legend=None)
    names = alt.Legend(labelExpr=methods_named(say))
    look: dict[str, Any] = {"title": say("Method"), "sort": None, "legend": names}
    base = alt.Chart(frame)
    line = base.transform_filter("datum.kind == 'line'")
    point = base.transform_filter("datum.kind == 'point'")
    declared = base.transform_filter("datum.kind == 'declared'")
    full, dashed = alt.value([1, 0]), alt.value([4, 3])
    kind = alt.when(f"datum.interval == '{COMPLETE}'").then(full).otherwise(dashed)
    return alt.layer(
        line.mark_line(strokeWidth=2).encode(x, y, colour, dash),
        declared.mark_rule(strokeWidth=3, opacity=0.6).encode(
            x, low, high, colour, strokeDash=kind
        ),
        point.mark_point(size=70, strokeWidth=2).encode(
            x,
            y,
            colour,
            alt.Shape("method:N", scale=marks, **look),
            alt.Fill("method:N", scale=ink, **look),
            fillOpacity=alt.condition("datum.used", alt.value(0.85), alt.value(0)),
            tooltip=tips(say, "method:N", "run:O", "speed_m_s:Q", ("cw_kg_m:Q", say("Cw [kg/m]"))),
        ),
    ).properties(width=WIDTH, height=HEIGHT)


def boats_compared(frame: pl.DataFrame, say: Say) -> Drawing:
    """The curves of two boats with their bands; `frame` holds `curve_points` with their `crew`."""
    x = number(alt.X, "speed_m_s", say("Speed through water [m/s]"))
    low, high = alt.Y("cw_lo_kg_m:Q", title=say("Cw [kg/m]")), alt.Y2("cw_hi_kg_m:Q")
    legend = alt.Legend(orient="top", columns=1, labelLimit=400)
    # One legend, that of the lines: the bands' own would show the same names again.
    band = colour("crew", say("Boat"), sort=None, legend=None)
    crew = colour("crew", say("Boat"), sort=None, legend=legend)
    dash = alt.StrokeDash("crew:N", title=say("Boat"), sort=None, legend=legend)
    base = alt.Chart(frame)
    tip = tips(say, ("crew:N", say("Boat")), "speed_m_s:Q", ("cw_kg_m:Q", say("Cw [kg/m]")))
    return alt.layer(
        base.mark_area(opacity=0.25).encode(x, low, high, band),
        base.mark_line(strokeWidth=2).encode(
            x, number(alt.Y, "cw_kg_m", say("Cw [kg/m]")), crew, dash, tooltip=tip
        ),
    ).properties(width=WIDTH, height=HEIGHT)
