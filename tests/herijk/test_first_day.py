"""What a newcomer does on the first day, as the README says it: nothing ends in an error."""

import gzip
import json
from dataclasses import replace

import polars as pl
import pytest
from python_calamine import load_workbook

from dashboards.reports import LastRun, make_report_pages, write_mail
from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from pipeline.errors import MissingKnowledgeError
from pipeline.history import ERAS
from pipeline.messages import make_translator
from tests.conftest import Workbench
from warehouse.queries.change_report import change_report
from warehouse.store.boats import choose_boat, find_boats, match_names, suggest_names

# A new archive


def test_a_new_archive_is_checked_and_rebuilt_without_an_error(herijk, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert herijk("init", "archive")[0] == 0
    assert "samples_missing" in herijk("check", "archive")[1]
    status, out, err = herijk("rebuild", "--archive", "archive", "--data", "data")
    assert status == 0
    assert "herijk:" not in err  # what is made is a line each
    assert "no tow has samples yet" in out
    assert "meetdata_" in out
    status, out, err = herijk("rebuild", "--archive", "archive", "--data", "data", "--json")
    assert status == 0
    assert "herijk:" not in err
    assert "no tow has samples yet" in json.loads(out)["reason"]


def test_a_mistyped_archive_leaves_nothing_behind(herijk, tmp_path):
    archive, data = tmp_path / "archeif", tmp_path / "data"
    status, _, said = herijk("rebuild", "--archive", archive, "--data", data)
    assert status == 1
    assert "There is no archive" in said
    assert list(tmp_path.iterdir()) == []


def test_lists_without_a_tow_are_no_error(herijk, tmp_path):
    archive = tmp_path / "archive"
    herijk("init", archive)
    example = archive / "sleeplijsten" / "sleeplijst_2025.xlsx"
    header = load_workbook(str(example)).get_sheet_by_index(0).to_python()[0]
    example.with_suffix(".csv").write_text(";".join(map(str, header)) + "\n", encoding="utf-8")
    example.unlink()
    status, out, _ = herijk("rebuild", "--archive", archive, "--data", tmp_path / "data")
    assert status == 0
    assert "Nothing to compute yet" in out


def test_an_archive_in_which_all_samples_are_damaged_is_an_error(herijk, tmp_path):
    archive = tmp_path / "archive"
    write_simulated_archive(archive, simulate_world(WorldSettings((2014,), 2, 20, 3)))
    for file in (archive / "meetdata_2014").iterdir():
        file.write_bytes(gzip.compress(b"x") if file.suffix == ".gz" else b"x")
    status, out, err = herijk("rebuild", "--archive", archive, "--data", tmp_path / "data")
    assert (status, out) == (1, "")
    assert "no tow can be used" in err


# One method


@pytest.mark.more
@pytest.mark.parametrize("method", ["as-published-2014", "rebased"])
def test_one_method_alone_gives_registers_and_a_site(method, herijk, tmp_path):
    bench = Workbench(tmp_path / "archive", tmp_path / "data")
    write_simulated_archive(bench.archive, simulate_world(WorldSettings((2013, 2014), 3, 20, 3)))
    bench.data.mkdir()
    (bench.data / "beheer.toml").write_text(f'methods = ["{method}"]\n', encoding="utf-8")
    status, _, err = herijk("rebuild", "--archive", bench.archive, "--data", bench.data)
    assert status == 0, err
    assert bench.table("methods")["method"].to_list() == [method]
    assert (bench.data / "site" / "register.html").is_file()
    assert not (bench.data / "unforeseen").exists()
    register = bench.table("register").filter(pl.col("flags").list.len() > 0, status="valid")
    for flagged in register["fsn_no"]:
        page = (bench.data / "site" / "en" / "boats" / f"{flagged}.html").read_text("utf-8")
        assert "Still to be looked at: " in page
    assert register.height or method == "rebased"
    boat = bench.table("tows")["fsn_no"][0]
    for call in (("register",), ("register", "--due"), ("seasons",), ("audit", boat)):
        status, _, err = herijk(*call, "--data", bench.data)
        assert (status, err) == (0, ""), call


# Documents


@pytest.mark.parametrize(
    ("call", "usual"),
    [
        (("certificate",), "certificate-concept-rebased-2015.pdf"),
        (("proposal", "rebased-2015"), "proposal-rebased-2015.pdf"),
    ],
)
@pytest.mark.parametrize("is_there", [True, False])
def test_a_document_goes_into_a_folder_under_its_usual_name(
    call, usual, is_there, herijk, built, tmp_path
):
    folder = tmp_path / "documents"
    if is_there:
        folder.mkdir()
    status, out, err = herijk("export", *call, "--data", built.data, "--out", folder)
    assert (status, err) == (0, "")
    assert (folder / usual).read_bytes().startswith(b"%PDF")
    assert str(folder / usual) in out


# Names of boats and types

BOATS = pl.DataFrame(
    [("FSN1", "Razende Snol"), ("FSN12", "Zeeëgel"), ("FSN13", "Zeehond"), ("FSN13", "Snelle")],
    schema=["fsn_no", "name"],
    orient="row",
)


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        ("fsn 1", ["FSN1"]),
        ("fsn1", ["FSN1"]),
        ("FSN", ["FSN1", "FSN12", "FSN13"]),
        ("zeeegel", ["FSN12"]),
        ("ZEE", ["FSN12", "FSN13"]),
        ("snel", ["FSN13"]),
        ("razendesnol", ["FSN1"]),
        ("snol", []),
        ("", []),
        (" ", []),
    ],
)
def test_boats_answer_to_the_beginning_of_number_or_name(wanted, found):
    assert find_boats(BOATS, wanted) == found


def test_several_boats_or_none_are_named_in_the_answer():
    with pytest.raises(MissingKnowledgeError, match="'zee' may be any of 2 boats: FSN12, FSN13"):
        choose_boat(BOATS, "zee")
    with pytest.raises(MissingKnowledgeError, match=r"no boat 'Razende Snoll'.* Did you mean Raz"):
        choose_boat(BOATS, "Razende Snoll")


def test_types_answer_to_their_beginning():
    types = ["Kromhout", "Kromhoutwhaler", "Kuikensloep"]
    assert match_names("kromhout", types) == ["Kromhout"]
    assert match_names("kromhoutw", types) == ["Kromhoutwhaler"]
    assert match_names("K", types) == types
    assert suggest_names("Kuikensleop", types) == " Did you mean Kuikensloep?"
    assert suggest_names("Pollux", types) == ""


def test_audit_takes_the_beginning_of_a_type_and_asks_back_where_nothing_fits(herijk, built):
    types = built.table("boats")["boat_type"].drop_nulls().unique().sort().to_list()
    one, other = (name[:5].lower() for name in types[:2])
    for names in ((one,), (one, other)):
        status, out, err = herijk("audit", *names, "--data", built.data)
        assert (status, err) == (0, "")
        assert types[0] in out
    misspelt = types[0][:-2] + types[0][-1]
    status, _, err = herijk("audit", misspelt + "x", "--data", built.data)
    assert status == 1
    assert f"Did you mean {types[0]}?" in err


# Flags


def test_flagged_tows_are_counted_wherever_a_rebuild_is_reported(built):
    changes = change_report(built.store)
    method = changes.judged["method"]
    statuses = built.table("curves").filter(method=method)["status"]
    for status in ("accepted", "flagged", "rejected"):
        assert changes.judged[status] == (statuses == status).sum()
    page = (built.data / "report" / "latest.en.html").read_text("utf-8")
    assert f"{changes.judged['accepted']} accepted, {changes.judged['flagged']} flagged" in page
    run = LastRun("2026-11-20T03:00:00+01:00", "unchanged", "", "2026-11-18T03:01:00+01:00")

    def make_page(judged):
        pages = make_report_pages(built.store, replace(changes, judged=judged), [], run)
        return pages["latest.en.html"]

    two_of_three = {"method": method, "accepted": 1, "flagged": 2, "rejected": 0}
    assert "1 accepted, 2 flagged" in make_page(two_of_three)
    assert "In order" not in make_page(two_of_three)
    assert "In order" in make_page(two_of_three | {"flagged": 0})
    text = write_mail(replace(changes, judged=two_of_three), [], simulated=False, run=run)[1]
    assert "nog te beoordelen" in text
    assert "2026-11-20 03:00. Er was niets veranderd." in text
    assert "Laatste verandering: 2026-11-18 03:01." in text


def test_a_flag_of_a_line_is_shown_wherever_the_line_is(herijk, built):
    flagged = built.table("register").filter(pl.col("flags").list.len() > 0, status="valid")
    line = flagged.row(0, named=True)
    edition = ("--edition", line["edition"])
    _, out, _ = herijk("audit", line["fsn_no"], *edition, "--data", built.data)
    assert "Still to be looked at: " in out
    _, out, _ = herijk("register", line["edition"], "--data", built.data, "--json")
    shown = {row["tow_id"]: row["flags"] for row in json.loads(out)["lines"]}
    assert shown[line["tow_id"]] == line["flags"]
    register = (built.data / "site" / "en" / "register.html").read_text("utf-8")
    assert "Flags" in register


# Words


def test_runs_are_cut_and_boats_are_not_trimmed():
    last = ERAS[-1].measured
    assert make_translator("en")(last) == "dGPS, runs cut"
    assert make_translator("nl")(last) == "dGPS, metingen bijgeknipt"


# Old workbooks


def test_an_old_workbook_is_refused_before_any_reader_opens_it(herijk, tmp_path):
    archive = tmp_path / "archive"
    herijk("init", archive)
    old = archive / "sleeplijsten" / "sleeplijst_2024.xls"
    # A compound file whose sector table points at itself: its chain of sectors has no end.
    header = bytes.fromhex("d0cf11e0a1b11ae1") + bytes(16) + bytes.fromhex("3e000300feff0900")
    old.write_bytes(header.ljust(512, b"\0") + bytes(1024))
    _, out, _ = herijk("check", archive, "--data", tmp_path / "data")
    assert "old Excel workbook" in out
    assert "save it as .xlsx" in out
