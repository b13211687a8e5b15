"""What is shown of a published edition stays, whatever the warehouse becomes."""

import datetime as dt

import duckdb
import pytest

from dashboards.document import Document
from dashboards.language import Language
from dashboards.paper import make_pdf
from dashboards.queries.boats import read_answers
from dashboards.queries.pages import read_register
from dashboards.queries.papers import read_certificates
from dashboards.queries.results import Results
from dashboards.templates import get_template
from pipeline.method.reading import read_shipped_method
from warehouse.editions.publish import Terms, publish
from warehouse.queries.views import Views

pytestmark = pytest.mark.more

EDITION, METHOD, DAY = "2014-1", "rebased", dt.date(2014, 6, 1)
OF_TODAY = ("tow_speed_m_s", "speed_reason")
"""The next tow is due by the tows of today."""


def lines_of(views, edition):
    data = read_register(Results(views), edition)
    return data["as_of"], data["lines"].filter(edition=edition).to_dicts()


def shown(store):
    """Answers on the boats' pages without what is of today, the register and all certificates."""
    names = Document(Language("en")).get_names()
    answer = get_template("answer.html.j2").make_module(names)
    with Views(store) as views:
        crews = [one for own in read_answers(Results(views), EDITION).values() for one in own]
        pages = []
        for crew in crews:
            line = crew | dict.fromkeys(OF_TODAY)
            macros = (answer.number_of, answer.bars_of, answer.reasons_of, answer.certainty_of)
            pages.append("".join(str(macro(line)) for macro in macros))
        papers = read_certificates(views, EDITION, None, day=DAY)
        paper = make_pdf("certificate", papers, "en", EDITION, simulated=True)
        return pages, lines_of(views, EDITION), paper


def change_lists(archive):
    """Other names and types under the same numbers, and other temperatures."""
    for file, was, now in (
        ("sloepregister/sloependata.csv", b"loep ", b"loep anders "),
        ("sloepregister/sloependata.csv", b";Stersloep;", b";Barkas;"),
        ("sleeplijsten/sleeplijst_2014.csv", b",4.", b",9."),
    ):
        text = (archive / file).read_bytes()
        assert was in text
        (archive / file).write_bytes(text.replace(was, now))


def test_an_edition_stays_on_pages_register_and_certificates(bench):
    bench.rebuild((METHOD,))
    terms = Terms(EDITION, DAY, "besluit van de ALV", DAY)
    publish(bench.store, read_shipped_method(METHOD), terms)
    before = shown(bench.store)
    with Views(bench.store) as views:
        draft = lines_of(views, f"concept-{METHOD}")
    assert any("the log read" in page for page in before[0])
    change_lists(bench.archive)
    bench.rebuild(("as-published", METHOD))
    with Views(bench.store) as views:
        assert lines_of(views, f"concept-{METHOD}") != draft
    with duckdb.connect(bench.store.database) as db:
        db.execute("UPDATE about SET value = 'other' WHERE key = 'code_version'")
        db.execute("DELETE FROM methods")
    assert shown(bench.store) == before
