"""The slide book as files: every slide as SVG and PNG, and all of them as one PDF."""

import io
import textwrap
from contextlib import nullcontext
from pathlib import Path
from typing import Final

import altair as alt
import pypdf
import vl_convert

from dashboards import drawn, labels
from dashboards.audit_plots import file_name
from dashboards.figures import FIGURES
from dashboards.slide_book import THE_PRESENTATION, Asked, Slide, slides
from pipeline.messages import speaker
from warehouse.queries.views import Views
from warehouse.store.database import open_database
from warehouse.store.files import written_beside
from warehouse.store.store import Store
from warehouse.store.unforeseen import Border

WIDTH_OF_TEXT: Final = 140
MARGIN: Final = 24
"""White around a slide [px]."""


def write_slides(
    store: Store,
    folder: Path,
    language: str,
    asked: Asked = THE_PRESENTATION,
    border: Border = nullcontext,
) -> list[Path]:
    """Writes every slide as SVG and PNG, and all of them as one PDF.

    Args:
        store: where the database lies.
        folder: where they go; made if it is not there.
        language: nl or en.
        asked: types, one or two; tows, `all`, `newest`, a season or a
            range of them; boats by number or name.
        border: stands round the work on each slide.

    Raises:
        MissingKnowledgeError: there is no such type, boat or choice of tows, or no database.
    """
    say = speaker(language)
    open_database(store.database).close()  # says so where there is none
    with Views(store) as views:
        simulated = views.about().get("simulated") == "true"
        made = list(slides(views, say, asked, border))
    folder.mkdir(parents=True, exist_ok=True)
    book, written = pypdf.PdfWriter(), []
    for number, slide in enumerate(made, 1):
        with border(f"slide {slide.name} drawn"):
            svg = _svg(slide, language, simulated)
            png, page = vl_convert.svg_to_png(svg, scale=2.0), vl_convert.svg_to_pdf(svg)
            stem = folder / file_name(f"{number:02d} {slide.name}")
            written += [_put(Path(f"{stem}.svg"), svg.encode()), _put(Path(f"{stem}.png"), png)]
            book.append(io.BytesIO(page))
    pages = io.BytesIO()
    book.write(pages)
    return [*written, _put(folder / f"slides-{language}.pdf", pages.getvalue())]


def _put(path: Path, content: bytes) -> Path:
    with written_beside(path) as beside:
        beside.write_bytes(content)
    return path


def _svg(slide: Slide, language: str, simulated: bool) -> str:
    say = speaker(language)
    said = [
        *slide.said,
        *([say(labels.SIMULATED)] if simulated else []),
    ]
    lines = [line for text in said for line in textwrap.wrap(text, WIDTH_OF_TEXT)]
    title = alt.Title(slide.title, subtitle=lines, anchor="start", offset=12)
    chart = FIGURES[slide.figure](slide.rows, say).properties(title=title, padding=MARGIN)
    spec = chart.to_dict(validate=False)
    return drawn.svg(spec, language)
