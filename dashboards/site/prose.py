"""Pages that are read: the method, how to read an audit, and what goes with an edition."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

from markupsafe import Markup

from dashboards.guides import GUIDES, guide_file
from dashboards.markdown import to_html
from dashboards.site.downloads import files_of
from dashboards.site.parts import Page, Section, edition_page
from dashboards.speech import Speech
from pipeline.messages import LANGUAGES, Sentence, say
from warehouse.queries.views import Views
from warehouse.store.editions import NOTES, NOTES_EN, NOTICE, NOTICE_EN, edition_path

_SHORT: Final = Path(__file__).parent / "guides"
"""The documents in short."""

_TEXTS: Final = {
    "notice": (say("Notice to the members"), NOTICE, NOTICE_EN),
    "release_notes": (say("Release notes"), NOTES, NOTES_EN),
}


TITLES: Final = {
    "method": (
        say("The method"),
        say("Every formula, from samples to a register line, with its source."),
    ),
    "audit": (
        say("Reading an audit"),
        say("How to read the audit of a boat or a type."),
    ),
}
"""Title of each document, and a sentence about it."""


def guide_pages() -> Iterator[Page]:
    """The documents in short, then whole."""
    links = {f"{name}.md": f"{name}.html" for name in GUIDES}
    for name in GUIDES:
        nl, en = (guide_file(name, language).read_text(encoding="utf-8") for language in LANGUAGES)
        prose = _in_language((nl, en), links)
        short = Section("guide_in_short", say("In short"), prose=_in_language(_short(name), {}))
        whole = Section(
            "guide_whole",
            say("The whole text"),
            say("The document of the project, as it is shipped with the program."),
            prose=prose,
        )
        yield Page(f"{name}.html", TITLES[name][0], [short, whole])


def _short(name: str) -> tuple[str, str]:
    nl, en = (_SHORT / f"{name}.{language}.md" for language in LANGUAGES)
    return nl.read_text(encoding="utf-8"), en.read_text(encoding="utf-8")


def guide_links() -> list[tuple[str, Sentence, Sentence]]:
    """Path of each document, its title and a sentence about it."""
    return [(f"{name}.html", *TITLES[name]) for name in GUIDES]


def edition_pages(views: Views) -> Iterator[Page]:
    """Per published edition its notice and release notes, in the language of the page."""
    for edition in views.table("editions")["edition"]:
        folder = edition_path(views.store, edition)
        yield Page(
            edition_page(edition),
            say("Edition"),
            [
                *(
                    Section(name, title, prose=_in_language(_texts(folder, files), {}))
                    for name, (title, *files) in _TEXTS.items()
                ),
                Section(
                    "downloads",
                    say("Downloads"),
                    say(
                        "The register of every edition as published, with the notice to the "
                        "members and the release notes in Dutch and English."
                    ),
                    files=files_of(edition),
                ),
            ],
            name=edition,
        )


def _texts(folder: Path, files: Sequence[str]) -> tuple[str, str]:
    dutch, english = ((folder / file).read_bytes().decode() for file in files)
    return dutch, english


def _in_language(in_each: tuple[str, str], links: Mapping[str, str]) -> Callable[[Speech], Markup]:
    """The document in the language of the page."""
    texts = dict(zip(LANGUAGES, in_each, strict=True))
    return lambda speech: to_html(texts[speech.language], links)
