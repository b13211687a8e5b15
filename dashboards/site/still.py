"""A page's first chart as a picture made with the page, to be seen before any script is there."""

import copy
import re
from collections.abc import Iterable

import polars as pl
from markupsafe import Markup

from dashboards import drawn
from dashboards.figures import drop
from dashboards.site.parts import Chart, Page, is_chosen
from dashboards.site.specifications import chart_specifications


def first_chart(page: Page) -> tuple[Chart, pl.DataFrame] | None:
    """The first chart that is seen at once, with the rows it shows; None where there is none."""
    chart = next((c for s in page.sections if not s.folded for c in s.charts), None)
    if chart is None:
        return None
    rows = _shown(page, chart)
    return None if rows.is_empty() else (chart, rows)


def still(figure: str, rows: pl.DataFrame, language: str, caption: str) -> Markup:
    """A figure as SVG; a screen reader says its caption."""
    spec = copy.deepcopy(chart_specifications(language)[figure])
    drop(spec, "href", "tooltip")
    svg = drawn.svg(spec | {"datasets": {"rows": rows.to_dicts()}}, language)
    bare = _renumbered(re.sub(r' (role|aria-[a-z]+)="[^"]*"', "", svg))
    named = Markup('<svg role="img" aria-label="{}" ').format(caption)
    return Markup(bare.replace("<svg ", named, 1))  # noqa: S704 - Vega escapes texts


def _renumbered(svg: str) -> str:
    """Names of clipping areas from 0: Vega counts on from one picture to the next."""
    names = dict.fromkeys(re.findall(r'id="(clip\d+)"', svg))
    places = {name: f"clip{place}" for place, name in enumerate(names)}
    return re.sub(r"\bclip\d+\b", lambda name: places[name[0]], svg)


def _shown(page: Page, chart: Chart) -> pl.DataFrame:
    """The rows that the selectors show at first, as `site.js` chooses them."""
    rows = pl.concat(page.data[chart.data], how="diagonal_relaxed")
    for column, names in chart.follows.items():
        wanted = [page.chosen[name] for name in ([names] if isinstance(names, str) else names)]
        rows = rows.filter(pl.Series(_are_chosen(rows[column], wanted), dtype=pl.Boolean))
    return rows


def _are_chosen(values: Iterable[object], wanted: list[str]) -> list[bool]:
    return [
        value is None
        or is_chosen(value.to_list() if isinstance(value, pl.Series) else value, *wanted)
        for value in values
    ]
