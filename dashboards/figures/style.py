"""What the figures share: colours, shapes, sizes, titles, and links to a boat."""

from typing import Any, Final

import altair as alt

OKABE_ITO: Final = (
    "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#999999",
)  # fmt: skip
"""Okabe and Ito (2008), dark ones first; yellow is left out, it cannot be seen on white."""

SHAPES: Final = ("circle", "square", "triangle-up", "diamond", "cross", "triangle-down")
GREY: Final = "#666666"
WIDTH: Final = 620
HEIGHT: Final = 320

OUT: Final = OKABE_ITO[0]
BACK: Final = OKABE_ITO[1]


def colour(field: str, title: str, **more: Any) -> alt.Color:
    """A category by colour."""
    return alt.Color(f"{field}:N", title=title, scale=alt.Scale(range=list(OKABE_ITO)), **more)


def stroke(field: str) -> alt.Stroke:
    """The colour of an interval: as its point's, which has the legend."""
    return alt.Stroke(f"{field}:N", scale=alt.Scale(range=list(OKABE_ITO)), legend=None)


def shape(field: str, title: str, **more: Any) -> alt.Shape:
    """The same category by shape, for print without colour; both share one legend."""
    return alt.Shape(f"{field}:N", title=title, scale=alt.Scale(range=list(SHAPES)), **more)


def number(channel: Any, field: str, title: str, zero: bool = False, **more: Any) -> Any:
    """A quantity on an axis that need not begin at zero."""
    return channel(f"{field}:Q", title=title, scale=alt.Scale(zero=zero), **more)


def tips(*pairs: tuple[str, str]) -> list[alt.Tooltip]:
    """Tooltips of `field:type` with their titles; numbers with five digits."""
    return [
        alt.Tooltip(field, title=title, **({"format": ".5~g"} if field.endswith(":Q") else {}))
        for field, title in pairs
    ]
