"""Archives in forms of their own: other headers, units, sheets, files and folders."""

import os
import re
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import xlsxwriter

from pipeline.errors import MissingKnowledgeError
from tests.warehouse.archive.conftest import BOATS, FIRST, HEADER, ROWS, TOWS, Archive, Scan
from tests.warehouse.archive.conftest import line_of as first_line_of
from tests.warehouse.archive.test_formats import cells_of, lvm, runs_in_a_folder
from warehouse.archive.check import check_archive
from warehouse.archive.profile import parse_profiles, read_profiles
from warehouse.archive.lists import _BOAT as BOAT_NUMBER
from warehouse.archive.columns import find_columns
from warehouse.archive.columns import split_header


def lists_in_one_workbook(archive: Archive) -> None:
    book = xlsxwriter.Workbook(str(archive.root / "Vereniging.xlsx"))
    book.add_worksheet("Toelichting").write(0, 0, "Van de commissie")
    for name, path in (("Sloepen", BOATS), ("Proeven 2014", TOWS)):
        sheet = book.add_worksheet(name)
        for place, row in enumerate(cells_of(archive, path)):
            sheet.write_row(place, 0, row)
        (archive.root / path).unlink()
    book.close()


def other_names(archive: Archive) -> None:
    root = archive.root
    shutil.move(root / "sloepregister/sloependata.csv", root / "Onze boten.csv")
    (root / "lijsten").mkdir()
    shutil.move(root / TOWS, root / "lijsten/Proeven 2014.csv")
    (root / "ruw").mkdir()
    shutil.move(root / "meetdata_2014", root / "ruw/2014")


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
        archive.replace(name, HEADER, "run;SB (m/s);BB (m/s);gps;Dynamometer [N];wind;windvaan")


def no_rate(archive: Archive) -> None:
    archive.edit(TOWS, lambda t: t.replace(";20;", ";;"))


def force_with_a_minus(archive: Archive) -> None:
    for path in sorted((archive.root / "meetdata_2014").glob("*.csv")):
        name = path.relative_to(archive.root).as_posix()
        lines = path.read_text("utf-8").count("\n")
        archive.cells(4, lambda cell, _: f"-{cell}".replace("--", ""), 2, lines, name)


def headers_over_three_lines(archive: Archive) -> None:
    """Two rows of names and one of units, where only a person sees which lines these are."""
    for path in sorted((archive.root / "meetdata_2014").glob("*.csv")):
        names = "vaart;snelheid;snelheid;snelheid;trek;wind;wind\nnr;BB;SB;gps;lijn;;hoek"
        above = f"Meting van zaterdag\n{names}\n-;m/s;m/s;m/s;N;m/s;graden"
        archive.replace(path.relative_to(archive.root).as_posix(), HEADER, above)
    header = "Nr;HT;Naam;Type;Lengte;Breedte;Hoogte;Gewicht;Ploeg;\nFSN;;;;lijn;;;leeg;aantal;h/d"
    units = ";;;;m;m;m;kg;;"
    archive.edit(BOATS, lambda t: "\n".join(["Onze sloepen", header, units, *t.split("\n")[1:]]))


def boats_by_name(archive: Archive) -> None:
    """No numbers of boats in the tow list, and one name that is spelled in another way."""
    archive.edit(TOWS, lambda t: t.replace(";fsn_nr;", ";Sloep;"))
    for number, name in (("1", "Eerste Boot"), ("2", "de 2e boot"), ("3", "derde-boot")):
        archive.replace(TOWS, f";FSN{number};", f";{name};")


def days_with_slashes(archive: Archive) -> None:
    archive.replace(TOWS, "2014-03-01", "1/3/2014")
    archive.replace(TOWS, "2014-03-03", "3/3/2014")


def folder_without_a_year(archive: Archive) -> None:
    """The season of a file is that of the row that names it, also for what its profile lacks."""
    other_channels(archive)
    shutil.move(archive.root / "meetdata_2014", archive.root / "metingen")


OF_2014 = '[[profile]]\nseasons = "2014"\n'
CHANNELS = f'{OF_2014}columns = {{ log1 = "SB", log2 = "BB", force = "Dynamometer" }}\n'
SETTLED = {
    force_with_a_minus: f'{OF_2014}reversed = ["force"]\n',
    headers_over_three_lines: f"""[header_lines]
        "{BOATS}" = "2:4"
        [headers]
        "Nr FSN" = "fsn_nr"
        "Lengte lijn" = "lengte"
        "Ploeg aantal" = "roeiers"
        "Ploeg h/d" = "klasse"
        [[profile]]
        seasons = "2014"
        header_lines = "2:4"
        columns.log1 = "snelheid BB"
        columns.log2 = "snelheid SB"
        columns.force = "trek lijn"
        """,
    days_with_slashes: f'[dates]\n"{TOWS}" = "dmy"\n',
    boats_by_name: '[words]\n"de 2e boot" = "tweede boot"\n',
    other_names: """[files]
        "Onze boten.csv" = "sloependata"
        "lijsten/Proeven 2014.csv" = "sleeplijst_2014"
        "ruw/2014" = "meetdata_2014"
        """,
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
    folder_without_a_year: f'{CHANNELS}[files]\n"metingen" = "meetdata"\n',
    lists_in_one_workbook: """[files]
        "Vereniging.xlsx#Sloepen" = "sloependata"
        "Vereniging.xlsx#Proeven 2014" = "sleeplijst_2014"
        """,
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
    assert check_archive(archive.root).causes == []
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
    assert check_archive(archive.root).causes == []
    scan = archive.scan()
    assert scan.faults == []
    columns = [c for c in good_scan.index.tows.columns if not c.endswith(("path", "sha256"))]
    assert scan.index.tows.select(columns).equals(good_scan.index.tows.select(columns))
    assert all(scan.good[tow].equals(samples) for tow, samples in good_scan.good.items())


def test_without_a_column_of_ids_day_boat_and_crew_are_the_id(archive: Archive) -> None:
    header, *rows = cells_of(archive, TOWS)
    (archive.root / TOWS).write_text("\n".join(";".join(row[1:]) for row in [header, *rows]))
    assert archive.scan().index.tows["tow_id"].to_list() == [
        *("2014-03-01 FSN1 8H", "2014-03-02 FSN2 6D", "2014-03-03 FSN3 12H")
    ]


@pytest.mark.parametrize(
    ("header", "expected"),
    [
        ("kracht_N", ("kracht", "N")), ("speed_m_s", ("speed", "m/s")),
        ("wind in kn", ("wind", "kn")),
        ("hull mass (lb)", ("hullmass", "lb")), ("meetfile b", ("meetfileb", None)),
        ("log C", ("logc", None)),
        ("wind (richting, graden)", ("windrichting", "graden")),
        ("gewicht na kg", ("gewichtna", "kg")),
        ("h/d", ("hd", None)),
    ],
)  # fmt: skip
def test_a_unit_at_the_end_of_a_header(header: str, expected: tuple[str, str | None]) -> None:
    assert split_header(header) == expected


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


def line_of(archive: Archive, path: str, text: str) -> int:
    """The line of a file in which a text stands, from 1, as an editor counts."""
    lines = (archive.root / path).read_text("utf-8").split("\n")
    (line,) = (number for number, line in enumerate(lines, start=1) if text in line)
    return line


@pytest.mark.parametrize("above", ["", "sep=;\n", "Meting van zaterdag\n\nmet mooi weer\n\n"])
def test_lines_are_counted_from_the_top_of_the_file(archive: Archive, above: str) -> None:
    """Titles and blank lines above a header, a second row of it, and rows that are no number."""
    archive.replace(TOWS, ";2,10;", ";schuin;")
    archive.replace(FIRST, HEADER, "run;log1;log2;gps;kracht;wind;windvaan\n-;m/s;m/s;m/s;N;m/s;°")
    place = (archive.root / FIRST).read_text("utf-8").index("\n3;")
    archive.edit(FIRST, lambda t: f"{t[: place + 3]}mistig{t[place + 4 :]}")
    for path in (FIRST, TOWS):
        archive.edit(path, lambda t: above + t)
    expected = {
        (FIRST, line_of(archive, FIRST, "mistig")),
        (TOWS, line_of(archive, TOWS, "schuin")),
    }
    assert {(fault.path, fault.line) for fault in archive.scan().faults} == expected


def test_a_fault_of_a_tow_of_several_files_names_its_file(archive: Archive) -> None:
    runs_in_a_folder(archive)
    path = f"{FIRST.removesuffix('.csv')}/vaart 4.csv"
    archive.edit(path, lambda t: f"Vierde vaart\n\n{t.replace('4;2', '4;mist', 1)}")
    (fault,) = archive.scan().faults
    assert (fault.path, fault.line) == (path, line_of(archive, path, "mist"))


def test_lines_of_labview_text_are_counted_over_its_headers(archive: Archive) -> None:
    """One cell that is no number, and one run of which the log was stuck."""
    lvm(archive)
    path = FIRST.replace(".csv", ".lvm")
    lines = (archive.root / path).read_text("utf-8").split("\n")
    begins = [number for number, line in enumerate(lines) if line.startswith("X_Value")]
    stuck = slice(begins[4] + 1, begins[4] + 1 + ROWS)
    lines[stuck] = [re.sub(r"^(\S+)\t\S+", r"\1\t2,40", line) for line in lines[stuck]]
    archive.edit(path, lambda _: "\n".join(lines))
    (fault,) = archive.scan().faults
    assert (fault.reason_code, fault.run, fault.path) == ("stuck_channel", 5, path)
    assert fault.line == begins[4] + 2
    lines[begins[2] + 7] = lines[begins[2] + 7].replace("\t2,", "\tmistig 2,", 1)
    archive.edit(path, lambda _: "\n".join(lines))
    assert {(fault.reason_code, fault.line) for fault in archive.scan().faults} == {
        ("bad_number", line_of(archive, path, "mistig")),
        ("stuck_channel", begins[4] + 2),
    }


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


def test_beaufort_is_no_speed(archive: Archive) -> None:
    """The wind is left out on request; the column is never read as m/s."""
    for path in sorted((archive.root / "meetdata_2014").glob("*.csv")):
        archive.replace(path.relative_to(archive.root).as_posix(), "wind [m/s]", "wind (Bft)")
    (cause,) = check_archive(archive.root).causes
    assert cause.reason_code == "unknown_unit"
    assert cause.settings == ['[[profile]] seasons = "2014": absent = ["wind"]']
    (archive.root / "archief.toml").write_text('[[profile]]\nseasons = "2014"\nabsent = ["wind"]\n')
    assert check_archive(archive.root).causes == []
    assert not archive.scan().index.tows["wind_measured"].any()


def test_a_unit_that_is_told_goes_before_a_label_that_nobody_knows(
    archive: Archive, good_scan: Scan
) -> None:
    for path in sorted((archive.root / "meetdata_2014").glob("*.csv")):
        archive.replace(path.relative_to(archive.root).as_posix(), "kracht [N]", "kracht [Volt]")
    (cause,) = check_archive(archive.root).causes
    assert cause.settings == ['[[profile]] seasons = "2014": units.force = "?"  # kgf, kn, lbf, n']
    (archive.root / "archief.toml").write_text('[[profile]]\nseasons = "2014"\nunits.force = "N"\n')
    scan = archive.scan()
    assert scan.faults == []
    assert scan.good["2014-001"].equals(good_scan.good["2014-001"])


def test_a_mark_that_is_told_settles_what_1_140_means(archive: Archive) -> None:
    archive.replace(TOWS, ";870;1140;", ";870;1.140;")
    (cause,) = check_archive(archive.root).causes
    assert cause.settings == [f'[decimals] "{TOWS}" = "?"  # ",", "."']
    (archive.root / "archief.toml").write_text(f'[decimals]\n"{TOWS}" = ","\n')
    assert archive.scan().index.tows["crew_weight_kg"].to_list() == [760, None, 1140]


def test_a_heading_between_the_rows_is_told_once_and_costs_no_tow(
    archive: Archive, good_scan: Scan
) -> None:
    header, first, *rows = (archive.root / TOWS).read_text("utf-8").splitlines()
    heading = "maart 2014" + ";" * header.count(";")
    archive.edit(TOWS, lambda _: "\n".join([header, first, heading, *rows, ""]))
    (fault,) = archive.scan().faults
    assert (fault.reason_code, fault.line) == ("bad_list_row", 3)
    assert "there is only 'maart 2014' in this row" in fault.message
    assert archive.scan().good.keys() == good_scan.good.keys()
    assert len(check_archive(archive.root).causes) == 1


def test_every_fault_of_a_row_is_told_at_once(archive: Archive) -> None:
    """Also where the row falls out for another reason; it is set aside once all the same."""
    archive.replace(
        TOWS, "FSN2;tweede boot 6d 2014;;6;D;2,10;", "FSN2;tweede boot 6d 2014;;zes;?;21;"
    )
    archive.edit(TOWS, lambda text: text + text.splitlines()[2] + "!\n")
    archive.replace(BOATS, "10,05;2,73;", "1005;273;")
    found = {
        (cause.reason_code, cause.places[0].line): cause.number
        for cause in check_archive(archive.root).causes
    }
    assert found == {
        ("duplicate_tow_id", 3): 2, ("bad_list_row", 3): 2, ("bad_boat_row", 4): 1,
    }  # fmt: skip
    set_aside = [fault.line for fault in archive.scan().faults if fault.path == TOWS]
    assert len(set_aside) == len(set(set_aside)) == 3


def test_a_unit_in_a_name_that_somebody_gives_is_its_unit():
    profiles = parse_profiles('[[profile]]\nseasons = "2014"\ncolumns.force = "pull_lbf"')
    found = find_columns(
        ["Pull"], [c for c in profiles.for_season(2014).columns if c.key == "force"]
    )
    assert found["force"].scale.to_si(100) == pytest.approx(444.82216)
    with pytest.raises(MissingKnowledgeError, match=r"units\.force"):
        parse_profiles('[[profile]]\nseasons = "2014"\ncolumns.force = "pull_km/h"')


def test_a_list_that_is_no_file_is_named(archive: Archive) -> None:
    (archive.root / "sleeplijsten/sleeplijst_2015.csv").mkdir()
    with pytest.raises(MissingKnowledgeError, match=r"sleeplijst_2015.csv is no file"):
        archive.scan()


def test_a_profile_that_is_no_file_is_not_taken_for_none(tmp_path: Path) -> None:
    """What it said of a day would be lost without a word."""
    (tmp_path / "archief.toml").symlink_to("lost")
    with pytest.raises(MissingKnowledgeError, match="is no file"):
        read_profiles(tmp_path)


def test_a_boat_that_no_list_has_is_asked_with_the_nearest_names(archive: Archive) -> None:
    boats_by_name(archive)
    (cause,) = check_archive(archive.root).causes
    assert cause.reason_code == "unknown_boat"
    assert cause.settings == ['[words] "de 2e boot" = "?"  # derde boot, tweede boot, eerste boot']


@pytest.mark.parametrize(
    ("cell", "number"),
    [("FSN nr 1", "1"), ("fsn-nummer 1", "1"), ("nr 1", "1"), ("FSN nr", None), ("101 nr", None)],
)
def test_a_boat_may_have_nr_before_its_number(cell: str, number: str | None) -> None:
    found = re.fullmatch(BOAT_NUMBER, cell)
    assert (found and found[1]) == number


def test_a_fault_in_a_file_with_blank_lines_names_its_line(archive: Archive) -> None:
    def parted(text: str) -> str:
        header, *rows = text.rstrip("\n").split("\n")
        rows[ROWS] = rows[ROWS].replace(";", ";x", 1)  # the first of run 2
        lines = [row.split(";", 1)[1] for row in (header, *rows)]
        runs = [lines[1 + i : 1 + i + ROWS] for i in range(0, len(rows), ROWS)]
        return lines[0] + "\n" + "\n\n\n".join("\n".join(run) for run in runs)

    archive.edit(FIRST, parted)
    (fault,) = archive.scan().faults
    assert (fault.reason_code, fault.run, fault.line) == ("bad_number", 2, first_line_of(2) + 2)


@pytest.mark.parametrize("cell", ["999", ""])
def test_a_wind_of_999_in_all_runs_is_none(archive: Archive, good_scan: Scan, cell: str) -> None:
    archive.cells(5, lambda *_: cell, 2, 6 * ROWS + 1)
    scan = archive.scan()
    (fault,) = scan.faults
    assert (fault.tow_id, fault.lost, fault.run) == ("2014-001", "seconds", None)
    assert "without wind" in fault.message
    for name in ("wind_speed_m_s", "wind_angle_deg"):
        assert scan.good["2014-001"][name].null_count() == 6 * ROWS
    others = ["run", "log1_m_s", "log2_m_s", "gps_m_s", "force_n"]
    assert scan.good["2014-001"].select(others).equals(good_scan.good["2014-001"].select(others))
