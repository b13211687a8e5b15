"""A page's first chart as a picture made with the page, to be seen before any script is there."""

import copy
import json
import re
from collections import Counter
from typing import Final

import polars as pl
from markupsafe import Markup

from herijk.dashboards import drawn
from herijk.dashboards.figures import drop
from herijk.dashboards.site.cells import hashable
from herijk.dashboards.site.parts import Chart, Page, is_chosen
from herijk.dashboards.site.specifications import chart_specifications
from herijk.dashboards.speech import Speech


def still_pictures(page: Page, speech: Speech) -> dict[str, Markup]:
    """The first chart that is seen at once, by its name."""
    charts = [c for s in page.sections if not s.folded for c in s.charts]
    if not charts:
        return {}
    rows = _shown(page, charts[0])
    if rows.is_empty():
        return {}
    first = charts[0]
    return {first.figure: still(first.figure, rows, speech, speech.say(first.caption))}


def still(figure: str, rows: pl.DataFrame, speech: Speech, caption: str) -> Markup:
    """A figure as SVG; a screen reader says its caption."""
    spec = copy.deepcopy(chart_specifications(speech.language)[figure])
    drop(spec, "href", "tooltip")
    spec["config"]["aria"] = False  # described as a whole
    text = json.dumps(spec)
    seen = rows.select(name for name in rows.columns if name in text)
    spec["datasets"] = {"rows": seen.to_dicts()}
    svg = drawn.svg(spec, speech.language)
    bare = re.sub(r' (role|aria-[a-z]+)="[^"]*"', "", _renumbered(svg))
    bare = _marks_once(DIGITS.sub(r"\1", bare))
    named = Markup('<svg role="img" aria-label="{}" ').format(caption)
    return Markup(bare.replace("<svg ", named, 1))  # noqa: S704 - Vega escapes texts


def _renumbered(svg: str) -> str:
    """Names of clipping areas from 0: Vega counts on from one picture to the next."""
    names = dict.fromkeys(re.findall(r'id="(clip\d+)"', svg))
    places = {name: f"clip{place}" for place, name in enumerate(names)}
    return re.sub(r"\bclip\d+\b", lambda found: places[found[0]], svg)


def _marks_once(svg: str) -> str:
    """What marks look like once, then where each of them is: a third of the characters to load."""
    looks = Counter(found["look"] for found in MARK.finditer(svg))
    names = {look: f"mark{n}" for n, (look, often) in enumerate(looks.items()) if often > 1}

    def placed(mark: re.Match[str]) -> str:
        name = names.get(mark["look"])
        return f'<use href="#{name}" x="{mark["x"]}" y="{mark["y"]}"/>' if name else mark[0]

    once = "".join(f'<path id="{name}" {look}/>' for look, name in names.items())
    return MARK.sub(placed, svg).replace(">", f"><defs>{once}</defs>", 1)


MARK: Final = re.compile(
    r'<path transform="translate\((?P<x>[-\d.]+),(?P<y>[-\d.]+)\)" (?P<look>d="[^>]*")/>'
)
DIGITS: Final = re.compile(r"(\.\d\d)\d+(?=[^<>]*>)")
"""Digits within a tag that nobody can see: of where something lies, how wide or light it is."""


def _shown(page: Page, chart: Chart) -> pl.DataFrame:
    """The rows that the selectors show at first, as `site.js` chooses them."""
    rows = pl.concat(page.data[chart.data], how="diagonal_relaxed")
    for column, names in chart.follows.items():
        wanted = [page.chosen[name] for name in ([names] if isinstance(names, str) else names)]
        values = hashable(rows[column])
        shown = {v for v in set(values) if v is None or is_chosen(v, *wanted)}
        rows = rows.filter([v in shown for v in values])
    return rows
