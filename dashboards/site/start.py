"""The start page: where things stand, and where to find what."""

from collections.abc import Iterator, Sequence
from typing import Final

import polars as pl
from markupsafe import Markup

from dashboards import labels
from dashboards.site.parts import Chart, Page, Section, first_edition
from dashboards.speech import Headline, Speech
from dashboards.statements import edition, season
from dashboards.statements.rebuild import PAGES, in_short
from pipeline.messages import Sentence, pgettext, say
from pipeline.register.register import default_method
from warehouse.queries.change_report import last_changes
from warehouse.queries.views import Views

MENU: Final = {
    "register": say("Register"),
    "boats": say("Boats"),
    "types": say("Types"),
    "seasons": say("Seasons"),
    "changes": say("Changes and races"),
    "about": say("About"),
}
"""Title of each page that the menu leads to."""

YEARS: Final = (
    say("The register of every year"),
    say("What each method would have made of the register, and of the races, of every past year."),
)
ABOUT: Final = {
    "years": YEARS,
    "words": (say("Glossary"), say("What the words and signs mean.")),
    "quality": (say("Quality"), say("Tows set aside, flags, and counts of the rebuild.")),
}
"""The same of the pages that `About` leads to."""

DOORS: Final = (
    (
        "boats.html",
        say("Your boat"),
        say("Your boat: its number, why it changed, and when it has to tow again."),
    ),
    (
        "changes.html",
        say("The vote"),
        say("The vote: what changes between two editions, for whom, and who would win."),
    ),
    ("years.html", *YEARS),
    (
        "types.html",
        say("Are equal boats equal?"),
        say("Are equal boats equal? A, B and Cw against weight and tow speed, before and after."),
    ),
)
"""What people come for: the page of each, its name on the start page, and what it says."""

RELATIVE: Final = say("Relative to the published Cw")


def start_page(
    views: Views, methods: Sequence[str], changes: pl.DataFrame, by_reports: bool
) -> Page:
    """The edition in force, key figures, what changes, the years, and where to go.

    Args:
        by_reports: whether the site lies beside the reports of rebuilds, so that it can lead there.
    """
    now = changes.filter(to_edition=first_edition(changes["to_edition"], methods))
    sections = [
        Section(
            "index_pages",
            say("Where to find what"),
            say(
                "The resistance of rowing sloops is measured with a tow test. These pages show "
                "the results of all tests, recomputed with one method: the register, every "
                "boat with its measurements, and what each step changes."
            ),
            links=DOORS,
        ),
        Section(
            "now",
            say("The current state"),
            key_figures=_figures(views),
            headline=edition.changes(now) if now.height else None,
        ),
        season_change("years", say("Through the seasons"), views, methods),
        *_last_rebuild(views, by_reports),
    ]
    return Page("index.html", say("Start"), sections)


def season_change(name: str, title: Sentence, views: Views, methods: Sequence[str]) -> Section:
    """What each method makes of each season: the history in one chart."""
    years = views.table("season_changes").filter(pl.col("method").is_in(methods))
    return Section(
        name,
        title,
        say("Cw by the method / Cw as published, of the same tow: median, and lowest to highest."),
        [Chart("season_change", [years], RELATIVE)],
        headline=season.changes(years, default_method(methods)),
    )


def _last_rebuild(views: Views, by_reports: bool) -> Iterator[Section]:
    """What the rebuild that last changed something changed."""
    changes = last_changes(views.store)
    if changes is not None:
        title, prose = say("What the last rebuild changed"), _to_report if by_reports else None
        yield Section("last_rebuild", title, headline=in_short(changes), prose=prose)


def _to_report(speech: Speech) -> Markup:
    page = {"nl": "../report/", "en": "../../report/"}[speech.language] + PAGES[speech.language]
    return Markup('<p><a href="{}">{}</a></p>').format(page, speech.say("Report of the rebuild"))


def _figures(views: Views) -> list[tuple[Sentence, str | Headline]]:
    """Which edition counts, and how much there is."""
    editions = views.table("editions").sort("valid_from")
    tows, year = views.table("tows"), pl.col("season")
    first, last = views.table("seasons").select(first=year.min(), last=year.max()).row(0)
    as_of = views.table("due_list").select(pl.col("as_of").max()).item()
    return [
        (say("Current edition"), _in_force(editions)),
        (labels.column("as_of"), lambda speech: speech.day(as_of)),
        (say("Boats"), str(views.table("boats").height)),
        (pgettext("number", "Tows"), f"{tows.height} ({first}\u2013{last})"),
    ]


def _in_force(editions: pl.DataFrame) -> Headline:
    def text(speech: Speech) -> str:
        if editions.is_empty():
            return speech.say("none yet: this is a draft")
        last = editions.row(-1, named=True)
        return speech.say(
            "{edition}, from {day}", edition=last["edition"], day=speech.day(last["valid_from"])
        )

    return text
