"""What is shown of a published edition stays, whatever the warehouse becomes."""

import datetime as dt

import duckdb

from dashboards.documents import certificate
from dashboards.speech import Speech
from dashboards.statements.boat import answers_by_boat
from pipeline.method.reading import read_shipped_method
from warehouse.editions.publish import Terms, publish
from warehouse.queries.registers import register_report
from warehouse.queries.views import Views

EDITION, METHOD, DAY = "2014-1", "rebased", dt.date(2014, 6, 1)
OF_TODAY = ("tow_speed_m_s", "speed_reason")
"""The next tow is due by the tows of today."""


def shown(store):
    """Answers on the boats' pages without what is of today, the register and all certificates."""
    with Views(store) as views:
        answers = [one for crews in answers_by_boat(views, EDITION).values() for one in crews]
        for answer in answers:
            answer.line.update(dict.fromkeys(OF_TODAY))
        english = Speech("en")
        pages = [
            [*(one(english) for one in answer.statements), *answer.waterfall] for answer in answers
        ]
        paper = certificate.certificates(views, EDITION, None, "en", certificate.Issued(DAY))
    return pages, register_report(store, EDITION), paper


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
    before, draft = shown(bench.store), register_report(bench.store, f"concept-{METHOD}")
    assert any("the log read" in text for page in before[0] for text in page)
    change_lists(bench.archive)
    bench.rebuild(("as-published", METHOD))
    assert register_report(bench.store, f"concept-{METHOD}") != draft
    with duckdb.connect(bench.store.database) as db:
        db.execute("UPDATE about SET value = 'other' WHERE key = 'code_version'")
        db.execute("DELETE FROM methods")
    assert shown(bench.store) == before
