"""How far a workbook reaches, seen before a reader makes room for all of it."""

import html
import io
import re
import zipfile
import zlib
from pathlib import Path
from typing import Final

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from warehouse.archive.limits import (
    MOST_LISTED_ROWS,
    SAMPLES_MAX_BYTES,
    WORKBOOK_MAX_BYTES,
    check_extent,
    check_unpacked,
)
from warehouse.archive.spelling.text import fold

_SHEETS: Final = "xl/worksheets/"
_READ: Final = (_SHEETS, "xl/sharedStrings.xml", "content.xml")
"""The parts that grow with what a workbook holds; damage in another is the reader's business."""
_NAMED: Final = re.compile(rb"<(?:\w+:)?(?:sheet|Relationship)\s[^<>]*>")
_ATTRIBUTE: Final = re.compile(rb"""([\w:]+)\s*=\s*["']([^"']*)["']""")
_MARK: Final = re.compile(
    rb"<(?:\w+:)?(table|row|c|table-row|(?:covered-)?table-cell)((?:[\s/][^<>]*)?)>(?=(\s*<[^/])?)"
)
"""A table, row or cell of XLSX or ODS, and whether anything is in it."""
_PLACE: Final = re.compile(rb"""\sr\s*=\s*["']([A-Za-z]{0,9})([0-9]{1,30})["']""")
_REPEATED: Final = re.compile(rb"""number-(?:rows|columns)-repeated\s*=\s*["']([0-9]{1,30})["']""")


_OLD_EXCEL: Final = bytes.fromhex("d0cf11e0a1b11ae1")
"""How a compound file begins: a workbook of Excel 97 to 2003, or a later one with a password."""


def check_workbook(data: bytes, only: str = "", most_rows: int = MOST_LISTED_ROWS) -> None:
    """Refuse a workbook whose cells lie too far apart, that unpacks to too much, or that is .xls.

    One cell in the last row makes a reader ask for the memory of every cell above it. What a sheet
    says of its own size may be absent or wrong, so the places of its cells count. An .xls file is
    refused unread: one whose sector table points at itself makes a reader ask for gigabytes.

    Args:
        data: content of the file.
        only: name of the sheet that is read; empty for all.
        most_rows: of a sheet.

    Raises:
        DefectiveInputError: `too_large`, or `unreadable_file` for an old workbook.
        BadZipFile, OSError, ValueError: the file is no zip file, or a damaged one.
    """
    if data.startswith(_OLD_EXCEL):
        said = say(
            "This is an old Excel workbook (.xls), or one with a password: save it as .xlsx, "
            "without a password."
        )
        raise DefectiveInputError("unreadable_file", said)
    with zipfile.ZipFile(io.BytesIO(data)) as book:
        members = book.infolist()
        if own := [part for name, part in _parts_of(book).items() if fold(name) == fold(only)]:
            members = [m for m in members if m.filename in own or not _is_sheet(m.filename)]
        check_unpacked(
            sum(member.file_size for member in members),
            WORKBOOK_MAX_BYTES if most_rows == MOST_LISTED_ROWS else SAMPLES_MAX_BYTES,
        )
        for member in members:
            if member.filename.startswith(_READ):
                _check_sheet(_content(book, member), most_rows)


def _is_sheet(part: str) -> bool:
    return part.startswith(_SHEETS)


def sheets_of(path: Path) -> list[str]:
    """The names of the sheets of an XLSX; none of another or a damaged file."""
    try:
        with zipfile.ZipFile(path) as book:
            return [*_parts_of(book)]
    except (zipfile.BadZipFile, OSError, ValueError):
        return []


def _parts_of(book: zipfile.ZipFile) -> dict[str, str]:
    """The parts of an XLSX by the name of the sheet that they hold, as far as it is said."""
    names = ("xl/workbook.xml", "xl/_rels/workbook.xml.rels")
    if not {*names} <= {*book.namelist()} or sum(book.getinfo(n).file_size for n in names) > 1e7:
        return {}
    said = [
        {name.rpartition(b":")[2]: value.decode() for name, value in _ATTRIBUTE.findall(tag)}
        for name in names
        for tag in _NAMED.findall(_content(book, book.getinfo(name)))
    ]
    targets = {one[b"Id"]: one.get(b"Target", "") for one in said if b"Id" in one}
    return {
        html.unescape(one[b"name"]): f"xl/{targets[one[b'id']].removeprefix('/xl/')}"
        for one in said
        if b"name" in one and one.get(b"id") in targets
    }


def _content(book: zipfile.ZipFile, member: zipfile.ZipInfo) -> bytes:
    """A part of the workbook; unpacking finds a size that is not true."""
    try:
        return book.read(member)
    except zlib.error as error:
        raise zipfile.BadZipFile(str(error)) from error


def _check_sheet(xml: bytes, most_rows: int) -> None:
    """Follows the cells of a sheet; empty ones do not count, as people format them by the million.

    A row or cell that does not say its place follows the one before it.
    """
    row = column = rows = columns = 0
    for mark in _MARK.finditer(xml):
        kind, attributes, child = mark.groups()
        if kind == b"table":
            row = rows = columns = 0
            continue
        place, repeated = _PLACE.search(attributes), _REPEATED.search(attributes)
        further = int(repeated[1]) if repeated else 1
        if kind in (b"row", b"table-row"):
            row, column = int(place[2]) if place else row + further, 0
            continue
        column += further
        if place:
            row, column = int(place[2]), _column(place[1])
        if (child and not attributes.endswith(b"/")) or b"value=" in attributes:
            rows, columns = max(rows, row), max(columns, column)
            check_extent(rows, columns, most_rows)


def _column(letters: bytes) -> int:
    """The number of a column: A is 1, XFD is 16384."""
    number = 0
    for letter in letters.upper():
        number = 26 * number + letter - ord("A") + 1
    return number
