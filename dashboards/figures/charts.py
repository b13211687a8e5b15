"""The kinds of chart of which the figures are made: scatter, groups, bars, curves.

Each function makes a figure: it is given the names of columns and says how they are drawn, and the
figure takes a frame that has them, and the language.
"""

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Final

import altair as alt
import polars as pl

from dashboards.figures.style import (
    GREY,
    HEIGHT,
    OKABE_ITO,
    WIDTH,
    Column,
    Drawing,
    Look,
    at_one,
    interval_kind,
    methods,
    named,
    number,
    tips,
)
from pipeline.messages import Say, say

Figure = Callable[[pl.DataFrame, Say], Drawing]
Label = Callable[[Say], str]

SPEED: Final = say("Speed through water [m/s]")
CW: Final = say("Cw [kg/m]")
CHANGE: Final = say("Cw after / Cw before")
SPREAD: Final = say("Standard deviation / Cw")
Marks = Callable[[Say], Sequence[alt.Chart]]
BULK: Final = 2.0
"""Axes reach so many interquartile ranges beyond the quartiles; points further out are marked at
the edge, so that one boat cannot squeeze all others."""

FACET_WIDTH: Final = 280


def scatter(
    x: Column,
    y: Column,
    look: Look,
    tip: Sequence[str],
    *,
    facet: tuple[str, Label] | None = None,
    line: str = "",
    brush: bool = False,
    height: int = 240,
    beneath: Marks = lambda _: (),
) -> Figure:
    """Points of one quantity against another, which lead to the `page` of their boat.

    A point that is `beyond_curve` is open.

    Args:
        x: the quantity along the axis at the bottom.
        y: the quantity along the axis at the side.
        look: what tells points apart.
        tip: columns that pointing at a point shows, as `field:type`.
        facet: a column of which each value has a panel, and an expression for its title.
        line: `same`, where x and y are equal; `x` or `y` at one; none.
        brush: whether boats can be chosen by dragging, as `brush`, and one stands out, as `chosen`.
        height: of the chart or of each panel [px].
        beneath: other marks of the same axes, beneath the points.
    """
    (x_field, x_title), (y_field, y_title) = x, y
    known = f"isValid(datum.{x_field}) && isValid(datum.{y_field})"

    def figure(frame: pl.DataFrame, say: Say) -> Drawing:
        across = number(alt.X, f"{x_field}_seen", say(x_title))
        up = number(alt.Y, f"{y_field}_seen", say(y_title))
        looks = look(say)
        point = (
            alt.Chart()
            .transform_filter(known)
            .mark_point(cursor="pointer", strokeWidth=1.5)
            .encode(across, up, *looks, fill=looks[0], href="page:N", tooltip=tips(say, *tip))
            .encode(fillOpacity=alt.condition("datum.beyond_curve", alt.value(0), alt.value(1)))
        )
        if brush:
            dragged = alt.selection_interval(name="brush")
            point = point.encode(
                size=alt.condition("datum.fsn_no == chosen", alt.value(320), alt.value(70)),
                opacity=alt.condition(dragged, alt.value(0.9), alt.value(0.2)),
            ).add_params(dragged, alt.param(name="chosen", value=""))
        else:
            point = point.encode(size=alt.value(60), opacity=alt.value(0.85))
        layers = [*_lines(line, x_field), *beneath(say), point, *_far(x_field, y_field)]
        drawing = alt.layer(*layers, data=frame).properties(height=height)
        whole = _panels(drawing, facet, say) if facet else drawing.properties(width=WIDTH)
        return _within_bulk(whole, x_field, y_field)

    return figure


def _within_bulk(chart: Drawing, *fields: str) -> Drawing:
    """With each quantity as `_seen`: as it is, or at the edge of where most values are.

    That edge is `_lowest` and `_highest`.
    """
    quartiles: dict[str, Any] = {}
    known: dict[str, str] = {}
    for field in fields:
        q1, q3 = f"datum.{field}_q1", f"datum.{field}_q3"
        reach = f"({q3} > {q1} ? {BULK} * ({q3} - {q1}) : 0.2 * abs({q1}))"
        quartiles |= {f"{field}_{q}": f"{q}({field})" for q in ("q1", "q3")}
        known |= {f"{field}_lowest": f"{q1} - {reach}", f"{field}_highest": f"{q3} + {reach}"}
        seen = f"clamp(datum.{field}, datum.{field}_lowest, datum.{field}_highest)"
        known[f"{field}_seen"] = seen
    return chart.transform_joinaggregate(**quartiles).transform_calculate(**known)


def _far(x: str, y: str) -> list[alt.Chart]:
    """The true value of what is drawn at an edge, beside it."""
    marks = []
    for field, (low, high) in ((x, ("\u25c2 ", " \u25b8")), (y, ("\u25be ", "\u25b4 "))):
        shown = f"format(datum.{field}, '.3~g')"
        above = f"{shown} + '{high}'" if field == x else f"'{high}' + {shown}"
        text = f"datum.{field} > datum.{field}_seen ? {above} : '{low}' + {shown}"
        known = f"isValid(datum.{x}) && isValid(datum.{y})"
        marks.append(
            alt.Chart()
            .transform_filter(f"{known} && abs(datum.{field} - datum.{field}_seen) > 1e-9")
            .transform_calculate(far=text)
            .mark_text(fontSize=10, dy=-10, color=GREY)
            .encode(alt.X(f"{x}_seen:Q"), alt.Y(f"{y}_seen:Q"), alt.Text("far:N"))
        )
    return marks


def _lines(line: str, x: str) -> list[alt.Chart]:
    if line == "same":
        same = alt.Chart().mark_line(color=GREY, strokeDash=[4, 3])
        return [same.encode(alt.X(f"{x}_seen:Q"), alt.Y(f"{x}_seen:Q"))]
    return [at_one(channel) for channel in line]


def _panels(drawing: Any, facet: tuple[str, Label], say: Say) -> Drawing:
    field, label = facet
    header = alt.Header(labelExpr=label(say), labelLimit=0)
    faceted: alt.FacetChart = drawing.properties(width=FACET_WIDTH).facet(
        alt.Facet(f"{field}:N", title=None, header=header), columns=2
    )
    return faceted


def by_group(
    group: str,
    value: Column,
    ends: tuple[str, str] | None = None,
    *,
    tip: Sequence[str] = (),
    codes: Iterable[str] = (),
    one: bool = False,
    zero: bool = False,
    dashed: bool = False,
    facet: tuple[str, Label] | None = None,
    beside: Marks = lambda _: (),
) -> Figure:
    """A value of every method, side by side, for each season, era or tow, with its interval.

    Args:
        group: the column along the axis.
        value: the column of the point.
        ends: columns of the lower and upper end of the bar.
        tip: columns that the tooltip shows besides, as `field:type`.
        codes: of the groups, which are shown in words.
        one: whether there is a line at 1.
        zero: whether the axis begins at zero.
        dashed: whether a bar is dashed where it is the spread of the runs alone.
        facet: a column of which each value has a panel, and an expression for its title.
        beside: other marks of the same axes.
    """
    (field, title), known = value, list(codes)

    def figure(frame: pl.DataFrame, say: Say) -> Drawing:
        axis = alt.Axis(labelExpr=named(known, say), labelAngle=-45 if group == "tow" else 0)
        base = alt.Chart().encode(alt.X(f"{group}:O", title=None, axis=axis), xOffset="method:N")
        shown = tips(say, "method:N", *tip, (f"{field}:Q", say(title)))
        point = base.mark_point(filled=True, size=65, opacity=1, cursor="pointer").encode(
            number(alt.Y, field, say(title), zero), *methods(say), href="page:N", tooltip=shown
        )
        layers = [at_one("y")] if one else []
        if ends:
            # The bar takes the colours of the point: given twice, there would be two legends.
            bar = base.mark_rule(strokeWidth=2).encode(
                number(alt.Y, ends[0], say(title), zero), alt.Y2(f"{ends[1]}:Q"),
                alt.Color("method:N"),
            )  # fmt: skip
            layers.append(bar.encode(strokeDash=interval_kind()) if dashed else bar)
        layers += [point, *beside(say)]
        drawing = alt.layer(*layers, data=frame).properties(height=HEIGHT)
        return _panels(drawing, facet, say) if facet else drawing.properties(width=WIDTH)

    return figure


def bars(
    name: str,
    value: Column,
    codes: Iterable[str],
    ends: tuple[str, str] | None = None,
) -> Figure:
    """A value per name, the largest first: a bar, or where it has ends a point with its interval.

    Args:
        name: the column of the names.
        value: the column of the values; with ends they are ratios.
        codes: of the names, which are shown in words.
        ends: columns of the lower and upper end.
    """
    (field, title), known = value, list(codes)

    def figure(frame: pl.DataFrame, say: Say) -> Drawing:
        axis = alt.Axis(labelExpr=named(known, say), labelLimit=0)
        down = alt.Y(f"{name}:N", title=None, sort="-x", axis=axis)
        shown = tips(say, f"{name}:N", f"{field}:Q")
        base = alt.Chart().encode(down)
        if ends is None:
            across = alt.X(f"{field}:Q", title=say(title))
            layers = [base.mark_bar(color=OKABE_ITO[0]).encode(across, tooltip=shown)]
        else:
            low = number(alt.X, ends[0], say(title))
            rule = base.mark_rule(strokeWidth=3, color=OKABE_ITO[0])
            point = base.mark_point(filled=True, size=80, color="black", opacity=1)
            layers = [
                at_one("x"),
                rule.encode(low, alt.X2(f"{ends[1]}:Q")),
                point.encode(number(alt.X, field, say(title)), tooltip=shown),
            ]
        return alt.layer(*layers, data=frame).properties(height=alt.Step(24), width=WIDTH)

    return figure


def curves(lines: Look, points: Look) -> Figure:
    """Curves of Cw against speed with bands, run points and the interval at the declared speed.

    The figure takes rows of `kind` line, point and declared, with `speed_m_s, cw_kg_m, cw_lo_kg_m,
    cw_hi_kg_m`; points also with `run, used`. A point that does not count is open.

    Args:
        lines: what tells curves apart.
        points: what tells points apart.
    """

    def figure(frame: pl.DataFrame, say: Say) -> Drawing:
        x, y = number(alt.X, "speed_m_s", say(SPEED)), number(alt.Y, "cw_kg_m", say(CW))
        low, high = alt.Y("cw_lo_kg_m:Q", title=say(CW)), alt.Y2("cw_hi_kg_m:Q")
        line, declared, point = (
            alt.Chart().transform_filter(f"datum.kind == '{kind}'")
            for kind in ("line", "declared", "point")
        )
        ink, form = lines(say), points(say)
        tip = tips(say, "run:O", "speed_m_s:Q", ("cw_kg_m:Q", say(CW)))
        return alt.layer(
            line.mark_area(opacity=0.2).encode(x, low, high, *ink[:1]),
            line.mark_line(strokeWidth=2).encode(x, y, *ink),
            declared.mark_rule(strokeWidth=3).encode(
                x, low, high, *ink[:1], strokeDash=interval_kind()
            ),
            declared.mark_point(shape="stroke", size=300, strokeWidth=2).encode(x, y, *ink[:1]),
            point.mark_point(size=80, strokeWidth=2).encode(
                x,
                y,
                *form,
                fillOpacity=alt.condition("datum.used", alt.value(0.85), alt.value(0)),
                fill=form[0],
                tooltip=tip,
            ),
            data=frame,
        ).properties(width=WIDTH, height=HEIGHT)

    return figure
