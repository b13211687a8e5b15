"""What people type that can be read without guessing."""

import pytest

from tests.warehouse.archive.conftest import FIRST, RATE_HZ, ROWS, TOWS, Archive, Scan, line_of
from warehouse.archive.sheets.cells import BOAT_NUMBER

TOW = "2014-001"
WIND, ANGLE = 5, 6
LAST = 6 * ROWS + 1


@pytest.mark.parametrize(
    ("cell", "number"),
    [("FSN nr 1", "1"), ("fsn-nummer 1", "1"), ("nr 1", "1"), ("FSN nr", None), ("101 nr", None)],
)
def test_a_boat_may_have_nr_before_its_number(cell: str, number: str | None) -> None:
    found = BOAT_NUMBER.fullmatch(cell)
    assert (found and found[1]) == number


@pytest.mark.parametrize("word", ["run ", "RUN-"])
def test_a_run_may_have_its_word_before_its_number(
    archive: Archive, good_scan: Scan, word: str
) -> None:
    archive.cells(0, lambda cell, _: word + cell, 2, LAST)
    scan = archive.scan()
    assert not scan.faults
    assert scan.good[TOW].equals(good_scan.good[TOW])


def test_blank_lines_part_runs_where_nothing_else_does(archive: Archive, good_scan: Scan) -> None:
    def parted(text: str) -> str:
        header, *rows = text.rstrip("\n").split("\n")
        without = [row.split(";", 1)[1] for row in rows]
        runs = [without[i : i + ROWS] for i in range(0, len(without), ROWS)]
        between = "\n;;;;;\n\n"
        return header.split(";", 1)[1] + "\n" + between.join("\n".join(run) for run in runs)

    archive.edit(FIRST, parted)
    scan = archive.scan()
    assert not scan.faults
    assert scan.good[TOW].equals(good_scan.good[TOW])


def test_a_fault_in_a_file_with_blank_lines_names_its_line(archive: Archive) -> None:
    def parted(text: str) -> str:
        header, *rows = text.rstrip("\n").split("\n")
        rows[ROWS] = rows[ROWS].replace(";", ";x", 1)  # the first of run 2
        lines = [row.split(";", 1)[1] for row in (header, *rows)]
        runs = [lines[1 + i : 1 + i + ROWS] for i in range(0, len(rows), ROWS)]
        return lines[0] + "\n" + "\n\n\n".join("\n".join(run) for run in runs)

    archive.edit(FIRST, parted)
    (fault,) = archive.scan().faults
    assert (fault.reason_code, fault.run, fault.line) == ("bad_number", 2, line_of(2) + 2)


@pytest.mark.parametrize("cell", ["999", ""])
def test_a_wind_of_999_in_all_runs_is_none(archive: Archive, good_scan: Scan, cell: str) -> None:
    archive.cells(WIND, lambda *_: cell, 2, LAST)
    scan = archive.scan()
    (fault,) = scan.faults
    assert (fault.tow_id, fault.lost, fault.run) == (TOW, "seconds", None)
    assert "without wind" in fault.message
    for name in ("wind_speed_m_s", "wind_angle_deg"):
        assert scan.good[TOW][name].null_count() == 6 * ROWS
    others = ["run", "log1_m_s", "log2_m_s", "gps_m_s", "force_n"]
    assert scan.good[TOW].select(others).equals(good_scan.good[TOW].select(others))


def test_a_wind_of_999_in_one_run_costs_that_run(archive: Archive) -> None:
    archive.cells(WIND, lambda *_: "999", line_of(2), line_of(3) - 1)
    scan = archive.scan()
    assert [(fault.lost, fault.run) for fault in scan.faults] == [("run", 2)]
    assert scan.good[TOW]["wind_speed_m_s"].null_count() == 0


def test_a_clock_that_jumps_back_costs_its_run(archive: Archive, good_scan: Scan) -> None:
    def timed(text: str) -> str:
        header, *rows = text.rstrip("\n").split("\n")
        times = [(i % ROWS) / RATE_HZ - (20.0 if ROWS + 500 <= i < 2 * ROWS else 0.0)
                 for i in range(len(rows))]  # fmt: skip
        return "\n".join(
            [f"{header};tijd [s]", *(f"{r};{t:.2f}" for r, t in zip(rows, times, strict=True))]
        )

    archive.edit(FIRST, lambda text: timed(text).replace(",", "."))
    scan = archive.scan()
    (fault,) = scan.faults
    assert (fault.lost, fault.run) == ("run", 2)
    assert "jump back" in fault.message
    kept = good_scan.good[TOW].filter(good_scan.good[TOW]["run"] != 2)
    assert scan.good[TOW].equals(kept)


def test_a_length_that_the_boat_list_rules_out_costs_the_tow_and_is_named(archive: Archive) -> None:
    """In feet, or another boat's: it was taken for a force that is off."""
    archive.replace(TOWS, "8,00", "24,9")
    scan = archive.scan()
    (fault,) = scan.faults
    assert (fault.tow_id, fault.reason_code) == (TOW, "bad_list_row")
    assert "'lengte [m]' is 24,9 and the boat list says" in fault.message
    assert TOW not in scan.good


def test_a_weight_that_the_boat_list_rules_out_costs_its_cell(archive: Archive) -> None:
    archive.replace(TOWS, ";1400;", ";14000;")
    scan = archive.scan()
    (fault,) = scan.faults
    assert (fault.tow_id, fault.lost) == (TOW, "cell")
    assert "14000 and the boat list says 1417" in fault.message
    assert scan.index.tows.filter(tow_id=TOW)["weight_kg"].to_list() == [None]


def test_a_rate_at_which_all_runs_last_twice_as_long_is_asked_about(
    archive: Archive, good_scan: Scan
) -> None:
    archive.replace(TOWS, ";nee;20;", ";nee;10;")
    scan = archive.scan()
    (fault,) = scan.faults
    assert (fault.tow_id, fault.reason_code, fault.lost_s) == (TOW, "long_run", 0.0)
    assert "is the rate 20?" in fault.message
    assert scan.good[TOW].equals(good_scan.good[TOW])
