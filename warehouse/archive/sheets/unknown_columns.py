"""What is said of a column that nobody knows: which names it may be meant for."""

from collections.abc import Collection, Iterable, Sequence

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from warehouse.archive.sheets.sheet import Sheet
from warehouse.archive.spelling.columns import Column, nearest_columns
from warehouse.archive.spelling.synonyms import NOTHING
from warehouse.archive.spelling.text import fold, fold_word, shorten


def check_named(sheet: Sheet, known: Collection[int]) -> None:
    """Raises where a column without a name holds something: its header may have been lost."""
    for place, header in enumerate(sheet.header):
        if place in known or fold(header):
            continue
        cells = (row.fields[place].strip() for row in sheet.rows if place < len(row.fields))
        content = next((cell for cell in cells if cell and fold_word(cell) not in NOTHING), None)
        if content is not None:
            said = say(
                "Column {number} has no name and holds '{cell}'. Give it its name; one that is not "
                "needed can be put under ignore in archief.toml.",
                number=place + 1,
                cell=shorten(content),
            )
            raise DefectiveInputError("unknown_column", said, sheet.line)


def about_unknown(unknown: Iterable[str], free: Sequence[Column]) -> str:
    """The sentence about columns that nobody knows.

    Args:
        unknown: their headers.
        free: the columns that no header has; of each, those with the nearest names are offered.
    """
    near = {header: [c.header for c in nearest_columns(header, free, 0.7)] for header in unknown}
    return say(
        "Column {names} is not known. Correct it, name it under [headers] in archief.toml, or put "
        "it there under ignore.",
        names=", ".join(
            f"'{shorten(header)}'" + (f" ({', '.join(names)}?)" if names else "")
            for header, names in near.items()
        ),
        near=tuple((header, tuple(names)) for header, names in near.items()),
    )
