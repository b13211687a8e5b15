"""A workbook that reaches too far is set aside before a reader makes room for it."""

import io
import subprocess
import sys
import zipfile

import pytest
import xlsxwriter

from pipeline.errors import DefectiveInputError
from tests.warehouse.archive.conftest import TOWS, Archive
from warehouse.archive.sheets.sheet import sheets_of_workbook

LAST = 1_048_575, 16_383
READ = (
    "import sys; from warehouse.archive.sheets.sheet import sheets_of_workbook as read;"
    "list(read(sys.stdin.buffer.read(), ()))"
)


def workbook(stray: str | None) -> bytes:
    """A list with a text, or else only a colour, in the last cell there can be."""
    file = io.BytesIO()
    with xlsxwriter.Workbook(file) as book:
        sheet = book.add_worksheet()
        sheet.write_string(0, 0, "sleep_id")
        sheet.write(*LAST, stray, book.add_format({"bg_color": "red"}))
    return file.getvalue()


def test_a_cell_far_outside_does_not_end_the_process() -> None:
    """In a process of its own: a reader that asks for 512 GB takes this one along."""
    command = [sys.executable, "-c", READ]
    ended = subprocess.run(command, input=workbook("x"), capture_output=True, check=False)
    assert ended.returncode == 1
    assert b"DefectiveInputError: A sheet of the workbook reaches to row 1048576" in ended.stderr


def test_the_file_is_set_aside_by_name(archive: Archive) -> None:
    path = TOWS.replace(".csv", ".xlsx")
    (archive.root / TOWS).unlink()
    (archive.root / path).write_bytes(workbook("x"))
    assert (path, "too_large") in {(f.path, f.reason_code) for f in archive.scan().index.faults}


def test_a_colour_far_outside_is_no_cell_of_a_list() -> None:
    (sheet,) = sheets_of_workbook(workbook(None), ())
    assert sheet.header == ["sleep_id"]


def test_a_workbook_that_unpacks_to_too_much_is_not_read() -> None:
    file = io.BytesIO(workbook(None))
    with zipfile.ZipFile(file, "a", zipfile.ZIP_DEFLATED) as book:
        book.writestr("xl/sharedStrings.xml.more", bytes(100_000_001))
    with pytest.raises(DefectiveInputError, match="unpacked") as told:
        list(sheets_of_workbook(file.getvalue(), ()))
    assert told.value.reason_code == "too_large"
