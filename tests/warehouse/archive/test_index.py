"""What the index says of a good archive, the profile, and archives that are none."""

import datetime as dt
from pathlib import Path

import polars as pl
import pytest

from pipeline.channels import SAMPLE_SCHEMA
from pipeline.errors import MissingKnowledgeError
from tests.warehouse.archive.conftest import BOATS, FIRST, ROWS, TOWS, Archive, Scan, line_of
from warehouse.archive import (
    Failure,
    FileHashes,
    index_archive,
    read_published_registers,
    read_races,
)
from warehouse.archive import lists as reading

TWO_RATES = (
    '[[profile]]\nseasons = "2012:2014"\nsample_rate_hz = 5\n'
    '[[profile]]\nseasons = "2014"\nsample_rate_hz = 6\n'
)
SAMPLE_ARCHIVE = Path(__file__).parents[2] / "data" / "sample-archive"
NEXT_TOW = "2014-009;2014-03-09;FSN1;tweede;{second};8;H;2,40;;;;;;;;;{runs};nee;20;\n"


def test_values_of_a_tow(good_scan: Scan) -> None:
    tow = good_scan.index.tows.row(0, named=True)
    assert tow["tow_date"] == dt.date(2014, 3, 1)
    assert tow["speed_correction_ratio"] == 0.06
    assert tow["waterline_length_m"] == 8.0
    assert (tow["altered"], tow["sample_rate_hz"]) == (False, 20)
    assert (tow["samples_path"], tow["list_path"], tow["list_line"]) == (FIRST, TOWS, 2)


def test_empty_dimensions_come_from_the_boat_but_not_its_weight(good_scan: Scan) -> None:
    tow = good_scan.index.tows.row(1, named=True)
    assert tow["tow_date"] == dt.date(2014, 3, 2)
    assert (tow["waterline_length_m"], tow["beam_m"], tow["bow_height_m"]) == (7.73, 2.1, 0.8)
    assert tow["weight_kg"] is None
    assert tow["speed_correction_ratio"] is None
    assert tow["altered"] is True


def test_files_have_their_hash_and_size(good_scan: Scan) -> None:
    files = good_scan.index.files
    assert files["path"].to_list() == sorted(files["path"])
    assert len(files) == 5
    first = files.filter(path=FIRST).row(0, named=True)
    assert first["sha256"] == good_scan.index.tows["samples_sha256"][0]
    assert len(first["sha256"]) == 64


def add_second_tow(archive: Archive, selection: str) -> None:
    """Add a tow of the first boat that uses the first boat's file as its second file."""
    text = (archive.root / FIRST).read_text().replace("1;2", "1;2,", 1).replace(",,", ",0", 1)
    (archive.root / "meetdata_2014/tweede.csv").write_text(text)
    row = NEXT_TOW.format(second="eerste boot 8h 2014", runs=selection)
    archive.edit(TOWS, lambda content: content + row)


def test_second_file_is_combined_and_may_be_another_tow_of_the_boat(
    archive: Archive, good_scan: Scan
) -> None:
    add_second_tow(archive, "1,2,3,b4,b5,b6")
    scan = archive.scan()
    assert scan.faults == []
    runs = scan.index.runs.filter(tow_id="2014-009")
    assert runs["run"].to_list() == [1, 2, 3, 4, 5, 6, 21, 22, 23, 24, 25, 26]
    assert runs.filter("selected")["run"].to_list() == [1, 2, 3, 24, 25, 26]
    assert runs["direction"].to_list() == [1, 1, 1, -1, -1, -1] * 2
    assert runs["target_speed_ratio"].to_list() == [0.9, 1.0, 1.1] * 4
    second = scan.good["2014-009"].filter(pl.col("run") > 10)
    assert second.drop("run").equals(good_scan.good["2014-001"].drop("run"))


def test_a_fault_in_the_second_file_names_that_file_and_its_line(archive: Archive) -> None:
    archive.cells(1, lambda cell, line: "0", line_of(5, 3), line_of(5, 9))
    archive.replace(TOWS, "1,2,3,4,5,6", "1,2,3,4,6")
    add_second_tow(archive, "1,2,3,b4,b5,b6")
    (fault,) = archive.scan().faults
    found = (fault.reason_code, fault.path, fault.tow_id, fault.line)
    assert found == ("log_dropout", FIRST, "2014-009", line_of(5, 3))


def test_natural_oddities_are_no_faults(archive: Archive, good_scan: Scan) -> None:
    archive.cells(4, lambda cell, line: "-67", line_of(1, 10), line_of(1, 14))  # surge
    archive.cells(1, lambda cell, line: "2,64", line_of(3), line_of(3, 98))  # just under 5 s
    archive.edit(FIRST, lambda text: "\n".join(text.split("\n")[:-11]))  # 49.5 s in run 6
    archive.cells(5, lambda cell, line: "0", line_of(2), line_of(2, 300))  # cups stall
    archive.cells(6, lambda cell, line: "80", line_of(2), line_of(2, 300))  # no wind to turn it
    archive.cells(3, lambda cell, line: "2,40", line_of(2), line_of(2, ROWS - 1))  # held fix
    assert archive.read_first(good_scan.index).faults == []


def test_the_profile_says_what_the_vane_reads_for_wind_from_ahead(
    archive: Archive, good_scan: Scan
) -> None:
    as_read = good_scan.good["2014-001"]["wind_angle_deg"]
    (archive.root / "archief.toml").write_text(
        '[[profile]]\nseasons = "2014"\nwind_zero_deg = 90\n'
    )
    turned = archive.read_first(good_scan.index).good["2014-001"]["wind_angle_deg"]
    assert ((as_read - turned) % 360 - 90).abs().max() < 1e-3


def test_a_replaced_log_begins_a_new_part_of_its_season(archive: Archive, good_scan: Scan) -> None:
    days = good_scan.index.tows["tow_date"].sort().to_list()
    toml = "".join(
        f'[[log_replaced]]\ndate = {day}\nlog = "{log}"\nreason = "worn"\n'
        for day, log in ((days[1], "log1"), ("2013-06-01", "log1"), (days[0], "log2"))
    )
    (archive.root / "archief.toml").write_text(toml)
    tows = archive.scan().index.tows.sort("tow_date")
    assert tows["log1_part"].to_list() == [int(day >= days[1]) for day in days]
    assert tows["log2_part"].to_list() == [1] * len(days)


@pytest.mark.parametrize(
    ("toml", "named"),
    [
        ('[[log_replaced]]\ndate = 2014-03-01\nlog = "log3"\nreason = "x"', "log"),
        ("simulatd = true", "simulatd"),
        ('[[profile]]\nseasons = "2014"\nrate = 3', "rate"),
        ('[[profile]]\nseasons = "2014"\ncolumns = { log3 = "x" }', "log3"),
        ('[[profile]]\nseasons = "2014"\nunits = { force = "stoon" }', "stoon"),
        ('[[profile]]\nseasons = "2014:2012"', "2014:2012"),
        (
            TWO_RATES,
            "2014",
        ),
        ("[[set_aside]]\ndate = 2014-03-01", "reason"),
        ("simulated = ", "TOML"),
    ],
)
def test_a_wrong_profile_names_file_and_key(archive: Archive, toml: str, named: str) -> None:
    (archive.root / "archief.toml").write_text(toml)
    with pytest.raises(MissingKnowledgeError, match=r"archief\.toml") as raised:
        archive.scan()
    assert named in str(raised.value)


@pytest.mark.parametrize("removed", ["", "sloepregister/sloependata.csv", TOWS])
def test_no_archive_says_what_was_expected_where(archive: Archive, removed: str) -> None:
    root = archive.root / "nowhere" if not removed else archive.root
    if removed:
        (archive.root / removed).unlink()
    with pytest.raises(MissingKnowledgeError, match="expected") as raised:
        index_archive(root, FileHashes().hash_file)
    assert str(root) in str(raised.value)


def test_nothing_outside_the_archive_is_read(archive: Archive) -> None:
    outside = archive.root.parent / "elsewhere"
    (archive.root / "meetdata_2014").rename(outside)
    (archive.root / "meetdata_2014").symlink_to(outside)
    hashed: list[Path] = []

    def hash_file(path: Path) -> str:
        hashed.append(path)
        return FileHashes().hash_file(path)

    index = index_archive(archive.root, hash_file)
    assert {fault.reason_code for fault in index.faults} == {"path_outside_archive"}
    assert not [path for path in hashed if "meetdata" in str(path)]


def test_sample_archive_reads_without_faults() -> None:
    scan = Archive(SAMPLE_ARCHIVE).scan()
    assert scan.faults == []
    assert len(scan.good) == 9
    for samples in scan.good.values():
        assert samples.schema == pl.Schema(SAMPLE_SCHEMA)
        assert samples["run"].n_unique() == 6
    assert scan.good["2010-001"]["gps_m_s"].null_count() == 15000


def test_published_registers() -> None:
    register, faults = read_published_registers(SAMPLE_ARCHIVE)
    assert faults == []
    assert register["has_valid_curve"].to_list() == [True, True, True, False]
    assert register["cw_kg_m"].to_list() == [43.89, 41.63, 25.36, None]
    assert register["a_kg_m"].to_list()[-1] is None
    assert register["season"].to_list() == [2014] * 4


def test_races() -> None:
    races, faults = read_races(SAMPLE_ARCHIVE)
    assert faults == []
    assert races["rowing_time_s"].to_list() == [7825.0, 7451.0, 9669.0, 9520.0]
    assert races["distance_m"].to_list() == [18400.0] * 4
    assert races["stream_m"].to_list() == [None, None, 350.0, 300.0]
    assert races["penalty_w"].to_list() == [None, 1.5, None, None]


def test_faulty_rows_of_registers_and_races(archive: Archive) -> None:
    (archive.root / "sloepregister/sloepregister_2014.csv").write_text(
        "fsn_nr;roeiers;klasse;A;B;Cw;roeisnelheid [m/s];sleepdatum\n"
        "FSN1;8;H;31,60;4,44;43,89;2,35;2012-03-10\nFSN2;8;H;x;4,44;43,89;2,35;2012-03-10\n"
    )
    (archive.root / "wedstrijden/race_2016.csv").write_text(
        "wedstrijd;datum;afstand [km];fsn_nr;roeiers;klasse;roeitijd;stroom [km];straf [W]\n"
        "Race;2016-06-04;18,4;FSN1;8;H;2:70:25;;\nRace;2016-06-04;18,4;FSN1;8;H;2:10:25;;\n"
    )
    register, faults = read_published_registers(archive.root)
    assert [(f.reason_code, f.line) for f in faults] == [("bad_register_row", 3)]
    assert len(register) == 1
    races, faults = read_races(archive.root)
    assert [(f.reason_code, f.line) for f in faults] == [("bad_race_row", 2)]
    assert len(races) == 1


@pytest.mark.parametrize(
    ("cells", "why"),
    [
        ("43,89;4,44;31,60;2,35", "Cw is 31,60, but A 43,89 and B 4,44 give 60.97 at 2,35 m/s"),
        ("31,60;2,10;43,89;2,35", "B must be higher"),
        ("31,60;4,44;48,39;2,35", "give 43.90"),
    ],
)
def test_a_printed_line_must_fit_its_own_curve(archive: Archive, cells: str, why: str) -> None:
    """The printed examples (presentation 2015) hold; A and Cw exchanged, or digits, do not."""
    (archive.root / "sloepregister/sloepregister_2014.csv").write_text(
        "fsn_nr;roeiers;klasse;A;B;Cw;roeisnelheid [m/s];sleepdatum\n"
        f"FSN1;8;H;{cells};2012-03-10\nFSN2;12;H;32,62;5,59;41,63;2,60;2012-03-10\n"
        "FSN3;8;D;14,93;3,90;25,36;2,50;2012-03-10\nFSN4;8;H;32;6;39;2,6;2012-03-10\n"
    )
    register, faults = read_published_registers(archive.root)
    assert [(f.reason_code, f.line) for f in faults] == [("bad_register_row", 2)]
    assert why in faults[0].message
    assert register["fsn_no"].to_list() == ["FSN2", "FSN3", "FSN4"]


@pytest.mark.parametrize(("time", "stream"), [("0:02:10", ""), ("2:10:25", "20")])
def test_a_race_at_no_boats_speed_is_set_aside(archive: Archive, time: str, stream: str) -> None:
    (archive.root / "wedstrijden/race_2016.csv").write_text(
        "wedstrijd;datum;afstand [km];fsn_nr;roeiers;klasse;roeitijd;stroom [km];straf [W]\n"
        f"Race;2016-06-04;18,4;FSN1;8;H;{time};{stream};\n"
    )
    races, faults = read_races(archive.root)
    assert races.is_empty()
    assert [(f.reason_code, f.line) for f in faults] == [("bad_race_row", 2)]
    assert "m/s; 0.5 to 6 can be right" in faults[0].message


def test_readings_of_the_load_cell_and_lamps_go_to_their_tows(
    archive: Archive, good_scan: Scan
) -> None:
    """A known weight of 50 kg pulls 490.65 N; each tow takes the last day up to its own."""
    day = good_scan.index.tows["tow_date"].min()
    (archive.root / "sleeplijsten/krachtijkingen_2014.csv").write_text(
        f"datum;gewicht [kg];aflezing [N]\n{day};50;493,1\n{day};50;492,1\n{day};50;494,1\n"
        f"{day};50;0\n2014-12-31;50;400\n"
    )
    (archive.root / "sleeplijsten/lampjes_2014.csv").write_text(
        "sleep_id;run;van [s];tot [s]\n2014-001;2;5;10\n2014-001;2;20;30\n2014-001;3;1;2\n"
        "2014-099;1;1;2\n2014-001;1;3;3\n"
    )
    index = archive.scan().index
    tow = index.tows.row(by_predicate=pl.col("tow_id") == "2014-001", named=True)
    assert tow["load_cell_ratio"] == pytest.approx(493.1 / 490.65)
    scatter = 1.0 / 490.65 / 3**0.5
    assert tow["load_cell_sd"] == pytest.approx((scatter**2 + 0.001**2) ** 0.5)
    assert tow["lamp_ratio"] == pytest.approx(15.0 / 50.0)
    others = index.tows.filter(pl.col("tow_id") != "2014-001")
    assert others["lamp_ratio"].null_count() == others.height
    faults = [(f.path.split("/")[-1], f.line, f.reason_code) for f in index.faults]
    assert faults == [
        ("krachtijkingen_2014.csv", 5, "bad_instrument_row"),
        ("lampjes_2014.csv", 5, "bad_instrument_row"),
        ("lampjes_2014.csv", 6, "bad_instrument_row"),
    ]


def test_a_thousand_with_a_point_beside_decimal_commas_is_no_number(
    archive: Archive, good_scan: Scan
) -> None:
    """1.012 beside 998,5 may be a thousand and twelve: never 1.012 N."""
    archive.cells(
        4, lambda cell, _: f"{float(cell.replace(',', '.')):.1f}".replace(".", ","), 2, 1 + 6 * ROWS
    )
    archive.cells(4, lambda _, __: "1.012", line_of(2, 7), line_of(2, 9))
    scan = archive.read_first(good_scan.index)
    force = scan.good["2014-001"].filter(run=2)["force_n"]
    assert force[7:10].is_nan().all()
    assert not force[:7].is_nan().any()
    assert [(f.reason_code, f.lost, f.run) for f in scan.faults] == [("bad_number", "seconds", 2)]


OTHER_BOATS = "sloepregister/Sloependata.txt"


def test_boats_on_which_two_lists_disagree_are_set_aside_with_both_places(
    archive: Archive,
) -> None:
    boats = (archive.root / BOATS).read_text().splitlines()
    (archive.root / OTHER_BOATS).write_text("\n".join(boats[:3]).replace(";1417;", ";999;"))
    scan = archive.scan()
    assert sorted(scan.good) == ["2014-002", "2014-003"]
    of_boat, of_tow = sorted(scan.faults, key=lambda fault: fault.tow_id or "")
    assert (of_boat.reason_code, of_tow.tow_id) == ("duplicate_boat", "2014-001")
    for place in (f"line 2 of {OTHER_BOATS}", "999", "1417"):
        assert place in of_tow.message
    assert of_boat.path == BOATS


@pytest.mark.parametrize(
    ("path", "lost"),
    [
        (BOATS, ["2014-001", "2014-002", "2014-003"]),
        (TOWS, []),
    ],
)
def test_a_list_on_which_herijk_fails_costs_that_list(
    archive: Archive, monkeypatch: pytest.MonkeyPatch, path: str, lost: list[str]
) -> None:
    real = reading._parse_rows

    def fails(table, file, *rest):
        if file.path == path:
            raise ZeroDivisionError("planted")
        return real(table, file, *rest)

    monkeypatch.setattr(reading, "_parse_rows", fails)
    faults = archive.scan().faults
    (of_list,) = [fault for fault in faults if isinstance(fault, Failure)]
    assert (of_list.path, of_list.reason_code) == (path, "unforeseen")
    assert "planted" in of_list.trace
    assert [f.tow_id for f in faults if f is not of_list and f.tow_id] == lost


def test_what_an_inspection_uses_is_read_in_its_unit_and_a_bad_cell_costs_no_tow(
    archive: Archive,
) -> None:
    header = "doft 1 [cm];doft 2;roer dikte [mm];foto sloep;Foto Roer"
    rows = ("180;3,21;40;a.jpg;b.jpg", "x;99;;;", ";;;;")
    lines = (archive.root / TOWS).read_text("utf-8").split("\n")
    for place, cells in enumerate((header, *rows)):
        lines[place] += f";{cells}"
    (archive.root / TOWS).write_text("\n".join(lines), "utf-8")
    scan = archive.scan()
    columns = ("thwart_1_m", "thwart_2_m", "rudder_thickness_m", "photo_boat", "photo_rudder")
    found = scan.index.tows.sort("tow_id").select(columns).rows()
    assert found == [(1.8, 3.21, 0.04, "a.jpg", "b.jpg"), (None,) * 5, (None,) * 5]
    faults = [(fault.tow_id, fault.lost, fault.message) for fault in scan.faults]
    word, size = faults
    assert word[:2] == size[:2] == ("2014-002", "cell")
    assert "'doft 1 [cm]' is 'x', which is not an ordinary number" in word[2]
    assert "'doft 2' is 99" in size[2]
    assert "counts as empty" in size[2]
