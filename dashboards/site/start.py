"""The start page: where things stand; and the page of words."""

from collections.abc import Sequence

import polars as pl

from dashboards import headlines
from dashboards.report import in_short
from dashboards.site.parts import (
    Chart,
    Page,
    Section,
    Table,
    draft_of,
    methods_select,
)
from dashboards.site.prose import guide_links
from dashboards.speech import Headline, Speech
from warehouse.queries.answers import newest_edition
from warehouse.queries.change_report import last_changes
from warehouse.queries.views import Views

CARDS = ("register", "due", "types", "compare", "races", "corrections", "reproducibility",
         "changes", "quality", "slides", "words")  # fmt: skip
TERMS = ("tow", "cw", "a", "b", "declared", "interval", "as_measured", "log_factor", "method",
         "edition", "flag", "set_aside", "e_n", "power", "type", "crew_class",
         "verification_code")  # fmt: skip


def start_page(views: Views, methods: Sequence[str], changes: pl.DataFrame) -> Page:
    """The edition in force, key figures, what changes, the years, and where to go."""
    editions = changes["to_edition"].unique().sort().to_list() if changes.height else []
    chosen = newest_edition(editions, draft_of(methods))
    links = [(f"{name}.html", name, f"about_{name}") for name in CARDS] + guide_links()
    years = views.table("season_changes")
    sections = [
        Section(
            "now",
            "index_intro",
            key_figures=_figures(views),
            headline=headlines.changes(changes.filter(to_edition=chosen)) if editions else None,
        ),
        *_last_rebuild(views),
        Section("index_pages", links=links),
    ]
    if years.height:
        chart = Chart("season_change", "years", "season_change", {"method": "method"})
        sections.append(Section("years", "season_change_note", [chart]))
    sections.append(Section("methods", "methods_note", tables=[methods_table(views)]))
    return Page(
        "index.html",
        "index",
        sections,
        selects=[methods_select(methods)] if years.height else [],
        data={"years": [years]} if years.height else {},
    )


def _last_rebuild(views: Views) -> list[Section]:
    """What the rebuild that last changed something changed."""
    changes = last_changes(views.store)
    if changes is None:
        return []
    return [Section("last_rebuild", headline=lambda speech: in_short(changes, (), speech.say))]


def methods_table(views: Views) -> Table:
    """The methods, with the title in the language of the page."""
    frame = views.table("methods").with_columns(titles=pl.concat_list("title", "title_en"))
    return Table("methods", frame, ["method", "titles", "content_hash"], "methods")


def _figures(views: Views) -> list[tuple[str, str | Headline]]:
    """Which edition counts, and how much there is."""
    editions = views.table("editions").sort("valid_from")
    tows, season = views.table("tows"), pl.col("season")
    first, last = views.table("seasons").select(first=season.min(), last=season.max()).row(0)
    return [
        ("edition_in_force", _in_force(editions)),
        ("column.as_of", str(views.table("due_list")["as_of"].max())),
        ("boats_number", str(views.table("boats").height)),
        ("tows_number", f"{tows.height} ({first}\u2013{last})"),
    ]


def _in_force(editions: pl.DataFrame) -> Headline:
    def text(speech: Speech) -> str:
        if editions.is_empty():
            return speech.say("no_edition")
        last = editions.row(-1, named=True)
        return speech.say("edition_from").format(edition=last["edition"], day=last["valid_from"])

    return text


def words_page() -> Page:
    """What the words mean, and how to read a page."""
    terms = [(f"term_{name}", f"meaning_{name}") for name in TERMS]
    return Page("words.html", "words", [Section("words_list", "words_note", terms=terms)])
