"""What the figures share: colours, shapes, sizes, titles, and links to a boat."""

import json
from collections.abc import Iterable, Sequence
from typing import Any, Final

import altair as alt
import polars as pl

from dashboards import labels
from pipeline.messages import Say
from pipeline.method.definition import COMPLETE, RUNS_ALONE, shipped_method, shipped_methods
from pipeline.register.register import draft_name

OKABE_ITO: Final = (
    "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#999999",
)  # fmt: skip
"""Okabe and Ito (2008), dark ones first; yellow is left out, it cannot be seen on white."""

SHAPES: Final = ("circle", "square", "triangle-up", "diamond", "cross", "triangle-down")
GREY: Final = "#666666"
WIDTH: Final = 620
HEIGHT: Final = 320

Drawing = alt.Chart | alt.LayerChart | alt.FacetChart
"""What a figure returns; Altair itself does not say which of them."""

OUT: Final = OKABE_ITO[0]
BACK: Final = OKABE_ITO[1]


def colour(field: str, title: str, **more: Any) -> alt.Color:
    """A category by colour."""
    return alt.Color(f"{field}:N", title=title, scale=alt.Scale(range=list(OKABE_ITO)), **more)


def crews(say: Say) -> tuple[alt.Color, alt.Shape]:
    """Men and women apart by colour and shape, in one legend."""
    people = f"{{'H': '{say(labels.crew('H'))}', 'D': '{say(labels.crew('D'))}'}}[datum.value]"
    title, legend = say("Crew"), alt.Legend(labelExpr=people, orient="bottom")
    shapes = alt.Scale(domain=["H", "D"], range=["circle", "triangle-up"])
    inks = alt.Scale(domain=["H", "D"], range=[OKABE_ITO[0], OKABE_ITO[1]])
    return (
        alt.Color("crew_class:N", scale=inks, title=title, legend=legend),
        alt.Shape("crew_class:N", scale=shapes, title=title, legend=legend),
    )


def methods(say: Say) -> tuple[alt.Color, alt.Shape]:
    """A method by colour and shape: every method that ships has the same in every figure.

    Others that the data hold have what follows, as on the workbench. Of all that have a look, the
    legend names those that are drawn, which stand side by side.
    """
    known = alt.DomainUnionWith(unionWith=list(shipped_methods()))
    legend = alt.Legend(values=alt.ExprRef("domain('xOffset')"), labelExpr=methods_named(say))
    inks, shapes = (alt.Scale(domain=known, range=list(looks)) for looks in (OKABE_ITO, SHAPES))
    look: dict[str, Any] = {"title": say("Method"), "sort": None, "legend": legend}
    return alt.Color("method:N", scale=inks, **look), alt.Shape("method:N", scale=shapes, **look)


def kinds(field: str, title: str, **more: Any) -> tuple[alt.Color, alt.Shape]:
    """A category by colour and, for print without colour, by shape; both share one legend."""
    shapes = alt.Scale(range=list(SHAPES))
    return colour(field, title, **more), alt.Shape(f"{field}:N", title=title, scale=shapes, **more)


def number(channel: Any, field: str, title: str, zero: bool = False, **more: Any) -> Any:
    """A quantity on an axis that need not begin at zero; labels below it keep apart."""
    across = {"axis": alt.Axis(tickCount=8)} if channel is alt.X else {}
    return channel(f"{field}:Q", title=title, scale=alt.Scale(zero=zero), **across | more)


SCENARIO: Final = "werkbank"
"""The method that is made on the workbench."""


def methods_named(say: Say) -> str:
    """A Vega expression that gives a method that ships, or the workbench's, its name in words."""
    texts = {name: say(labels.method(name)) for name in (*shipped_methods(), SCENARIO)}
    return f"({json.dumps(texts)})[datum.value] || datum.value"


def editions_legend(say: Say) -> alt.Legend:
    """A legend of editions: drafts by the name of their method in words."""
    texts = {
        draft_name(name): f"{say('draft')}: {say(labels.method(name))}"
        for name in (*shipped_methods(), SCENARIO)
    }
    return alt.Legend(labelExpr=f"({json.dumps(texts)})[datum.value] || datum.value")


def type_legend(say: Say, **more: Any) -> alt.Legend:
    """A legend of boat types, of which one is not known."""
    return alt.Legend(labelExpr=named(["unknown"], say), **more)


def tips(say: Say, *shown: str | tuple[str, str]) -> list[alt.Tooltip]:
    """Tooltips of `field:type`, numbers with five digits.

    Each is called as its column is in tables, unless a title is given with it.
    """
    titled = [one if isinstance(one, tuple) else (one, _column(one, say)) for one in shown]
    return [
        alt.Tooltip(field, title=title, format=".5~g" if field.endswith(":Q") else alt.Undefined)
        for field, title in titled
    ]


def _column(field: str, say: Say) -> str:
    return labels.unbroken(say(labels.column(field.partition(":")[0])))


def at_one(frame: pl.DataFrame, channel: str) -> alt.Chart:
    """A line at 1 along an axis of ratios."""
    line = alt.Chart(frame).mark_rule(color=GREY, strokeDash=[4, 3])
    return line.encode(**{channel: alt.datum(1.0)})


def by_method(
    base: alt.Chart,
    say: Say,
    value: tuple[str, str],
    ends: tuple[str, str],
    more: Sequence[str] = (),
    zero: bool = False,
    dash: alt.StrokeDash | None = None,
) -> list[alt.Chart]:
    """A value with its interval for every method, side by side: a bar and a point.

    Args:
        base: the chart with its x encoded.
        say: gives texts.
        value: column of the point, and the title of the y axis.
        ends: columns of the lower and upper end of the bar.
        more: columns that the tooltip shows besides, as `field:type`.
        zero: whether the y axis begins at zero.
        dash: how the bar is drawn; `interval_dash` where intervals differ in kind.
    """
    (field, title), (low, high) = value, ends
    beside = base.encode(xOffset="method:N")
    # The bar takes the colours of the point: given twice, colour and shape would have two legends.
    bar = beside.mark_rule(strokeWidth=2).encode(
        number(alt.Y, low, title, zero), alt.Y2(f"{high}:Q"), alt.Color("method:N")
    )
    if dash is not None:
        bar = bar.encode(dash)
    point = beside.mark_point(filled=True, size=65, opacity=1).encode(
        number(alt.Y, field, title, zero),
        *methods(say),
        tooltip=tips(say, "method:N", *more, (f"{field}:Q", title), f"{low}:Q", f"{high}:Q"),
    )
    return [bar, point]


def interval_kind() -> Any:
    """Full or dashed as `interval_dash`, for rows that have their `method` alone."""
    names = json.dumps([n for n in shipped_methods() if shipped_method(n).interval == RUNS_ALONE])
    runs_alone = alt.when(f"indexof({names}, datum.method) >= 0")
    return runs_alone.then(alt.value([3, 2])).otherwise(alt.value([1, 0]))


def interval_dash(say: Say) -> alt.StrokeDash:
    """Full for a 95 % interval, dashed for the spread of the runs alone; `interval` says which."""
    return alt.StrokeDash(
        "interval:N",
        title=say(labels.column("interval")),
        scale=alt.Scale(domain=[COMPLETE, RUNS_ALONE], range=[[1, 0], [4, 3]]),
        legend=alt.Legend(
            labelExpr=named([COMPLETE, RUNS_ALONE], say), labelLimit=400, orient="bottom"
        ),
    )


def named(codes: Iterable[str], say: Say) -> str:
    """A Vega expression that gives codes on an axis their text, and leaves others as they are."""
    texts = {code: say(labels.code(code)) for code in codes}
    return f"({json.dumps(texts)})[datum.value] || datum.value"
