"""What pages load to draw charts: figures without data, the data, and a first picture.

A page's first chart is also a picture made with the page, to be seen before any script is there.
"""

import copy
import json
import re
from collections.abc import Callable, Iterable
from functools import cache
from typing import Any, Final

import polars as pl
import polars.selectors as cs
import vl_convert
from altair.utils.schemapi import debug_mode
from markupsafe import Markup

from dashboards import drawn, labels
from dashboards.figures import FIGURES, drop
from dashboards.html import as_json
from dashboards.site.parts import Chart, Page, is_chosen
from pipeline.messages import speaker

DRAWN: Final = 5
"""Significant digits of what charts draw."""


@cache
def vega_bundle() -> str:
    """Vega, Vega-Lite and Vega-Embed in one script, as Altair's own converter ships them."""
    return str(vl_convert.javascript_bundle())  # type: ignore[call-arg]  # its stub lacks the default


def charts_script(language: str) -> str:
    """A script with the figures and their words in one language."""
    say = speaker(language)
    words = {name: say(text) for name, text in labels.named().items()} | {
        "yes": say("yes"),
        "no": say("no"),
        "no_values": say("no values"),
        "picture": say("Save as a picture"),
    }
    figures = as_json(chart_specifications(language))
    return f"window.HERIJK_FIGURES = {figures};\nwindow.HERIJK_WORDS = {as_json(words)};\n"


@cache
def chart_specifications(language: str) -> dict[str, Any]:
    """Every figure's Vega-Lite in a language, without data."""
    say = speaker(language)
    return {name: specification(figure, say) for name, figure in FIGURES.items()}


def specification(figure: Callable[..., Any], say: Callable[[str], str]) -> dict[str, Any]:
    """A figure's Vega-Lite with the data left to the page: a dataset called `rows`."""
    # Validating takes as long as all else of a small site; the tests of figures do it.
    with debug_mode(False):
        spec: dict[str, Any] = figure(pl.DataFrame({"kind": ["x"]}), say).to_dict(validate=False)
    (placeholder,) = spec.pop("datasets")
    spec.pop("$schema")
    text = json.dumps(spec | {"config": drawn.CONFIG}).replace(f'"{placeholder}"', '"rows"')
    return dict(json.loads(text))


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
