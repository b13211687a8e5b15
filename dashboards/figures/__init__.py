"""Figures: functions from a frame to a chart, the same for every place that shows them.

A figure draws the columns it names and computes nothing; its Vega-Lite does not depend on what the
frame holds, so that one specification serves every boat. Axis titles carry units; colours are
Okabe and Ito's, which colour-blind people tell apart, and a shape or dash says the same in print.
Does not belong here: reading tables, and pages.
"""

from collections.abc import Sequence
from typing import Any, Final

import altair as alt
import polars as pl

from dashboards import labels
from dashboards.figures import boat, style, types
from dashboards.figures.charts import (
    CHANGE,
    CW,
    SPEED,
    SPREAD,
    Figure,
    bars,
    by_group,
    curves,
    scatter,
)
from dashboards.figures.style import OKABE_ITO, WIDTH, Column, Drawing, named, tips
from pipeline.history import ERAS
from pipeline.messages import Say, say
from pipeline.studies.ladder import STEP_ORDER
from pipeline.studies.options import CHOICES, SPEEDS, TICKS
from pipeline.uncertainty.propagation import COMPONENTS

alt.data_transformers.disable_max_rows()  # an archive of 1,000 tows has more than 5,000 rows

WEIGHT: Final = ("weight_kg", labels.column("weight_kg"))
DECLARED: Final = ("declared_speed_m_s", say("Declared speed [m/s]"))
A: Final = ("a_kg_m", labels.column("a_kg_m"))
B: Final = ("b_m_s", labels.column("b_m_s"))
STANDARD: Final = ("cw_standard_kg_m", say("Cw at the standard speed [kg/m]"))
QUANTITIES: Final = {column[0]: column for column in (A, B, STANDARD)}
EXPLAINING: Final = {column[0]: column for column in (WEIGHT, DECLARED)}


def _against(quantity: Column, explaining: Column) -> Figure:
    """A quantity of every tow of a type, a panel per method, where dragging chooses."""
    tip = ("name:N", "fsn_no:N", "boat_type:N", "season:O")
    own = (f"{explaining[0]}:Q", f"{quantity[0]}:Q")
    facet = ("method", style.methods_named)
    return scatter(explaining, quantity, style.types, (*tip, *own), facet=facet, brush=True)


def _black(_: Say) -> Sequence[Any]:
    """A curve that stands alone."""
    return (alt.ColorValue("black"),)


def _of_method(_: Say) -> Sequence[Any]:
    """Two methods, the older one dashed; the legend is that of the points."""
    ink = alt.Scale(range=[OKABE_ITO[0], OKABE_ITO[4]])
    dashes = alt.Scale(range=[[5, 4], [1, 0]])
    return (
        alt.Color("method:N", scale=ink, sort=None, legend=None),
        alt.StrokeDash("method:N", scale=dashes, sort=None, legend=None),
    )


def _points_of_method(say: Say) -> Sequence[Any]:
    look: dict[str, Any] = {
        "title": say("Method"),
        "sort": None,
        "legend": alt.Legend(labelExpr=style.methods_named(say)),
    }
    inks = alt.Scale(range=[OKABE_ITO[0], OKABE_ITO[4]])
    shapes = alt.Scale(range=[style.SHAPES[0], style.SHAPES[4]])
    ink = alt.Color("method:N", scale=inks, **look)
    return ink, alt.Shape("method:N", scale=shapes, **look)


def _ladder(frame: pl.DataFrame, say: Say) -> Drawing:
    """Factor on Cw of each step in each season, as a coloured table with its numbers."""
    axis = alt.Axis(labelExpr=named(STEP_ORDER, say), labelAngle=-45, orient="top")
    order = alt.EncodingSortField("position", order="ascending")
    base = alt.Chart(frame).encode(
        alt.X("step:N", title=None, sort=order, axis=axis), alt.Y("season:O", title=None)
    )
    shades = alt.Scale(
        domain=[0.8, 1.0, 1.2], range=[OKABE_ITO[5], "#ffffff", OKABE_ITO[4]], clamp=True,
        interpolate="rgb",
    )  # fmt: skip
    ink = alt.Color("factor:Q", scale=shades, legend=None)
    return alt.layer(
        base.mark_rect(stroke="#dddddd").encode(
            ink, tooltip=tips(say, "season:O", "step:N", "factor:Q")
        ),
        base.mark_text(color="black").encode(alt.Text("factor:Q", format=".3f")),
    ).properties(width=WIDTH, height=alt.Step(22))


def _gains(frame: pl.DataFrame, say: Say) -> Drawing:
    """A bar for every crew: what a race of two hours at equal power gains or loses."""
    title = say("Seconds in a race of two hours [s]")
    inks = alt.condition(
        "datum.gain_in_two_hours_s < 0", alt.value(OKABE_ITO[1]), alt.value(OKABE_ITO[0])
    )
    crew = "datum.name + ' ' + datum.fsn_no + ' ' + datum.rowers + datum.crew_class"
    return (
        alt.Chart(frame)
        .transform_calculate(crew=crew)
        .mark_bar()
        .encode(alt.X("crew:N", sort="-y", axis=None), alt.Y("gain_in_two_hours_s:Q", title=title))
        .encode(color=inks, tooltip=tips(say, "crew:N", "gain_in_two_hours_s:Q"))
        .properties(width=WIDTH, height=220)
    )


def _eras(say: Say) -> list[alt.Chart]:
    """With what was measured, beneath the first season of each era; in turn on two lines."""
    return [
        alt.Chart()
        .transform_filter(f"datum.season >= {era.first} && datum.season <= {era.last}")
        .transform_aggregate(first="min(season)")
        .mark_text(align="left", baseline="top", dx=-14, fontSize=12, fontStyle="italic")
        .encode(
            x="first:O",
            y=alt.value(style.HEIGHT + 22 + 14 * (place % 2)),
            text=alt.value(say(era.measured)),
        )
        for place, era in enumerate(ERAS)
    ]


JUDGED: Final = (*CHOICES, *TICKS, *SPEEDS)
"""What options are judged by: choices of a method, and those of the tool of 2015."""
RUN_TIPS: Final = ("run:O", "speed_m_s:Q", "cw_kg_m:Q")
STAGES: Final = ("gross", "net")
WIND: Final = (
    ("wind_angle_deg", say("Wind angle, 0 from ahead [deg]")),
    ("wind_m_s", say("Apparent wind [m/s]")),
)

FIGURES: Final[dict[str, Figure]] = {
    "resistance_curve": curves(_black, style.directions),
    "certificate_curve": curves(_black, _black),
    "curves_compared": curves(_of_method, _points_of_method),
    "traces": boat.traces,
    "out_and_back": scatter(
        ("speed_m_s", SPEED), ("cw_kg_m", CW), style.directions, RUN_TIPS,
        facet=("stage", lambda say: named(STAGES, say)),
    ),
    "wind": scatter(*WIND, style.directions, ("run:O", "wind_m_s:Q")),
    "b_weight": _against(B, WEIGHT),
    "b_speed": _against(B, DECLARED),
    "a_weight": _against(A, WEIGHT),
    "cw_standard_weight": _against(STANDARD, WEIGHT),
    "cw_standard_speed": _against(STANDARD, DECLARED),
    "history": by_group(
        "tow", ("cw_kg_m", say("Cw at the declared speed [kg/m]")), ("cw_lo_kg_m", "cw_hi_kg_m"),
        tip=("tow:N",), dashed=True,
    ),
    "log_factors": by_group(
        "season", ("factor", labels.column("factor")), ("lo", "hi"), tip=("season:O",), one=True
    ),
    "season_change": by_group(
        "season", ("median_ratio", CHANGE), ("lowest_ratio", "highest_ratio"),
        tip=("season:O", "tows:Q"), one=True, beside=_eras,
    ),
    "reproducibility": by_group(
        "scope", ("sd_ratio", SPREAD), ("lo", "hi"), tip=("n_pairs:Q",), codes=["all"], zero=True
    ),
    "eras": by_group(
        "era", ("shift_ratio", say("Cw new / old without ageing, median")), ("lo", "hi"),
        tip=("n:Q",), one=True,
    ),
    "repeats": by_group(
        "season", ("cw_ratio", labels.column("cw_ratio")), one=True,
        tip=("name:N", "fsn_no:N", "season_before:O", "e_n:Q"),
    ),
    "budget": bars(
        "component", ("u_ratio", say("Standard uncertainty / Cw")), COMPONENTS
    ),
    "options": bars(
        "option", ("median_ratio", CHANGE), JUDGED, ("lo_ratio", "hi_ratio")
    ),
    "ladder": _ladder,
    "changes": _gains,
    **{
        f"type_{name}": types.against(QUANTITIES[y], EXPLAINING[x])
        for name, (y, x) in types.PAIRS.items()
    },
}  # fmt: skip
"""Every figure by name."""
