"""A race day: an inspector prints the sheets of a race and holds the boats on the quay to them."""

import csv
import shutil

import polars as pl
import pytest
from pypdf import PdfReader

from dashboards.page import render_page
from dashboards.queries.results import Results
from dashboards.site import list_pages
from pipeline.register.inspection import TOLERANCES
from tests.conftest import METHODS
from warehouse.queries.views import Views

RACE = "Spiegelrace"


def read_list(path, encoding="cp1252"):
    text = path.read_text(encoding)
    delimiter = max(";,\t|", key=text.splitlines()[0].count)
    return list(csv.DictReader(text.splitlines(), delimiter=delimiter))


def text_of(pdf):
    return " ".join(" ".join(page.extract_text() for page in PdfReader(pdf).pages).split())


def sheet_of(text, fsn_no):
    """The sheet of a boat in a document: from its number to the place for a signature."""
    return text.partition(f"{fsn_no} ·")[2].partition("Handtekening")[0]


def get_page(data_store, path):
    with Views(data_store) as views:
        page = next(page for page in list_pages(Results(views)) if page.path == path)
        data = page.query() | {"has_reports": False}
        return render_page(page.path, page.template, data, "nl", views.about())


def test_an_inspector_prints_a_race_and_finds_each_boat_with_its_last_weight(
    herijk, built, tmp_path
):
    out = tmp_path / "race.pdf"
    command = ("--lang", "nl", "export", "inspection", "--data", built.data)
    assert herijk(*command, "--race", RACE.lower(), "--out", out)[0] == 0
    text = text_of(out)
    assert "GESIMULEERD" in text
    assert "Afgeleid, niet vastgesteld door de federatie: gewicht" in text
    (race,) = (built.archive / "wedstrijden").glob("*.csv")
    raced = {row["fsn_nr"] for row in read_list(race)}
    names = dict(built.table("boats").select("fsn_no", "name").rows())
    tows = built.table("tows").sort("tow_date", "tow_id")
    for fsn_no in raced:
        last = tows.filter(pl.col("fsn_no") == fsn_no).row(-1, named=True)
        sheet, weight = sheet_of(text, fsn_no), last["weight_kg"]
        ends = [weight * (1 + side * TOLERANCES["weight"]) for side in (-1, 1)]
        allowed = "\N{EN DASH}".join(f"{end:.0f}" for end in ends)
        assert names[fsn_no] in text
        assert f"sleep {last['tow_id']}" in sheet
        assert f"Gewicht [kg] {weight:.0f} {allowed}" in sheet
        assert "Niet gemeten: vrijboord" in sheet  # it is since 2017
        for measured in ("Doft 1 [m]", "Roer dikte [m]", "sloep.jpg"):
            assert measured in sheet
    assert text.count("Handtekening") == len(raced)

    # One boat is asked for again, and another race does not exist.
    boat = min(raced)
    assert herijk(*command, names[boat], "--out", out)[0] == 0
    assert text_of(out).count("Handtekening") == 1
    assert sheet_of(text_of(out), boat)
    status, _, err = herijk(*command, "--race", "Elfstedentocht")
    assert (status, RACE in err) == (1, True)
    assert herijk(*command, boat, "--race", RACE)[0] == 2


def test_the_pages_of_a_boat_and_a_race_lead_to_the_same_sheets(built):
    page = get_page(built.store, "inspection.html")
    lines = built.table("register").filter(edition=f"concept-{METHODS[1]}", status="valid")
    assert lines.height > 0
    boats = lines["fsn_no"].unique().sort()
    for fsn_no in boats:
        assert f'id="{fsn_no}"' in page
    for fsn_no in (boats[0], boats[-1]):
        of_boat = get_page(built.store, f"boats/{fsn_no}.html")
        assert f'href="../inspection.html#{fsn_no}"' in of_boat
    with Views(built.store) as views:
        (path,) = [page.path for page in list_pages(Results(views)) if page.template == "race"]
    key = path.removeprefix("races/").removesuffix(".html")
    assert f'href="../inspection.html?race={key}"' in get_page(built.store, path)
    assert f'<option value="{key}">' in page
    assert f'data-race="|{key}"' in page


@pytest.mark.more
def test_a_committee_sets_a_tolerance_and_the_sheet_no_longer_calls_it_inferred(
    herijk, bench, tmp_path
):
    shutil.rmtree(bench.data / "site")
    (bench.data / "beheer.toml").write_text("tolerance_weight = 0.1\n")
    bench.rebuild(METHODS)
    row = bench.table("inspections").filter(measure="weight_kg").row(0, named=True)
    assert row["highest"] == round(row["value"] * 1.1)
    out = tmp_path / "all.pdf"
    herijk("--lang", "nl", "export", "inspection", "--data", bench.data, "--out", out)
    text = text_of(out)
    assert "gewicht 10 %" in text
    assert "federatie: vrijboord" not in text
    assert "federatie: doften, roer." in text
