"""A page's first chart as a picture made with the page, to be seen before any script is there."""

import re
from collections import Counter
from collections.abc import Mapping
from typing import Final

import polars as pl
from markupsafe import Markup

from dashboards import drawn
from dashboards.site.parts import Chart, Page, is_chosen
from dashboards.site.specifications import picture_specification

Stills = Mapping[str, Mapping[str, Markup]]
"""Pictures by language and name of the figure."""


def first_chart(page: Page) -> tuple[Chart, pl.DataFrame] | None:
    """The first chart that is seen at once, with the rows it shows; None where there is none."""
    chart = next((c for s in page.sections if not s.folded for c in s.charts), None)
    if chart is None:
        return None
    rows = _shown(page, chart)
    return None if rows.is_empty() else (chart, rows)


def stills(figure: str, rows: pl.DataFrame, captions: Mapping[str, str]) -> Stills:
    """A figure in every language that has a caption."""
    return {
        language: {figure: still(figure, rows, language, caption)}
        for language, caption in captions.items()
    }


def still(figure: str, rows: pl.DataFrame, language: str, caption: str) -> Markup:
    """A figure as SVG; a screen reader says its caption."""
    vega = picture_specification(figure, language)
    text = str(vega)
    seen = rows.select(name for name in rows.columns if name in text)
    svg = drawn.compiled_svg(vega, seen.to_dicts(), language)
    bare = re.sub(r' (role|aria-[a-z]+)="[^"]*"', "", _renumbered(svg))
    bare = _marks_once(DIGITS.sub("", bare))
    named = Markup('<svg role="img" aria-label="{}" ').format(caption)
    return Markup(bare.replace("<svg ", named, 1))  # noqa: S704 - Vega escapes texts


def _renumbered(svg: str) -> str:
    """Names of clipping areas from 0: Vega counts on from one picture to the next."""
    names = dict.fromkeys(re.findall(r'id="(clip\d+)"', svg))
    places = {name: f"clip{place}" for place, name in enumerate(names)}
    return re.sub(r"\bclip\d+\b", lambda name: places[name[0]], svg)


def _marks_once(svg: str) -> str:
    """What marks look like once, then where each of them is: a third of the characters to load."""
    looks = Counter(mark["look"] for mark in MARK.finditer(svg))
    names = {look: f"mark{n}" for n, (look, often) in enumerate(looks.items()) if often > 1}

    def placed(mark: re.Match[str]) -> str:
        name = names.get(mark["look"])
        return f'<use href="#{name}" x="{mark["x"]}" y="{mark["y"]}"/>' if name else mark[0]

    once = "".join(f'<path id="{name}" {look}/>' for look, name in names.items())
    return MARK.sub(placed, svg).replace(">", f"><defs>{once}</defs>", 1)


MARK: Final = re.compile(
    r'<path transform="translate\((?P<x>[-\d.]+),(?P<y>[-\d.]+)\)" (?P<look>d="[^>]*")/>'
)
DIGITS: Final = re.compile(r"(?<=\.\d\d)\d+(?=[^<>]*>)")
"""Digits within a tag that nobody can see: of where something lies, how wide or light it is."""


def _shown(page: Page, chart: Chart) -> pl.DataFrame:
    """The rows that the selectors show at first, as `site.js` chooses them."""
    rows = pl.concat(page.data[chart.data], how="diagonal_relaxed")
    for column, names in chart.follows.items():
        wanted = [page.chosen[name] for name in ([names] if isinstance(names, str) else names)]
        values = rows[column].unique()
        is_shown = [v is None or is_chosen(v, *wanted) for v in values.to_list()]
        shown = values.filter(pl.Series(is_shown, dtype=pl.Boolean)).to_frame()
        rows = rows.join(shown, on=column, how="semi", nulls_equal=True, maintain_order="left")
    return rows
