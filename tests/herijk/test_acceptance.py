"""A tow is accepted on the quay, as the federation does it, and a later check doubts it."""

import csv
import datetime as dt
import json

import pytest

from dashboards.page import render_page
from dashboards.queries.results import Results
from dashboards.site import list_pages
from tests.conftest import METHODS
from tests.herijk.test_assess import (
    METHOD,
    RUN,
    change_row,
    edit_samples,
    hashes,
    scale,
    sound_tow,
)
from warehouse.queries.change_report import change_report
from warehouse.queries.views import Views

__all__ = ["sound_tow"]

LIST = "sleeplijsten/beoordelingen.csv"
NAME, NOTE = "J. de Vries", 'run 5: "zwaan", opnieuw'


def read_list(bench):
    text = (bench.archive / LIST).read_text("utf-8")
    delimiter = max(";,\t|", key=text.splitlines()[0].count)
    return list(csv.DictReader(text.splitlines(), delimiter=delimiter))


def render_quality(bench):
    with Views(bench.store) as views:
        page = next(page for page in list_pages(Results(views)) if page.path == "quality.html")
        data = page.query() | {"has_reports": False}
        return render_page(page.path, page.template, data, "nl", views.about())


@pytest.mark.more
def test_a_committee_accepts_a_tow_and_a_later_check_doubts_it(bench, sound_tow, herijk):
    tow = bench.table("tows").filter(tow_id=sound_tow).row(0, named=True)
    folders = ("--archive", bench.archive, "--data", bench.data, "--method", METHOD)
    assess = ("--lang", "nl", "assess", sound_tow, *folders)
    audit = ("audit", tow["fsn_no"], "--data", bench.data, "--method", METHOD, "--tow", sound_tow)

    # The tow comes in with a swan before the bow in run 5, and the boat waits.
    edit_samples(bench, sound_tow, scale("kracht", 1.25, RUN == 5))
    assert "Sleep opnieuw: run 5" in herijk(*assess)[1]

    # Run 5 is towed again, and the tow is good. The line is shown, and nothing is written.
    edit_samples(bench, sound_tow, scale("kracht", 1 / 1.25, RUN == 5))
    accept = (*assess, "--accept", NAME, "--redo", "5", "--note", NOTE)
    before, first_day = hashes(bench.archive), dt.date.today()
    status, out, _ = herijk(*accept)
    assert (status, hashes(bench.archive)) == (0, before)
    assert "De eerste beoordeling zegt: goed" in out
    status, out, _ = herijk(*accept[2:], "--write", "--json")
    last_day = dt.date.today()
    assert hashes(bench.archive).items() - before.items() == {
        (str(bench.archive / LIST), hashes(bench.archive)[str(bench.archive / LIST)])
    }
    (row,) = read_list(bench)
    assert (row["sleep_id"], row["goedgekeurd door"]) == (sound_tow, NAME)
    assert (row["runs overgedaan"], row["toelichting"], row["bevindingen"]) == ("5", NOTE, "")
    assert first_day <= dt.date.fromisoformat(row["datum"]) <= last_day
    assert json.loads(out)["line"] == (bench.archive / LIST).read_text("utf-8").splitlines()[1]

    # The same day nobody else accepts it besides.
    status, _, err = herijk("assess", sound_tow, *folders, "--accept", "SKC", "--write")
    assert (status, "the line would be set aside" in err) == (1, True)
    assert len(read_list(bench)) == 1

    # The rebuild reads it: the boat's page says who accepted the tow, and nothing doubts it.
    bench.rebuild(METHODS)
    rows = bench.table("acceptances").filter(tow_id=sound_tow, method=METHOD).to_dicts()
    assert [(one["accepted_by"], one["newest"], one["doubted_by"]) for one in rows] == [
        (NAME, True, [])
    ]
    out = herijk("--lang", "nl", *audit)[1]
    assert f"goedgekeurd door {NAME}. Eerst overgedaan: run 5. “{NOTE}”" in " ".join(out.split())
    assert "twijfelt" not in out
    assert "betwijfeld" not in render_quality(bench)
    out = herijk(*audit, "--steps")[1]
    assert NAME in out.partition("Lineage")[2]

    # Later the crew turns out to have been weighed with its coats: a check marks the tow.
    change_row(bench, sound_tow, {"bemanning [kg]": str(125 * tow["rowers"])})
    bench.rebuild(METHODS)
    found = bench.table("acceptances").filter(tow_id=sound_tow, method=METHOD)
    assert found["doubted_by"].to_list() == [["crew_weight"]]
    assert change_report(bench.store).judged["doubted"] == [sound_tow]
    out = " ".join(herijk("--lang", "nl", *audit)[1].split())
    assert "Een latere controle twijfelt aan de goedgekeurde proef" in out
    page = render_quality(bench)
    assert "Goedgekeurd, en later betwijfeld" in page
    assert sound_tow in page.partition("Goedgekeurd, en later betwijfeld")[2]


def test_what_goes_with_an_acceptance_is_not_taken_without_one(built, herijk):
    tow_id = built.table("tows")["tow_id"][-1]
    folders = ("--archive", built.archive, "--data", built.data)
    for given in (("--write",), ("--redo", "2"), ("--note", "x"), ("--accept", " ")):
        status, out, err = herijk("assess", tow_id, *folders, *given)
        assert (status, out) == (2, "")
        assert "--accept" in err
    assert not (built.archive / LIST).exists()
