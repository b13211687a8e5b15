"""The commands about registers, seasons and editions: what they print, and their exit status."""

import json
import shutil

from pypdf import PdfReader

from tests.conftest import METHODS, Workbench

DECISION = ("--decision", "ALV 12-5-2014")
FROM = ("--valid-from", "2014-06-01", "--published-on", "2014-05-13")
EDITION = f"concept-{METHODS[1]}"


def test_a_register_has_every_line_judged_on_a_day(herijk, built):
    call = ("register", EDITION, "--data", built.data, "--as-of", "2012-06-01")
    assert "1\N{NO-BREAK SPACE}June\N{NO-BREAK SPACE}2012" in herijk(*call)[1]
    lines = json.loads(herijk(*call, "--json")[1])["lines"]
    report = json.loads(herijk(*call, "--due", "--json")[1])
    assert {line["tow_id"] for line in lines} == {line["tow_id"] for line in report["lines"]}
    days = {line["tow_date"] for line in report["lines"]} - {None}
    assert days
    assert max(days) <= "2012-06-01"


def test_due_groups_by_expiry_and_has_each_speed(herijk, built):
    call = ("register", EDITION, "--due", "--data", built.data)
    status, out, err = herijk(*call)
    assert (status, err) == (0, "")
    report = json.loads(herijk(*call, "--json")[1])
    assert report["method"] == METHODS[1]
    for part in ("SIMULATED", "70 to 90 W"):
        assert part in " ".join(out.split())
    for line in report["lines"]:
        assert line["fsn_no"] in out
        assert line["tow_speed_m_s"] is None or f"{line['tow_speed_m_s']:.2f}" in out
    assert all(line["tow_speed_m_s"] > 0 for line in report["lines"] if line["power_w"])


def test_publish_says_where_the_edition_is_and_only_once(herijk, published, tmp_path):
    copy = published.copy(tmp_path)
    call = ("publish", "x", "--method", "rebased", *FROM, *DECISION, "--data", copy.data)
    status, out, err = herijk(*call)
    assert (status, err) == (0, "")
    assert "Published x" in out
    assert "SIMULATED" in out
    assert (copy.data / "editions" / "x" / "register.csv").exists()
    status, out, err = herijk(*call)
    assert (status, out) == (1, "")
    assert "already published" in err
    assert herijk("publish", "y", *call[2:], "--json")[0] == 0


def test_an_edition_counts_at_once(herijk, built, tmp_path):
    copy = Workbench(built.archive, shutil.copytree(built.data, tmp_path / "data"))
    terms = ("--method", "rebased-2015", *DECISION, "--data", copy.data)
    for name, day in (("2014-9", "2014-06-01"), ("2014-10", "2014-07-01")):
        assert herijk("publish", name, "--valid-from", day, *terms)[0] == 0
    assert "2014-9" in herijk("register", "2014-9", "--data", copy.data)[1]
    assert "2014-10" in herijk("register", "--data", copy.data)[1]
    assert "2014-10" in herijk("register", "--as-of", "2012-06-01", "--data", copy.data)[1]
    paper = tmp_path / "certificate.pdf"
    assert herijk("export", "certificate", "--out", paper, "--data", copy.data)[0] == 0
    assert "2014-10" in PdfReader(paper).pages[0].extract_text()


def test_editions_are_compared_with_causes_and_races(herijk, published):
    call = ("compare", "2014-1", "2014-2", "--data", published.data)
    report = json.loads(herijk(*call, "--json")[1])["effect"]
    assert len(report["rows"]) == report["lines"]
    assert {"cw_ratio", "old_rank", "new_rank", "old_power_w", "causes"} <= set(report["rows"][0])


def test_verify_is_1_where_an_edition_was_changed(herijk, published, tmp_path):
    copy = published.copy(tmp_path)
    file = copy.data / "editions" / "2014-1" / "register.csv"
    file.write_bytes(file.read_bytes().replace(b",1", b",2", 1))
    status, out, _ = herijk("verify", "--data", copy.data)
    assert status == 1
    assert "register.csv" in out
    assert "WRONG" in out


def test_the_register_of_every_year_beside_the_published_one(herijk, built):
    call = ("register", EDITION, "--years", "--data", built.data)
    status, out, err = herijk(*call)
    assert (status, err) == (0, "")
    assert "SIMULATED" in out
    report = json.loads(herijk(*call, "--json")[1])
    years = [row["year"] for row in report["years"]]
    assert years == sorted(years)
    for row in report["years"]:
        assert str(row["year"]) in out
        assert row["lines"] == sum(line["year"] == row["year"] for line in report["lines"])
