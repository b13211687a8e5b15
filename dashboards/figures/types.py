"""Figures of boat types: are equal boats equal?

Each is a scatter with a selection by dragging (`brush`, read by the page to fill the boat list), a
parameter `chosen` that the list sets, and points that link to their boat.
"""

from collections.abc import Callable
from typing import Final

import altair as alt
import polars as pl

from dashboards import labels
from dashboards.figures.style import (
    Drawing,
    kinds,
    methods_named,
    number,
    tips,
    type_legend,
)
from pipeline.messages import Say, say

QUANTITIES: Final = {
    "b": ("b_m_s", labels.column("b_m_s")),
    "a": ("a_kg_m", labels.column("a_kg_m")),
    "cw_standard": ("cw_standard_kg_m", say("Cw at the standard speed [kg/m]")),
}
EXPLAINING: Final = {
    "weight": ("weight_kg", labels.column("weight_kg")),
    "speed": ("declared_speed_m_s", say("Declared speed [m/s]")),
}
"""Columns of the axes, with their titles."""


def against(quantity: str, explaining: str) -> Callable[[pl.DataFrame, Say], Drawing]:
    """The figure of a quantity against weight or tow speed, as points that link to their boat.

    It draws `Views.type_tows` with `page`: all types, and methods side by side on the same axes, so
    that they can be compared.
    """
    (x, x_title), (y, y_title) = EXPLAINING[explaining], QUANTITIES[quantity]

    def figure(frame: pl.DataFrame, say: Say) -> Drawing:
        brush = alt.selection_interval(name="brush")
        chosen = alt.param(name="chosen", value="")
        legend = type_legend(say, orient="top", columns=3)
        points = (
            alt.Chart(frame)
            .mark_point(filled=True, strokeWidth=2, cursor="pointer")
            .encode(
                number(alt.X, x, say(x_title)),
                number(alt.Y, y, say(y_title)),
                *kinds("boat_type", say("Type"), legend=legend),
                size=alt.condition("datum.fsn_no == chosen", alt.value(320), alt.value(70)),
                opacity=alt.condition(brush, alt.value(0.9), alt.value(0.2)),
                href="page:N",
                tooltip=tips(
                    say, "name:N", "fsn_no:N", "boat_type:N", "season:O", f"{x}:Q", f"{y}:Q"
                ),
            )
            .add_params(brush, chosen)
        )
        header = alt.Header(labelExpr=methods_named(say))
        return points.properties(width=400, height=280).facet(
            alt.Facet("method:N", title=None, header=header), columns=2
        )

    return figure


def shared_bend(frame: pl.DataFrame, say: Say) -> alt.Chart:
    """B of each boat: its own, drawn to its type's, and shared; `frame` is `Views.shared_bends`."""
    names = {code: say(labels.code(code)) for code in ("own", "partial", "shared")}
    legend = alt.Legend(labelExpr=f"({names})[datum.value] || datum.value")
    return (
        alt.Chart(frame)
        .mark_point(filled=True, size=60, opacity=0.85)
        .encode(
            number(alt.X, "b_m_s", say(labels.column("b_m_s"))),
            alt.Y("crew:N", title=say("Boat")),
            *kinds("pooling", say("Bend"), legend=legend),
            tooltip=tips(say, ("crew:N", say("Boat")), "b_m_s:Q"),
        )
        .properties(width=360)
    )
