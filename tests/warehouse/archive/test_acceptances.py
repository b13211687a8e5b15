"""Who accepted which tow: what is read of the list, and the line that a command adds to it."""

import csv
import datetime as dt
import os
from dataclasses import replace
from pathlib import Path

import pytest
import xlsxwriter
from hypothesis import given, settings
from hypothesis import strategies as st

from pipeline.errors import HerijkError, UnavailableError
from tests.warehouse.archive.conftest import TOWS, Archive, small_archive
from warehouse.archive import FileHashes, index_archive
from warehouse.archive.acceptance import Acceptance, compose_line

LIST = "sleeplijsten/beoordelingen.csv"
HEADER = "sleep_id;datum;goedgekeurd door;runs overgedaan;toelichting;bevindingen\n"
GOOD = "2014-001;2014-03-01;J. de Vries;2,5;scheef gestuurd;heavier_after\n"
READ = (
    *("tow_id", "accepted_on", "accepted_by", "redone_runs", "explanation", "known_checks"),
    "line",
)
ACCEPTANCE = Acceptance(
    tow_id="2014-001",
    towed_on=dt.date(2014, 3, 1),
    planned_runs=(1, 2, 3, 4, 5, 6),
    accepted_by="J. de Vries",
    accepted_on=dt.date(2014, 3, 1),
    redone_runs="2,5",
    note="scheef gestuurd",
    known_checks=("heavier_after", "log_not_linear"),
)


def give(archive: Archive, rows: str, header: str = HEADER) -> None:
    (archive.root / LIST).write_text(header + rows, "utf-8", newline="")


# What is read


def test_an_archive_without_the_list_has_no_acceptance_and_no_fault(good_scan):
    assert good_scan.index.acceptances.is_empty()
    assert good_scan.faults == []


def test_acceptances_are_read_as_written(archive):
    give(archive, GOOD + "2014-003;4-3-2014;SKC;1-3;;\n2014-002;2014-03-02;SKC;;-;\n")
    scan = archive.scan()
    assert scan.faults == []
    assert scan.index.acceptances.select(READ).rows() == [
        ("2014-001", dt.date(2014, 3, 1), "J. de Vries", "2,5", "scheef gestuurd",
         "heavier_after", 2),
        ("2014-003", dt.date(2014, 3, 4), "SKC", "1,2,3", None, None, 3),
        ("2014-002", dt.date(2014, 3, 2), "SKC", None, None, None, 4),
    ]  # fmt: skip


def test_a_tow_may_be_accepted_again_on_a_later_day(archive):
    give(archive, GOOD + "2014-001;2014-03-08;SKC;5;opnieuw gewogen;\n")
    scan = archive.scan()
    assert scan.faults == []
    assert scan.index.acceptances["accepted_by"].to_list() == ["J. de Vries", "SKC"]


FAULTY = (
    ("2014-009;2014-03-01;SKC;;;", "sleep_id 2014-009 is in no tow list"),
    ("2014-001;vandaag;SKC;;;", "not a date"),
    ("2014-001;2014-02-28;SKC;;;", "before it was towed on 2014-03-01"),
    ("2014-001;2014-03-09;;;;", "'goedgekeurd door' is empty"),
    ("2014-001;2014-03-10;SKC;7;;", "tow 2014-001 has no run 7"),
    ("2014-001;2014-03-11;SKC;b2;;", "tow 2014-001 has no run b2"),
    ("2014-001;2014-03-12;SKC;allemaal;;", "tow 2014-001 has no run allemaal"),
    ("2014-002;2014-03-02;SKC;;;", "is also on line 10"),
    ("2014-002;2014-03-02;J. de Vries;;;", "is also on line 9"),
)


def test_a_faulty_row_costs_no_tow_and_no_other_row(archive):
    give(archive, "\n".join([*(row for row, _ in FAULTY), GOOD]))
    scan = archive.scan()
    found = sorted(scan.faults, key=lambda fault: fault.line or 0)
    assert [(f.path, f.tow_id, f.line) for f in found] == [
        (LIST, None, line) for line in range(2, 2 + len(FAULTY))
    ]
    for fault, (_, said) in zip(found, FAULTY, strict=True):
        assert fault.reason_code == "bad_acceptance_row"
        assert said in fault.message
    assert scan.index.acceptances["tow_id"].to_list() == ["2014-001"]
    assert len(scan.good) == 3


def test_a_run_of_the_second_file_may_be_redone(archive):
    text = (archive.root / "meetdata_2014/eerste boot 8h 2014.csv").read_text()
    (archive.root / "meetdata_2014/tweede.csv").write_text(text.replace(";2", ";2,", 1))
    archive.replace(TOWS, "eerste boot 8h 2014;;", "eerste boot 8h 2014;tweede;")
    give(archive, "2014-001;2014-03-01;SKC;b2;;\n")
    assert archive.scan().index.acceptances["redone_runs"].to_list() == ["b2"]


# The line that is added


def read(archive: Archive) -> list[tuple[object, ...]]:
    index = index_archive(archive.root, FileHashes().hash_file)
    return index.acceptances.select(READ[:-1]).rows()


def meant(acceptance: Acceptance) -> tuple[object, ...]:
    return (
        acceptance.tow_id,
        acceptance.accepted_on,
        acceptance.accepted_by,
        acceptance.redone_runs or None,
        acceptance.note or None,
        ", ".join(acceptance.known_checks) or None,
    )


def test_a_line_is_composed_without_writing_and_then_written(archive):
    files = {file for file in archive.root.rglob("*") if file.is_file()}
    line = compose_line(archive.root, ACCEPTANCE)
    assert {file for file in archive.root.rglob("*") if file.is_file()} == files
    assert line.path == LIST
    line.write()
    written = (archive.root / LIST).read_text("utf-8")
    assert written == f"{HEADER}{line.line}\n"
    assert {file for file in archive.root.rglob("*") if file.is_file()} - files == {
        archive.root / LIST
    }
    assert read(archive) == [meant(ACCEPTANCE)]


def test_a_new_list_has_the_delimiter_and_line_ends_of_the_tow_list(archive):
    rows = (archive.root / TOWS).read_text("utf-8").replace("1,2,3,4,5,6", "1-6")
    rows = rows.replace(",", ".").replace(";", ",").replace("\n", "\r\n")
    (archive.root / TOWS).write_bytes(rows.encode())
    compose_line(archive.root, ACCEPTANCE).write()
    content = (archive.root / LIST).read_bytes().decode()
    assert content.startswith(HEADER.replace(";", ",").replace("\n", "\r\n"))
    assert content.count("\r\n") == content.count("\n") == 2
    assert read(archive) == [meant(ACCEPTANCE)]


LAYOUTS = {
    "UTF-8 with a mark": ("utf-8-sig", ";", "\r\n"),
    "UTF-16": ("utf-16", "\t", "\r\n"),
    "Windows-1252": ("cp1252", ";", "\r\n"),
    "commas": ("utf-8", ",", "\n"),
    "bars, and old line ends": ("utf-8", "|", "\r"),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_list_stays_as_it_is_and_grows_by_a_line_of_its_own_kind(archive, layout):
    encoding, delimiter, end = LAYOUTS[layout]
    rows = (
        ["Beoordelingen van de SKC"],
        ["toelichting", "sleep_id", "datum", "paraaf", "door", "bevindingen", "runs overgedaan"],
        ["geen café", "2014-003", "4-3-2014", "x", "René", "", ""],
    )
    text = end.join(delimiter.join(row) for row in rows)  # the last line has no end
    (archive.root / LIST).write_bytes(text.encode(encoding))
    (archive.root / "archief.toml").write_text(
        'ignore = ["paraaf"]\n[headers]\n"door" = "goedgekeurd door"\n'
    )
    before = (archive.root / LIST).read_bytes()
    acceptance = replace(ACCEPTANCE, accepted_by="Zoë", note='één; "twee", drie|vier')
    line = compose_line(archive.root, acceptance)
    line.write()
    after = (archive.root / LIST).read_bytes()
    assert after.startswith(before)
    added = after.decode(encoding).removeprefix(before.decode(encoding))
    assert added == end + line.line + end
    assert next(csv.reader([line.line], delimiter=delimiter))[3] == ""
    assert read(archive)[-1] == meant(acceptance)
    assert len(read(archive)) == 2


def test_a_list_in_quotes_gets_a_line_in_quotes(archive):
    give(archive, "", '"' + HEADER.strip().replace(";", '";"') + '"\n')
    line = compose_line(archive.root, ACCEPTANCE)
    assert all(cell[0] == cell[-1] == '"' for cell in line.line.split(";"))
    line.write()
    assert read(archive) == [meant(ACCEPTANCE)]


def test_who_may_read_the_list_stays(archive):
    give(archive, GOOD.replace("2014-001;2014-03-01", "2014-001;2014-03-02"))
    (archive.root / LIST).chmod(0o664)
    compose_line(archive.root, ACCEPTANCE).write()
    assert (archive.root / LIST).stat().st_mode & 0o777 == 0o664


@pytest.fixture(scope="module")
def written_in(tmp_path_factory) -> Archive:
    return Archive(small_archive(tmp_path_factory.mktemp("written")))


LISTS = {
    (delimiter, encoding): (HEADER + "2014-001;2014-03-09;René;;;\n")
    .replace(";", delimiter)
    .encode(encoding)
    for delimiter in ";,\t|"
    for encoding in ("utf-8", "utf-8-sig", "cp1252", "utf-16")
}
"""A list with a row, by how it is written."""
SENTENCES = st.text("ab é,.;:|'\"\t\r\n()[]{}#=-!?&<>%\\", max_size=60).map("a{}".format)
"""What a person may write, not as a formula or a word for nothing."""


@settings(max_examples=10)
@given(SENTENCES, SENTENCES, st.sets(st.integers(1, 6)), st.sampled_from(list(LISTS)))
def test_what_a_person_writes_is_added_and_reads_back_equal(written_in, name, note, redo, layout):
    (written_in.root / LIST).write_bytes(LISTS[layout])
    runs = ",".join(map(str, sorted(redo)))
    acceptance = replace(ACCEPTANCE, accepted_by=name, note=note, redone_runs=runs)
    compose_line(written_in.root, acceptance).write()
    one_line = replace(acceptance, accepted_by=" ".join(name.split()), note=" ".join(note.split()))
    assert (written_in.root / LIST).read_bytes().startswith(LISTS[layout])
    assert read(written_in)[1:] == [meant(one_line)]


@settings(max_examples=10)
@given(st.text(max_size=20), st.text(max_size=20), st.sampled_from(list(LISTS)))
def test_any_text_is_added_as_it_is_or_refused_before_anything_is_written(
    written_in, name, note, layout
):
    (written_in.root / LIST).write_bytes(LISTS[layout])
    acceptance = replace(ACCEPTANCE, accepted_by=name, note=note)
    try:
        compose_line(written_in.root, acceptance).write()
    except HerijkError:
        assert (written_in.root / LIST).read_bytes() == LISTS[layout]
    else:
        words = [" ".join(text.split()) for text in (name, note)]
        assert read(written_in)[1][2:5:2] == (words[0], words[1] or None)


def test_words_with_commas_quotes_and_line_breaks_are_added(archive):
    note = '\'t Was druk,\n"heel druk"; zie\r\nfoto 3'
    compose_line(archive.root, replace(ACCEPTANCE, note=note)).write()
    assert read(archive)[0][4] == '\'t Was druk, "heel druk"; zie foto 3'


# What is refused

REFUSED = {
    "no name": ({"accepted_by": " "}, "'goedgekeurd door' is empty"),
    "a name that says nothing": ({"accepted_by": "-"}, "'goedgekeurd door' is empty"),
    "a run that does not exist": ({"redone_runs": "2,9"}, "tow 2014-001 has no run 9"),
    "a day before the tow": ({"accepted_on": dt.date(2014, 2, 1)}, "before it was towed"),
    "a formula": ({"note": "=1+1"}, "formula"),
    "a note that says nothing": ({"note": "n.v.t."}, "it would be read as ''"),
    "another acceptance that day": ({"accepted_on": dt.date(2014, 3, 8)}, "is also on line 2"),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSED)
def test_what_a_rebuild_would_set_aside_is_refused(archive, what):
    change, said = REFUSED[what]
    give(archive, "2014-001;2014-03-08;SKC;;;\n")
    before = (archive.root / LIST).read_bytes()
    with pytest.raises(HerijkError, match=said.replace("(", r"\(")):
        compose_line(archive.root, replace(ACCEPTANCE, **change))
    assert (archive.root / LIST).read_bytes() == before


def test_what_the_list_says_already_is_not_added(archive):
    compose_line(archive.root, ACCEPTANCE).write()
    with pytest.raises(HerijkError, match="says so already, on line 2"):
        compose_line(archive.root, ACCEPTANCE)


def test_a_list_without_a_column_that_is_needed_is_not_written(archive):
    give(archive, "", "sleep_id;datum;goedgekeurd door\n")
    with pytest.raises(HerijkError, match="has no column 'runs overgedaan'"):
        compose_line(archive.root, ACCEPTANCE)
    plain = replace(ACCEPTANCE, redone_runs="", note="", known_checks=())
    compose_line(archive.root, plain).write()
    assert read(archive) == [meant(plain)]


def test_a_list_that_a_rebuild_does_not_read_is_not_written(archive):
    give(archive, "", HEADER.replace("toelichting", "toelichting;paraaf"))
    with pytest.raises(HerijkError, match="Column 'paraaf' is not known"):
        compose_line(archive.root, ACCEPTANCE)


def test_a_letter_that_the_encoding_lacks_is_named(archive):
    (archive.root / LIST).write_bytes(("# café\n" + HEADER).encode("cp1252"))
    with pytest.raises(HerijkError, match="'Ł' cannot be written in cp1252"):
        compose_line(archive.root, replace(ACCEPTANCE, accepted_by="Łukasz"))


def test_a_workbook_is_not_written(archive):
    with xlsxwriter.Workbook(str(archive.root / LIST.replace("csv", "xlsx"))) as book:
        book.add_worksheet().write_row(0, 0, HEADER.strip().split(";"))
    with pytest.raises(HerijkError, match="is a workbook"):
        compose_line(archive.root, ACCEPTANCE)
    give(archive, "")
    with pytest.raises(HerijkError, match="several lists"):
        compose_line(archive.root, ACCEPTANCE)


@pytest.mark.parametrize("existed", [False, True])
def test_a_list_that_was_changed_meanwhile_is_not_written(archive, existed):
    if existed:
        give(archive, "")
    line = compose_line(archive.root, ACCEPTANCE)
    give(archive, "2014-003;2014-03-04;SKC;;;\n")
    before = (archive.root / LIST).read_bytes()
    with pytest.raises(UnavailableError, match="changed in the meantime"):
        line.write()
    assert (archive.root / LIST).read_bytes() == before
    assert [file.name for file in (archive.root / LIST).parent.iterdir()].count(Path(LIST).name)
    assert not [*(archive.root / LIST).parent.glob(".herijk-*")]


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_is_read_only_is_named(archive):
    line = compose_line(archive.root, ACCEPTANCE)
    (archive.root / LIST).parent.chmod(0o555)
    with pytest.raises(UnavailableError, match="cannot be written"):
        line.write()


def test_a_folder_that_is_gone_is_named_and_nothing_is_left_behind(archive):
    line = compose_line(archive.root, ACCEPTANCE)
    folder = (archive.root / LIST).parent
    folder.rename(archive.root / "weg")
    folder.write_text("")
    with pytest.raises(UnavailableError, match="cannot be written"):
        line.write()
    assert folder.read_text() == ""


def test_a_list_outside_the_archive_is_not_written(archive, tmp_path):
    (tmp_path / "elders.csv").write_text(HEADER)
    (archive.root / LIST).symlink_to(tmp_path / "elders.csv")
    with pytest.raises(HerijkError, match="outside the archive"):
        compose_line(archive.root, ACCEPTANCE)
