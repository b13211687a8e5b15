"""`herijk check`: every fault by cause in one round, with the lines that would settle it."""

from pathlib import Path

import pytest

from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say
from tests.warehouse.archive.conftest import FIRST, TOWS, Archive
from warehouse.archive.check import check_archive
from warehouse.archive.empty_archive import write_templates

THIRD = "meetdata_2014/derde boot 12h 2014.csv"
SECOND = "meetdata_2014/tweede boot 6d 2014.csv"


def test_a_sound_archive_has_nothing(archive: Archive) -> None:
    checked = check_archive(archive.root)
    assert checked.causes == []
    assert checked.tows == 3


def test_files_that_nobody_reads_are_listed(archive: Archive) -> None:
    (archive.root / "meetdata_2014/Möwe 8h 2014.mat").write_bytes(b"x")
    (archive.root / "sleeplijsten/lijst.csv").write_text("x")
    (archive.root / "oud").mkdir()
    causes = check_archive(archive.root, "en").causes
    (unread,) = [c for c in causes if c.reason_code == "unrecognised_file"]
    assert {place.path for place in unread.places} == {
        "sleeplijsten/lijst.csv", "meetdata_2014/Möwe 8h 2014.mat", "oud",
    }  # fmt: skip


def test_a_samples_file_that_no_list_names_says_nothing_of_its_season(archive: Archive) -> None:
    (archive.root / "meetdata_2014/kladje.csv").write_text("los bestand\n")
    checked = check_archive(archive.root)
    assert [cause.reason_code for cause in checked.causes] == ["samples_not_listed"]


def test_extra_runs_are_named_and_a_plan_takes_them(archive: Archive) -> None:
    lines = (archive.root / FIRST).read_text("utf-8").split("\n")
    again = [f"7{line[1:]}" for line in reversed(lines) if line.startswith("1;")]
    again += [f"8{line[1:]}" for line in reversed(lines) if line.startswith("4;")]
    archive.edit(FIRST, lambda t: t + "\n".join([*again, ""]))
    (cause,) = check_archive(archive.root, "en").causes
    assert cause.reason_code == "run_not_planned"
    assert "Runs 1, 2, 3, 4, 5, 6, 7, 8 are in the file" in cause.sentence
    (archive.root / "archief.toml").write_text(
        '[[plan]]\ntows = ["2014-001"]\ntargets = [0.9, 1.0, 1.1, 0.9, 1.0, 1.1, 0.9, 0.9]\n'
        'directions = ["out", "out", "out", "back", "back", "back", "out", "back"]\n'
    )
    archive.replace(TOWS, "1,2,3,4,5,6", "1-8")
    scan = archive.scan()
    assert scan.faults == []
    runs = scan.index.runs.filter(tow_id="2014-001", selected=True)
    assert runs["run"].to_list() == [1, 2, 3, 4, 5, 6, 7, 8]
    assert runs["direction"].to_list()[-2:] == [1, -1]


@pytest.mark.parametrize("old", ["gebruik runs", "correctie [%]"])
def test_a_misspelt_optional_header_is_never_ignored(archive: Archive, old: str) -> None:
    archive.replace(TOWS, old, f"x{old}")
    faults = archive.scan().faults
    assert [f.reason_code for f in faults] == ["unknown_column"]
    assert old in faults[0].message


def test_what_libraries_say_is_made_printable() -> None:
    said = say("broken: {error}, {cell}.", error=ValueError("a\nb\x0e"), cell="\x1b[31mred")
    assert said == "broken: a b?, ?[31mred."
    assert said.write_in("nl").isprintable()


def test_an_empty_archive_to_begin_with(tmp_path: Path) -> None:
    root = tmp_path / "nieuw"
    write_templates(root)
    (cause,) = check_archive(root, "nl").causes
    assert cause.reason_code == "samples_missing"  # of the example that is to be removed
    with pytest.raises(MissingKnowledgeError, match="not empty"):
        write_templates(root)
