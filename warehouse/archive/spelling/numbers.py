"""Numbers in cells: decimal marks, marks between thousands, and units behind them."""

import math
import re
from collections.abc import Iterable
from typing import Final

from warehouse.archive.spelling.text import shorten

NUMBER_PATTERN: Final = r"^[+-]?([0-9]+([.,][0-9]*)?|[.,][0-9]+)([eE][+-]?[0-9]+)?$"
"""An ordinary number with a decimal comma or point. No digit groups, no other scripts' digits."""

_NUMBER: Final = re.compile(NUMBER_PATTERN)
_GAPS: Final = "'\u2019 \u00a0\u202f"
"""Marks between thousands that are never before decimals."""
WITH_UNIT: Final = re.compile(
    rf"([+-]?[0-9.,]+(?:[{_GAPS}][0-9]{{3}})*(?:[.,][0-9]+)?(?:[eE][+-]?[0-9]+)?)"
    r"\s*([^0-9\s.,+-].*)"
)
THOUSAND: Final = re.compile(r"[+-]?[1-9][0-9]{0,2}([.,])[0-9]{3}")
_GROUPED: Final = re.compile(
    rf"[+-]?[1-9][0-9]{{0,2}}(?P<mark>[.,{_GAPS}])[0-9]{{3}}(?P<more>(?:(?P=mark)[0-9]{{3}})*)"
    r"(?P<decimals>(?!(?P=mark))[.,][0-9]+)?"
)
_DECIMAL: Final = re.compile(r"[+-]?[0-9]*([.,])([0-9]{1,2}|[0-9]{4,})")


def parse_number(text: str) -> float:
    """The number a cell holds.

    Raises:
        ValueError: the cell is empty, not an ordinary number, or too large to be one.
    """
    stripped = text.strip(" \t")
    if not _NUMBER.match(stripped):
        raise ValueError(f"'{shorten(text)}' is not a number" if stripped else "is empty")
    number = float(stripped.replace(",", "."))
    if not math.isfinite(number):
        raise ValueError(f"'{shorten(text)}' is too large")
    return number


def ungrouped(cell: str) -> str:
    """A number without the marks between its thousands, where they can be nothing else.

    `1.140,50`, `1,234,567`, `1 140` and `1'140` are; `1.140` can be little more than one.
    """
    match = _GROUPED.fullmatch(cell)
    if match is None or not (match["more"] or match["decimals"] or match["mark"] in _GAPS):
        return cell
    return cell.replace(match["mark"], "")


def decimal_mark(cells: Iterable[str]) -> str:
    """The decimal marks of numbers that can be read in one way only."""
    return "".join(sorted({m[1] for cell in cells if (m := _DECIMAL.fullmatch(cell))}))
