"""Pages that are read: the methods, how to read an audit, and each edition."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Final

from markupsafe import Markup

from dashboards import labels
from dashboards.addresses import edition_page
from dashboards.documents import pdf
from dashboards.guides import GUIDES, guide_file, method_guide
from dashboards.html import keep_units
from dashboards.markdown import to_blocks, to_html
from dashboards.measured import CAPTION, picture
from dashboards.site.parts import Chart, Page, Section
from dashboards.speech import Speech
from dashboards.statements import Statement, together
from dashboards.statements.method import BASES, EACH_STEP, VOTE, WORKED, Explained, explained
from pipeline.messages import Sentence, say
from pipeline.register.register import STUDIED_METHOD, default_method
from warehouse.queries.views import Views
from warehouse.store.editions import CSV, NOTICE, NOTICE_EN, XLSX, edition_names, edition_path
from warehouse.store.store import Store

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
    title, prose = TITLES["audit"][0], _read(partial(guide_file, "audit"))
    return Page("audit.html", title, [Section("guide", title, prose=prose)])


def _read(
    file: Callable[[str], Path], links: Mapping[str, str] = LINKS
) -> Callable[[Speech], Markup]:
    """A document in the language of the page, without its title: the section has one."""
    return lambda speech: _below_title(file(speech.language).read_text("utf-8"), links)


def _below_title(text: str, links: Mapping[str, str] = LINKS) -> Markup:
    return to_html(text.split("\n", 1)[1], links)


def guide_links() -> list[tuple[str, Sentence, Sentence]]:
    """Path of each document, its title and a sentence about it."""
    return [(f"{name}.html", *TITLES[name]) for name in GUIDES]


def method_pages(views: Views, methods: Sequence[str]) -> Iterator[Page]:
    """The page of each method; that of the default one is the page of the method."""
    paths = {name: f"method-{name}.html" for name in methods}
    paths[default_method(methods)] = "method.html"
    for name, path in paths.items():
        others = {other: to for other, to in paths.items() if other != name}
        yield _page(path, explained(views, name), others)


def _page(path: str, told: Explained, others: dict[str, str]) -> Page:
    name = told.method.name
    links = [(to, labels.method(other), "") for other, to in others.items()]
    sections = [
        Section("measured", say("What is measured"), prose=_measured),
        Section(
            "steps",
            EACH_STEP,
            BASES,
            terms=[(step.name, together(step.statements, " ")) for step in told.steps],
        ),
        *_worked(told),
        Section("certain", say("How certain it is"), prose=_certain(told)),
        Section("vote", VOTE, prose=_listed(told.vote)),
        _folded("runs", say("From six runs to a curve")),
        *([_folded("added", say("What re-based adds"))] if name == STUDIED_METHOD else []),
        _folded("register", say("From curve to register")),
        Section("methods", say("Other methods"), links=links),
    ]
    title = say("The method: {method}", method=labels.method(name))
    return Page(path, title, sections)


def _worked(told: Explained) -> Iterator[Section]:
    if told.worked is not None:
        chart = Chart("resistance_curve", [told.worked.drawn], say("Resistance curve"))
        yield Section("worked", WORKED, charts=[chart], prose=_listed(told.worked.statements))


def _measured(speech: Speech) -> Markup:
    """The picture, and below it the text."""
    drawing = Markup('<figure>{}<figcaption class="says">{}</figcaption></figure>')
    return drawing.format(picture(speech), speech.say(CAPTION)) + _text("measured")(speech)


def _certain(told: Explained) -> Callable[[Speech], Markup]:
    return lambda speech: _listed(told.uncertainty)(speech) + _text("certain")(speech)


def _folded(part: str, title: Sentence) -> Section:
    return Section(f"guide_{part}", title, prose=_text(part), folded=True)


def _text(part: str) -> Callable[[Speech], Markup]:
    """A section of the document on methods."""
    return lambda speech: _below_title(getattr(method_guide(speech.language), part))


def _listed(statements: Sequence[Statement]) -> Callable[[Speech], Markup]:
    """A paragraph for each statement."""
    paragraph = Markup("<p>{}</p>")
    return lambda speech: Markup("").join(
        paragraph.format(keep_units(statement(speech))) for statement in statements
    )


DOWNLOADS: Final = "downloads"
SHEETS: Final = (CSV, XLSX)
NOTICES: Final = {"nl": NOTICE, "en": NOTICE_EN}
PAPERS: Final = {"bericht.pdf": "nl", "notice.pdf": "en"}
"""The notice as it is made for paper, and its language."""


def edition_pages(views: Views) -> Iterator[Page]:
    """Per published edition its notice, in the language of the page."""
    for edition in views.table("editions")["edition"]:
        notice = _read(partial(_notice_file, edition_path(views.store, edition)), {})
        sections = [
            Section("notice", say("Notice to the members"), prose=notice),
            Section("downloads", say("Downloads"), files=files_of(edition)),
        ]
        yield Page(edition_page(edition), say("Edition"), sections, name=edition)


def _notice_file(folder: Path, language: str) -> Path:
    return folder / NOTICES[language]


def files_of(edition: str) -> list[tuple[str, str]]:
    """Path within the site and name of all there is to download of an edition."""
    return [(f"{DOWNLOADS}/{edition}/{f}", f"{edition} {f}") for f in (*SHEETS, *PAPERS)]


def copy_sheets(store: Store, folder: Path) -> None:
    """Copies the sheets of every edition to `downloads/<edition>/`, byte for byte, with papers."""
    for edition in edition_names(store):
        source, target = edition_path(store, edition), folder / DOWNLOADS / edition
        target.mkdir(parents=True)
        for name in SHEETS:
            (target / name).write_bytes((source / name).read_bytes())
        for name, language in PAPERS.items():
            text = _notice_file(source, language).read_text("utf-8")
            (target / name).write_bytes(notice(text, language))


def notice(text: str, language: str) -> bytes:
    """A notice to the members, written in Markdown, as PDF."""
    blocks = to_blocks(text)
    title = "".join(run["text"] for run in blocks[0]["runs"])
    content = {"title": title, "language": language, "simulated": "", "blocks": blocks}
    return pdf("notice.typ", content)
