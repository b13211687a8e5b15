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

MOST_ROWS_OF_A_SHEET: Final = 1_048_576
"""Of samples: as many as a spreadsheet has."""

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


def check_unpacked(size: int, most: int = WORKBOOK_MAX_BYTES) -> None:
    """Refuses a workbook of which so many bytes have to be unpacked.

    Raises:
        DefectiveInputError: `too_large`.
    """
    if size > most:
        said = say(
            "The workbook holds {:.0f} MB, unpacked; at most {:.0f} MB can be right. Copy the "
            "sheet alone into a new workbook.",
            size / 1e6,
            most / 1e6,
        )
        raise DefectiveInputError("too_large", said)


def check_extent(rows: int, columns: int, most_rows: int = MOST_LISTED_ROWS) -> None:
    """Refuses a sheet that reaches so far.

    Raises:
        DefectiveInputError: `too_large`.
    """
    if rows > most_rows or columns > MOST_COLUMNS or rows * columns > MOST_CELLS:
        said = say(
            "A sheet of the workbook reaches to row {} and column {}; a table has at most {} rows, "
            "{} columns and {} cells. Delete what is far below or beside the table, or copy it "
            "alone into a new workbook.",
            rows,
            columns,
            most_rows,
            MOST_COLUMNS,
            MOST_CELLS,
        )
        raise DefectiveInputError("too_large", said)
