"""A cell of a workbook means what a person sees in it; a workbook that is too large is refused."""

import datetime as dt
import io
import re
import zipfile
from collections.abc import Callable
from pathlib import Path

import openpyxl
import pytest
import xlsxwriter
from openpyxl.worksheet.worksheet import Worksheet

from tests.warehouse.archive.conftest import BOATS, TOWS, Archive, Scan
from tests.warehouse.archive.test_formats import assert_same, cells_of, xlsx
from warehouse.archive import Fault
from warehouse.archive import kinds as list_kinds
from warehouse.archive.files import ArchiveFile
from warehouse.archive.lists import read_lists
from warehouse.archive.profile import Profiles
from warehouse.archive.workbooks import MAX_PART_BYTES, show_number

LIST = TOWS.replace(".csv", ".xlsx")
BOAT_LIST = BOATS.replace(".csv", ".xlsx")
CORRECTION = 16  # column of `correctie [%]`, from 1


def change(archive: Archive, edit: Callable[[openpyxl.Workbook], None], path: str = LIST) -> None:
    """Write the lists as workbooks, and change one as openpyxl sees it."""
    xlsx(archive)
    book = openpyxl.load_workbook(archive.root / path)
    edit(book)
    book.save(archive.root / path)


def put(row: int, column: int, value: object, number_format: str = "General"):
    def edit(book: openpyxl.Workbook) -> None:
        cell = book.active.cell(row, column, value)
        cell.number_format = number_format

    return edit


def faults_of(scan: Scan, path: str = LIST) -> list[Fault]:
    return [fault for fault in scan.faults if fault.path == path]


def add_rows(sheet: Worksheet, number: int) -> list[int]:
    """Copy the first tow so many times below the list; return the lines."""
    lines = list(range(7, 7 + number))
    for line in lines:
        for column in range(1, sheet.max_column + 1):
            sheet.cell(line, column, sheet.cell(4, column).value)
        sheet.cell(line, 1, f"2014-1{line}")
    return lines


def read_rows(archive: Archive) -> tuple[dict[int, dict[str, object]], dict[int, Fault]]:
    """The rows of the tow list by their line, and what is wrong on each line."""
    file = ArchiveFile(LIST, archive.root / LIST, list_kinds.TOWS, 2014, inside=True)
    found = read_lists([file], list_kinds.TOWS, Profiles())
    rows = {row["line"]: row for row in found.frame.iter_rows(named=True)}
    faults = {fault.line: fault for fault in found.faults if fault.line is not None}
    assert len(faults) == len(found.faults)
    return rows, faults


def test_a_percentage_is_what_a_person_sees(archive: Archive) -> None:
    written = [
        (6, "General", 0.06),
        (0.06, "0%", 0.06),
        (0.0625, "0.0%", 0.0625),
        (-0.03, "0.00%", -0.03),
        ("6%", "General", 0.06),
        ("6 %", "@", 0.06),
        ("6,5", "@", 0.065),
    ]

    def type_in(book: openpyxl.Workbook) -> None:
        lines = add_rows(book.active, len(written))
        for line, (value, number_format, _) in zip(lines, written, strict=True):
            put(line, CORRECTION, value, number_format)(book)

    change(archive, type_in)
    rows, faults = read_rows(archive)
    assert faults == {}
    read = [rows[line]["speed_correction_ratio"] for line in sorted(rows)[3:]]
    assert read == pytest.approx([ratio for *_, ratio in written], rel=1e-12)


@pytest.mark.parametrize(
    ("value", "number_format", "shown"),
    [
        (2.4, "General", "2.4"),
        (2.4, "0.00", "2.4"),
        (1140, "#,##0", "1140"),
        (1140, '#,##0.0,"k"', "1.14k"),
        (0.03, "0.0%", "3%"),
        (0.07, "0%", "7%"),
        (8.28, '0.00" km/h"', "8.28km/h"),
        (8.28, "0.00\\ \\m", "8.28m"),
        (7, "000", "007"),
        (7, '"FSN"000', "FSN007"),
        (1400, "[$€-413] #,##0.00", "1400"),
        (-5, "0;[Red]-0", "-5"),
        (1.5e-7, "0.00E+00", "1.5e-07"),
    ],
)
def test_a_number_is_shown_as_its_format_says_with_all_decimals(
    value: float, number_format: str, shown: str
) -> None:
    assert show_number(value, number_format) == shown


def test_a_unit_that_a_format_shows_must_be_that_of_the_column(archive: Archive) -> None:
    change(archive, put(4, 8, 8.64, '0.00" km/h"'))
    (fault,) = [fault for fault in faults_of(archive.scan()) if fault.tow_id == "2014-001"]
    assert (fault.reason_code, fault.line) == ("bad_list_row", 4)
    assert "8.64km/h" in fault.message
    archive.root.joinpath(LIST).unlink()


def test_a_unit_that_repeats_that_of_the_header_is_read(archive: Archive) -> None:
    change(archive, put(4, 12, 1400, '0" kg"'))
    scan = archive.scan()
    assert faults_of(scan) == []
    assert scan.index.tows["weight_kg"][0] == 1400


def test_an_error_or_an_uncalculated_formula_is_a_fault_of_its_cell(archive: Archive) -> None:
    error, formula = "an error of the spreadsheet", "never calculated"
    written = [
        (CORRECTION, "#N/A", error, None),
        (CORRECTION, "#VERW!", error, None),
        (CORRECTION, "=1+2", formula, None),
        (14, "=1+2", formula, "cell"),
        (14, "#DIV/0!", error, "cell"),
        (4, '=CONCATENATE("a","b")', formula, None),
        (3, "#REF!", error, None),
        (CORRECTION, "3 of 4", "not an ordinary number", None),
    ]

    def type_in(book: openpyxl.Workbook) -> None:
        lines = add_rows(book.active, len(written))
        for line, (column, value, *_) in zip(lines, written, strict=True):
            put(line, column, value)(book)

    change(archive, type_in)
    rows, faults = read_rows(archive)
    assert sorted(faults) == list(range(7, 7 + len(written)))
    for (line, fault), (_, _, said, lost) in zip(sorted(faults.items()), written, strict=True):
        assert (fault.tow_id, fault.lost) == (f"2014-1{line}", lost)
        assert said in fault.message
        assert (line in rows) == (lost == "cell")


def test_a_row_that_begins_with_an_error_is_no_remark(archive: Archive) -> None:
    change(archive, put(4, 1, "#REF!"))
    (fault,) = faults_of(archive.scan())
    assert (fault.reason_code, fault.line) == ("bad_list_row", 4)


def test_a_formula_with_its_result_is_read(archive: Archive, good_scan: Scan) -> None:
    """Also one whose result is an empty text."""
    header, *rows = cells_of(archive, TOWS)
    (archive.root / TOWS).unlink()
    with xlsxwriter.Workbook(str(archive.root / LIST)) as book:
        sheet = book.add_worksheet()
        sheet.write_row(0, 0, header)
        for place, row in enumerate(rows, start=1):
            sheet.write_row(place, 0, row)
        sheet.write_formula(1, CORRECTION - 1, "=12/2", None, 6)
        sheet.write_formula(1, 4, '=IF(1,"","x")', None, "nothing")
    edit_parts(archive.root / LIST, b"<v>nothing</v>", b"<v></v>")
    scan = archive.scan()
    assert_same(scan, good_scan)


def test_a_hidden_sheet_is_not_read_and_named(archive: Archive, good_scan: Scan) -> None:
    def hide_a_copy(book: openpyxl.Workbook) -> None:
        copy = book.copy_worksheet(book.active)
        copy.title = "kopie"
        copy.sheet_state = "hidden"
        copy.cell(4, 8, 9.9)

    change(archive, hide_a_copy)
    scan = archive.scan()
    (fault,) = scan.faults
    assert (fault.reason_code, fault.path, fault.lost) == ("hidden", LIST, "row")
    assert "'kopie'" in fault.message
    assert scan.good.keys() == good_scan.good.keys()


def test_a_hidden_row_is_not_read_and_named(archive: Archive) -> None:
    def hide(book: openpyxl.Workbook) -> None:
        book.active.row_dimensions[5].hidden = True

    change(archive, hide)
    scan = archive.scan()
    assert [(f.reason_code, f.line) for f in faults_of(scan)] == [("hidden", 5)]
    assert sorted(scan.good) == ["2014-001", "2014-003"]


def test_a_cell_beside_the_table_is_named_with_its_line(archive: Archive) -> None:
    change(archive, put(6, 26, "let op"))
    (fault,) = faults_of(archive.scan())
    assert fault.reason_code == "unknown_column"
    assert "Column 26 has no header, and holds 'let op' on line 6" in fault.message


def test_a_hidden_column_stops_its_list_where_it_holds_something(
    archive: Archive, good_scan: Scan
) -> None:
    def hide(book: openpyxl.Workbook) -> None:
        book.active.column_dimensions["P"].hidden = True

    change(archive, hide)
    (fault,) = faults_of(archive.scan())
    assert (fault.reason_code, fault.line) == ("hidden", 3)
    assert "'correctie [%]'" in fault.message
    book = openpyxl.load_workbook(archive.root / LIST)
    book.active["P4"].value = None
    book.save(archive.root / LIST)
    scan = archive.scan()
    assert faults_of(scan) == []
    assert scan.good.keys() == good_scan.good.keys()


@pytest.mark.parametrize(
    ("area", "lost"),
    [("P4:P6", {"2014-002", "2014-003"}), ("L4:M4", set()), ("A1:P1", set())],
)
def test_a_merged_cell_is_never_read_as_empty(archive: Archive, area: str, lost: set[str]) -> None:
    """Of weights, without which a tow goes on, the cell counts as empty and is named."""
    change(archive, lambda book: book.active.merge_cells(area))
    scan = archive.scan()
    assert set(scan.index.tows["tow_id"]) == {"2014-001", "2014-002", "2014-003"} - lost
    merged = [fault for fault in faults_of(scan) if "merged cells" in fault.message]
    assert len(merged) == {"P4:P6": 2, "L4:M4": 1, "A1:P1": 0}[area]


def test_a_heading_over_all_columns_is_one_fault(archive: Archive, good_scan: Scan) -> None:
    def add_heading(book: openpyxl.Workbook) -> None:
        book.active.cell(7, 1, "Tweede dag")
        book.active.merge_cells("A7:T7")

    change(archive, add_heading)
    scan = archive.scan()
    (fault,) = faults_of(scan)
    assert (fault.line, fault.lost) == (7, "row")
    assert scan.good.keys() == good_scan.good.keys()


def test_a_far_cell_that_is_only_coloured_costs_nothing(archive: Archive, good_scan: Scan) -> None:
    def colour(book: openpyxl.Workbook) -> None:
        for cell in ("C1048576", "XFD4", "XFD1048576"):
            book.active[cell].fill = openpyxl.styles.PatternFill("solid", "FFFF00")

    change(archive, colour)
    assert_same(archive.scan(), good_scan)


@pytest.mark.parametrize(
    ("has_commas", "written"),
    [
        (True, {"1.140": None, "1,140": 1.14, 2.475: 2.475}),
        (False, {"1.140": None, "1,140": None, 2.475: 2.475, "0.455": 0.455}),
    ],
)
def test_a_number_typed_as_text_is_not_taken_for_another(
    archive: Archive, has_commas: bool, written: dict[str | float, float | None]
) -> None:
    """In a column that a tow can do without: the water's temperature."""

    def type_in(book: openpyxl.Workbook) -> None:
        for other in [] if has_commas else book.active["A4:T6"]:
            for one in other:
                if re.fullmatch("[0-9]+,[0-9]+", str(one.value)):
                    one.value = float(one.value.replace(",", "."))
        for line, cell in zip(add_rows(book.active, len(written)), written, strict=True):
            book.active.cell(line, 15, cell)

    change(archive, type_in)
    rows, faults = read_rows(archive)
    for line, read in enumerate(written.values(), start=7):
        assert rows[line]["water_temperature_c"] == read
        assert (line in faults) == (read is None)
    assert {fault.reason_code for fault in faults.values()} == {"ambiguous_number"}


def test_the_same_list_as_workbook_and_csv_counts_once(archive: Archive, good_scan: Scan) -> None:
    for path in (TOWS, BOATS):
        text = (archive.root / path).read_text()
        xlsx_of = archive.root / path.replace(".csv", ".xlsx")
        with xlsxwriter.Workbook(str(xlsx_of)) as book:
            sheet = book.add_worksheet()
            for place, line in enumerate(text.splitlines()):
                for column, cell in enumerate(line.split(";")):
                    number = cell.replace(",", ".")
                    is_number = number.replace(".", "", 1).isdigit() and not cell.startswith("0")
                    sheet.write(place, column, float(number) if is_number else cell)
    scan = archive.scan()
    assert scan.faults == []
    assert scan.good.keys() == good_scan.good.keys()
    assert scan.index.boats.sort("fsn_no").equals(good_scan.index.boats)


def test_rows_that_differ_between_two_lists_are_set_aside_with_both_places(
    archive: Archive,
) -> None:
    text = (archive.root / TOWS).read_text("utf-8")
    (archive.root / TOWS.replace(".csv", ".txt")).write_text(text.replace(";2,40;", ";2,41;"))
    scan = archive.scan()
    assert sorted(scan.good) == ["2014-002", "2014-003"]
    places = {(fault.path, fault.line): str(fault.message) for fault in scan.faults}
    assert set(places) == {(TOWS, 2), (TOWS.replace(".csv", ".txt"), 2)}
    assert f"line 2 of {TOWS.replace('.csv', '.txt')}" in places[TOWS, 2]
    assert f"line 2 of {TOWS}" in places[TOWS.replace(".csv", ".txt"), 2]


def test_a_total_below_a_list_is_one_fault_and_costs_nothing(
    archive: Archive, good_scan: Scan
) -> None:
    archive.edit(TOWS, lambda text: text + "Totaal;;;;;26;;7,30;;;;;;;;;;;;\n")
    scan = archive.scan()
    (fault,) = scan.faults
    assert (fault.line, fault.lost, fault.tow_id) == (5, "row", None)
    assert "'Totaal', '26', '7,30'" in fault.message
    assert scan.good.keys() == good_scan.good.keys()


@pytest.mark.parametrize("cell", [" " * 200_000, "x" * 200_000, "8" * 5_000])
def test_a_cell_too_long_is_a_fault_before_any_pattern_is_tried(
    archive: Archive, cell: str
) -> None:
    archive.replace(TOWS, "2014-03-01", f"{cell}2014-03-01")
    faults = [fault for fault in archive.scan().faults if fault.path == TOWS]
    if cell.strip():
        (fault,) = faults
        assert (fault.reason_code, fault.line) == ("bad_list_row", 2)
        assert "'datum' has more than 1000 characters" in fault.message
    else:
        assert faults == []


@pytest.mark.parametrize("suffix", [".xls", ".ods"])
def test_other_workbooks_are_refused_with_what_to_do(archive: Archive, suffix: str) -> None:
    (archive.root / TOWS).rename(archive.root / TOWS.replace(".csv", suffix))
    (fault,) = [f for f in archive.scan().faults if f.path.endswith(suffix)]
    assert fault.reason_code == "unreadable_file"
    assert "save it as .xlsx" in fault.message


def edit_parts(path: Path, old: bytes, new: bytes) -> None:
    """Replace a text in the parts of a workbook."""
    with zipfile.ZipFile(path) as book:
        parts = {name: book.read(name) for name in book.namelist()}
    assert any(old in part for part in parts.values())
    with zipfile.ZipFile(path, "w") as book:
        for name, part in parts.items():
            book.writestr(name, part.replace(old, new))


def too_large(root: Path) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as book:
        book.writestr("xl/worksheets/sheet1.xml", bytes(MAX_PART_BYTES + 1))
    return content.getvalue()


def far_cell(root: Path) -> bytes:
    """A list with a text in the last cell there can be, and no word of how far it reaches."""
    content = io.BytesIO()
    with xlsxwriter.Workbook(content) as book:
        sheet = book.add_worksheet()
        sheet.write_string(0, 0, "sleep_id")
        sheet.write_string(1_048_575, 16_383, "x")
    path = root / "far.xlsx"
    path.write_bytes(content.getvalue())
    edit_parts(path, b'<dimension ref="A1:XFD1048576"/>', b"")
    data = path.read_bytes()
    path.unlink()
    return data


@pytest.mark.parametrize("made", [too_large, far_cell])
def test_a_workbook_that_is_too_large_is_refused_by_name(
    archive: Archive, made: Callable[[Path], bytes]
) -> None:
    (archive.root / TOWS).unlink()
    (archive.root / LIST).write_bytes(made(archive.root))
    (fault,) = [fault for fault in archive.scan().index.faults if fault.path == LIST]
    assert fault.reason_code == "too_large"
    assert "into a new workbook" in fault.message


def test_a_time_in_a_cell_is_a_rowing_time(archive: Archive) -> None:
    header = ["wedstrijd", "datum", "afstand [km]", "fsn_nr", "roeiers", "klasse", "roeitijd"]
    book = openpyxl.Workbook()
    book.active.append(header)
    day = dt.datetime(2014, 6, 1)
    book.active.append(["Tocht", day, 18.4, 1, 8, "H", dt.time(2, 10, 25)])
    book.active.append(["Tocht", day, 18.4, 2, 6, "D", dt.timedelta(hours=2, minutes=41)])
    book.save(archive.root / "wedstrijden/tocht_2014.xlsx")
    from warehouse.archive import read_races  # noqa: PLC0415

    races, faults = read_races(archive.root)
    assert faults == []
    assert races["rowing_time_s"].to_list() == [7825.0, 9660.0]
