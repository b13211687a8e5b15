"""The charts of the presentation of 24 January 2015: B and Cw of a type, a panel per method.

Beneath the points of the one scatter lie their intervals and the fitted line of each class.
"""

from typing import Final

import altair as alt

from dashboards.figures import style
from dashboards.figures.charts import Figure, scatter
from dashboards.figures.style import GREY, Column, interval_kind, methods_named, number
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
    "b_weight": ("b_m_s", "weight_kg"),
    "cw_weight": ("cw_standard_kg_m", "weight_kg"),
    "b_speed": ("b_m_s", "declared_speed_m_s"),
    "cw_speed": ("cw_standard_kg_m", "declared_speed_m_s"),
}
"""What is drawn against what on the page of a type, by the name of the figure, in order."""


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
    """Name boat, crew and season of tows that stand out in Cw, towards the middle of the panel."""
    is_right = f"scale('x', datum.{x}_seen) > range('x')[1] / 2"
    return (
        alt.Chart()
        .transform_filter(f"datum.cw_outside && isValid(datum.{y})")
        .mark_text(fontSize=10, dy=-9, align=alt.ExprRef(f"{is_right} ? 'right' : 'left'"))
        .encode(alt.X(f"{x}_seen:Q"), alt.Y(f"{y}_seen:Q"), text="label:N")
    )
