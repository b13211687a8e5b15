"""One cell of a header: the name in it, and its unit."""

import re
from collections.abc import Sequence
from typing import Final

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from warehouse.archive.spelling.text import fold
from warehouse.archive.spelling.units import find_scale, is_any_unit, is_unit

_BRACKETS: Final = re.compile(r"\[([^\[\]]*)\]|\(([^()]*)\)")
_UNIT_BEHIND: Final = re.compile(r"^(.*?[^\s_,])(?:\s*,\s+|\s+in\s+|[\s_]+)(m_s|[^\s_]+)$")
_NO_UNIT_BEHIND: Final = frozenset("cfgksw")
"""Single letters that mean something else behind a name: `log C`, `meetfile s`."""


def split_header(cell: str) -> tuple[str, str | None]:
    """The folded name in a header cell, and its unit as written where it has one.

    A unit is in brackets, or last (`kracht, N`, `snelheid in kn`, `breedte_cm`); other brackets
    belong to the name.
    """
    cell = cell.strip()
    groups = list(_BRACKETS.finditer(cell))
    units = [group for group in groups if is_any_unit(_last_part(group)[1])]
    square = [group for group in groups if group[1] is not None]
    for group in units or square[-1:]:
        more, unit = _last_part(group)
        return fold(cell[: group.start()] + more + cell[group.end() :]), unit
    behind = _UNIT_BEHIND.match(cell)
    unit = behind[2].replace("m_s", "m/s") if behind else ""
    if behind and is_unit(unit) and unit.casefold() not in _NO_UNIT_BEHIND:
        return fold(behind[1]), unit
    return fold(cell), None


def unit_behind(name: str, dimension: str) -> str | None:
    """The unit that ends a name somebody gave: `pull_lbf`, `speed_m_per_s`; None without one.

    Raises:
        DefectiveInputError: `unknown_unit`: a unit of something else, or what follows a `_`.
    """
    unit = split_header(name)[1]
    ends = [unit] if unit else [name[mark.end() :] for mark in re.finditer(r"[\s_,]+", name)]
    for end in ends:
        if find_scale(dimension, end.replace("_", " ")) is not None:
            return end.replace("_", " ")
    if not (unit or unread_unit(name) or (ends and name[-len(ends[-1]) - 1] == "_")):
        return None
    message = say(
        "'{end}' at the end of '{name}' is no known unit of it; put the unit in brackets."
    )
    raise DefectiveInputError("unknown_unit", say(message, end=ends[-1], name=name))


def unread_unit(name: str) -> bool:
    """Whether a name ends in a unit that `split_header` takes for a part of it: `pull_lbf`."""
    last = re.split(r"[\s_,]+", name)[-1]
    return last != name and split_header(name)[1] is None and is_any_unit(last)


def _last_part(group: re.Match[str]) -> tuple[str, str]:
    """What is in brackets before the last comma, and behind it: `(richting, graden)`."""
    more, _, unit = (group[1] or group[2] or "").rpartition(",")
    return more, unit.strip()


def with_units(header: Sequence[str], below: Sequence[str]) -> list[str] | None:
    """A header with the units of the row below it; None where that row is not one of units.

    Args:
        header: the cells of the header.
        below: the cells of the next row: `m/s`, `[N]`, or nothing.
    """
    units = [cell.strip().strip("[]()").strip() for cell in below]
    if len(units) > len(header) or not any(units):
        return None
    if not any(map(is_unit, units)):
        return None
    if not all(is_any_unit(unit) for unit in units if fold(unit) or unit in {"%", "°"}):
        return None
    units += [""] * (len(header) - len(units))
    pairs = zip(header, units, strict=True)
    return [f"{name} [{unit}]" if is_any_unit(unit) else name for name, unit in pairs]


def is_rest_of_header(header: Sequence[str], below: Sequence[str]) -> bool:
    """Whether a row goes on with the header above it: not a digit, and units or names it lacks."""
    if any(map(str.isdigit, "".join(below))) or not any(map(str.strip, below)):
        return False
    names = [cell.strip() for cell in header if cell.strip()]
    has_units = any(is_unit(cell.strip("[]() ")) or split_header(cell)[1] for cell in below)
    return has_units or len(set(names)) < len(names)


def joined_rows(upper: Sequence[str], lower: Sequence[str]) -> list[str] | None:
    """Two rows of one header as one: `Gewicht` over `voor` and `na` goes for both."""
    if len(lower) > len(upper) or not any(map(str.strip, upper)):
        return None
    joined, last = [], ""
    for above, below in zip(upper, [*lower, *[""] * (len(upper) - len(lower))], strict=True):
        last = above.strip() or last
        name = last if below.strip() else above.strip()
        joined.append(f"{name} {below.strip()}".strip())
    return joined


def header_of_rows(rows: Sequence[list[str]]) -> list[str]:
    """The header that several rows make: each goes on with the names above, or has the units."""
    header = rows[0] if rows else []
    for row in rows[1:]:
        header = with_units(header, row) or joined_rows(header, row) or header
    return header
