"""A page per method: in two pages what it measures, what its steps do, and what is voted on."""

from collections.abc import Callable, Iterator, Sequence

from markupsafe import Markup

from dashboards import labels
from dashboards.guides import method_guide
from dashboards.html import keep_units
from dashboards.measured import CAPTION, picture
from dashboards.site.parts import Chart, Page, Section, default_method
from dashboards.site.prose import LINKS, in_language
from dashboards.speech import Speech
from dashboards.statements import Statement, together
from dashboards.statements.method import BASES, EACH_STEP, VOTE, WORKED, Explained, explained
from pipeline.messages import LANGUAGES, Sentence, say
from warehouse.derive.studies import STUDIED_METHOD
from warehouse.queries.views import Views


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
        _read("runs", say("From six runs to a curve")),
        *([_read("added", say("What re-based adds"))] if name == STUDIED_METHOD else []),
        _read("register", say("From curve to register")),
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


def _read(part: str, title: Sentence) -> Section:
    return Section(f"guide_{part}", title, prose=_text(part), folded=True)


def _text(part: str) -> Callable[[Speech], Markup]:
    """A section of the document on methods without its heading."""
    texts = (getattr(method_guide(language), part) for language in LANGUAGES)
    nl, en = (text.split("\n", 1)[1] for text in texts)
    return in_language((nl, en), LINKS)


def _listed(statements: Sequence[Statement]) -> Callable[[Speech], Markup]:
    """A paragraph for each statement."""
    paragraph = Markup("<p>{}</p>")
    return lambda speech: Markup("").join(
        paragraph.format(keep_units(statement(speech))) for statement in statements
    )
