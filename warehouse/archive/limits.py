"""How large a file of the archive may be: so that no reader takes more than a gigabyte.

A small file can unpack to a large one, and a large header or footer can ask for more than the rest
of it. Everything larger is set aside with `too_large`.
"""

from typing import Final

from pipeline.errors import DefectiveInputError
from pipeline.words import say

LIST_MAX_BYTES: Final = 20_000_000
SAMPLES_MAX_BYTES: Final = 250_000_000
"""Size of a file, unpacked; one tow of six runs at 1000 Hz is 12 MB."""

MOST_ROWS: Final = 3_000_000
"""Ten times the samples of a tow."""

MOST_LISTED_ROWS: Final = 100_000
"""Rows of a list; a spreadsheet that claims more is not a list."""

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
