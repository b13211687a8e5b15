"""Figures of boat types: are equal boats equal?

Each is a scatter with a selection by dragging (`brush`, read by the page to fill the boat list), a
parameter `chosen` that the list sets, and points that link to their boat.
"""

import altair as alt
import polars as pl

from dashboards.figures.style import colour, number, shape, tips
from dashboards.words import Say


def _scatter(frame: pl.DataFrame, say: Say, x: tuple[str, str], y: tuple[str, str]) -> alt.Chart:
    brush = alt.selection_interval(name="brush")
    chosen = alt.param(name="chosen", value="")
    is_chosen = "datum.fsn_no == chosen"
    return (
        alt.Chart(frame)
        .mark_point(filled=True, strokeWidth=2, cursor="pointer")
        .encode(
            number(alt.X, *x),
            number(alt.Y, *y),
            colour("boat_type", say("type"), legend=alt.Legend(orient="top", columns=3)),
            shape("boat_type", say("type"), legend=alt.Legend(orient="top", columns=3)),
            href="page:N",
            size=alt.condition(is_chosen, alt.value(320), alt.value(70)),
            opacity=alt.condition(brush, alt.value(0.9), alt.value(0.2)),
            tooltip=tips(
                ("name:N", say("name")),
                ("fsn_no:N", "FSN"),
                ("boat_type:N", say("type")),
                ("season:O", say("season")),
                (f"{x[0]}:Q", x[1]),
                (f"{y[0]}:Q", y[1]),
            ),
        )
        .add_params(brush, chosen)
        .properties(width=360, height=280)
    )


def b_against_weight(frame: pl.DataFrame, say: Say) -> alt.Chart:
    """B against weight; `frame` is `Views.type_boats` with `page`."""
    return _scatter(frame, say, ("weight_kg", say("weight")), ("b_m_s", say("b")))


def b_against_speed(frame: pl.DataFrame, say: Say) -> alt.Chart:
    """B against tow speed."""
    return _scatter(frame, say, ("declared_speed_m_s", say("tow_speed")), ("b_m_s", say("b")))


def a_against_weight(frame: pl.DataFrame, say: Say) -> alt.Chart:
    """A against weight."""
    return _scatter(frame, say, ("weight_kg", say("weight")), ("a_kg_m", say("a")))


def cw_standard_against_weight(frame: pl.DataFrame, say: Say) -> alt.Chart:
    """Cw at the type's standard speed against weight."""
    y = ("cw_standard_kg_m", say("cw_standard"))
    return _scatter(frame, say, ("weight_kg", say("weight")), y)


def cw_standard_against_speed(frame: pl.DataFrame, say: Say) -> alt.Chart:
    """Cw at the type's standard speed against tow speed."""
    y = ("cw_standard_kg_m", say("cw_standard"))
    return _scatter(frame, say, ("declared_speed_m_s", say("tow_speed")), y)


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


def cw_against_weight(frame: pl.DataFrame, say: Say) -> alt.Chart:
    """Cw at the declared speed against weight."""
    return _scatter(frame, say, ("weight_kg", say("weight")), ("cw_kg_m", say("cw_declared")))


def cw_against_speed(frame: pl.DataFrame, say: Say) -> alt.Chart:
    """Cw at the declared speed against that speed."""
    x = ("declared_speed_m_s", say("tow_speed"))
    return _scatter(frame, say, x, ("cw_kg_m", say("cw_declared")))
