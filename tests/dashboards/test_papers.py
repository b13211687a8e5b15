"""Certificates and proposals: what goes into them, and that they are made alike each time."""

import datetime as dt
import io

import polars as pl
import pytest
from pypdf import PdfReader

from dashboards.document import Document
from dashboards.language import Language
from dashboards.paper import make_pdf
from dashboards.queries import papers
from dashboards.queries.papers import read_certificates, read_proposal
from dashboards.reading import read_blocks
from pipeline.errors import MissingKnowledgeError
from pipeline.races.race import power_per_rower_w
from pipeline.register.causes import summarise_causes
from pipeline.register.register import name_draft
from tests.conftest import METHODS
from tests.dashboards.conftest import EDITIONS
from warehouse.queries.answers import compare_editions, compare_races, line_changes
from warehouse.queries.views import Views

PLAIN = {"sender": "", "date": None, "valid_from": None}


@pytest.fixture(scope="module")
def views(store):
    with Views(store) as views:
        yield views


def lines_of(views, edition):
    return views.register().filter(edition=edition).drop_nulls("cw_kg_m")


def certificate_of(views, line, edition=EDITIONS[-1], **terms):
    made = read_certificates(views, edition, line["fsn_no"], **terms)
    return next(one for one in made if one["line"]["crew_class"] == line["crew_class"]
                and one["line"]["rowers"] == line["rowers"])  # fmt: skip


def blocks_of(template, data, language="en"):
    return read_blocks(Document(Language(language)).render(template, **data))


def everything(blocks):
    """The blocks of a document, those in columns too."""
    for block in blocks:
        yield block
        for part in block.parts:
            yield from everything(part)


def test_a_certificate_says_what_the_register_says(views):
    line = lines_of(views, EDITIONS[-1]).row(0, named=True)
    terms = {"issuer": "Federatie", "site": "https://register.example/"}
    made = certificate_of(views, line, day=dt.date(2016, 1, 1), **terms)
    assert made["line"]["verification_code"] == line["verification_code"]
    blocks = list(everything(blocks_of("certificate", made)))
    facts = dict(row for block in blocks if block.look == "facts" for row in block.rows)
    assert facts["A [kg/m]"] == f"{line['a_kg_m']:.3f}"
    assert facts["Valid until"] == Language("en").write_day(line["valid_until"])
    assert facts["Decision"] == "SKC <8 mei>"
    assert facts["Issued by"] == "Federatie"
    assert facts["Tow"] == line["tow_id"]
    pictures = [block.caption for block in blocks if block.kind == "picture"]
    assert len(pictures) == 3, pictures  # the code, the number and the curve
    tables = [block.rows for block in blocks if block.kind == "table" and block.look != "facts"]
    speed, cw, power = (float(text) for text in tables[0][4])
    assert speed == pytest.approx(line["declared_speed_m_s"], abs=0.005)
    assert cw == pytest.approx(line["cw_kg_m"], abs=0.005)
    exact = power_per_rower_w(line["cw_kg_m"], line["declared_speed_m_s"], line["rowers"])
    assert power == pytest.approx(float(exact), abs=0.05)
    others = lines_of(views, EDITIONS[-1]).filter(fsn_no=line["fsn_no"]).height - 1
    known = [row for table in tables[1:] for row in table[1:] if row[1] != "\N{EN DASH}"]
    assert len(known) == others


@pytest.mark.parametrize(
    ("status", "days_after", "said"),
    [("valid", 0, "Geldig op"), ("valid", 1, "geldt niet meer op"), ("expired", 0, "geldt niet")],
)
def test_a_certificate_says_whether_it_holds(views, monkeypatch, status, days_after, said):
    (line, *_) = papers.read_certificate_lines(views, EDITIONS[-1], None)
    monkeypatch.setattr(papers, "read_certificate_lines", lambda *_: [line | {"status": status}])
    day = line["valid_until"] + dt.timedelta(days=days_after)
    (made,) = read_certificates(views, EDITIONS[-1], None, day=day)
    (shown,) = [
        one.text
        for one in everything(blocks_of("certificate", made, "nl"))
        if one.said.startswith("certificate")
    ]
    assert said in shown


def test_a_draft_is_no_certificate(views):
    line = lines_of(views, "concept-as-published").row(0, named=True)
    made = certificate_of(views, line, "concept-as-published")
    assert (made["status"], made["qr"]) == ("draft", "")


@pytest.mark.parametrize(("edition", "fsn_no"), [("1999-1", None), (EDITIONS[-1], "FSN9")])
def test_what_is_not_there_is_told(views, edition, fsn_no):
    with pytest.raises(MissingKnowledgeError, match=r"has no edition|no valid line"):
        read_certificates(views, edition, fsn_no)


def proposed(views, methods, letter=PLAIN):
    titles = {name: f"Title of {name}" for name in methods}
    return read_proposal(views, methods, EDITIONS[0], titles, letter)


def test_a_proposal_counts_every_line_that_changes(views):
    data = proposed(views, [METHODS[1]])
    (one,) = data["proposals"]
    lines = compare_editions(views, EDITIONS[0], name_draft(METHODS[1]))
    changed = lines.filter(change="changed").height
    texts = [block.text for block in everything(blocks_of("proposal", data))]
    assert any(f"{changed} of {lines.height} lines change" in text for text in texts)
    assert one["types"]["lines"].sum() == lines.drop_nulls("cw_ratio").height
    assert all(one["explained"][part] for part in ("steps", "worked", "certain", "voted"))
    moved = lines.drop_nulls("gain_in_two_hours_s").filter(change="changed")
    gaining = moved.filter(pl.col("gain_in_two_hours_s") > 0).height
    assert one["gaining"].height == min(papers.MAX_CREWS_NAMED, gaining)


def test_a_proposal_names_the_causes_that_pages_name(views):
    old, new = map(name_draft, METHODS)
    mine = summarise_causes(compare_editions(views, old, new))
    shown = summarise_causes(line_changes(views).filter(from_edition=old, to_edition=new))
    assert {"temperature", "wind"} & {cause["step"] for cause in mine}
    for one, other in zip(mine, shown, strict=True):
        assert one == pytest.approx(other)


def test_a_proposal_counts_flags_of_the_lines_that_are_voted_on(views, monkeypatch):
    """A flag of a tow that a newer one superseded is about no line."""
    lines = compare_editions(views, EDITIONS[0], name_draft(METHODS[1]))
    tows = lines.drop_nulls("new_cw_kg_m")["new_tow_id"]
    flagged = pl.DataFrame({"method": METHODS[1], "tow_id": [tows[0], tows[0], "superseded"]})
    ask = Views.ask
    monkeypatch.setattr(
        Views, "ask", lambda v, q, *of: flagged if q == "flagged_boats" else ask(v, q, *of)
    )
    (one,) = proposed(views, [METHODS[1]])["proposals"]
    assert one["flagged"] == {"flagged": 1, "lines": tows.len()}


def test_drafts_and_the_due_list_judge_on_one_day(views):
    drafts = views.table("register").filter(pl.col("edition").str.starts_with("concept-"))
    days = {*drafts["as_of"], *views.table("due_list")["as_of"]}
    assert days == {max(*views.table("tows")["tow_date"], *views.ask("races")["race_date"])}


def test_several_methods_make_a_ballot(views):
    data = proposed(views, METHODS)
    (ballot,) = [
        block.rows
        for block in everything(blocks_of("proposal", data, "nl"))
        if block.kind == "table" and block.rows[0][0] == "Methode"
    ]
    assert [row[0] for row in ballot[1:]] == ["zoals gepubliceerd", "regels van 2015"]


def test_the_same_tables_give_the_same_document_with_a_page_per_crew(views):
    fsn_no = lines_of(views, EDITIONS[-1])["fsn_no"][0]
    pages = read_certificates(views, EDITIONS[-1], fsn_no)
    made = [make_pdf("certificate", pages, "nl", "x", simulated=True) for _ in range(2)]
    assert made[0] == made[1]
    crews = lines_of(views, EDITIONS[-1]).filter(fsn_no=fsn_no).height
    texts = [page.extract_text() for page in PdfReader(io.BytesIO(made[0])).pages]
    assert len(texts) == crews
    assert all("GESIMULEERD" in text for text in texts)


def test_a_proposal_is_a_letter_of_six_pages_at_most_with_the_method_as_its_annex(views):
    letter = {
        "sender": "Bestuur <FSN>", "date": dt.date(2026, 4, 1), "valid_from": dt.date(2026, 5, 1)
    }  # fmt: skip
    data = proposed(views, [METHODS[1]], letter)
    made = make_pdf("proposal", [data], "nl", "x", simulated=True)
    texts = [page.extract_text() for page in PdfReader(io.BytesIO(made)).pages]
    annex = next(place for place, text in enumerate(texts) if "Bijlage" in text)
    assert annex <= 6
    assert "Bestuur <FSN>" in texts[0]
    assert "1 mei 2026" in " ".join(texts[0].split())
    assert "Wat elke stap hier doet" in " ".join("".join(texts[annex:]).split())


def test_a_proposal_counts_places_as_the_pages_of_races_do(views):
    _, (moved, results) = compare_races(views, *EDITIONS)
    rows = views.ask("races").filter(from_edition=EDITIONS[0], to_edition=EDITIONS[1])
    placed = rows.drop_nulls("new_rank")
    assert results == placed.height > 0
    assert moved == placed.filter(pl.col("old_rank") != pl.col("new_rank")).height


def test_a_draft_that_could_not_be_made_has_no_results(views):
    winners, moved = compare_races(views, EDITIONS[0], name_draft("never-made"))
    assert (winners["new_winner"].drop_nulls().to_list(), moved) == ([], (0, 0))
