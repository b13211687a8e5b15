"""A workbook that reaches too far is set aside before a reader makes room for it."""

import io
import zipfile
from pathlib import Path

import pytest
import xlsxwriter
from xlsxwriter.worksheet import Worksheet

from pipeline.errors import DefectiveInputError
from tests.warehouse.archive.conftest import TOWS, Archive, Scan
from tests.warehouse.archive.test_formats import assert_same
from warehouse.archive import FileHashes
from warehouse.archive.check import check_archive
from warehouse.archive.lists import _check_last_cells as check_workbook
from warehouse.archive.lists import _sheets

LAST = 1_048_575, 16_383


def workbook(stray: str | None) -> bytes:
    """A list with a text, or else only a colour, in the last cell there can be."""
    file = io.BytesIO()
    with xlsxwriter.Workbook(file) as book:
        sheet = book.add_worksheet()
        sheet.write_string(0, 0, "sleep_id")
        sheet.write(*LAST, stray, book.add_format({"bg_color": "red"}))
    return file.getvalue()


def test_the_file_is_set_aside_by_name(archive: Archive) -> None:
    path = TOWS.replace(".csv", ".xlsx")
    (archive.root / TOWS).unlink()
    (archive.root / path).write_bytes(workbook("x"))
    assert (path, "too_large") in {(f.path, f.reason_code) for f in archive.scan().index.faults}


def test_a_colour_far_outside_is_no_cell_of_a_list() -> None:
    (grid,) = grids_of_workbook(workbook(None), ())
    assert grid.rows == [["sleep_id"]]


def packed(name: str, *parts: bytes) -> bytes:
    """A workbook, as far as its directory and this part of it go."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as book, book.open(name, "w") as part:
        for piece in parts:
            part.write(piece)
    return file.getvalue()


def of_ods(rows: bytes) -> bytes:
    return packed("content.xml", b"<table:table>", rows, b"</table:table>")


def of_xlsx(rows: bytes) -> bytes:
    return packed("xl/worksheets/sheet1.xml", b"<sheetData>", rows, b"</sheetData>")


CELL = b"<c><v>1</v></c>"
ODS_CELL = b"<table:table-cell><text:p>1</text:p></table:table-cell>"
EMPTY_ROWS = (
    b'<table:table-row table:number-rows-repeated="1048570"><table:table-cell/></table:table-row>'
)


@pytest.mark.parametrize(
    "book",
    [
        of_xlsx(b'<row r="1048576">' + CELL + b"</row>"),
        of_xlsx(b'<row r="7"><c r="XFC7"/>' + CELL + b"</row>"),
        of_xlsx(b"<row/>" * 100_000 + b"<row>" + CELL + b"</row>"),
        of_xlsx(b'<row><c r="CV60000"><v>1</v></c></row>'),
        of_ods(EMPTY_ROWS + b"<table:table-row>" + ODS_CELL + b"</table:table-row>"),
        of_ods(
            b'<table:table-row><table:table-cell table:number-columns-repeated="16383"/>'
            + ODS_CELL
            + b"</table:table-row>"
        ),
        of_ods(
            b'<table:table-row table:number-rows-repeated="40000000">'
            b'<table:table-cell office:value="1"/></table:table-row>'
        ),
    ],
    ids=["row", "column", "no places", "area", "ODS row", "ODS column", "40 million rows"],
)
def test_a_sheet_that_reaches_too_far_is_not_read(book: bytes) -> None:
    with pytest.raises(DefectiveInputError, match="reaches") as raised:
        check_workbook(book)
    assert raised.value.reason_code == "too_large"


@pytest.mark.parametrize(
    "book",
    [
        of_xlsx(b'<row r="2"><c r="B2"><v>1</v></c></row><row r="1048576" ht="12"/>'),
        of_ods(ODS_CELL + EMPTY_ROWS),
        of_ods((b"<table:table-row>" + ODS_CELL + b"</table:table-row>") * 50_000),
    ],
)
def test_empty_rows_to_the_last_one_are_no_list(book: bytes) -> None:
    check_workbook(book)


def test_a_workbook_that_unpacks_to_too_much_is_not_read() -> None:
    file = io.BytesIO(workbook(None))
    with zipfile.ZipFile(file, "a", zipfile.ZIP_DEFLATED) as book:
        book.writestr("xl/sharedStrings.xml.more", bytes(100_000_001))
    with pytest.raises(DefectiveInputError, match="unpacked") as told:
        grids_of_workbook(file.getvalue(), ())
    assert told.value.reason_code == "too_large"


@pytest.mark.parametrize(("blanks", "sheets"), [(0, ["een"]), (10_000_000, [])])
def test_a_directory_of_sheets_of_ten_megabytes_is_not_read(
    tmp_path: Path, blanks: int, sheets: list[str]
) -> None:
    path = tmp_path / "a.xlsx"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as book:
        book.writestr("xl/workbook.xml", '<sheet name="een" r:id="a"/>' + " " * blanks)
        book.writestr("xl/_rels/workbook.xml.rels", '<Relationship Id="a" Target="b.xml"/>')
    assert sheets_of(path) == sheets


@pytest.mark.parametrize("named", ["Proeven.xlsx#{}", "{}"])
def test_samples_in_a_sheet_per_tow_and_in_a_sheet_per_run(
    archive: Archive, good_scan: Scan, named: str
) -> None:
    """One workbook of two tows, named by sheet; one of a tow with its runs in sheets."""
    names = ("eerste boot 8h 2014", "tweede boot 6d 2014", "derde boot 12h 2014")
    with xlsxwriter.Workbook(str(archive.root / "meetdata_2014/Proeven.xlsx")) as book:
        for name in names[:2]:
            write_samples(book.add_worksheet(name), typed_rows(archive, name))
            archive.replace(TOWS, f";{name};", ";" + named.format(name) + ";")
        book.add_worksheet("Blad3")
    header, *rows = typed_rows(archive, names[2])
    with xlsxwriter.Workbook(str(archive.root / f"meetdata_2014/{names[2]}.xlsx")) as book:
        for run in range(1, 7):
            own = [row[1:] for row in rows if row[0] == run]
            write_samples(book.add_worksheet(f"run {run}"), [header[1:], *own])
        book.add_worksheet("Blad7")
    for name in names:
        (archive.root / f"meetdata_2014/{name}.csv").unlink()
    scan = archive.scan()
    assert_same(scan, good_scan)
    assert check_archive(archive.root).causes == []
    first = scan.index.tows.row(0, named=True)
    assert first["samples_path"] == f"meetdata_2014/Proeven.xlsx#{names[0]}"
    assert first["samples_sha256"] == FileHashes().hash_samples(archive.root, first["samples_path"])


def test_a_sheet_that_two_workbooks_have_is_asked_about(archive: Archive) -> None:
    rows = typed_rows(archive, "eerste boot 8h 2014")
    for name in ("Proeven", "Kopie"):
        with xlsxwriter.Workbook(str(archive.root / f"meetdata_2014/{name}.xlsx")) as book:
            write_samples(book.add_worksheet("snol"), rows)
    archive.replace(TOWS, ";eerste boot 8h 2014;", ";snol;")
    faults = [f for f in archive.scan().index.faults if f.reason_code == "ambiguous_file"]
    assert len(faults) == 1
    assert "'Kopie.xlsx#snol', 'Proeven.xlsx#snol'" in faults[0].message


def test_faults_of_samples_in_a_workbook_are_named_with_sheet_and_line(archive: Archive) -> None:
    header, *rows = typed_rows(archive, "eerste boot 8h 2014")
    for row in rows[:60]:
        row[4] = "kapot"
    with xlsxwriter.Workbook(str(archive.root / "meetdata_2014/Proeven.xlsx")) as book:
        write_samples(book.add_worksheet("snol"), [["titel"], [], header, *rows])
        write_samples(book.add_worksheet("anders"), [["run", "log1 [m/s]", "log2 [m/s]"], [1, 2]])
    archive.replace(TOWS, ";eerste boot 8h 2014;", ";Proeven.xlsx#snol;")
    archive.replace(TOWS, ";tweede boot 6d 2014;", ";Proeven.xlsx#anders;")
    archive.replace(TOWS, ";derde boot 12h 2014;", ";Proeven.xlsx#weg;")
    for path in (archive.root / "meetdata_2014").glob("*.csv"):
        path.unlink()
    told = {
        (place.path, place.line, cause.reason_code)
        for cause in check_archive(archive.root).causes
        for place in cause.places
    }
    assert told == {
        ("meetdata_2014/Proeven.xlsx#snol", 4, "bad_number"),
        ("meetdata_2014/Proeven.xlsx#anders", 1, "missing_column"),
        ("meetdata_2014/Proeven.xlsx#weg", None, "unreadable_file"),
    }


def typed_rows(archive: Archive, name: str) -> list[list[str | float]]:
    header, *lines = (archive.root / f"meetdata_2014/{name}.csv").read_text("utf-8").splitlines()
    cells = (line.replace(",", ".").split(";") for line in lines)
    return [list(header.split(";")), *([float(cell) for cell in row] for row in cells)]


def write_samples(sheet: Worksheet, rows: list[list[str | float]]) -> None:
    for place, row in enumerate(rows):
        sheet.write_row(place, 0, row)
