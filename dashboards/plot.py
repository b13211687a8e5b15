"""A drawing area with axes and marks, as SVG: the same on a page, in print and in a PDF.

There is no script in it. Colours are those of Okabe and Ito, which colour-blind people tell apart;
a shape or dash says the same in print. Pointing at a mark shows its numbers.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from math import ceil, floor, log10
from types import MappingProxyType
from typing import Final, NamedTuple, Self

import numpy as np
from markupsafe import Markup, escape

from dashboards.language import Language
from dashboards.pictures import FONT_SIZE_PX

INKS: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "currentColor")
"""Colour of each kind of mark, by its number."""


def get_ink(kind: int) -> str:
    """Return the colour of a kind of mark."""
    return INKS[kind % len(INKS)]


SHAPES: Final = (
    "",  # circle: an element of its own
    "m-3.6-3.6h7.2v7.2h-7.2z",  # square
    "m0 -4.8l4.6 8.2h-9.2z",  # triangle
    "m0 -5.2l4.4 5.2l-4.4 5.2l-4.4 -5.2z",  # diamond
    "m-1.6 -4.6h3.2v3h3v3.2h-3v3h-3.2v-3h-3v-3.2h3z",  # cross
    "m0 4.8l4.6 -8.2h-9.2z",  # triangle upside down
)
"""Path of each kind of mark, in pixels from its place."""

GREY: Final = "#888888"
CHARACTER_WIDTH_PX: Final = 6.6
"""About the width of a letter of a label."""

BULK_QUARTILES: Final = 2.0
"""Interquartile ranges beyond the quartiles that an axis for the bulk of the numbers reaches, so
that one boat does not squeeze all others."""

TICKS: Final = 5
"""About as many ticks as an axis has."""


@dataclass(frozen=True)
class Scale:
    """A way from numbers to pixels: `low` is drawn at `start`, `high` at `end`."""

    low: float
    high: float
    start: float
    end: float

    def __call__(self, value: float) -> float:
        """Return the place of a number [px]; one beyond the scale lies at its end."""
        inside = min(max(value, self.low), self.high)
        return self.start + (inside - self.low) / (self.high - self.low) * (self.end - self.start)

    @property
    def step(self) -> float:
        """The distance of ticks: 1, 2 or 5 times a power of ten."""
        rough = (self.high - self.low) / TICKS
        power = 10.0 ** floor(log10(rough))
        for factor in (1, 2, 5):
            if factor * power >= rough:
                return factor * power
        return 10 * power

    @property
    def ticks(self) -> list[float]:
        """Round numbers along the scale."""
        first, last = ceil(self.low / self.step), floor(self.high / self.step)
        return [place * self.step for place in range(first, last + 1)]

    @property
    def decimals(self) -> int:
        """The decimals that tell ticks apart."""
        return max(0, -floor(log10(self.step)))


def fit_scale(
    values: Iterable[float | None],
    start: float,
    end: float,
    *,
    including: Sequence[float] = (),
    bulk: bool = False,
) -> Scale:
    """Return a scale that holds numbers, with some room beyond them.

    Args:
        values: the numbers; None is left out.
        start: where the scale begins [px].
        end: where it ends [px].
        including: numbers that it holds in any case.
        bulk: hold the bulk of the numbers only, as `BULK_QUARTILES` says.
    """
    known = np.array([value for value in values if value is not None] + list(including), float)
    if not known.size:
        known = np.array([0.0, 1.0])
    low, high = known.min(), known.max()
    if bulk:
        lower, upper = np.quantile(known, (0.25, 0.75))
        reach = BULK_QUARTILES * (upper - lower or np.inf)
        low = min(max(low, lower - reach), *including, np.inf)
        high = max(min(high, upper + reach), *including, -np.inf)
    room = 0.05 * (high - low) or 0.05 * abs(high) or 1.0
    return Scale(float(low - room), float(high + room), start, end)


LEGEND_ROW_PX: Final = 18


class LegendEntry(NamedTuple):
    """What a mark means: its name, the kind of its shape (None: a line) and its colour."""

    name: str
    kind: int | None
    ink: str

    @classmethod
    def from_kind(cls, name: str, kind: int) -> Self:
        """Return the entry of a kind of mark, in its own colour."""
        return cls(name, kind, get_ink(kind))


NO_STYLE: Final[Mapping[str, str | float | None]] = MappingProxyType({})


def _place_legend(
    legend: Sequence[LegendEntry], width: float
) -> list[tuple[LegendEntry, float, int]]:
    """Return each entry with its place [px] on a row of the legend, and the row."""
    placed = []
    x, row = 0.0, 0
    for entry in legend:
        entry_width = CHARACTER_WIDTH_PX * len(entry.name) + 30
        if x and x + entry_width > width - 40:
            x, row = 0.0, row + 1
        placed.append((entry, x, row))
        x += entry_width
    return placed


class Mark(NamedTuple):
    """An element of SVG.

    Attributes:
        tag: its name.
        place: the attributes that are its own.
        looks: attributes of colour, line and letter, which it may share with a group.
        content: what stands in it.
    """

    tag: str
    place: str
    looks: str
    content: str

    def write(self, looks: str) -> str:
        """Return the element with these looks."""
        end = f">{self.content}</{self.tag}>" if self.content else "/>"
        return f"<{self.tag}{self.place}{looks}{end}"


class Plot:
    """An area with two axes, and marks in the order in which they are added.

    Args:
        language: of the numbers on the axes.
        width, height: of the whole picture [px].
        left, top: room for labels [px].
        legend: what marks mean, on lines of their own at the top.
    """

    def __init__(
        self,
        language: Language,
        width: int = 480,
        height: int = 300,
        left: int = 52,
        top: int = 44,
        legend: Sequence[LegendEntry] = (),
    ) -> None:
        placed = _place_legend(legend, width - 10)
        extra = LEGEND_ROW_PX * max((row for _, _, row in placed), default=0)
        height += extra
        self.language = language
        self.width, self.height = width, height
        self.left, self.top = left, top + extra
        self.right, self.bottom = width - 10, height - 40
        self._marks: list[Mark] = []
        self._has_links = False
        self._add_legend(placed)

    def fit_x(
        self,
        values: Iterable[float | None],
        *,
        including: Sequence[float] = (),
        bulk: bool = False,
    ) -> Scale:
        """Return a scale along the bottom; see `fit_scale`."""
        return fit_scale(values, self.left, self.right, including=including, bulk=bulk)

    def fit_y(
        self,
        values: Iterable[float | None],
        *,
        including: Sequence[float] = (),
        bulk: bool = False,
    ) -> Scale:
        """Return a scale along the side; see `fit_scale`."""
        return fit_scale(values, self.bottom, self.top, including=including, bulk=bulk)

    def add_path(
        self,
        path: str,
        ink: str = "currentColor",
        tip: str = "",
        style: Mapping[str, str | float | None] = NO_STYLE,
    ) -> None:
        """Add a shape or line; attributes without a value are left out.

        Args:
            path: in the language of SVG.
            ink: colour of its stroke.
            tip: what pointing at it shows.
            style: attributes of SVG.
        """
        looks = ""
        for name, value in ({"fill": "none", "stroke": ink} | dict(style)).items():
            if value is not None:
                looks += f' {name}="{value}"'
        self._marks.append(Mark("path", f' d="{path}"', looks, _write_tip(tip)))

    def add_text(
        self, x: float, y: float, text: str, anchor: str = "start", size: int = FONT_SIZE_PX
    ) -> None:
        """Add a text at a place; `anchor` is which of its ends lies there."""
        end = f' text-anchor="{anchor}"' if anchor != "start" else ""
        own_size = f' font-size="{size}"' if size != FONT_SIZE_PX else ""
        place = f' x="{round(x, 1):g}" y="{round(y, 1):g}"'
        self._marks.append(Mark("text", place, end + own_size, escape(text)))

    def add_axes(self, x: Scale | None, y: Scale, x_title: str, y_title: str) -> None:
        """Add lines, ticks, numbers and titles; the title of the side stands above it."""
        write = self.language.write_number
        grid = "".join(f"M{self.left} {y(tick):.1f}H{self.right}" for tick in y.ticks)
        self.add_path(grid, GREY, style={"stroke-opacity": 0.25})
        for tick in y.ticks:
            self.add_text(self.left - 6, y(tick) + 4, write(tick, y.decimals), "end")
        below = f"M{self.left} {self.bottom}H{self.right}"
        if x is not None:
            for tick in x.ticks:
                below += f"M{x(tick):.1f} {self.bottom}v4"
                self.add_text(x(tick), self.bottom + 17, write(tick, x.decimals), "middle")
        self.add_path(below)
        self.add_text(4, self.top - 12, y_title)
        self.add_text((self.left + self.right) / 2, self.height - 6, x_title, "middle")

    def add_grid(self, x: Scale, title: str, *, signed: bool = False) -> None:
        """Add lines across for rows of marks, numbers below them and a title.

        Args:
            x: the scale along the bottom.
            title: of the scale.
            signed: whether numbers have a plus, and the line at zero stands out.
        """
        for tick in x.ticks:
            is_zero = abs(tick) < x.step / 2
            opacity = None if signed and is_zero else 0.25
            line = f"M{x(tick):.1f} {self.top}V{self.bottom}"
            self.add_path(line, GREY, style={"stroke-opacity": opacity})
            sign = "+" if signed and not is_zero else ""
            label = self.language.write_number(tick, x.decimals, sign)
            self.add_text(x(tick), self.bottom + 16, label, "middle")
        self.add_text((self.left + self.right) / 2, self.height - 6, title, "middle")

    def add_point(
        self,
        x: float,
        y: float,
        kind: int,
        tip: str = "",
        *,
        ink: str = "",
        filled: bool = True,
        page: str = "",
    ) -> None:
        """Add a mark.

        Args:
            x, y: its place [px].
            kind: of its shape, and of its colour where no ink is named.
            tip: what pointing at it shows.
            ink: its colour.
            filled: whether it counts; one that does not is open.
            page: where it leads to.
        """
        colour = ink or get_ink(kind)
        fill, shape = colour if filled else "none", SHAPES[kind % len(SHAPES)]
        tag, place = "path", f' d="M{round(x, 1):g} {round(y, 1):g}{shape}"'
        if not shape:
            tag, place = "circle", f' cx="{round(x, 1):g}" cy="{round(y, 1):g}" r="4"'
        mark = Mark(tag, place, f' fill="{fill}" stroke="{colour}"', _write_tip(tip))
        if page:
            self._has_links = True
            link = f' href="{escape(page)}" aria-label="{escape(tip)}"'
            mark = Mark("a", link, mark.looks, mark.write(""))
        self._marks.append(mark)

    def add_interval(
        self, x: float, low: float, high: float, ink: str, *, dashed: bool = False
    ) -> None:
        """Add a bar from low to high [px]; one that leaves out a part of it is dashed."""
        self.add_path(
            f"M{x:.1f} {low:.1f}V{high:.1f}",
            ink,
            style={"stroke-width": 2, "stroke-dasharray": "3 3" if dashed else None},
        )

    def add_line(
        self,
        points: Sequence[tuple[float, float]],
        ink: str,
        *,
        parts: int = 2,
        style: Mapping[str, str | float | None] = NO_STYLE,
    ) -> None:
        """Add a line through points [px], each to so many parts of a pixel."""
        whole = [(round(parts * x), round(parts * y)) for x, y in points]
        if len(whole) < 2:
            return
        moves = " ".join(
            f"{(x - before_x) / parts:g} {(y - before_y) / parts:g}"
            for (before_x, before_y), (x, y) in pairwise(whole)
        ).replace(" -", "-")  # a sign separates, too
        x, y = whole[0]
        self.add_path(f"M{x / parts:g} {y / parts:g}l{moves}", ink, style=style)

    def add_band(
        self, x: Sequence[float], low: Sequence[float], high: Sequence[float], ink: str = GREY
    ) -> None:
        """Add the area between two lines, in a light shade of an ink."""
        above = list(zip(x, low, strict=True))
        below = list(zip(reversed(x), reversed(high), strict=True))
        self.add_line([*above, *below], "none", parts=1, style={"fill": ink, "fill-opacity": 0.22})

    def add_group(self, attributes: str, marks: str) -> None:
        """Add marks, as SVG, that are shown together."""
        self._marks.append(Mark("g", attributes, "", marks))

    def _add_legend(self, placed: Sequence[tuple[LegendEntry, float, int]]) -> None:
        for entry, x, row in placed:
            left, y = self.left + x, LEGEND_ROW_PX * row + 10
            if entry.kind is None:
                line = f"M{left - 6:.1f} {y}h12"
                self.add_path(line, entry.ink, style={"stroke-width": 3})
            else:
                self.add_point(left, y, entry.kind, ink=entry.ink)
            self.add_text(left + 9, y + 4, entry.name)

    def to_svg(self, caption: str = "") -> Markup:
        """Return the picture as a part of a page, whose style sheet has `STANDALONE_LOOKS`.

        A screen reader says its caption, and skips one without.
        """
        role = "group" if self._has_links else "img"  # an image has no parts that can be reached
        label = f'role="{role}" aria-label="{escape(caption)}"' if caption else 'aria-hidden="true"'
        return Markup(  # noqa: S704 - texts were escaped
            f'<svg viewBox="0 0 {self.width} {self.height}" {label}>'
            f"{''.join(self._write_marks())}</svg>"
        )

    def _write_marks(self) -> Iterator[str]:
        """Write the marks in order; those next to each other that look alike say so once."""
        for looks, alike in groupby(self._marks, key=lambda mark: mark.looks):
            marks = list(alike)
            if len(marks) == 1:
                yield marks[0].write(looks)
            else:
                shared = "".join(mark.write("") for mark in marks)
                yield f"<g{looks}>{shared}</g>" if looks else shared


def _write_tip(tip: str) -> str:
    """Return what pointing at a mark shows, as the element that SVG has for it."""
    return f"<title>{escape(tip)}</title>" if tip else ""
