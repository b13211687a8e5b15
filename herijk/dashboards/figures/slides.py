"""The charts of the presentation of 24 January 2015, over all seasons and under every method.

Methods stand side by side on equal axes; men and women differ in shape; a tow made too slowly for
the common speed is open; a tow outside its type is named with its season and crew. Frames come from
`dashboards.slides`.
"""

from collections.abc import Callable
from typing import Final

import altair as alt
import polars as pl

from herijk.dashboards.figures.style import (
    GREY,
    OKABE_ITO,
    Drawing,
    colour,
    interval_kind,
    named,
    number,
    tips,
)
from herijk.dashboards.words import Say
from herijk.pipeline.consistency.compared import ROWED_RATIO

METHODS: Final = ["as-published", "corrected-2013", "rebased-2015", "rebased"]
"""The four that are compared, in the order of history; others come after."""

SIDE: Final = 190
QUANTITIES: Final = {
    "b": ("b_m_s", "b_lo_m_s", "b_hi_m_s"),
    "a": ("a_kg_m", "a_lo_kg_m", "a_hi_kg_m"),
    "cw": ("cw_standard_kg_m", "cw_standard_lo_kg_m", "cw_standard_hi_kg_m"),
}
EXPLAINING: Final = {
    "weight": "weight_kg",
    "speed": "declared_speed_m_s",
    "length": "waterline_length_m",
}
TITLES: Final = {
    "b_m_s": "b",
    "a_kg_m": "a",
    "cw_standard_kg_m": "cw_standard",
    "weight_kg": "weight",
    "declared_speed_m_s": "tow_speed",
    "waterline_length_m": "waterline_length",
}


def _by_method() -> alt.Column:
    return alt.Column("method:N", title=None, sort=METHODS)


def _crew(say: Say) -> tuple[alt.Color, alt.Shape]:
    """Men and women apart by colour and shape, in one legend."""
    people = f"{{'H': '{say('men')}', 'D': '{say('women')}'}}[datum.value]"
    title, legend = say("crew_class"), alt.Legend(labelExpr=people, orient="bottom")
    shapes = alt.Scale(domain=["H", "D"], range=["circle", "triangle-up"])
    inks = alt.Scale(domain=["H", "D"], range=[OKABE_ITO[0], OKABE_ITO[1]])
    return (
        alt.Color("crew_class:N", scale=inks, title=title, legend=legend),
        alt.Shape("crew_class:N", scale=shapes, title=title, legend=legend),
    )


def against(quantity: str, explaining: str) -> Callable[[pl.DataFrame, Say], Drawing]:
    """The figure of a quantity against what may explain it, types below each other.

    It draws rows of `kind` tow (of `compared_tows`, with `label`) and line (of `type_line_points`).
    """
    y, lo, hi = QUANTITIES[quantity]
    x = EXPLAINING[explaining]

    def figure(frame: pl.DataFrame, say: Say) -> Drawing:
        x_title, y_title = say(TITLES[x]), say(TITLES[y])
        tow = alt.Chart().transform_filter(
            f"datum.kind == 'tow' && isValid(datum.{x}) && isValid(datum.{y})"
        )
        line = alt.Chart().transform_filter(
            f"datum.kind == 'line' && datum.quantity == '{y}' && datum.explaining == '{x}'"
        )
        at, value = number(alt.X, x, x_title), number(alt.Y, y, y_title)
        by_class = alt.Detail("crew_class:N")
        ink, form = _crew(say)
        band = line.mark_area(color=GREY, opacity=0.18, clip=True).encode(
            number(alt.X, "x", x_title), alt.Y("lo:Q", title=y_title), alt.Y2("hi:Q"), by_class
        )
        drawn = line.mark_line(color=GREY, clip=True).encode(
            number(alt.X, "x", x_title), number(alt.Y, "y", y_title), by_class
        )
        bar = tow.transform_filter(f"isValid(datum.{hi})").mark_rule(opacity=0.35, clip=True)
        point = tow.mark_point(size=38, strokeWidth=1.2).encode(
            at,
            value,
            ink,
            form,
            fill=ink,
            fillOpacity=alt.condition("datum.beyond_curve", alt.value(0), alt.value(0.7)),
            tooltip=tips(
                ("label:N", say("tow")),
                (f"{x}:Q", x_title),
                (f"{y}:Q", y_title),
                ("deviation_sd:Q", say("column.deviation_sd")),
            ),
        )
        name = (
            tow.transform_filter("datum.outside")
            .mark_text(align="left", dx=5, dy=-4, fontSize=9, limit=110)
            .encode(at, value, text="label:N")
        )
        bars = bar.encode(
            at,
            alt.Y(f"{lo}:Q", title=y_title),
            alt.Y2(f"{hi}:Q"),
            ink,
            strokeDash=interval_kind(),
        )
        return (
            alt.layer(band, bars, drawn, point, name, data=frame)
            .properties(width=SIDE, height=SIDE)
            .facet(row=alt.Row("boat_type:N", title=None), column=_by_method())
        )

    return figure


def b_and_hull_speed(frame: pl.DataFrame, say: Say) -> Drawing:
    """B of every tow against length, with the line on which B is hull speed."""
    tow = alt.Chart().transform_filter("datum.kind == 'tow'")
    x = number(alt.X, "waterline_length_m", say("waterline_length"))
    ink = colour("boat_type", say("type"), legend=alt.Legend(orient="bottom"))
    points = (
        tow.transform_filter("isValid(datum.b_m_s)")
        .mark_point(size=30)
        .encode(
            x,
            number(alt.Y, "b_m_s", say("b")),
            ink,
            alt.Shape("boat_type:N", title=say("type")),
            tooltip=tips(
                ("label:N", say("tow")), ("b_m_s:Q", say("b")), ("b_hull_ratio:Q", "B / v")
            ),
        )
    )
    hull = tow.mark_line(color="black", strokeDash=[5, 3]).encode(
        x, number(alt.Y, "hull_speed_m_s", say("b")), order="waterline_length_m:Q"
    )
    return (
        alt.layer(points, hull, data=frame)
        .properties(width=SIDE, height=SIDE)
        .facet(column=_by_method())
    )


def towed_at(frame: pl.DataFrame, say: Say) -> Drawing:
    """Tow speed as part of hull speed, of every tow; grey is the 60-70 % of the presentation."""
    low, high = ROWED_RATIO
    zone = (
        alt.Chart(frame)
        .transform_aggregate(n="count()")
        .mark_rect(color=GREY, opacity=0.25)
        .encode(x=alt.datum(low), x2=alt.datum(high))
    )
    ink, form = _crew(say)
    points = (
        alt.Chart(frame)
        .transform_filter("datum.kind == 'tow' && datum.method == datum.newest_method")
        .mark_point(size=40, opacity=0.7)
        .encode(
            number(alt.X, "tow_hull_ratio", say("tow_hull_ratio")),
            alt.Y(
                "boat_type:N", title=say("type"), axis=alt.Axis(labelExpr=named(["unknown"], say))
            ),
            ink,
            form,
            tooltip=tips(("label:N", say("tow")), ("tow_hull_ratio:Q", say("tow_hull_ratio"))),
        )
    )
    return alt.layer(zone, points).properties(width=620, height=alt.Step(34))


def raced_beyond(frame: pl.DataFrame, say: Say) -> Drawing:
    """Power by a tow's own curve / by its type's bend, at the fastest speed that it raced."""
    base = alt.Chart().transform_filter("isValid(datum.power_ratio_raced)")
    y = alt.Y("label:N", title=say("tow"))
    ratio = say("power_ratio_raced")
    bar = base.mark_rule().encode(
        number(alt.X, "power_ratio_raced_lo", ratio), alt.X2("power_ratio_raced_hi:Q"), y
    )
    point = base.mark_point(filled=True, size=60).encode(
        number(alt.X, "power_ratio_raced", ratio),
        y,
        colour("speed_case", say("speed_case"), legend=alt.Legend(orient="bottom")),
        alt.Shape("speed_case:N", title=say("speed_case")),
        tooltip=tips(
            ("label:N", say("tow")),
            ("power_w:Q", say("power")),
            ("raced_power_w:Q", say("raced_power")),
            ("power_ratio_raced:Q", ratio),
        ),
    )
    one = alt.Chart().mark_rule(color=GREY, strokeDash=[3, 3]).encode(x=alt.datum(1.0))
    return (
        alt.layer(one, bar, point, data=frame)
        .properties(width=SIDE, height=alt.Step(16))
        .facet(column=_by_method())
    )


def boat_years(frame: pl.DataFrame, say: Say) -> Drawing:
    """Curves of all seasons of a boat on one pair of axes, before and after.

    `frame` holds `curve_points` with `season, crew, name` and `standard_speed_m_s`, the common
    speed, drawn as a line.
    """
    base = alt.Chart()
    ink = alt.Color(
        "season:O", title=say("season"), scale=alt.Scale(scheme="viridis"),
        legend=alt.Legend(orient="bottom"),
    )  # fmt: skip
    curve = base.mark_line(strokeWidth=2).encode(
        number(alt.X, "speed_m_s", say("speed")),
        number(alt.Y, "cw_kg_m", say("cw")),
        ink,
        alt.StrokeDash("crew:N", title=say("crew"), legend=alt.Legend(orient="bottom")),
        alt.Detail("tow_id:N"),
        tooltip=tips(("tow_id:N", say("tow")), ("season:O", say("season"))),
    )
    common = base.mark_rule(color=GREY, strokeDash=[3, 3]).encode(
        alt.X("mean(standard_speed_m_s):Q", title=say("speed"))
    )
    return (
        alt.layer(common, curve, data=frame)
        .properties(width=SIDE, height=SIDE)
        .facet(row=alt.Row("name:N", title=None), column=_by_method())
    )
