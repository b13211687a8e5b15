"""`herijk check`: every fault by cause in one round, and a profile that settles what it can."""

import json
from dataclasses import asdict
from pathlib import Path

import pytest

from herijk.cli.archive import check_text
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import LANGUAGE, say
from tests.warehouse.archive.conftest import BOATS, FIRST, TOWS, Archive, Scan
from warehouse.archive.check.check import check_archive
from warehouse.archive.check.report import check_report
from warehouse.archive.files.empty_archive import write_templates
from warehouse.archive.profile.reading import parse_profiles

THIRD = "meetdata_2014/derde boot 12h 2014.csv"
SECOND = "meetdata_2014/tweede boot 6d 2014.csv"


def as_committees_have_it(archive: Archive) -> None:
    archive.edit(TOWS, lambda t: t.replace(";H;", ";Hrn;").replace(";D;", ";Dms;"))
    archive.replace(TOWS, "bemanning [kg]", "Bemaning (kg)")
    archive.replace(TOWS, ";opmerking", ";Weer")
    archive.replace(TOWS, "2014-03-01", "1/3/2014")
    archive.replace(TOWS, "2014-03-03", "3/4/2014")
    archive.edit(BOATS, lambda t: t.replace(";H\n", ";Hrn\n"))
    for path in (FIRST, SECOND, THIRD):
        archive.replace(path, "wind [m/s];wind [gra]", "druk [Pa];vocht [%]")
    for path in (FIRST, SECOND):
        archive.replace(path, "kracht [N]", "Dynamometer [N]")


def test_a_sound_archive_has_nothing(archive: Archive) -> None:
    checked = check_archive(archive.root)
    assert checked.causes == ()
    assert checked.profile is None
    assert checked.tows == 3


def test_what_settles_nothing_is_not_proposed(archive: Archive) -> None:
    """A rate of 0, a target speed as the second log; a tow that falls out is not promised."""
    profile = '[[profile]]\nseasons = "2014"\ncolumns = { force = "trek" }\n'
    (archive.root / "archief.toml").write_text(profile)
    for path in (FIRST, SECOND, THIRD):
        archive.replace(path, "log2 [m/s]", "doel [m/s]")
        archive.replace(path, "kracht", "trek")
    header, *rows = (archive.root / FIRST).read_text("utf-8").splitlines()
    rows = [f"{i % 1000 * 4};{row}" for i, row in enumerate(rows)]
    (archive.root / FIRST).write_text("\n".join([f"tijd;{header}", *rows, ""]), "utf-8")
    (archive.root / "tweede boot.xlsx").write_bytes(b"of a tow, maybe")
    checked = check_archive(archive.root)
    lines = {p.line for cause in checked.causes for p in cause.proposals}
    assert lines == {'[[profile]] seasons = "2014": absent = ["log2"]'}
    assert checked.tows == 2
    added = 'columns.force = "trek"\n# absent = ["log2"]\n'
    assert str(checked.profile) == profile.replace('columns = { force = "trek" }\n', added)
    parse_profiles(str(checked.profile).replace("# ", ""))


def test_one_round_finds_every_cause_and_its_profile_settles_them(
    archive: Archive, good_scan: Scan
) -> None:
    as_committees_have_it(archive)
    checked = check_archive(archive.root)
    report = check_report(archive.root, checked, "nl")
    assert {cause.reason_code for cause in report.causes} == {
        *("bad_list_row", "bad_boat_row", "unknown_column", "ambiguous_date", "missing_column")
    }
    assert checked.tows == 3
    before = LANGUAGE.set("nl")
    text = check_text(report)
    LANGUAGE.reset(before)
    assert "; H of D wordt verwacht." in text
    assert "druk" not in str(checked.profile)
    json.dumps(asdict(report))
    # What is no guess is settled; dates are asked for, in a comment.
    assert '# "sleeplijsten/sleeplijst_2014.csv" = "dmy"' in str(checked.profile)
    answered = str(checked.profile).replace('# "sleeplijsten', '"sleeplijsten')
    (archive.root / "archief.toml").write_text(answered, encoding="utf-8")
    scan = archive.scan()
    assert [fault.reason_code for fault in scan.faults] == []
    columns = ["tow_id", "crew_class", "crew_weight_kg", "declared_speed_m_s"]
    assert scan.index.tows.select(columns).equals(good_scan.index.tows.select(columns))
    assert scan.index.tows["wind_measured"].to_list() == [False] * 3
    assert check_archive(archive.root).causes == ()


def test_what_is_written_in_the_profile_stays(archive: Archive) -> None:
    (archive.root / "Archief.toml").write_text(
        '# ons archief\nsimulated = true\n[words]\nz = "H"\n'
    )
    as_committees_have_it(archive)
    profile = str(check_archive(archive.root).profile)
    assert "# ons archief" in profile
    parsed = parse_profiles(profile)
    assert parsed.simulated
    assert parsed.wording.words == {"z": "H", "hrn": "H", "dms": "D"}


def test_files_that_nobody_reads_are_listed(archive: Archive) -> None:
    (archive.root / "meetdata_2014/Möwe 8h 2014.mat").write_bytes(b"x")
    (archive.root / "sleeplijsten/lijst.csv").write_text("x")
    (archive.root / "oud").mkdir()
    causes = check_report(archive.root, check_archive(archive.root), "en").causes
    (unread,) = [c for c in causes if c.reason_code == "unrecognised_file"]
    assert {place.path for place in unread.places} == {
        "sleeplijsten/lijst.csv", "meetdata_2014/Möwe 8h 2014.mat", "oud",
    }  # fmt: skip


def test_a_samples_file_that_no_list_names_says_nothing_of_its_season(archive: Archive) -> None:
    (archive.root / "meetdata_2014/kladje.csv").write_text("los bestand\n")
    checked = check_archive(archive.root)
    assert [cause.reason_code for cause in checked.causes] == ["samples_not_listed"]
    assert checked.profile is None


def test_a_class_that_nobody_knows_is_one_fault_under_the_heading_as_typed(
    archive: Archive,
) -> None:
    header, *rows = (archive.root / TOWS).read_text("utf-8").splitlines()
    cells = [row.split(";") for row in rows]
    place = header.split(";").index("roeiers")
    apart = [[*c[:place], c[place] + c[place + 1], *c[place + 2 :]] for c in cells]
    apart += [[f"{c[0]}-{i}", *c[1:]] for i in range(2) for c in apart]
    apart[0][place] = "8X"
    heading = header.replace("roeiers;klasse", "Ploeg")
    text = "\n".join([heading, *(";".join(c) for c in apart), ""])
    (archive.root / TOWS).write_text(text, "utf-8")
    faults = [fault for fault in archive.scan().faults if fault.reason_code == "bad_list_row"]
    assert [fault.message for fault in faults] == [
        "Line 2: column 'Ploeg' is 'X'; H or D is expected."
    ]


def test_extra_runs_are_named_and_a_plan_takes_them(archive: Archive) -> None:
    lines = (archive.root / FIRST).read_text("utf-8").split("\n")
    again = [f"7{line[1:]}" for line in reversed(lines) if line.startswith("1;")]
    again += [f"8{line[1:]}" for line in reversed(lines) if line.startswith("4;")]
    archive.edit(FIRST, lambda t: t + "\n".join([*again, ""]))
    (cause,) = check_report(archive.root, check_archive(archive.root), "en").causes
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


@pytest.mark.parametrize("old", ["gebruik runs", "verbouwd", "correctie [%]"])
def test_a_misspelt_optional_header_is_never_ignored(archive: Archive, old: str) -> None:
    archive.replace(TOWS, old, f"x{old}")
    faults = archive.scan().faults
    assert [f.reason_code for f in faults] == ["unknown_column"]
    assert old in faults[0].message


def test_a_number_that_can_be_read_in_two_ways_is_asked(archive: Archive) -> None:
    archive.replace(TOWS, ";760;", ";1.140;")
    assert [f.reason_code for f in archive.scan().faults] == ["ambiguous_number"]


def test_what_libraries_say_is_made_printable() -> None:
    said = say("broken: {error}, {cell}.", error=ValueError("a\nb\x0e"), cell="\x1b[31mred")
    assert said == "broken: a b?, ?[31mred."
    assert said.spoken("nl").isprintable()


def test_an_empty_archive_to_begin_with(tmp_path: Path) -> None:
    root = tmp_path / "nieuw"
    write_templates(root)
    (cause,) = check_report(root, check_archive(root), "nl").causes
    assert cause.reason_code == "samples_missing"  # of the example that is to be removed
    with pytest.raises(MissingKnowledgeError, match="not empty"):
        write_templates(root)


def test_lamps_of_another_name_are_no_windows(archive):
    (archive.root / "sleeplijsten/recht sturen 2014.csv").write_text(
        "sleep_id;run;van [s];tot [s]\n2014-001;2;5;9\n"
    )
    (cause,) = check_archive(archive.root).causes
    (proposal,) = cause.proposals
    assert proposal.line == '[files] "sleeplijsten/recht sturen 2014.csv" = "lampjes_2014"'
