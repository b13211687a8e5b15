"""Figures of boat types: are equal boats equal?

Each is a scatter with a selection by dragging (`brush`, read by the page to fill the boat list), a
parameter `chosen` that the list sets, and points that link to their boat.
"""

import json
from typing import Any

import altair as alt
import polars as pl

from herijk.dashboards.figures.style import (
    OKABE_ITO,
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


def _pair(frame: pl.DataFrame, say: Say, axes: Axes) -> Drawing:
    """Two types side by side and methods one above the other, all on the same axes."""
    points = _points(frame, say, axes, {"color": alt.value(OKABE_ITO[0])})
    return points.properties(width=220, height=220).facet(
        row=alt.Row("method:N", title=None, header=_methods(say)),
        column=alt.Column("boat_type:N", title=None),
    )


def _methods(say: Say) -> alt.Header:
    return alt.Header(labelExpr=methods_named(say))


def _one_type(frame: pl.DataFrame, say: Say, axes: Axes, ends: tuple[str, str]) -> Drawing:
    """The boats of a type with their intervals, the fitted line, men and women apart."""
    (x, x_title), (y, y_title) = axes
    base = alt.Chart(frame)
    ink = alt.Scale(domain=["H", "D"], range=[OKABE_ITO[0], OKABE_ITO[3]])
    people = json.dumps({code: say(f"crew.{code}") for code in ("H", "D")})
    legend = alt.Legend(labelExpr=f"({people})[datum.value] || datum.value")
    crew = alt.Color("crew_class:N", title=say("class"), scale=ink, legend=legend)
    line = base.transform_regression(x, y).mark_line(color="black", strokeDash=[4, 3])
    layers = [line.encode(number(alt.X, x, x_title), number(alt.Y, y, y_title))]
    if ends[0]:
        bars = base.mark_rule(opacity=0.6)
        layers.append(
            bars.encode(
                number(alt.X, x, x_title),
                alt.Y(f"{ends[0]}:Q", title=y_title),
                alt.Y2(f"{ends[1]}:Q"),
                crew,
            )
        )
    shapes = alt.Scale(domain=["H", "D"], range=["circle", "triangle-up"])
    more = {
        "color": crew,
        "shape": alt.Shape("crew_class:N", title=say("class"), scale=shapes, legend=legend),
    }
    layers.append(_points(frame, say, axes, more))
    return alt.layer(*layers).properties(width=420, height=300)


def type_cw_against_weight(frame: pl.DataFrame, say: Say) -> Drawing:
    """Cw at the standard speed against weight, of one type."""
    return _one_type(frame, say, (_weight(say), _cw_standard(say)), ("", ""))


def type_cw_declared_against_speed(frame: pl.DataFrame, say: Say) -> Drawing:
    """Cw at the declared speed against that speed with its interval, of one type."""
    return _one_type(frame, say, (_speed(say), _cw(say)), ("cw_lo_kg_m", "cw_hi_kg_m"))


def _weight(say: Say) -> tuple[str, str]:
    return "weight_kg", say("weight")


def _speed(say: Say) -> tuple[str, str]:
    return "declared_speed_m_s", say("tow_speed")


def _b(say: Say) -> tuple[str, str]:
    return "b_m_s", say("b")


def _cw(say: Say) -> tuple[str, str]:
    return "cw_kg_m", say("cw_declared")


def _cw_standard(say: Say) -> tuple[str, str]:
    return "cw_standard_kg_m", say("cw_standard")


def b_against_weight(frame: pl.DataFrame, say: Say) -> Drawing:
    """B against weight; `frame` is `Views.type_boats` with `page`."""
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


def cw_against_weight(frame: pl.DataFrame, say: Say) -> Drawing:
    """Cw at the declared speed against weight."""
    return _scatter(frame, say, (_weight(say), _cw(say)))


def cw_against_speed(frame: pl.DataFrame, say: Say) -> Drawing:
    """Cw at the declared speed against that speed."""
    return _scatter(frame, say, (_speed(say), _cw(say)))


def pair_b_against_weight(frame: pl.DataFrame, say: Say) -> Drawing:
    """B against weight, two types side by side; `frame` holds boats of two types."""
    return _pair(frame, say, (_weight(say), _b(say)))


def pair_b_against_speed(frame: pl.DataFrame, say: Say) -> Drawing:
    """B against tow speed, two types side by side."""
    return _pair(frame, say, (_speed(say), _b(say)))


def pair_cw_against_weight(frame: pl.DataFrame, say: Say) -> Drawing:
    """Cw at the declared speed against weight, two types side by side."""
    return _pair(frame, say, (_weight(say), _cw(say)))


def pair_cw_against_speed(frame: pl.DataFrame, say: Say) -> Drawing:
    """Cw at the declared speed against that speed, two types side by side."""
    return _pair(frame, say, (_speed(say), _cw(say)))
