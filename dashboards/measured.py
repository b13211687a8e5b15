"""What a tow test measures, as a picture: ship, boom and boat from above, and the six runs."""

from collections.abc import Iterator
from typing import Final

from markupsafe import Markup, escape

from dashboards.colours import GREY, OKABE_ITO
from dashboards.speech import Speech
from pipeline.messages import pgettext, say

SHIP: Final = "10,34 220,34 262,58 220,82 10,82"
BOAT: Final = "M30 166C60 142 140 142 170 166C140 190 60 190 30 166z"
BOOM: Final = "M200 58V166"
LINE: Final = "M200 166H170"

CALLED: Final = (
    (60, 63, "start", say("motor ship")),
    (78, 171, "start", say("sloop")),
    (208, 128, "start", pgettext("picture", "boom")),
    (276, 30, "start", say("GPS: speed over ground")),
    (276, 104, "start", say("vane: wind")),
    (276, 171, "start", say("load cell: tow force")),
    (276, 208, "start", say("log: speed through water")),
)
"""Where a word stands, and the word."""

LEADERS: Final = ("M226 56L272 27", "M200 94L272 100", "M185 166L272 166", "M200 184L272 203")
INSTRUMENTS: Final = ((226, 56), (200, 94), (185, 166), (200, 184))
"""GPS on the ship; vane, load cell and log at the boom."""

RUNS: Final = ((1, 90), (2, 100), (3, 110))
"""Runs of a way and their speed in per cent of the declared speed."""

CAPTION: Final = say(
    "A tow test from above, and its six runs. Not to scale; where log and GPS hang is inferred."
)
SIZE: Final = (480, 320)


def picture(speech: Speech) -> Markup:
    """The picture as SVG, of `SIZE` pixels."""
    parts = (
        f'<polygon points="{SHIP}" fill="none" stroke="black" stroke-width="1.5"/>',
        f'<path d="{BOAT}" fill="{OKABE_ITO[4]}" fill-opacity="0.35" stroke="black"/>',
        f'<path d="{BOOM}" stroke="black" stroke-width="3"/>',
        f'<path d="{LINE}" stroke="black" stroke-width="1.5"/>',
        *(f'<path d="{leader}" stroke="{GREY}" fill="none"/>' for leader in LEADERS),
        *(f'<circle cx="{x}" cy="{y}" r="5" fill="{OKABE_ITO[5]}"/>' for x, y in INSTRUMENTS),
        *(_word(x, y, anchor, speech.say(word)) for x, y, anchor, word in CALLED),
        *_runs(speech),
    )
    width, height = SIZE
    drawing = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
        f'height="{height}" role="img" aria-label="{escape(speech.say(CAPTION))}" '
        f'font-family="Open Sans, sans-serif" font-size="15">{"".join(parts)}</svg>'
    )
    return Markup(drawing)  # noqa: S704 - its words are escaped


def _word(x: float, y: float, anchor: str, word: str) -> str:
    return f'<text x="{x}" y="{y}" text-anchor="{anchor}">{escape(word)}</text>'


def _runs(speech: Speech) -> Iterator[str]:
    """Three arrows out, and below them three back, as long as the runs are fast."""
    for way, (y, name) in enumerate(((256, say("out")), (302, say("back")))):
        yield _word(4, y + 5, "start", speech.say(name))
        for place, (run, per_cent) in enumerate(RUNS):
            start, length = 64 + 140 * place, 0.95 * per_cent
            ends = (start, start + length)[:: -1 if way else 1]
            tip = 8 if way else -8
            yield (
                f'<path d="M{ends[0]:.0f} {y}H{ends[1]:.0f}m{tip} -5l{-tip} 5l{tip} 5" '
                'fill="none" stroke="black" stroke-width="1.5"/>'
            )
            yield _word(start, y - 9, "start", f"{run + 3 * way}: {per_cent}\u00a0%")
