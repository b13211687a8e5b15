"""The commands about editions: what they print, and their exit status."""

import json
import shutil

import pytest

from pipeline.recompute import recompute
from tests.conftest import Workbench

DECISION = ("--decision", "ALV 12-5-2014")
FROM = ("--valid-from", "2014-06-01", "--published-on", "2014-05-13")


def test_publish_tells_where_the_edition_is_and_only_once(herijk, published, tmp_path):
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
    page = tmp_path / "certificate.html"
    assert herijk("certificate", "--out", page, "--data", copy.data)[0] == 0
    assert "2014-10" in page.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "arguments",
    [
        ("publish", "x", *FROM, *DECISION),
        ("publish", "x", "--method", "rebased", "--printed", "2014", *FROM, *DECISION),
        ("publish", "x", "--printed", "2014", "--carry", "y", *FROM, *DECISION),
        ("publish", "x", "--method", "rebased", "--valid-from", "1-6-2014", *DECISION),
        ("publish", "x", "--method", "rebased", *FROM),
        ("diff", "2014-1", "2014-2", "--fatigue", "some"),
        ("diff", "2014-1"),
    ],
)
def test_wrong_arguments_are_status_2(herijk, published, arguments):
    assert herijk(*arguments, "--data", published.data)[0] == 2


def test_diff_names_gain_loss_causes_and_races(herijk, published):
    status, out, err = herijk("diff", "2014-1", "2014-2", "--data", published.data)
    assert (status, err) == (0, "")
    for part in (
        "Gain",
        "Lose",
        "method: water temperature",
        "in 2 h",
        "Races, corrected for fatigue",
        "Winners",
    ):
        assert part in out
    status, out, _ = herijk("diff", "2014-1", "2014-2", "--data", published.data, "--json")
    report = json.loads(out)
    assert len(report["rows"]) == report["lines"]
    assert {"cw_ratio", "old_rank", "new_rank", "old_power_w", "causes"} <= set(report["rows"][0])


def test_verify_is_0_when_all_is_well_and_1_when_not(herijk, published, tmp_path):
    status, out, err = herijk("verify", "--data", published.data)
    assert (status, err) == (0, "")
    assert "Everything is as it was published." in out
    copy = published.copy(tmp_path)
    file = copy.data / "editions" / "2014-1" / "register.csv"
    file.write_bytes(file.read_bytes().replace(b",1", b",2", 1))
    status, out, _ = herijk("verify", "--data", copy.data)
    assert status == 1
    assert "register.csv, cell" in out
    assert "WRONG" in out


def test_verify_under_other_code_says_that_what_was_published_stands(
    herijk, published, monkeypatch
):
    original = recompute.still_air_coefficient_kg_m
    monkeypatch.setattr(
        recompute,
        "still_air_coefficient_kg_m",
        lambda area, drag: 1.5 * original(area, drag),
    )
    status, out, _ = herijk("verify", "--data", published.data)
    assert status == 1
    assert "The head decides" in out
    head = out.split("Head: ")[1].split()[0]
    status, out, _ = herijk("verify", "--head", head, "--data", published.data)
    assert status == 0
    assert "what was published stands" in out
    assert "Everything is as it was" not in out


def test_verify_without_any_edition_says_so(herijk, built):
    status, out, _ = herijk("verify", "--data", built.data)
    assert (status, out) == (0, "No edition has been published yet; nothing to verify.\n")


def test_lineage_goes_from_line_to_files_runs_and_seconds(herijk, published):
    tow = published.tow(2014)
    status, out, err = herijk("lineage", "2014-2", tow["fsn_no"], "--data", published.data)
    assert (status, err) == (0, "")
    for part in ("Verification code", tow["samples_path"], tow["samples_sha256"], "seconds"):
        assert part in out
    assert herijk("lineage", "2014-2", tow["fsn_no"], "--data", published.data, "--json")[0] == 0
    status, _, err = herijk("lineage", "2014-2", "FSN000", "--data", published.data)
    assert status == 1
    assert "boat FSN000 is not in edition 2014-2" in err


def test_verify_of_a_mistyped_folder_fails(herijk, tmp_path):
    status, printed, said = herijk("verify", "--data", tmp_path / "typo")
    assert (status, printed) == (1, "")
    assert "holds no editions and no tables" in said
