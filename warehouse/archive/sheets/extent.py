"""How far a workbook reaches, seen before a reader makes room for all of it."""

import io
import re
import zipfile
from typing import Final

from warehouse.archive.limits import check_extent, check_unpacked

_FILLED_CELL: Final = re.compile(
    rb"""<(?:\w+:)?c\s(?:[^<>]*\s)?r\s*=\s*["']([A-Za-z]{1,3})([0-9]{1,9})["'][^<>]*(?<!/)>\s*<[^/]"""
)
"""The place of a cell that holds something; people format empty ones by the million."""


def check_workbook(data: bytes) -> None:
    """Refuses a workbook whose cells lie too far apart, or that unpacks to too much.

    One cell in the last row makes a reader ask for the memory of every cell above it. The
    `dimension` of a sheet may be absent or wrong, so the references of its cells count.

    Args:
        data: content of the file; what is no zip file has no more cells than bytes.

    Raises:
        DefectiveInputError: `too_large`.
        BadZipFile, OSError, ValueError: the zip file is damaged.
    """
    if not zipfile.is_zipfile(io.BytesIO(data)):
        return
    with zipfile.ZipFile(io.BytesIO(data)) as book:
        members = book.infolist()
        check_unpacked(sum(member.file_size for member in members))
        for member in members:
            if member.filename.startswith("xl/worksheets/"):
                _check_sheet(book.read(member))


def _check_sheet(xml: bytes) -> None:
    rows = columns = 0
    for cell in _FILLED_CELL.finditer(xml):
        rows, columns = max(rows, int(cell[2])), max(columns, _column(cell[1]))
    check_extent(rows, columns)


def _column(letters: bytes) -> int:
    """The number of a column: A is 1, XFD is 16384."""
    number = 0
    for letter in letters.upper():
        number = 26 * number + letter - ord("A") + 1
    return number
