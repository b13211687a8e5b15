"""An archive as volunteers type it, within the written format: own headers, words and units."""

import datetime as dt
import gzip
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import polars as pl
import pytest
import xlsxwriter

from tests.warehouse.archive.conftest import Archive, Scan
from warehouse.archive import read_published_registers, read_races

RATE_HZ = 50
RUN_ROWS = 50 * RATE_HZ
BOATS = (
    (101, "0001", "Eerste Boot", "Kuikensloep", 8.08, 2.25, 0.90, 1417, 8, "heren"),
    (102, "0002", "tweede boot", "overig", 7.73, 2.10, 0.80, 969, 6, "dames"),
    (103, "0003", "Dérde boot", "Pollux", 10.05, 2.73, 1.05, 864, 12, "heren"),
    (104, "0004", "vierde boot", "Kuikensloep", 8.01, 2.2, 0.9, 1300, 8, "dames"),
)
TOWS_2014_HEADER = (
    "Proef;Datum;FSN nr;Meetfile;Roeiers;Klasse;Roeisnelheid [m/s];Lengte [m];Breedte [m];"
    "Hoogte [m];Gewicht [kg];Gewicht na [kg];Bemanning [kg];Watertemperatuur [C];Correctie [%];"
    "Gebruik runs;Verbouwd;Weer"
)
TOWS_2014 = (
    ("2014/1", dt.date(2014, 3, 1), 101, "eerste boot 8h 2014", 8, "heren", 2.40, 8.00, 2.20, 0.90,
     1400, 1405, 760, 8.7, 6, "1-6", "nee", "zonnig"),
    ("2014/2", dt.date(2014, 3, 2), 102, "TWEEDE  boot 6d 2014", 6, "dames", 2.10, "n.v.t.", "", "",
     "-", "", 450, 8.1, "", "", "ja", "zonnig"),
    ("2014/3", dt.date(2014, 3, 2), 103, "dérde boot 12h 2014.csv", 12, "heren", 2.80, 10.05, 2.73,
     1.05, 864, 870, 1140, 5.2, "", "1,2,3,4,5,6", "nee", "regen"),
)  # fmt: skip
TOWS_2015 = """\
Lijst van 2015;;;;;;;;
sleep_id;datum;fsn_nr;meetfile;meetfile2;roeiers;klasse;roeisnelheid [km/h];lengte [cm];\
breedte [cm];hoogte [cm];gewicht [kg];bemanning [kg];gebruik runs;verbouwd;meetfrequentie [Hz];\
opmerking
2015-1;7-3-2015;FSN 104;vierde boot 8d 2015;;8;D;8,28;801;220;90;1302,5;600;1,2,3,4,5,6;nee;50;\
één roer los
# deze nog nakijken
;;;;;;;;;;;;;;;;
2015-2;08-03-2015;fsn101;eerste boot 8h 2015;;8;H;8,64;;;;1400;760;1,2,3,5,6;nee;50;
2015-3;8-3-2015;102;weg;;6;D;7,5;;;;;;;nee;50;
2015-4;31-2-2015;102;tweede 2015;;6;D;7,5;;;;;;;nee;50;
"""
PROFILE = """\
simulated = true
ignore = ["Weer"]
[words]
heren = "H"
dames = "D"
[headers]
"Proef" = "sleep_id"
[[profile]]
seasons = "2014"
sample_rate_hz = 50
columns = { log1 = "snelheid SB", force = "trek" }
units = { force = "kgf" }
[[set_aside]]
date = 2014-03-29
reason = "storm"
"""
SMALL_LISTS = {
    "sleeplijsten/vensters_2014.csv": "sleep_id;run;van [s];tot [s];reden\n"
    "2014-1;2;5;45;zwaan\n2014-1;7;5;45;fout\n2014-3;6;0;49;laat\n",
    "sleeplijsten/krachtijkingen_2014.csv": "datum;gewicht [kg];aflezing [N]\n"
    "2014-03-01;50;493,1\n2014-03-01;50;492,1\n2014-03-01;50;494,1\n2-3-2014;50;491\n",
    "sleeplijsten/lampjes_2014.csv": "sleep_id;run;van [s];tot [s]\n"
    "2014-1;2;5;10\n2014-1;2;20;30\n2014-9;1;1;2\n",
    "sloepregister/sloepregister_2014.csv": "fsn_nr;roeiers;klasse;A;B;Cw;roeisnelheid [m/s];"
    "sleepdatum\nFSN101;8;H;31,60;4,44;43,89;2,35;2012-03-10\nFSN102;6;D;1,0;99;1,00;2,1;\n"
    "FSN103;12;H;43,89;4,44;31,60;2,35;2012-03-10\n",
    "wedstrijden/tocht_2014.csv": "wedstrijd;datum;afstand [km];fsn_nr;roeiers;klasse;roeitijd;"
    "stroom [km];straf [W]\nTocht;1-6-2014;18,4;101;8;H;2:10:25;;\n"
    "Tocht;1-6-2014;18,4;102;6;D;2:41:09;0,35;1,5\nTocht;1-6-2014;18,4;103;12;H;0:02:10;;\n",
}


def simulate_tow(seed: int, declared_m_s: float, cw_kg_m: float) -> list[list[float]]:
    """Rows of run, log 1, log 2, GPS [m/s], force [N], wind [m/s], its angle [deg] and time [s]."""
    rng = np.random.default_rng(seed)
    rows = []
    for run in range(1, 7):
        speed = declared_m_s * (0.9, 1.0, 1.1)[(run - 1) % 3]
        log1 = speed + rng.normal(0, 0.03, RUN_ROWS)
        log2 = speed * 1.01 + rng.normal(0, 0.03, RUN_ROWS)
        gps = np.repeat((speed + rng.normal(0, 0.02, 50)).round(2), RATE_HZ)
        force = cw_kg_m * speed**2 + rng.normal(0, 40, RUN_ROWS)
        wind = 4 + rng.normal(0, 0.3, RUN_ROWS) + np.sin(np.arange(RUN_ROWS) / 200)
        angle = rng.normal(8 if run < 4 else 188, 12, RUN_ROWS) % 360
        time_s = np.arange(RUN_ROWS) / RATE_HZ
        number = np.full(RUN_ROWS, run)
        rows += np.column_stack([number, log1, log2, gps, force, wind, angle, time_s]).tolist()
    return rows


def with_comma(number: float, decimals: int) -> str:
    return f"{number:.{decimals}f}".replace(".", ",")


def write_samples_2014(path: Path, rows: Sequence[Sequence[float]]) -> None:
    """Own headers, decimal commas, and the force in kgf without saying so."""
    lines = ["Meting Sleepcommissie", ""]
    lines += ["run;snelheid SB [m/s];log2 [m/s];gps [m/s];trek;wind [m/s];wind [gra]"]
    for run, log1, log2, gps, force, wind, angle, _ in rows:
        cells = [f"{run:.0f}", with_comma(log1, 3), with_comma(log2, 3), with_comma(gps, 2)]
        cells += [with_comma(force / 9.80665, 3), with_comma(wind, 3), with_comma(angle, 1)]
        lines.append(";".join(cells))
    path.write_text("\n".join([*lines, ""]), "utf-8")


def write_samples_2015(path: Path, rows: Sequence[Sequence[float]]) -> None:
    """Tabs, decimal points, km/h, a column of time, and packed."""
    header = "run\ttijd [s]\tlog1 [km/h]\tlog2 [km/h]\tgps [km/h]\tkracht [N]\twind [m/s]"
    lines = [f"{header}\twind [gra]"]
    for run, log1, log2, gps, force, wind, angle, time_s in rows:
        speeds = "\t".join(f"{speed * 3.6:.3f}" for speed in (log1, log2, gps))
        lines.append(f"{run:.0f}\t{time_s:.3f}\t{speeds}\t{force:.2f}\t{wind:.3f}\t{angle:.1f}")
    path.write_bytes(gzip.compress("\r\n".join([*lines, ""]).encode(), 3))


def write_archive(root: Path) -> None:
    for folder in ("sloepregister", "sleeplijsten", "meetdata_2014", "meetdata_2015"):
        (root / folder).mkdir(parents=True)
    (root / "wedstrijden").mkdir()
    with xlsxwriter.Workbook(str(root / "sloepregister/sloependata.xlsx")) as book:
        book.add_worksheet("Toelichting").write(0, 0, "Van de technische commissie")
        sheet = book.add_worksheet("Sloepen")
        sheet.write(0, 0, "Sloepen, bijgewerkt door Jan")
        header = "FSN nr;HT-nr;Sloep;Type;Lengte [m];Breedte [m];Hoogte [m];Gewicht [kg]"
        sheet.write_row(2, 0, [*header.split(";"), "Roeiers", "Klasse"])
        for place, boat in enumerate(BOATS, start=3):
            sheet.write_row(place, 0, boat)
    with xlsxwriter.Workbook(str(root / "sleeplijsten/sleeplijst_2014.xlsx")) as book:
        sheet = book.add_worksheet("2014")
        day = book.add_format({"num_format": "d-m-yyyy"})
        sheet.write(0, 0, "Sleepproeven 2014")
        sheet.write_row(2, 0, TOWS_2014_HEADER.split(";"))
        for place, tow in enumerate(TOWS_2014, start=3):
            sheet.write(place, 0, tow[0])
            sheet.write_datetime(place, 1, dt.datetime.combine(tow[1], dt.time()), day)
            sheet.write_row(place, 2, tow[2:])
    (root / "sleeplijsten/sleeplijst_2015.csv").write_bytes(TOWS_2015.encode("cp1252"))
    for path, text in SMALL_LISTS.items():
        (root / path).write_text(text)
    (root / "archief.toml").write_text(PROFILE)
    (root / "meetdata_2015/kladje.csv").write_text("los bestand\n")

    rows = simulate_tow(1, 2.4, 40)
    for row in rows[2600:2650]:  # log 1 drops out for a second of run 2
        row[1] = 0.0
    write_samples_2014(root / "meetdata_2014/Eerste boot 8h 2014.csv", rows)
    write_samples_2014(root / "meetdata_2014/tweede boot 6d 2014.txt", simulate_tow(2, 2.1, 28))
    rows = simulate_tow(3, 2.8, 33)
    write_samples_2014(root / "meetdata_2014/Dérde boot 12h 2014.csv", rows[:-80])  # cut off
    rows = simulate_tow(4, 2.3, 38)
    for row in rows[5200:5900]:  # the load cell fails for 14 s of run 3
        row[4] = 99999.0
    write_samples_2015(root / "meetdata_2015/vierde boot 8d 2015.csv.gz", rows)
    write_samples_2015(root / "meetdata_2015/eerste boot 8h 2015.csv.gz", simulate_tow(5, 2.4, 41))


@pytest.fixture(scope="module")
def typed(tmp_path_factory: pytest.TempPathFactory) -> Archive:
    root = tmp_path_factory.mktemp("handtyped") / "archief"
    write_archive(root)
    return Archive(root)


@pytest.fixture(scope="module")
def scan(typed: Archive) -> Scan:
    return typed.scan()


def test_each_fault_costs_what_it_touches(typed: Archive, scan: Scan) -> None:
    faults = {(f.path.split("/")[-1], f.line, f.tow_id, f.reason_code, f.lost) for f in scan.faults}
    assert faults == {
        ("archief.toml", None, None, "idle_setting", None),
        ("kladje.csv", None, None, "samples_not_listed", None),
        ("lampjes_2014.csv", 4, None, "bad_instrument_row", None),
        ("sleeplijst_2015.csv", 7, "2015-3", "samples_missing", None),
        ("sleeplijst_2015.csv", 8, "2015-4", "bad_list_row", None),
        ("vensters_2014.csv", 3, None, "window_unknown_run", None),
        ("Eerste boot 8h 2014.csv", 2604, "2014-1", "log_dropout", "seconds"),
        ("Dérde boot 12h 2014.csv", 12504, "2014-3", "short_run", "seconds"),
        ("vierde boot 8d 2015.csv.gz", 5202, "2015-1", "implausible_value", "run"),
    }
    assert sorted(scan.good) == ["2014-1", "2014-2", "2014-3", "2015-1", "2015-2"]
    races, race_faults = read_races(typed.root)
    printed, register_faults = read_published_registers(typed.root)
    assert (races.height, [fault.line for fault in race_faults]) == (2, [4])
    assert (printed.height, [fault.line for fault in register_faults]) == (2, [4])


def test_lists_read_as_they_are_meant(scan: Scan) -> None:
    tows = scan.index.tows.sort("tow_id")
    days = [dt.date(2014, 3, 1), dt.date(2014, 3, 2), dt.date(2014, 3, 2)]
    assert tows["tow_date"].to_list() == [*days, dt.date(2015, 3, 7), dt.date(2015, 3, 8)]
    assert tows["fsn_no"].to_list() == ["FSN101", "FSN102", "FSN103", "FSN104", "FSN101"]
    assert tows["declared_speed_m_s"].to_list() == pytest.approx([2.4, 2.1, 2.8, 2.3, 2.4])
    assert tows["weight_kg"].to_list() == [1400, None, 864, 1302.5, 1400]
    assert tows["waterline_length_m"].to_list() == [8.0, 7.73, 10.05, 8.01, 8.08]
    assert tows["speed_correction_ratio"].to_list() == [0.06, None, None, None, None]
    assert tows["altered"].to_list() == [False, True, False, False, False]


@pytest.mark.parametrize(
    ("tow_id", "seed", "declared_m_s", "cw_kg_m"), [("2014-2", 2, 2.1, 28), ("2015-2", 5, 2.4, 41)]
)
def test_samples_read_as_they_were_measured(
    scan: Scan, tow_id: str, seed: int, declared_m_s: float, cw_kg_m: float
) -> None:
    names = ["run", "log1_m_s", "log2_m_s", "gps_m_s", "force_n", "wind_speed_m_s"]
    rows = np.array(simulate_tow(seed, declared_m_s, cw_kg_m))
    measured = pl.DataFrame(rows[:, :6], schema=names)
    read = scan.good[tow_id]
    for name in names:
        assert (read[name].cast(pl.Float64) - measured[name]).abs().max() < 0.01, name
