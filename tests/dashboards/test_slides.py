"""The slides: what each holds and says, and the PDF."""

import io

import polars as pl
import pypdf
import pytest

from dashboards.documents.slides import slide_book as as_pdf
from dashboards.speech import Speech
from dashboards.statements import slides as slide_book
from dashboards.statements import together
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import LANGUAGES
from warehouse.queries.views import Views


@pytest.fixture(scope="module")
def views(built):
    with Views(built.store) as views:
        yield views


@pytest.fixture
def book(views):
    return slide_book.Book(views)


def line(**differs):
    return {
        "slope_lo": -1.0,
        "slope_hi": 1.0,
        "r2": 0.1,
        "n": 9,
        "n_boats": 7,
        "slope": 0.5,
        "boat_type": "galjas",
    } | differs


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_slide_has_a_finding_rows_and_a_source(views, language):
    made = list(slide_book.slides(views))
    assert len({slide.name for slide in made}) == len(made) >= 3
    for slide in made:
        assert slide.rows.height
        assert set(slide.rows["method"]) <= set(views.table("methods")["method"])
        assert views.table(slide.source).height
        texts = [Speech(language).words(text) for text in (slide.finding, *slide.notes)]
        assert all(texts)
        assert "{" not in "".join(texts)
    pairs = views.table("reproducibility").filter(scope="all")["n_pairs"].min()
    assert (made[-1].name == "conclusion") == (pairs >= slide_book.FEWEST)


@pytest.mark.parametrize(
    ("differs", "verdict"),
    [
        ({"slope_lo": 0.1}, "B rises with weight"),
        ({"slope_hi": -0.1}, "B falls with weight"),
        ({}, "no relation seen between B and weight"),
        ({"r2": 0.5}, "too few boats to tell whether B goes with weight"),
    ],
)
def test_a_verdict_follows_the_interval_of_the_slope(differs, verdict):
    assert slide_book.relation("b_weight", line(**differs))(Speech("en")) == verdict


def test_nothing_is_found_in_the_line_of_a_few_boats(book, monkeypatch):
    (boat_type, *_) = book.chosen_types(())
    for boats, slides in ((slide_book.FEWEST, 1), (slide_book.FEWEST - 1, 0)):
        monkeypatch.setattr(book, "line", lambda *_, n=boats: line(n_boats=n))
        assert len(list(book.against("b_weight", boat_type))) == slides


def test_a_line_without_a_spread_explains_nothing_that_is_known(book, monkeypatch):
    lines = iter([line(r2=None), line(r2=0.36)])
    monkeypatch.setattr(book, "line", lambda *_: next(lines))
    assert book.fit("b_weight", "galjas")(Speech("en")).startswith("R² is 36 % ")
    lines = iter([None, line(r2=None)])
    assert "R² is not known" in book.fit("b_weight", "galjas")(Speech("en"))


@pytest.mark.parametrize(
    ("shift", "apart", "said"),
    [
        (0.877, True, "re-based Cw falls by 12.3 %"),
        (1.02, True, "re-based Cw rises by 2.0 %"),
        (0.99, False, "re-based no difference is seen"),
    ],
)
def test_an_era_is_compared_from_old_to_new(shift, apart, said):
    row = {"method": "rebased", "shift_ratio": shift, "apart": apart}
    assert slide_book.shift(row)(Speech("en")) == said


def test_a_page_says_of_a_type_how_many_tows_its_line_rests_on(book):
    for boat_type in book.chosen_types(()):
        found = book.line("cw_weight", boat_type, book.ends[1])
        said = together(book.in_words("cw_weight", boat_type), " ")(Speech("en"))
        assert (f"{found['n']} tow" in said) == (found["slope"] is not None)
        drawn = book.drawn(boat_type)
        assert set(drawn["boat_type"]) == {boat_type}
        assert drawn.filter(pl.col("quantity").is_null()).height


def test_men_and_women_are_spoken_of_apart_where_tow_speed_explains(book):
    for boat_type in book.chosen_types(()):
        for figure in ("b_speed", "cw_speed"):
            lines = {
                crews: book.line(figure, boat_type, book.ends[1], crews)
                for crews in ("men", "women")
            }
            said = [one(Speech("en")) for one in book.in_words(figure, boat_type)]
            of_crews = [one for one in said if not one.startswith("R²")]
            assert [one.rpartition(" ")[2] for one in of_crews] == ["men.", "women."]
            for one, line in zip(of_crews, lines.values(), strict=True):
                assert ("Too few boats" in one) == (line["slope"] is None)
            for slide in book.against(figure, boat_type):
                assert slide.finding(Speech("en")).count(" among ") == sum(
                    line["n_boats"] >= slide_book.FEWEST for line in lines.values()
                )
            drawn = book.drawn(boat_type, figure=figure).filter(pl.col("quantity").is_not_null())
            assert set(drawn["crew_class"]) <= {"H", "D"}


def test_a_type_that_is_not_there_is_refused(views):
    with pytest.raises(MissingKnowledgeError, match="Galjas"):
        list(slide_book.slides(views, ["Galjas"]))


def test_the_pdf_has_a_page_for_each_slide(views):
    made = list(slide_book.slides(views))
    pages = pypdf.PdfReader(io.BytesIO(as_pdf(views, "nl"))).pages
    assert len(pages) == len(made)
    for slide, page in zip(made, pages, strict=True):
        text = " ".join(page.extract_text().split())
        assert slide.finding(Speech("nl")) in text
        assert "GESIMULEERD" in text
