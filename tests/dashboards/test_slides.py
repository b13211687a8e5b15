"""The slide book: what each slide holds and says, and the files."""

import itertools
import re

import pypdf
import pytest

from dashboards import slide_book as book
from dashboards import slides as files
from dashboards.figures.slides import METHODS
from dashboards.site.slides import sentences
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import LANGUAGES, speaker
from warehouse.queries.views import Views


@pytest.fixture(scope="module")
def made(built):
    with Views(built.store) as views:
        return {language: list(book.slides(views, speaker(language))) for language in LANGUAGES}


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_slide_has_rows_a_title_and_a_whole_sentence(made, language):
    for slide in made[language]:
        assert slide.rows.height
        assert slide.title
        assert slide.sentence.endswith(".")
        assert "{" not in slide.title + slide.sentence
    names = [slide.name for slide in made[language]]
    assert len(set(names)) == len(names) >= 14


def test_a_b_and_cw_stand_against_weight_speed_and_length(made):
    named = {slide.figure for slide in made["nl"]}
    pairs = itertools.product(("a", "b", "cw"), ("weight", "speed", "length"))
    assert {f"slide_{y}_{x}" for y, x in pairs} <= named


def test_the_tows_of_all_seasons_are_drawn_under_every_method(made, built):
    rows = next(s.rows for s in made["nl"] if s.figure == "slide_cw_weight")
    tows = rows.filter(kind="tow")
    assert tows["season"].unique().sort().to_list() == [2009, 2014]
    assert set(tows["method"]) == set(METHODS) & set(built.table("methods")["method"])
    of_2014 = next(s.rows for s in made["nl"] if s.name == "cw weight 2014")
    assert of_2014.filter(kind="tow")["season"].unique().to_list() == [2014]


def test_a_range_of_seasons_draws_its_tows_alone(built):
    with Views(built.store) as views:
        first = next(book.slides(views, speaker("en"), book.Asked(tows="2014:2015")))
    assert first.rows.filter(kind="tow")["season"].unique().to_list() == [2014]
    assert first.rows.filter(kind="line").height
    assert "2014\N{EN DASH}2015" in first.title


def test_pages_say_of_every_choice_and_type_how_many_tows_it_rests_on(built):
    with Views(built.store) as views:
        said = sentences(views).filter(figure="slide_cw_weight")
        lines = views.table("type_lines").filter(
            method=book.Book(views, speaker("en")).ends()[1],
            quantity="cw_standard_kg_m",
            explaining="weight_kg",
        )
    both = said.join(lines, on=["tows", "boat_type"])
    assert {"all", "newest", "2009", "2014"} == set(both["tows"])
    for row in both.iter_rows(named=True):
        assert re.search(rf"\b{row['n']} tows? of {row['n_boats']} boats?\b", row["en"])
        assert re.search(rf"\b{row['n']} (proef|proeven) van {row['n_boats']} sloep", row["nl"])


def test_an_era_is_told_from_old_to_new_in_per_cent(built):
    row = {"method": "rebased", "shift_ratio": 0.877, "lo": 0.85, "hi": 0.9, "apart": True}
    with Views(built.store) as views:
        said = book.Book(views, speaker("en"))._apart(row)
    assert "-12.3 % (-15.0 % to -10.0 %)" in said


def test_a_type_or_choice_of_tows_that_is_not_there_is_told(built):
    with Views(built.store) as views:
        for types, tows in ((["Galjas"], "all"), ([], "1999")):
            with pytest.raises(MissingKnowledgeError, match=r"Galjas|1999"):
                list(book.slides(views, speaker("en"), book.Asked(types, tows)))


def test_slides_are_written_as_pictures_and_as_one_document(built, made, tmp_path, monkeypatch):
    few = made["en"][6:8]
    monkeypatch.setattr(files, "slides", lambda *_: iter(few))
    written = files.write_slides(built.store, tmp_path / "book", "en")
    assert [path.suffix for path in written] == [".svg", ".png", ".svg", ".png", ".pdf"]
    assert len(pypdf.PdfReader(written[-1]).pages) == 2
    svg = written[0].read_text(encoding="utf-8")
    assert few[0].title in svg
    assert "SIMULATED" in svg
