"""The page of the slides: a finding, the chart that shows it, and what explains it under it."""

from collections.abc import Iterator, Sequence

from markupsafe import Markup

from dashboards.documents.slides import SOURCE
from dashboards.site.parts import Chart, Page, Section
from dashboards.speech import Headline, Speech
from dashboards.statements.slides import Slide, slides
from pipeline.messages import say
from warehouse.queries.views import Views


def slides_page(views: Views) -> Page:
    """The slides below each other, the same as in the PDF."""
    title = say("Presentation 2015")
    if not views.has("compared_tows"):
        return Page("slides.html", title, [])
    return Page("slides.html", title, list(_sections(list(slides(views)))))


def _sections(made: Sequence[Slide]) -> Iterator[Section]:
    for place, slide in enumerate(made):
        chart = Chart(slide.figure, [slide.rows], says=_explained(slide))
        is_between = 0 < place < len(made) - 1
        yield Section(f"slide_{place}", slide.finding, charts=[chart], folded=is_between)


def _explained(slide: Slide) -> Headline:
    def under(speech: Speech) -> str:
        notes = (*slide.notes, say(SOURCE, table=slide.source))
        return Markup("<br>").join(map(speech.words, notes))

    return under
