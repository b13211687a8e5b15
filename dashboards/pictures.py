"""Two small pictures as SVG, for pages that show them at once and for documents.

They need no script and no library in the browser; the charts that people can point at and choose
from are `dashboards.figures`. Coordinates in pixels, y down.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import accumulate
from operator import mul
from typing import Final

import numpy as np
from markupsafe import Markup, escape

from dashboards.colours import GREY, OKABE_ITO
from dashboards.speech import Speech
from pipeline.tables.row import Row
from warehouse.queries.documents import Curve

WIDTH: Final = 460
HEIGHT: Final = 230
LEFT: Final = 52
BOTTOM: Final = 40
TOP: Final = 30
ROW: Final = 26
LABEL: Final = 185
VALUE: Final = 70
LESS, MORE, TOTAL = OKABE_ITO[2], OKABE_ITO[1], OKABE_ITO[0]

_SVG = Markup(
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {} {}" width="{}" height="{}" '
    'role="img" aria-label="{}" font-family="Open Sans, sans-serif" font-size="12">{}</svg>'
)
_TEXT = '<text x="{:.1f}" y="{:.1f}" text-anchor="{}">{}</text>'
_LINE = '<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" stroke="{}" stroke-width="{}"/>'
_BAR = '<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="16" fill="{}"/>'
_NUMBER = '<path d="M{:.1f} {:.1f}l7 8l-7 8l-7 -8z" fill="{}"/>'
_CURVE = '<polyline points="{}" fill="none" stroke="black" stroke-width="2"/>'

Place = Callable[[float], float]


@dataclass(frozen=True)
class Axis:
    """A linear scale with round ticks."""

    ticks: Sequence[float]
    place: Place
    digits: int

    @classmethod
    def over(cls, values: Sequence[float], start: float, end: float) -> "Axis":
        """An axis that holds all values, from one end in pixels to the other."""
        low, high = min(values), max(values)
        spread = (high - low) or abs(high) or 1.0
        power = 10.0 ** np.floor(np.log10(spread / 4))
        step = next(power * m for m in (1, 2, 5, 10) if spread / (power * m) <= 5)
        first, last = np.floor(low / step) * step, np.ceil(high / step) * step
        ticks = np.arange(first, last + step / 2, step).tolist()
        digits = max(0, -int(np.floor(np.log10(step))))
        return cls(ticks, lambda v: start + (v - first) / (last - first) * (end - start), digits)


def curve_picture(curve: Curve, line: Row, speech: Speech, title: str) -> Markup:
    """A curve, and the interval of Cw at the declared speed.

    Args:
        curve: speed [m/s], Cw [kg/m] and power [W] along it.
        line: of a register: `declared_speed_m_s`, and the interval where it is known.
        speech: the language.
        title: what a screen reader says.
    """
    if not curve:
        return Markup()
    speeds, values, _ = zip(*curve, strict=True)
    low, high = line["cw_lo_kg_m"], line["cw_hi_kg_m"]
    known = low is not None and high is not None
    x = Axis.over(speeds, LEFT, WIDTH - 12)
    y = Axis.over([*values, *((low, high) if known else ())], HEIGHT - BOTTOM, TOP)
    parts = _axes(x, y, speech)
    if known:
        at = x.place(line["declared_speed_m_s"])
        parts.append(_LINE.format(at, y.place(low), at, y.place(high), OKABE_ITO[5], 6))
    path = " ".join(f"{x.place(v):.1f},{y.place(c):.1f}" for v, c, _ in curve)
    return _picture(HEIGHT, title, [*parts, _CURVE.format(path)])


def _picture(height: float, title: str, parts: Iterable[str]) -> Markup:
    """The parts, in which texts are escaped, as a picture with a name."""
    drawn = Markup("".join(parts))  # noqa: S704 - see above
    return _SVG.format(WIDTH, height, WIDTH, height, title, drawn)


def _axes(x: Axis, y: Axis, speech: Speech) -> list[str]:
    floor, left = HEIGHT - BOTTOM, LEFT
    parts = [
        _LINE.format(left, floor, WIDTH - 12, floor, GREY, 1),
        _LINE.format(left, floor, left, TOP, GREY, 1),
        _TEXT.format(
            (left + WIDTH) / 2, HEIGHT - 5, "middle", speech.text("Speed through water [m/s]")
        ),
        _TEXT.format(4, 11, "start", speech.text("Cw [kg/m]")),
    ]
    for tick in x.ticks:
        parts.append(_LINE.format(x.place(tick), floor, x.place(tick), floor + 4, GREY, 1))
        label = speech.number(tick, x.digits)
        parts.append(_TEXT.format(x.place(tick), floor + 17, "middle", label))
    for tick in y.ticks:
        parts.append(_LINE.format(left - 4, y.place(tick), WIDTH - 12, y.place(tick), "#ddd", 1))
        label = speech.number(tick, y.digits)
        parts.append(_TEXT.format(left - 7, y.place(tick) + 4, "end", label))
    return parts


def waterfall_picture(
    numbers: tuple[float, float], causes: Sequence[tuple[str, float]], speech: Speech, title: str
) -> Markup:
    """From the old number to the new one: a mark at both, and a bar for each cause.

    The axis need not begin at zero: both numbers are marks on it, and only changes have a length.

    Args:
        numbers: Cw before and after [kg/m].
        causes: name and factor of each; they multiply to new / old, but for what is too small.
        speech: the language.
        title: what a screen reader says.
    """
    before_all, after_all = numbers
    steps = list(accumulate([before_all, *(factor for _, factor in causes)], mul))
    x = Axis.over([*steps, *_around(steps)], LABEL, WIDTH - VALUE)
    floor = (len(steps) + 1) * ROW + 4
    parts = [*_scale(x, floor, speech), _number(0, speech.say("was"), steps[0], x, speech)]
    for row, ((name, factor), *ends) in enumerate(zip(causes, steps, steps[1:], strict=False), 1):
        before, after = map(x.place, ends)
        ink = MORE if factor > 1 else LESS
        left, width = min(before, after), max(abs(after - before), 1.0)
        parts += [
            _LINE.format(before, row * ROW - 5, before, row * ROW + 5, GREY, 1),
            _BAR.format(left, row * ROW + 5, width, ink),
            _row(row, name, speech.per_cent(factor)),
        ]
    row, end = len(steps), x.place(after_all)
    parts.append(_LINE.format(end, row * ROW - 5, end, row * ROW + 5, GREY, 1))
    parts.append(_number(row, speech.say("becomes"), after_all, x, speech))
    height = floor + 20
    return _picture(height, title, parts)


def _around(steps: Sequence[float]) -> tuple[float, float]:
    """A little room at both ends, so that no mark is on the edge."""
    room = 0.25 * (max(steps) - min(steps)) or 0.01 * steps[0]
    return min(steps) - room, max(steps) + room


def _scale(x: Axis, floor: float, speech: Speech) -> list[str]:
    """Thin lines with their numbers below."""
    parts = []
    for tick in x.ticks:
        parts.append(_LINE.format(x.place(tick), 2, x.place(tick), floor, "#ddd", 1))
        label = speech.number(tick, x.digits)
        parts.append(_TEXT.format(x.place(tick), floor + 15, "middle", label))
    return parts


def _number(row: int, name: str, value: float, x: Axis, speech: Speech) -> str:
    """A row with a mark where a number lies."""
    mark = _NUMBER.format(x.place(value), row * ROW + 5, TOTAL)
    return mark + _row(row, name, speech.number(value, 2))


def _row(row: int, name: str, value: str) -> str:
    """What is left and right of the marks of a row."""
    y = row * ROW + 17
    left = _TEXT.format(LABEL - 8, y, "end", escape(name))
    return left + _TEXT.format(WIDTH, y, "end", value)
