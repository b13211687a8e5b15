"""The slides as one PDF, a finding on each page."""

from collections.abc import Sequence
from contextlib import nullcontext
from typing import Any, Final

from dashboards import drawn, labels
from dashboards.documents import pdf
from dashboards.html import keep_units
from dashboards.speech import Speech
from dashboards.statements.slides import Slide, slides
from pipeline.messages import say
from warehouse.queries.views import Views
from warehouse.store.unforeseen import Border

WIDE: Final = {"width": 900, "height": 270}
PANEL: Final = {"width": 430, "height": 270}
"""Size of a chart, and of each of two panels [px]."""

TITLE: Final = say("The questions of 2015, answered by this archive")
SOURCE: Final = say("Source: all tows of this archive, table {table}.")


def slide_book(
    views: Views,
    language: str,
    types: Sequence[str] = (),
    boats: Sequence[str] = (),
    border: Border = nullcontext,
) -> bytes:
    """All slides as PDF; a slide that Herijk itself fails on is left out.

    Raises:
        MissingKnowledgeError: there is no such type or boat, or nothing to compare.
    """
    speech = Speech(language)
    say = speech.say
    pages = []
    for slide in slides(views, types, boats, border):
        with border(f"slide {slide.name} drawn"):
            pages.append(_page(slide, speech))
    simulated = views.about().get("simulated") == "true"
    content = {
        "language": language,
        "title": say(TITLE),
        "simulated": say(labels.SIMULATED) if simulated else "",
        "slides": pages,
    }
    return pdf("slides.typ", content)


def _page(slide: Slide, speech: Speech) -> dict[str, Any]:
    spec = drawn.specification(slide.figure, speech.language)
    if "facet" in spec:
        spec["spec"] |= PANEL
    else:
        spec |= WIDE if isinstance(spec.get("height"), int) else {"width": WIDE["width"]}
    return {
        "finding": keep_units(slide.finding(speech)),
        "chart": drawn.svg(spec, slide.rows, speech.language),
        "notes": [keep_units(speech.words(note)) for note in slide.notes],
        "source": speech.say(SOURCE, table=slide.source),
    }
