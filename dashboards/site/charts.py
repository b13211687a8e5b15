"""What pages load to draw charts: figures without data, the data, and a first picture.

A page's first chart is also a picture made with the page, to be seen before any script is there:
on a slow line (1.6 Mbit/s) the 1.1 MB of scripts take 5 s, and 3 s are allowed.
"""

import re
from functools import cache
from typing import Final

import polars as pl
import polars.selectors as cs
import vl_convert
from markupsafe import Markup

from dashboards import drawn, labels
from dashboards.figures import FIGURES
from dashboards.html import as_json
from dashboards.site.cells import hashable
from dashboards.site.parts import Chart, Page, is_chosen
from dashboards.speech import Speech
from pipeline.messages import speaker

DRAWN: Final = 5
"""Significant digits of what charts draw."""


@cache
def vega_bundle() -> str:
    """Vega, Vega-Lite and Vega-Embed in one script, as Altair's own converter ships them."""
    return str(vl_convert.javascript_bundle())  # type: ignore[call-arg]  # its stub lacks the default


def charts_script(language: str) -> str:
    """A script with the figures, their words and how numbers are written, in one language."""
    say = speaker(language)
    words = {name: say(text) for name, text in labels.named().items()} | {
        "yes": say("yes"),
        "no": say("no"),
        "no_values": say("no values"),
        "picture": say("Save as a picture"),
    }
    figures = as_json({name: drawn.specification(name, language) for name in FIGURES})
    held = {"FIGURES": figures, "WORDS": as_json(words), "LOCALE": as_json(drawn.LOCALES[language])}
    return "".join(f"window.HERIJK_{name} = {json};\n" for name, json in held.items())


def page_json(page: Page) -> str:
    """What the charts of a page draw, column by column, by name."""
    charts = (
        f"{as_json(name)}:[{','.join(map(json_of, frames))}]" for name, frames in page.data.items()
    )
    return f'{{"charts":{{{",".join(charts)}}}}}'


def json_of(frame: pl.DataFrame) -> str:
    """A frame as lists by column."""
    shown = frame.with_columns(cs.float().round_sig_figs(DRAWN))
    return shown.select(pl.all().implode()).write_ndjson().rstrip("\n")


def stills(page: Page, language: str) -> dict[str, Markup]:
    """The picture of the first chart that is seen at once, by the name of its figure."""
    for section in page.shown:
        for chart in section.charts:
            rows = _shown(page, chart)
            if section.folded or rows.is_empty():
                continue
            caption = Speech(language).text(chart.caption or section.title)
            return {chart.figure: _still(chart.figure, rows, language, caption)}
    return {}


def _still(figure: str, rows: pl.DataFrame, language: str, caption: str) -> Markup:
    """A figure as SVG; a screen reader says its caption."""
    svg = drawn.svg(drawn.specification(figure, language), rows, language)
    bare = re.sub(r' (role|aria-[a-z]+)="[^"]*"', "", svg)
    named = Markup('<svg role="img" aria-label="{}" ').format(caption)
    return Markup(bare.replace("<svg ", named, 1))  # noqa: S704 - Vega escapes texts


def _shown(page: Page, chart: Chart) -> pl.DataFrame:
    """The rows that the selectors show at first, as `site.js` chooses them."""
    rows = pl.concat(chart.rows, how="diagonal_relaxed")
    for column, names in chart.follows.items():
        wanted = [page.chosen[name] for name in ([names] if isinstance(names, str) else names)]
        values = hashable(rows[column])
        rows = rows.filter(
            pl.Series([v is None or is_chosen(v, *wanted) for v in values], dtype=pl.Boolean)
        )
    return rows
