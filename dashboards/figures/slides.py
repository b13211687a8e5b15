"""The charts of the presentation of 24 January 2015: facets of the one scatter.

What a slide adds to the scatter lies beneath its points: intervals, the fitted line, hull speed.
"""

from typing import Final

import altair as alt
import polars as pl

from dashboards import labels
from dashboards.figures import style
from dashboards.figures.charts import FACET_WIDTH, Figure, scatter
from dashboards.figures.style import (
    GREY,
    Column,
    Drawing,
    interval_kind,
    methods_named,
    number,
    tips,
)
from pipeline.consistency.compared import ROWED_RATIO
from pipeline.messages import Say

METHOD: Final = ("method", methods_named)
"""A panel for each method."""

ENDS: Final = {
    "a_kg_m": ("a_lo_kg_m", "a_hi_kg_m"),
    "b_m_s": ("b_lo_m_s", "b_hi_m_s"),
    "cw_standard_kg_m": ("cw_standard_lo_kg_m", "cw_standard_hi_kg_m"),
}
"""The columns of the interval of each quantity."""

PAIRS: Final = {
    "cw_weight": ("cw", "weight"),
    "cw_speed": ("cw", "speed"),
    "b_weight": ("b", "weight"),
    "b_speed": ("b", "speed"),
    "a_weight": ("a", "weight"),
}
"""What is drawn against what, by the name of the figure."""


def against(quantity: Column, explaining: Column) -> Figure:
    """A quantity of the tows of a type against what may explain it, with the line that fits best.

    It draws tows of `compared_tows` with `label`, and rows of `type_line_points`.
    """
    (y, title), x = quantity, explaining[0]
    lo, hi = ENDS[y]

    def beneath(say: Say) -> list[alt.Chart]:
        x_title, y_title, crew = say(explaining[1]), say(title), alt.Detail("crew_class:N")
        fitted = alt.Chart().transform_filter(
            f"datum.quantity == '{y}' && datum.explaining == '{x}'"
        )
        tow = alt.Chart().transform_filter(f"isValid(datum.{x}) && isValid(datum.{lo})")
        at, value = number(alt.X, "x", x_title), number(alt.Y, "y", y_title)
        ends = number(alt.Y, "seen_lo", y_title), alt.Y2("seen_hi:Q")
        band = _seen(fitted, y, "lo", "hi").mark_area(color=GREY, opacity=0.18)
        bar = _seen(tow, y, lo, hi).mark_rule(opacity=0.35)
        own = number(alt.X, f"{x}_seen", x_title), alt.Color("crew_class:N")
        return [
            band.encode(at, *ends, crew),
            fitted.mark_line(color=GREY, clip=True).encode(at, value, crew),
            bar.encode(*own, *ends, strokeDash=interval_kind()),
            _names(x, y),
        ]

    shown = ("label:N", f"{x}:Q", f"{y}:Q", f"{lo}:Q", f"{hi}:Q")
    return scatter(explaining, quantity, style.crews, shown, facet=METHOD, beneath=beneath)


def _seen(chart: alt.Chart, y: str, lo: str, hi: str) -> alt.Chart:
    """With an interval as far as the axis reaches; one without an upper end reaches its edge."""
    low, high = f"datum.{y}_lowest", f"datum.{y}_highest"
    return chart.transform_calculate(
        seen_lo=f"clamp(datum.{lo}, {low}, {high})",
        seen_hi=f"isValid(datum.{hi}) ? clamp(datum.{hi}, {low}, {high}) : {high}",
    )


def _names(x: str, y: str) -> alt.Chart:
    """Boat, crew and season of tows outside their type, towards the middle of the panel."""
    is_right = f"scale('x', datum.{x}_seen) > range('x')[1] / 2"
    return (
        alt.Chart()
        .transform_filter(f"datum.outside && isValid(datum.{y})")
        .mark_text(fontSize=10, dy=-9, align=alt.ExprRef(f"{is_right} ? 'right' : 'left'"))
        .encode(alt.X(f"{x}_seen:Q"), alt.Y(f"{y}_seen:Q"), text="label:N")
    )


def b_and_hull_speed(length: Column, b: Column) -> Figure:
    """B of every tow against length, with the line on which B is hull speed."""

    def hull(say: Say) -> list[alt.Chart]:
        return [_hull_speed("hull_speed_m_s", length, b, say)]

    shown = ("label:N", f"{b[0]}:Q", "b_hull_ratio:Q")
    return scatter(length, b, style.crews, shown, facet=METHOD, beneath=hull)


def towed_at(length: Column, speed: Column) -> Figure:
    """Tow speed against length; the lines are the parts of hull speed at which crews row."""

    def rowed(say: Say) -> list[alt.Chart]:
        return [
            _hull_speed(f"hull_{100 * ratio:.0f}", length, speed, say).transform_calculate(
                **{f"hull_{100 * ratio:.0f}": f"{ratio} * datum.hull_speed_m_s"}
            )
            for ratio in ROWED_RATIO
        ]

    shown = ("label:N", f"{speed[0]}:Q", "tow_hull_ratio:Q")
    return scatter(length, speed, style.crews, shown, beneath=rowed, height=320)


def _hull_speed(field: str, x: Column, y: Column, say: Say) -> alt.Chart:
    line = alt.Chart().mark_line(color="black", strokeDash=[5, 3])
    return line.encode(
        number(alt.X, x[0], say(x[1])), number(alt.Y, field, say(y[1])), order=f"{x[0]}:Q"
    )


def boat_years(frame: pl.DataFrame, say: Say) -> Drawing:
    """Curves of all seasons of a boat, a panel for each method.

    `frame` holds `curve_points` with `season, crew`.
    """
    shades = alt.Scale(scheme="viridis")
    header = alt.Header(labelExpr=methods_named(say), labelLimit=0)
    curve = (
        alt.Chart(frame)
        .mark_line(strokeWidth=2)
        .encode(
            number(alt.X, "speed_m_s", say("Speed [m/s]")),
            number(alt.Y, "cw_kg_m", say("Cw [kg/m]")),
            alt.Color("season:O", title=say(labels.column("season")), scale=shades),
            alt.StrokeDash("crew:N", title=say("Crew")),
            alt.Detail("tow_id:N"),
            tooltip=tips(say, "tow_id:N", "season:O"),
        )
        .properties(width=FACET_WIDTH, height=240)
    )
    drawn: Drawing = curve.facet(alt.Facet("method:N", title=None, header=header), columns=2)
    return drawn
