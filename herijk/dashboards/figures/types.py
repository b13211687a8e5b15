"""Figures of boat types: are equal boats equal?

Each is a scatter with a selection by dragging (`brush`, read by the page to fill the boat list), a
parameter `chosen` that the list sets, and points that link to their boat.
"""

from typing import Any

import altair as alt
import polars as pl

from herijk.dashboards.figures.style import (
    Drawing,
    colour,
    methods_named,
    number,
    shape,
    tips,
    type_legend,
)
from herijk.words.catalogue import Say

Axes = tuple[tuple[str, str], tuple[str, str]]


def _points(frame: pl.DataFrame, say: Say, axes: Axes, more: dict[str, Any]) -> alt.Chart:
    """Boats as points that link to their page; `axes` are column and title of x and y."""
    x, y = axes
    return (
        alt.Chart(frame)
        .mark_point(filled=True, strokeWidth=2, cursor="pointer")
        .encode(
            number(alt.X, *x),
            number(alt.Y, *y),
            href="page:N",
            tooltip=tips(
                ("name:N", say("name")),
                ("fsn_no:N", "FSN"),
                ("boat_type:N", say("type")),
                ("season:O", say("season")),
                (f"{x[0]}:Q", x[1]),
                (f"{y[0]}:Q", y[1]),
            ),
            **more,
        )
    )


def _scatter(frame: pl.DataFrame, say: Say, axes: Axes) -> Drawing:
    """All types; methods side by side on the same axes, so that they can be compared."""
    brush = alt.selection_interval(name="brush")
    chosen = alt.param(name="chosen", value="")
    legend = type_legend(say, orient="top", columns=3)
    more = {
        "color": colour("boat_type", say("type"), legend=legend),
        "shape": shape("boat_type", say("type"), legend=legend),
        "size": alt.condition("datum.fsn_no == chosen", alt.value(320), alt.value(70)),
        "opacity": alt.condition(brush, alt.value(0.9), alt.value(0.2)),
    }
    points = _points(frame, say, axes, more).add_params(brush, chosen)
    return points.properties(width=400, height=280).facet(
        alt.Facet("method:N", title=None, header=_methods(say)), columns=2
    )


def _methods(say: Say) -> alt.Header:
    return alt.Header(labelExpr=methods_named(say))


def _weight(say: Say) -> tuple[str, str]:
    return "weight_kg", say("weight")


def _speed(say: Say) -> tuple[str, str]:
    return "declared_speed_m_s", say("tow_speed")


def _b(say: Say) -> tuple[str, str]:
    return "b_m_s", say("b")


def _cw_standard(say: Say) -> tuple[str, str]:
    return "cw_standard_kg_m", say("cw_standard")


def b_against_weight(frame: pl.DataFrame, say: Say) -> Drawing:
    """B against weight; `frame` is `Views.type_tows` with `page`."""
    return _scatter(frame, say, (_weight(say), _b(say)))


def b_against_speed(frame: pl.DataFrame, say: Say) -> Drawing:
    """B against tow speed."""
    return _scatter(frame, say, (_speed(say), _b(say)))


def a_against_weight(frame: pl.DataFrame, say: Say) -> Drawing:
    """A against weight."""
    return _scatter(frame, say, (_weight(say), ("a_kg_m", say("a"))))


def cw_standard_against_weight(frame: pl.DataFrame, say: Say) -> Drawing:
    """Cw at the type's standard speed against weight."""
    return _scatter(frame, say, (_weight(say), _cw_standard(say)))


def cw_standard_against_speed(frame: pl.DataFrame, say: Say) -> Drawing:
    """Cw at the type's standard speed against tow speed."""
    return _scatter(frame, say, (_speed(say), _cw_standard(say)))


def shared_bend(frame: pl.DataFrame, say: Say) -> alt.Chart:
    """B of each boat: its own, drawn to its type's, and shared; `frame` is `Views.shared_bends`."""
    names = {code: say(f"code.{code}") for code in ("own", "partial", "shared")}
    legend = alt.Legend(labelExpr=f"({names})[datum.value] || datum.value")
    return (
        alt.Chart(frame)
        .mark_point(filled=True, size=60, opacity=0.85)
        .encode(
            number(alt.X, "b_m_s", say("b")),
            alt.Y("crew:N", title=say("boat")),
            colour("pooling", say("pooling"), legend=legend),
            shape("pooling", say("pooling"), legend=legend),
            tooltip=tips(("crew:N", say("boat")), ("b_m_s:Q", say("b"))),
        )
        .properties(width=360)
    )
