"""The charts of the presentation of 24 January 2015, over all seasons and under every method.

Methods stand side by side on equal axes, below each other where there is no room. Men and women
differ in shape. A tow made too slowly for the common speed is open, and a tow outside its type is
named with its season and crew. Frames come from `dashboards.slide_rows`.
"""

import json
from collections.abc import Callable
from typing import Any, Final

import altair as alt
import polars as pl

from dashboards import labels
from dashboards.colours import GREY
from dashboards.figures.style import (
    Drawing,
    colour,
    crews,
    interval_kind,
    named,
    number,
    tips,
)
from pipeline.consistency.compared import ROWED_RATIO
from pipeline.consistency.tow_speed import HIGH, LOW, MIDDLE
from pipeline.messages import Say, say
from pipeline.studies.claims import CHANNELS
from pipeline.studies.options import CHOICES, SPEED_NAMES, SPEEDS, TICKS

METHODS: Final = ("as-published", "corrected-2013", "rebased-2015", "rebased")
"""The four that are compared, in the order of history."""

OF_2014: Final = ("as-published-2014", "as-published", "rebased-2015", "rebased")
"""What was done to the tows of 2014: the correction of 2013 did not touch them."""

_ORDER: Final = ("as-published-2014", *METHODS)

CODES: Final = (
    *("unknown", *TICKS, *SPEEDS, *SPEED_NAMES, LOW, MIDDLE, HIGH),
    *CHOICES,
    *(f"channel.{name}" for name in CHANNELS),
)
"""Codes that the charts of the slides show in words."""

SIDE: Final = 190
SPACING: Final = 30
"""Between panels [px]: the last label of an axis keeps clear of the first of the next."""

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
    "b_m_s": labels.column("b_m_s"),
    "a_kg_m": labels.column("a_kg_m"),
    "cw_standard_kg_m": say("Cw at the standard speed [kg/m]"),
    "weight_kg": labels.column("weight_kg"),
    "declared_speed_m_s": say("Declared speed [m/s]"),
    "waterline_length_m": say("Waterline length [m]"),
}


def panels(chart: Any, say: Say, of: str = "", **look: Any) -> Drawing:
    """A chart per method; with a column `of`, such as the type, all methods of each of its values.

    Panels are wrapped, so that a page can put fewer in a row; their key sorts by that column, then
    by the method's place in history. `look` are `columns`, `width` and `height` of a panel.
    """
    look = {"columns": len(METHODS), "width": SIDE, "height": SIDE} | look
    place = f"indexof({json.dumps(_ORDER)}, datum.method)"
    value = f"datum.{of}" if of else "''"
    key = f"{value} + '|' + ({place} < 0 ? 9 : {place}) + '|' + datum.method"
    names = json.dumps({name: say(labels.method(name)) for name in _ORDER})
    first, method = (f"split(datum.value, '|')[{n}]" for n in (0, 2))
    label = f"({names})[{method}] || {method}"
    if of:
        label = f"{in_words(first, say)} + ' · ' + ({label})"
    header = alt.Header(labelExpr=label, labelLimit=260)
    sized = chart.properties(width=look["width"], height=look["height"])
    drawn: Drawing = (
        sized.transform_calculate(panel=key)
        .facet(alt.Facet("panel:N", title=None, header=header), columns=look["columns"])
        .properties(spacing=SPACING)
    )
    return drawn


def small(field: str, title: str) -> alt.X:
    """A quantity along a narrow panel: labels that keep apart."""
    axis = alt.Axis(tickCount=4, labelOverlap=True, labelFlush=False)
    return alt.X(f"{field}:Q", title=title, scale=alt.Scale(zero=False), axis=axis)


def in_words(value: str, say: Say) -> str:
    """A Vega expression that says what a code means; names stay as they are."""
    texts = {code: say(labels.code(code)) for code in CODES}
    return f"(({json.dumps(texts)})[{value}] || {value})"


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
        at, value = small(x, x_title), number(alt.Y, y, y_title)
        by_class = alt.Detail("crew_class:N")
        ink, form = crews(say)
        low, high = number(alt.Y, "seen_lo", y_title), alt.Y2("seen_hi:Q")
        band = (
            _within_reach(line, "lo", "hi")
            .mark_area(color=GREY, opacity=0.18)
            .encode(small("x", x_title), low, high, by_class)
        )
        drawn = line.mark_line(color=GREY, clip=True).encode(
            small("x", x_title), number(alt.Y, "y", y_title), by_class
        )
        bars = (
            _within_reach(tow.transform_filter(f"isValid(datum.{lo})"), lo, hi)
            .mark_rule(opacity=0.35)
            .encode(at, low, high, ink, strokeDash=interval_kind())
        )
        point = tow.mark_point(size=38, strokeWidth=1.2).encode(
            at,
            value,
            ink,
            form,
            fill=ink,
            fillOpacity=alt.condition("datum.beyond_curve", alt.value(0), alt.value(0.7)),
            tooltip=tips(
                say, "label:N", f"{x}:Q", f"{y}:Q", f"{lo}:Q", f"{hi}:Q", "deviation_sd:Q"
            ),
        )
        slow = tow.transform_filter("datum.slow").mark_circle(size=9, color="black", opacity=1)
        names = [
            name.encode(at, value, text="label:N")
            for name in _names(tow.transform_filter("datum.outside"), x, y)
        ]
        drawing = (
            alt.layer(band, bars, drawn, point, slow.encode(at, value), *names, data=frame)
            .transform_joinaggregate(top=f"max({y})", bottom=f"min({y})", groupby=["boat_type"])
            .transform_calculate(
                room=f"max({ROOM} * (datum.top - datum.bottom), {ROOM_OF_ONE} * datum.top)"
            )
        )
        return panels(drawing, say, "boat_type")

    return figure


LETTER: Final = 4.8
"""Mean width of a letter of a name [px]: its true width is not known before it is drawn."""


NAME_HEIGHT: Final = 10
"""Room that a name needs from top to bottom [px]."""


def _names(outliers: alt.Chart, x: str, y: str) -> list[alt.Chart]:
    """Names within their panel: the highest above its point, the lowest below, others beside.

    Points that lie together have their names below each other.
    """
    placed = outliers.transform_window(
        place="row_number()", sort=[alt.SortField(y, order="descending")], groupby=["panel"]
    ).transform_joinaggregate(named="count()", groupby=["panel"])
    at, end, wide = f"scale('x', datum.{x})", "range('x')[1]", f"{LETTER} * length(datum.label)"
    right, left = f"{at} + 7", f"{at} - 7 - {wide}"
    beside = "datum.place > 1 && datum.place < datum.named"
    begin = f"{beside} ? ({right} + {wide} < {end} ? {right} : {left}) : {at} - {wide} / 2"
    row = f"{NAME_HEIGHT} * (datum.place - (datum.named + 1) / 2)"
    others = f"{NAME_HEIGHT} / 2 * max(0, datum.named - 3)"
    look: dict[str, Any] = {
        "fontSize": 9,
        "align": "left",
        "dx": alt.ExprRef(f"clamp({begin}, 0, max(0, {end} - {wide})) - {at}"),
        "dy": alt.ExprRef(f"{beside} ? {row} : datum.place > 1 ? 11 + {others} : -9 - {others}"),
    }
    return [
        placed.mark_text(stroke="white", strokeWidth=3, opacity=0.8, **look),
        placed.mark_text(color="black", **look),
    ]


ROOM: Final = 0.25
"""How far an interval is drawn beyond the outermost points, of their range: one without an upper
end, as of B, would leave no room for the points."""

ROOM_OF_ONE: Final = 0.02
"""The same where there is no range, of the value."""


def _within_reach(chart: alt.Chart, lo: str, hi: str) -> alt.Chart:
    """With the ends of an interval as far as they are drawn; one without an upper end goes on."""
    top, bottom = "datum.top + datum.room", "datum.bottom - datum.room"
    return chart.transform_calculate(
        seen_lo=f"clamp(datum.{lo}, {bottom}, {top})",
        seen_hi=f"isValid(datum.{hi}) ? clamp(datum.{hi}, {bottom}, {top}) : {top}",
    )


def b_and_hull_speed(frame: pl.DataFrame, say: Say) -> Drawing:
    """B of every tow against length, with the line on which B is hull speed."""
    tow = alt.Chart().transform_filter("datum.kind == 'tow'")
    x = small("waterline_length_m", say("Waterline length [m]"))
    ink = colour("boat_type", say("Type"), legend=alt.Legend(orient="bottom"))
    points = (
        tow.transform_filter("isValid(datum.b_m_s)")
        .mark_point(size=30)
        .encode(
            x,
            number(alt.Y, "b_m_s", say(labels.column("b_m_s"))),
            ink,
            alt.Shape("boat_type:N", title=say("Type")),
            tooltip=tips(say, "label:N", "b_m_s:Q", "b_hull_ratio:Q"),
        )
    )
    hull = tow.mark_line(color="black", strokeDash=[5, 3]).encode(
        x,
        number(alt.Y, "hull_speed_m_s", say(labels.column("b_m_s"))),
        order="waterline_length_m:Q",
    )
    return panels(alt.layer(points, hull, data=frame), say)


def towed_at(frame: pl.DataFrame, say: Say) -> Drawing:
    """Tow speed as part of hull speed, of every tow; grey is the 60-70 % of the presentation."""
    low, high = ROWED_RATIO
    zone = (
        alt.Chart(frame)
        .transform_aggregate(n="count()")
        .mark_rect(color=GREY, opacity=0.25)
        .encode(x=alt.datum(low), x2=alt.datum(high))
    )
    ink, form = crews(say)
    points = (
        alt.Chart(frame)
        .transform_filter("datum.kind == 'tow' && datum.method == datum.newest_method")
        .mark_point(size=40, opacity=0.7)
        .encode(
            number(alt.X, "tow_hull_ratio", say("Tow speed / hull speed")),
            alt.Y(
                "boat_type:N", title=say("Type"), axis=alt.Axis(labelExpr=named(["unknown"], say))
            ),
            ink,
            form,
            tooltip=tips(say, "label:N", "tow_hull_ratio:Q"),
        )
    )
    return alt.layer(zone, points).properties(width=620, height=alt.Step(34))


def raced_beyond(frame: pl.DataFrame, say: Say) -> Drawing:
    """Power by a tow's own curve / by its type's bend, at the fastest speed that it raced."""
    base = alt.Chart().transform_filter("isValid(datum.power_ratio_raced)")
    y = alt.Y("label:N", title=say("Tow"))
    ratio = say("Power: own curve / type's curve")
    legend = alt.Legend(orient="bottom", labelExpr=in_words("datum.value", say))
    bar = base.mark_rule().encode(
        small("power_ratio_raced_lo", ratio), alt.X2("power_ratio_raced_hi:Q"), y
    )
    point = base.mark_point(filled=True, size=60).encode(
        small("power_ratio_raced", ratio),
        y,
        colour("speed_case", say("Tow speed by hull speed"), legend=legend),
        alt.Shape("speed_case:N", title=say("Tow speed by hull speed"), legend=legend),
        tooltip=tips(
            say,
            "label:N",
            ("power_w:Q", say("Power when towed [W]")),
            "raced_power_w:Q",
            "power_ratio_raced:Q",
        ),
    )
    one = alt.Chart().mark_rule(color=GREY, strokeDash=[3, 3]).encode(x=alt.datum(1.0))
    drawing = alt.layer(one, bar, point, data=frame)
    return panels(drawing, say, columns=2, width=300, height=alt.Step(16))


def boat_years(frame: pl.DataFrame, say: Say) -> Drawing:
    """Curves of all seasons of a boat on one pair of axes, before and after.

    `frame` holds `curve_points` with `season, crew, name` and `standard_speed_m_s`, the common
    speed, drawn as a line.
    """
    base = alt.Chart()
    ink = alt.Color(
        "season:O", title=say(labels.column("season")), scale=alt.Scale(scheme="viridis"),
        legend=alt.Legend(orient="bottom"),
    )  # fmt: skip
    curve = base.mark_line(strokeWidth=2).encode(
        small("speed_m_s", say("Speed [m/s]")),
        number(alt.Y, "cw_kg_m", say("Cw [kg/m]")),
        ink,
        alt.StrokeDash("crew:N", title=say("Crew"), legend=alt.Legend(orient="bottom")),
        alt.Detail("tow_id:N"),
        tooltip=tips(say, "tow_id:N", "season:O"),
    )
    common = base.mark_rule(color=GREY, strokeDash=[3, 3]).encode(
        alt.X("mean(standard_speed_m_s):Q", title=say("Speed [m/s]"))
    )
    return panels(alt.layer(common, curve, data=frame), say, "name")
