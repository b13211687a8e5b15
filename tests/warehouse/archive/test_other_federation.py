"""An archive of another federation: its own files, columns, boat numbers and classes of crews."""

import re
from collections.abc import Callable
from pathlib import Path

import openpyxl
import polars as pl
import pytest

from pipeline.errors import MissingKnowledgeError
from tests.warehouse.archive.conftest import BOATS, TOWS, Archive
from warehouse.archive.check import check_archive
from warehouse.archive.empty_archive import write_templates
from warehouse.archive.list_rules import read_races
from warehouse.archive.profile import parse_profiles, read_profiles

CREWS = """
number_prefix = "CR"
[[crew]]
code = "M"
name = "men"
power_w = [55, 85]
[[crew]]
code = "U23"
name = "under 23"
power_w = [50, 75]
slow_w = 40
rower_kg = [60, 100]
"""
FILES = """
[files]
boats = "boats/boats"
tows = "tows/tows {year}"
samples = "{year} samples"
"""
HEADERS = """
[headers]
"Tow" = "sleep_id"
"Boat no" = "fsn_no"
"""


@pytest.fixture
def other(archive: Archive) -> Archive:
    """The tiny archive with the names, classes and numbers of another federation."""
    archive.edit(BOATS, lambda text: re.sub(";H\n", ";M\n", re.sub(";D\n", ";u23\n", text)))
    archive.edit(TOWS, lambda text: text.replace(";H;", ";M;").replace(";D;", ";U23;"))
    for path in (BOATS, TOWS):
        archive.edit(path, lambda text: text.replace("FSN", "CR ").replace("fsn_nr", "Boat no"))
    archive.edit(TOWS, lambda text: text.replace("sleep_id", "Tow"))
    for old, new in (
        (BOATS, "boats/boats.csv"),
        (TOWS, "tows/tows 2014.csv"),
        ("meetdata_2014", "2014 samples"),
    ):
        target = archive.root / new
        target.parent.mkdir(exist_ok=True)
        (archive.root / old).rename(target)
    for folder in ("sloepregister", "sleeplijsten"):
        (archive.root / folder).rmdir()
    (archive.root / "archief.toml").write_text(CREWS + FILES + HEADERS, "utf-8")
    return archive


def test_everything_is_read_under_its_own_names(other: Archive) -> None:
    scan = other.scan()
    assert scan.faults == []
    tows = scan.index.tows
    assert tows["fsn_no"].str.contains("^CR[0-9]+$").all()
    assert set(tows["crew_class"]) == {"M", "U23"}
    assert set(scan.good) == set(tows["tow_id"])
    crews = scan.index.profiles.crew_classes.filter(crew_class="U23").row(0, named=True)
    assert (crews["lowest_power_w"], crews["highest_power_w"], crews["slow_power_w"]) == (
        50,
        75,
        40,
    )
    assert crews["raced_power_w"] is None


def test_a_class_that_nobody_declared_is_asked_for_by_name(other: Archive) -> None:
    other.replace("tows/tows 2014.csv", ";U23;", ";H;")
    (cause,) = check_archive(other.root).causes
    assert cause.sentence == "column 'klasse' is 'H'; one of M, U23 is expected."
    assert '[words]\n"H" = "?"' in cause.ask


def test_a_missing_column_is_named_as_the_federation_names_it(other: Archive) -> None:
    other.replace("tows/tows 2014.csv", "Tow", "Nonsense")
    (cause,) = check_archive(other.root).causes
    assert "Not found in the header: 'Tow'" in cause.sentence


def test_a_missing_list_is_named_as_the_federation_names_it(other: Archive) -> None:
    (other.root / "tows/tows 2014.csv").unlink()
    with pytest.raises(MissingKnowledgeError, match=re.escape("tows/tows <jaar>.csv is expected")):
        check_archive(other.root)


def test_kinds_that_are_not_renamed_keep_their_place(other: Archive) -> None:
    boat = pl.read_csv(other.root / "boats/boats.csv", separator=";").row(0, named=True)
    text = "wedstrijd;datum;afstand [km];Boat no;roeiers;klasse;roeitijd\n"
    text += f"Head;2014-06-01;10;{boat['Boat no']};8;M;1:10:00\n"
    (other.root / "wedstrijden/head_2014.csv").write_text(text, "utf-8")
    races, faults = read_races(other.root)
    assert faults == []
    assert races["fsn_no"].to_list() == [boat["Boat no"].replace(" ", "")]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('[files]\ntows = "tows/tows"', "files.tows: 'tows/tows' must have {year} in it"),
        ('[files]\nboats = "boats_{year}/b"', "must not have {year} in it"),
        ('[files]\nsamples = "a/{year}"', "'a/{year}' is not a folder"),
        ('[files]\nraces = "races"', "'races' is not a folder and a name"),
        (
            '[files]\ntows = "lists/tows_{year}"\nraces = "lists/{name}_{year}"',
            "files: 'lists/tows_{year}' can be races and tows",
        ),
        ('[files]\nweather = "w/{year}"', "files.weather"),
        (CREWS.replace("U23", "M"), "two [[crew]] have one code"),
        (CREWS.replace("U23", "under"), "crew.1.code"),
        (CREWS.replace("[55, 85]", "[85, 55]"), "crew.0.power_w"),
        ('handicap = "portsmouth"', "'handicap'"),
    ],
)
def test_a_profile_that_cannot_be_meant_is_refused(text: str, said: str) -> None:
    with pytest.raises(MissingKnowledgeError, match=re.escape(said)):
        parse_profiles(text)


def read_choices(sheet: Callable[..., object]) -> set[str]:
    """Return the values that the lists of choices of a spreadsheet offer."""
    rules = sheet.data_validations.dataValidation  # type: ignore[attr-defined]
    return {rule.formula1 for rule in rules if rule.type == "list"}


def test_an_empty_archive_has_the_names_of_its_profile(tmp_path: Path) -> None:
    profile = tmp_path / "own.toml"
    profile.write_text(CREWS + FILES + HEADERS + '[words]\nyes = "ja"\nno = "nee"\n', "utf-8")
    root = tmp_path / "new"
    write_templates(root, profile)
    assert read_profiles(root) == parse_profiles(profile.read_text("utf-8"))
    names = {path.relative_to(root).as_posix() for path in root.rglob("*")}
    assert {"boats/boats.xlsx", "archief.toml"} < names
    assert not any(re.search("sloep|sleep|meetdata|LEESMIJ", name) for name in names)
    (file,) = (root / "tows").glob("*.xlsx")
    sheet = openpyxl.load_workbook(file).active
    assert [cell.value for cell in sheet[1]][:3] == ["Tow", "datum", "Boat no"]
    assert read_choices(sheet) == {'"M,U23"', '"yes,no"'}
    # Nothing is wrong with it but that no tow is in it yet.
    assert check_archive(root).causes == []
