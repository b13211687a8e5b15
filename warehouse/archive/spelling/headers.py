"""One cell of a header: the name in it, and its unit."""

import re
from collections.abc import Sequence
from typing import Final

from warehouse.archive.spelling.text import fold
from warehouse.archive.spelling.units import is_unit

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
    units = [group for group in groups if is_unit(_last_part(group)[1])]
    square = [group for group in groups if group[1] is not None]
    for group in units or square[-1:]:
        more, unit = _last_part(group)
        return fold(cell[: group.start()] + more + cell[group.end() :]), unit
    behind = _UNIT_BEHIND.match(cell)
    unit = behind[2].replace("m_s", "m/s") if behind else ""
    if behind and is_unit(unit) and unit.casefold() not in _NO_UNIT_BEHIND:
        return fold(behind[1]), unit
    return fold(cell), None


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
    if len(units) > len(header):
        return None
    written = [unit for unit in units if fold(unit) or unit in {"%", "°"}]
    if not written or not all(map(is_unit, written)):
        return None
    units += [""] * (len(header) - len(units))
    pairs = zip(header, units, strict=True)
    return [f"{name} [{unit}]" if is_unit(unit) else name for name, unit in pairs]


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
