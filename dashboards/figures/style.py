"""What the figures share: colours, shapes, sizes, titles, and links to a boat."""

import json
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Final

import altair as alt

from dashboards import labels
from pipeline.messages import Say, Sentence
from pipeline.method.definition import RUNS_ALONE
from pipeline.method.reading import list_shipped_methods, read_shipped_method

OKABE_ITO: Final = (
    "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#999999",
)  # fmt: skip
"""Okabe and Ito (2008), dark ones first; yellow is left out, it cannot be seen on white."""
GREY: Final = "#666666"
SHAPES: Final = ("circle", "square", "triangle-up", "diamond", "cross", "triangle-down")
WIDTH: Final = 620
HEIGHT: Final = 320

Drawing = alt.Chart | alt.LayerChart | alt.FacetChart | alt.VConcatChart
"""What a figure returns; Altair itself does not say which of them."""

Look = Callable[[Say], Sequence[Any]]
"""Encodings that tell categories apart by colour and, for print without colour, by shape."""

Column = tuple[str, Sentence]
"""A field and the title of its axis."""

SCENARIO: Final = "werkbank"
"""The method that is made on the workbench."""


def _both(field: str, inks: alt.Scale, shapes: alt.Scale, **more: Any) -> Sequence[Any]:
    """A category by colour and shape, which share one legend."""
    return (
        alt.Color(f"{field}:N", scale=inks, **more),
        alt.Shape(f"{field}:N", scale=shapes, **more),
    )


def _pair(field: str, names: dict[str | int, str], title: str) -> Sequence[Any]:
    """The same of two values that always look alike."""
    domain: list[Any] = list(names)
    known = {str(value): text for value, text in names.items()}
    return _both(
        field,
        alt.Scale(domain=domain, range=list(OKABE_ITO[:2])),
        alt.Scale(domain=domain, range=["circle", "triangle-up"]),
        title=title,
        legend=alt.Legend(labelExpr=f"({json.dumps(known)})[datum.value]"),
    )


def crews(say: Say) -> Sequence[Any]:
    """Men and women apart."""
    return _pair("crew_class", {c: say(labels.crew(c)) for c in ("H", "D")}, say("Crew"))


def directions(say: Say) -> Sequence[Any]:
    """Out and back apart."""
    names: dict[str | int, str] = {d: say(labels.code(f"direction.{d}")) for d in (1, -1)}
    return _pair("direction", names, say(labels.column("direction")))


def types(say: Say) -> Sequence[Any]:
    """Boat types apart, of which one is not known."""
    scales = alt.Scale(range=list(OKABE_ITO)), alt.Scale(range=list(SHAPES))
    legend = alt.Legend(labelExpr=named(["unknown"], say))
    return _both("boat_type", *scales, title=say("Type"), legend=legend)


def methods(say: Say) -> Sequence[Any]:
    """A method by colour and shape: every method that ships has the same in every figure.

    Others that the data hold have what follows, as on the workbench. Of all that have a look, the
    legend names those that are drawn.
    """
    known = alt.DomainUnionWith(unionWith=list(list_shipped_methods()))
    legend = alt.Legend(values=alt.ExprRef("domain('xOffset')"), labelExpr=methods_named(say))
    inks, shapes = (alt.Scale(domain=known, range=list(looks)) for looks in (OKABE_ITO, SHAPES))
    return _both("method", inks, shapes, title=say("Method"), sort=None, legend=legend)


def number(channel: Any, field: str, title: str, zero: bool = False, **more: Any) -> Any:
    """A quantity on an axis that need not begin at zero; labels below it keep apart."""
    across = {"axis": alt.Axis(tickCount=8)} if channel is alt.X else {}
    return channel(f"{field}:Q", title=title, scale=alt.Scale(zero=zero), **across | more)


def methods_named(say: Say) -> str:
    """A Vega expression that gives a method that ships, or the workbench's, its name in words."""
    texts = {name: say(labels.method(name)) for name in (*list_shipped_methods(), SCENARIO)}
    return f"({json.dumps(texts)})[datum.value] || datum.value"


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


def at_one(channel: str) -> alt.Chart:
    """A line at 1 along an axis of ratios."""
    return alt.Chart().mark_rule(color=GREY, strokeDash=[4, 3]).encode(**{channel: alt.datum(1.0)})


def interval_kind() -> Any:
    """Full for a 95 % interval, dashed for the spread of the runs alone.

    The `interval` of a row says which, or else its `method`.
    """
    names = json.dumps(
        [n for n in list_shipped_methods() if read_shipped_method(n).interval == RUNS_ALONE]
    )
    own = f"datum.interval ? datum.interval == '{RUNS_ALONE}' : indexof({names}, datum.method) >= 0"
    return alt.when(own).then(alt.value([3, 2])).otherwise(alt.value([1, 0]))


def named(codes: Iterable[str], say: Say) -> str:
    """A Vega expression that gives codes on an axis their text, and leaves others as they are."""
    texts = {code: say(labels.code(code)) for code in codes}
    return f"({json.dumps(texts)})[datum.value] || datum.value"
