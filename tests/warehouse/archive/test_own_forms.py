"""Archives in forms of their own: other headers, units, sheets, files and folders."""

import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from pipeline.errors import MissingKnowledgeError
from tests.warehouse.archive.conftest import BOATS, HEADER, ROWS, TOWS, Archive, Scan
from warehouse.archive.check import check_archive
from warehouse.archive.profile import read_profiles


def other_headers(archive: Archive) -> None:
    for old, new in (
        ("sleep_id", "nr"), ("datum", "Dag van de proef"), (";roeiers;", ";Bemensing;"),
        (";klasse;", ";Team;"), ("roeisnelheid [m/s]", "v (m/s)"),
        ("gewicht na [kg]", "Gewicht na afl. (kg)"),
        ("gebruik runs", "Goede"), ("watertemperatuur [C]", "Temp. van het water"),
    ):  # fmt: skip
        archive.replace(TOWS, old, new)
    archive.edit(BOATS, lambda t: t.replace(";H\n", ";M\n").replace(";D\n", ";V\n"))


def other_channels(archive: Archive) -> None:
    for path in sorted((archive.root / "meetdata_2014").glob("*.csv")):
        name = path.relative_to(archive.root).as_posix()
        archive.replace(
            name, HEADER, "run;SB (m/s);BB (m/s);gps;Dynamometer [N];windsnelheid;windrichting"
        )


def no_rate(archive: Archive) -> None:
    archive.edit(TOWS, lambda t: t.replace(";20;", ";;"))


def force_with_a_minus(archive: Archive) -> None:
    for path in sorted((archive.root / "meetdata_2014").glob("*.csv")):
        name = path.relative_to(archive.root).as_posix()
        lines = path.read_text("utf-8").count("\n")
        archive.cells(4, lambda cell, _: f"-{cell}".replace("--", ""), 2, lines, name)


OF_2014 = '[[profile]]\nseasons = "2014"\n'
CHANNELS = f'{OF_2014}columns = {{ log1 = "SB", log2 = "BB", force = "Dynamometer" }}\n'
SETTLED = {
    force_with_a_minus: f'{OF_2014}reversed = ["force"]\n',
    other_headers: """[words]
        m = "H"
        v = "D"
        [headers]
        nr = "sleep_id"
        "Dag van de proef" = "datum"
        "Bemensing" = "roeiers"
        "Team" = "klasse"
        "v" = "roeisnelheid"
        "Gewicht na afl." = "gewicht na"
        "Goede" = "gebruik runs"
        "Temp. van het water" = "watertemperatuur"
        """,
    other_channels: CHANNELS,
    no_rate: f"{OF_2014}sample_rate_hz = 20\n",
}
"""Forms of an archive, with what a person fills in in `archief.toml` for each."""


def test_out_and_back_in_a_file_each(archive: Archive) -> None:
    """Three runs out in one file, the three back in another, each numbered from 1."""
    for path in sorted((archive.root / "meetdata_2014").glob("*.csv")):
        header, *lines = path.read_text("utf-8").splitlines()
        back = [f"{int(line[0]) - 3}{line[1:]}" for line in lines if line[0] in "456"]
        path.write_text("\n".join([header, *(line for line in lines if line[0] in "123"), ""]))
        path.with_name(f"terug {path.name}").write_text("\n".join([header, *back, ""]))
    for name in ("eerste boot 8h 2014", "tweede boot 6d 2014", "derde boot 12h 2014"):
        archive.replace(TOWS, f"{name};;", f"{name};terug {name};")
    archive.edit(TOWS, lambda t: t.replace(";1,2,3,4,5,6;", ";;"))
    (archive.root / "archief.toml").write_text(
        '[[plan]]\nseasons = "2014"\ntargets = [0.9, 1.0, 1.1]\n'
        'directions = ["out", "out", "out"]\nsecond_directions = ["back", "back", "back"]\n'
    )
    scan = archive.scan()
    assert scan.faults == []
    assert scan.index.runs.filter("selected").height == 18
    assert scan.index.runs.group_by("direction").len()["len"].to_list() == [9, 9]


@pytest.mark.parametrize("form", SETTLED, ids=lambda form: form.__name__)
def test_forms_that_lines_in_archief_toml_settle(
    archive: Archive, good_scan: Scan, form: Callable[[Archive], None]
) -> None:
    form(archive)
    assert check_archive(archive.root).causes
    (archive.root / "archief.toml").write_text(SETTLED[form], encoding="utf-8")
    scan = archive.scan()
    assert scan.faults == []
    columns = [c for c in good_scan.index.tows.columns if not c.endswith(("path", "sha256"))]
    assert scan.index.tows.select(columns).equals(good_scan.index.tows.select(columns))
    assert all(scan.good[tow].equals(samples) for tow, samples in good_scan.good.items())


def test_a_type_that_says_there_is_none_is_none(archive: Archive) -> None:
    lines = (archive.root / BOATS).read_text("utf-8").splitlines()
    place = lines[0].split(";").index("type")
    cells = [line.split(";") for line in lines]
    cells[1][place], cells[2][place] = "Overig", "Whaler"
    (archive.root / BOATS).write_text("\n".join(";".join(c) for c in cells), "utf-8")
    assert archive.scan().index.boats["boat_type"].to_list()[:2] == [None, "Whaler"]


@pytest.mark.skipif(sys.platform != "linux", reason="other systems refuse such names")
def test_names_that_are_no_text_and_links_to_themselves_are_told(
    archive: Archive, good_scan: Scan
) -> None:
    folder = os.fsencode(archive.root / "meetdata_2014")
    Path(os.fsdecode(folder + b"/bo\xffot.csv")).write_text("x")
    (archive.root / "meetdata_2014/zelf.csv").symlink_to("zelf.csv")
    (archive.root / "meetdata_2014/lus").symlink_to(".")
    scan = archive.scan()
    assert {(f.reason_code, f.path) for f in scan.faults} == {
        ("unrecognised_file", "meetdata_2014/bo\N{REPLACEMENT CHARACTER}ot.csv"),
        ("unrecognised_file", "meetdata_2014/lus"),
        ("path_outside_archive", "meetdata_2014/zelf.csv"),
    }
    assert scan.good.keys() == good_scan.good.keys()
    assert {c.reason_code for c in check_archive(archive.root).causes} >= {"unrecognised_file"}


def test_the_height_of_the_bow_is_asked_for_where_wind_was_measured_only(
    archive: Archive, good_scan: Scan
) -> None:
    archive.replace(BOATS, ";2,10;0,80;", ";2,10;;")
    (fault,) = archive.scan().faults
    assert (fault.reason_code, fault.tow_id) == ("bad_list_row", "2014-002")
    assert "'hoogte [m]' must be there" in fault.message
    profile = archive.root / "archief.toml"
    profile.write_text('[[profile]]\nseasons = "2014"\nabsent = ["wind"]\n')
    scan = archive.scan()
    assert scan.faults == []
    assert scan.index.tows["bow_height_m"].to_list() == [0.9, None, 1.05]


def test_a_profile_that_is_no_file_is_not_taken_for_none(tmp_path: Path) -> None:
    """What it said of a day would be lost without a word."""
    (tmp_path / "archief.toml").symlink_to("lost")
    with pytest.raises(MissingKnowledgeError, match="is no file"):
        read_profiles(tmp_path)


@pytest.mark.parametrize("cell", ["999", ""])
def test_a_wind_of_999_in_all_runs_is_none(archive: Archive, good_scan: Scan, cell: str) -> None:
    archive.cells(5, lambda *_: cell, 2, 6 * ROWS + 1)
    scan = archive.read_first(good_scan.index)
    (fault,) = scan.faults
    assert (fault.tow_id, fault.lost, fault.run) == ("2014-001", "seconds", None)
    assert "without wind" in fault.message
    for name in ("wind_speed_m_s", "wind_angle_deg"):
        assert scan.good["2014-001"][name].null_count() == 6 * ROWS
    others = ["run", "log1_m_s", "log2_m_s", "gps_m_s", "force_n"]
    assert scan.good["2014-001"].select(others).equals(good_scan.good["2014-001"].select(others))
