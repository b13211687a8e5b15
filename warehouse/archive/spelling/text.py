"""Text as people and their programs write it: bytes, lines, delimiters, letters."""

import codecs
import csv
import io
import unicodedata
from functools import lru_cache
from typing import Final

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from warehouse.archive.limits import check_header

MOST_NAMES: Final = 250_000
"""Texts whose folded form is kept: those of the longest lists."""
DELIMITERS: Final = (";", "\t", ",", "|")
LONGEST_QUOTE: Final = 40
"""Letters of a cell that a sentence quotes."""


def decode(data: bytes) -> str:
    """The text of a file in UTF-8 (with or without BOM), UTF-16 with BOM, or Windows-1252.

    Raises:
        DefectiveInputError: `unreadable_file` for anything else, and for an empty file.
    """
    if not data.strip():
        raise DefectiveInputError("unreadable_file", say("The file is empty."))
    for encoding in _encodings(data):
        try:
            return data.decode(encoding)
        except UnicodeDecodeError:
            continue
    raise DefectiveInputError(
        "unreadable_file",
        say("The file is not text in UTF-8, UTF-16 or Windows-1252: it can be damaged."),
    )


def _encodings(data: bytes) -> tuple[str, ...]:
    """What the bytes can be; no text has a zero byte, but for UTF-16 with its mark."""
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return ("utf-16",)
    return () if 0 in data else ("utf-8-sig", "cp1252")


def is_separator_line(line: str) -> bool:
    """Whether a line only tells Excel the separator: `sep=;`."""
    return line.strip().strip('"').casefold().startswith("sep=") and len(line.strip()) <= 7


def find_delimiter(header_line: str) -> str:
    """The delimiter that occurs most in a header; a blank, then `;`, when there is none.

    Raises:
        DefectiveInputError: `too_large`: it is longer than a header can be.
    """
    most = max(DELIMITERS, key=header_line.count)
    check_header(header_line, header_line.count(most) + 1)
    if most not in header_line and len(header_line.split()) > 1:
        return " "
    return most


def split_line(line: str, delimiter: str) -> list[str]:
    """The fields of one line, quotes taken off.

    Raises:
        DefectiveInputError: `unreadable_file`, e.g. when a quotation mark is not closed.
    """
    if delimiter == " ":
        return line.split()
    if line and len(line) < csv.field_size_limit() and '"' not in line and "\r" not in line:
        return line.split(delimiter)  # as `csv` does, in a tenth of the time
    try:
        return next(csv.reader(io.StringIO(line), delimiter=delimiter, strict=True), [])
    except csv.Error as error:
        said = say("The header is not a row of a table: {error}.", error=error)
        raise DefectiveInputError("unreadable_file", said, line=1) from error


def split_or_nothing(line: str, delimiter: str = "") -> list[str]:
    """The fields of a line that may not be a row of a table; none where it is not."""
    try:
        return split_line(line, delimiter or find_delimiter(line))
    except DefectiveInputError:
        return []


@lru_cache(MOST_NAMES)
def fold(text: str) -> str:
    """A header for comparing: its letters and digits, without case and accents."""
    plain = unicodedata.normalize("NFKD", text).casefold()
    return "".join(letter for letter in plain if letter.isalnum())


@lru_cache(MOST_NAMES)
def fold_word(text: str) -> str:
    """A value or a file name for comparing: without case; blanks inside count once."""
    return " ".join(unicodedata.normalize("NFC", text).casefold().split())


def shorten(text: str) -> str:
    """The text, printable and cut to a length that fits in a sentence."""
    if len(text) <= LONGEST_QUOTE and text.isprintable():
        return text
    printable = "".join(letter if letter.isprintable() else "?" for letter in text[:LONGEST_QUOTE])
    return printable + ("..." if len(text) > LONGEST_QUOTE else "")
