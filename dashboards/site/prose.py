"""Pages that are read: the method, how to read an audit, and what goes with an edition."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Final

from markupsafe import Markup

from dashboards.guides import GUIDES, guide_file
from dashboards.markdown import to_html
from dashboards.site.downloads import files_of
from dashboards.site.parts import Page, Section, edition_page
from dashboards.speech import Speech
from pipeline.words import LANGUAGES
from pipeline.words.guides import GUIDES_IN_SHORT
from warehouse.queries.views import Views
from warehouse.store.editions import NOTES, NOTES_EN, NOTICE, NOTICE_EN, edition_path

_TEXTS: Final = {"notice": (NOTICE, NOTICE_EN), "release_notes": (NOTES, NOTES_EN)}


def guide_pages() -> Iterator[Page]:
    """The documents in short, then whole."""
    links = {f"{name}.md": f"{name}.html" for name in GUIDES}
    for name in GUIDES:
        nl, en = (guide_file(name, language).read_text(encoding="utf-8") for language in LANGUAGES)
        prose = _in_language((nl, en), links)
        short = Section("guide_in_short", prose=_in_language(GUIDES_IN_SHORT[name], {}))
        whole = Section("guide_whole", "guide_note", prose=prose)
        yield Page(f"{name}.html", f"guide_{name}", [short, whole])


def guide_links() -> list[tuple[str, str, str]]:
    """Path of each document, key of its title and of a sentence about it."""
    return [(f"{name}.html", f"guide_{name}", f"about_guide_{name}") for name in GUIDES]


def edition_pages(views: Views) -> Iterator[Page]:
    """Per published edition its notice and release notes, in the language of the page."""
    for edition in views.table("editions")["edition"]:
        folder = edition_path(views.store, edition)
        yield Page(
            edition_page(edition),
            "edition_title",
            [
                *(
                    Section(title, prose=_in_language(_texts(folder, files), {}))
                    for title, files in _TEXTS.items()
                ),
                Section("downloads", "downloads_note", files=files_of(edition)),
            ],
            name=edition,
        )


def _texts(folder: Path, files: tuple[str, str]) -> tuple[str, str]:
    dutch, english = ((folder / file).read_bytes().decode() for file in files)
    return dutch, english


def _in_language(in_each: tuple[str, str], links: Mapping[str, str]) -> Callable[[Speech], Markup]:
    """The document in the language of the page."""
    texts = dict(zip(LANGUAGES, in_each, strict=True))
    return lambda speech: to_html(texts[speech.language], links)
