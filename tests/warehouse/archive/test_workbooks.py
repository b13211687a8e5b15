"""A workbook that reaches too far is set aside before a reader makes room for it."""

import io

import xlsxwriter

from tests.warehouse.archive.conftest import TOWS, Archive

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
