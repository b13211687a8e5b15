"""Crews in one cell, as people say them: `8H` is eight rowers, men."""

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from herijk.warehouse.archive.meaning import FITS
from herijk.warehouse.archive.sheets import Sheet
from herijk.warehouse.archive.text import Column, find_columns
from herijk.warehouse.archive.words import CLASSES

_CREW: Final = re.compile(r"\s*([0-9]{1,2})\s*([^\W\d_]+)\s*")


def with_crews_apart(sheet: Sheet, wanted: Sequence[Column]) -> Sheet:
    """Return the table with rowers and class in a column each, where one column holds both.

    Where either column is missing, a column that is one of them, or that nobody knows, may hold
    crews. A cell that is none stays among the rowers, without a class. Where both are there, crews
    are taken apart whose class is left empty.

    Args:
        sheet: a table of a list.
        wanted: the columns of that list.
    """
    names = {c.key: c.header for c in wanted if c.key in ("rowers", "crew_class")}
    if len(names) < 2:
        return sheet
    optional = [replace(column, required=False) for column in wanted]
    found = find_columns(sheet.header, optional, sheet.line)
    if names.keys() <= found.keys():
        rowers, crew_class = (found[key].index for key in ("rowers", "crew_class"))
        rows = [replace(r, fields=_filled(r.fields, rowers, crew_class)) for r in sheet.rows]
        return replace(sheet, rows=rows)
    known = {column.index for key, column in found.items() if key not in names}
    place = next((k for k in range(len(sheet.header)) if k not in known and _crews(sheet, k)), None)
    if place is None:
        return sheet
    header = [*sheet.header, names["crew_class"]]
    header[place] = names["rowers"]
    return replace(
        sheet,
        header=header,
        rows=[replace(row, fields=_apart(row.fields, place, len(header))) for row in sheet.rows],
    )


def _crews(sheet: Sheet, place: int) -> bool:
    """Return whether a column holds crews."""
    cells = [row.fields[place] for row in sheet.rows if place < len(row.fields)]
    there = [cell for cell in cells if cell.strip()]
    return bool(there) and sum(_crew(cell) is not None for cell in there) >= FITS * len(there)


def _crew(cell: str) -> tuple[str, str] | None:
    """Return rowers and class as they are written, None where a cell is no crew."""
    match = _CREW.fullmatch(cell)
    return (match[1], match[2]) if match and match[2].casefold() in CLASSES else None


def _filled(fields: Sequence[str], rowers: int, crew_class: int) -> list[str]:
    """Return a row with the class of a crew among the rowers in its own, empty cell."""
    filled = list(fields)
    crew = _crew(fields[rowers]) if max(rowers, crew_class) < len(fields) else None
    if crew and not fields[crew_class].strip():
        filled[rowers], filled[crew_class] = crew
    return filled


def _apart(fields: Sequence[str], place: int, width: int) -> list[str]:
    """Return a row with the class in the last column of so many."""
    apart = [*fields[: width - 1], *[""] * (width - 1 - len(fields))]
    apart[place], crew_class = _crew(apart[place]) or (apart[place], "")
    return [*apart, crew_class, *fields[width - 1 :]]
