"""How large a file of the archive may be: so that no reader takes more than a gigabyte.

A small file can unpack to a large one, and a large header or footer can ask for more than the rest
of it. Everything larger is set aside with `too_large`.
"""

from typing import Final

from pipeline.errors import DefectiveInputError
from pipeline.messages import say

LIST_MAX_BYTES: Final = 20_000_000
SAMPLES_MAX_BYTES: Final = 250_000_000
"""Size of a file, unpacked; one tow of six runs at 1000 Hz is 12 MB."""

MOST_ROWS: Final = 3_000_000
"""Ten times the samples of a tow."""

MOST_LISTED_ROWS: Final = 100_000
"""Rows of a list; a spreadsheet that claims more is not a list."""

MOST_CELLS: Final = 5_000_000
"""Rows times columns of a sheet: a reader makes room for all of them."""

WORKBOOK_MAX_BYTES: Final = 100_000_000
"""Size of a workbook, unpacked; a list of 1,000 tows is 2 MB."""

LONGEST_HEADER: Final = 20_000
MOST_COLUMNS: Final = 500


def too_many_rows(rows: int) -> DefectiveInputError:
    """The error for a file with more rows than a tow can have."""
    return DefectiveInputError(
        "too_large",
        say(
            "The file has {} rows or more; at most {} can be right, and a tow of six "
            "runs at 1000 Hz has 300000.",
            rows,
            MOST_ROWS,
        ),
    )


def check_header(line: str, columns: int) -> None:
    """Refuses what cannot be a header.

    Raises:
        DefectiveInputError: `too_large`.
    """
    if len(line) > LONGEST_HEADER or columns > MOST_COLUMNS:
        raise DefectiveInputError(
            "too_large",
            say(
                "The header has {} columns in {} letters; at most {} in {} can be right.",
                columns,
                len(line),
                MOST_COLUMNS,
                LONGEST_HEADER,
            ),
            line=1,
        )


def check_unpacked(size: int) -> None:
    """Refuses a workbook that unpacks to so many bytes.

    Raises:
        DefectiveInputError: `too_large`.
    """
    if size > WORKBOOK_MAX_BYTES:
        said = say(
            "The workbook holds {:.0f} MB, unpacked; at most {:.0f} MB can be a list. Copy the "
            "list alone into a new workbook.",
            size / 1e6,
            WORKBOOK_MAX_BYTES / 1e6,
        )
        raise DefectiveInputError("too_large", said)


def check_extent(rows: int, columns: int) -> None:
    """Refuses a sheet that reaches so far.

    Raises:
        DefectiveInputError: `too_large`.
    """
    if rows > MOST_LISTED_ROWS or columns > MOST_COLUMNS or rows * columns > MOST_CELLS:
        said = say(
            "A sheet of the workbook reaches to row {} and column {}; a list has at most {} rows, "
            "{} columns and {} cells. Delete what is far below or beside the list, or copy the "
            "list alone into a new workbook.",
            rows,
            columns,
            MOST_LISTED_ROWS,
            MOST_COLUMNS,
            MOST_CELLS,
        )
        raise DefectiveInputError("too_large", said)
