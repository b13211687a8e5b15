"""Pages that are read: how to read an audit, and what goes with an edition."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Final

from markupsafe import Markup

from dashboards.addresses import edition_page
from dashboards.guides import GUIDES, guide_file
from dashboards.markdown import to_html
from dashboards.site.downloads import files_of
from dashboards.site.parts import Page, Section
from dashboards.speech import Speech
from pipeline.messages import LANGUAGES, Sentence, say
from warehouse.queries.views import Views
from warehouse.store.editions import NOTICE, NOTICE_EN, edition_path

TITLES: Final = {
    "method": (
        say("The method"),
        say("In two pages: what is measured, what each step does here, and what is voted on."),
    ),
    "audit": (say("Reading an audit"), say("How to read the audit of a boat or a type.")),
}
"""Title of each document, and a sentence about it."""


LINKS: Final = {f"{name}.md": f"{name}.html" for name in GUIDES}
"""Where links between the documents lead on the site."""


def audit_guide() -> Page:
    """The document on audits, as it is shipped with the program."""
    nl, en = (_below_title(guide_file("audit", language)) for language in LANGUAGES)
    title = TITLES["audit"][0]
    return Page("audit.html", title, [Section("guide", title, prose=in_language((nl, en), LINKS))])


def _below_title(file: Path) -> str:
    """A document without its title: the page or section has one."""
    return file.read_bytes().decode().split("\n", 1)[1]


def guide_links() -> list[tuple[str, Sentence, Sentence]]:
    """Path of each document, its title and a sentence about it."""
    return [(f"{name}.html", *TITLES[name]) for name in GUIDES]


def edition_pages(views: Views) -> Iterator[Page]:
    """Per published edition its notice, in the language of the page."""
    for edition in views.table("editions")["edition"]:
        folder = edition_path(views.store, edition)
        dutch, english = (_below_title(folder / file) for file in (NOTICE, NOTICE_EN))
        yield Page(
            edition_page(edition),
            say("Edition"),
            [
                Section(
                    "notice", say("Notice to the members"), prose=in_language((dutch, english), {})
                ),
                Section("downloads", say("Downloads"), files=files_of(edition)),
            ],
            name=edition,
        )


def in_language(in_each: tuple[str, str], links: Mapping[str, str]) -> Callable[[Speech], Markup]:
    """The document in the language of the page."""
    texts = dict(zip(LANGUAGES, in_each, strict=True))
    return lambda speech: to_html(texts[speech.language], links)
