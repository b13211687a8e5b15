"""Certificates and proposals: what goes into them, and that they are made alike each time."""

import datetime as dt
import io

import polars as pl
import pytest
from pypdf import PdfReader

from dashboards.documents import certificate, proposal
from dashboards.speech import Speech
from pipeline.errors import MissingKnowledgeError
from pipeline.races.race import power_per_rower_w
from pipeline.register.register import draft_name
from tests.conftest import METHODS
from tests.dashboards.conftest import EDITIONS
from warehouse.editions.compare import causes_of
from warehouse.queries.answers import compared, line_changes, replayed
from warehouse.queries.views import Views
from warehouse.store.methods import KnownMethods

ISSUED = certificate.Issued(dt.date(2016, 1, 1), "Federatie", "https://register.example/")


@pytest.fixture(scope="module")
def views(store):
    with Views(store) as views:
        yield views


@pytest.fixture
def contents(monkeypatch):
    """What templates are given, instead of the documents."""
    found = []
    for module in (certificate, proposal):
        monkeypatch.setattr(module, "pdf", lambda _, content: found.append(content) or b"")
    return found


def lines_of(views, edition):
    return views.register().filter(edition=edition).drop_nulls("cw_kg_m")


def test_a_certificate_says_what_the_register_says(views, contents):
    line = lines_of(views, EDITIONS[-1]).row(0, named=True)
    certificate.certificates(views, EDITIONS[-1], line["fsn_no"].lower(), "en", ISSUED)
    mine = [c for c in contents[0]["certificates"] if c["code"] == line["verification_code"]]
    assert len(mine) == 1
    shown = dict(mine[0]["left"]) | dict(mine[0]["right"])
    assert shown["A [kg/m]"] == f"{line['a_kg_m']:.3f}"
    assert shown["Valid until"] == Speech("en").day(line["valid_until"])
    assert shown["Decision"] == "SKC <8 mei>"
    assert shown["Issued by"] == "Federatie"
    assert shown["Tow"] == line["tow_id"]
    assert "<svg" in mine[0]["qr"]
    others = lines_of(views, EDITIONS[-1]).filter(fsn_no=line["fsn_no"]).height - 1
    assert len([other for other in mine[0]["others"] if other[1] != "\u2013"]) == others
    speed, cw, power = (float(text) for text in mine[0]["powers"][3])
    assert speed == pytest.approx(line["declared_speed_m_s"], abs=0.005)
    assert cw == pytest.approx(line["cw_kg_m"], abs=0.005)
    exact = power_per_rower_w(line["cw_kg_m"], line["declared_speed_m_s"], line["rowers"])
    assert power == pytest.approx(float(exact), abs=0.05)


@pytest.mark.parametrize(
    ("status", "days_after", "said"),
    [("valid", 0, "Geldig op"), ("valid", 1, "geldt niet meer op"), ("expired", 0, "geldt niet")],
)
def test_a_certificate_says_whether_it_holds(
    views, contents, monkeypatch, status, days_after, said
):
    (line, *_) = certificate.certificate_lines(views, EDITIONS[-1], None)
    monkeypatch.setattr(certificate, "certificate_lines", lambda *_: [line | {"status": status}])
    issued = certificate.Issued(line["valid_until"] + dt.timedelta(days=days_after))
    certificate.certificates(views, EDITIONS[-1], None, "nl", issued)
    assert said in contents[0]["certificates"][0]["validity"]


def test_a_draft_is_no_certificate(views, contents):
    line = lines_of(views, "concept-as-published").row(0, named=True)
    certificate.certificates(views, "concept-as-published", line["fsn_no"], "nl", ISSUED)
    assert "geen geldige meetbrief" in contents[0]["certificates"][0]["validity"]
    assert contents[0]["certificates"][0]["qr"] == ""
    assert contents[0]["simulated"].startswith("GESIMULEERD")


@pytest.mark.parametrize(("edition", "fsn_no"), [("1999-1", None), (EDITIONS[-1], "FSN9")])
def test_what_is_not_there_is_told(views, edition, fsn_no):
    with pytest.raises(MissingKnowledgeError, match=r"has no edition|no valid line"):
        certificate.certificates(views, edition, fsn_no, "nl", ISSUED)


def proposed(views, methods, language, *letter):
    known = KnownMethods.of(views.store)
    return proposal.proposal(views, methods, EDITIONS[0], language, known, *letter)


def test_a_proposal_counts_every_line_that_changes(views, contents):
    proposed(views, [METHODS[1]], "en")
    lines = proposal.compared(views, EDITIONS[0], f"concept-{METHODS[1]}")
    changed = lines.filter(change="changed").height
    parts = {part["title"]: part for part in contents[0]["parts"]}
    assert (
        f"{changed} of {lines.height} lines change"
        in parts["What changes: rules of 2015"]["sentences"][0]
    )
    by_type = parts["For whom: by type"]["rows"]
    assert sum(int(row[1]) for row in by_type) == lines.drop_nulls("cw_ratio").height
    (explained,) = contents[0]["methods"]
    assert all(explained[part] for part in ("steps", "boat", "curve", "uncertainty", "vote"))
    moved = lines.drop_nulls("gain_in_two_hours_s").filter(change="changed")
    named = len(parts.get("Who gains most", {"rows": ()})["rows"])
    assert named == min(10, moved.filter(pl.col("gain_in_two_hours_s") > 0).height)


def test_a_proposal_names_the_causes_that_pages_name(views):
    old, new = map(draft_name, METHODS)
    proposed = causes_of(compared(views, old, new))
    shown = causes_of(line_changes(views).filter(from_edition=old, to_edition=new))
    assert {"temperature", "wind"} & {cause["step"] for cause in proposed}
    for mine, theirs in zip(proposed, shown, strict=True):
        assert mine == pytest.approx(theirs)


def test_a_proposal_counts_flags_of_the_lines_that_are_voted_on(views, contents, monkeypatch):
    """A flag of a tow that a newer one superseded is about no line."""
    lines = compared(views, EDITIONS[0], f"concept-{METHODS[1]}")
    tows = lines.drop_nulls("new_cw_kg_m")["new_tow_id"]
    flagged = pl.DataFrame({"method": METHODS[1], "tow_id": [tows[0], tows[0], "superseded"]})
    ask = Views.ask
    monkeypatch.setattr(
        Views, "ask", lambda v, q, *of: flagged if q == "flagged_boats" else ask(v, q, *of)
    )
    proposed(views, [METHODS[1]], "en")
    said = [s for part in contents[0]["parts"] for s in part["sentences"]]
    assert any(f"still has to look at: 1 of {tows.len()}." in sentence for sentence in said)


def test_drafts_and_the_due_list_judge_on_one_day(views):
    drafts = views.table("register").filter(pl.col("edition").str.starts_with("concept-"))
    days = {*drafts["as_of"], *views.table("due_list")["as_of"]}
    assert days == {max(*views.table("tows")["tow_date"], *views.ask("races")["race_date"])}


def test_several_methods_make_a_ballot(views, contents):
    proposed(views, METHODS, "nl")
    assert [row[0] for row in contents[0]["parts"][0]["rows"]] == [
        "zoals gepubliceerd",
        "regels van 2015",
    ]


def test_the_same_tables_give_the_same_document(views):
    fsn_no = lines_of(views, EDITIONS[-1])["fsn_no"][0]
    made = [certificate.certificates(views, EDITIONS[-1], fsn_no, "nl", ISSUED) for _ in range(2)]
    assert made[0] == made[1]
    crews = lines_of(views, EDITIONS[-1]).filter(fsn_no=fsn_no).height
    assert len(PdfReader(io.BytesIO(made[0])).pages) == crews


def test_a_proposal_is_a_letter_of_six_pages_at_most_with_the_method_as_its_annex(views):
    letter = proposal.Letter("Bestuur <FSN>", dt.date(2026, 4, 1), dt.date(2026, 5, 1))
    made = proposed(views, [METHODS[1]], "nl", letter)
    texts = [page.extract_text() for page in PdfReader(io.BytesIO(made)).pages]
    annex = next(place for place, text in enumerate(texts) if "Bijlage" in text)
    assert annex <= 6
    assert "Bestuur <FSN>" in texts[0]
    assert "1 mei 2026" in " ".join(texts[0].split())
    assert "[steps" not in "".join(texts)


def test_a_proposal_counts_places_as_the_pages_of_races_do(views):
    _, (moved, results) = replayed(views, *EDITIONS)
    rows = views.ask("races").filter(from_edition=EDITIONS[0], to_edition=EDITIONS[1])
    placed = rows.drop_nulls("new_rank")
    assert results == placed.height > 0
    assert moved == placed.filter(pl.col("old_rank") != pl.col("new_rank")).height


def test_a_draft_that_could_not_be_made_has_no_results(views):
    winners, moved = replayed(views, EDITIONS[0], draft_name("never-made"))
    assert (winners["new_winner"].drop_nulls().to_list(), moved) == ([], (0, 0))
