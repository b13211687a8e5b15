"""Whether a cell can belong to a column, by what it looks like."""

import re
from collections.abc import Callable, Mapping
from typing import Final

from pipeline.tables.declare import dy
from pipeline.tables.frames import limits
from warehouse.archive.sheets.row import BOAT_NUMBER, is_own_unit
from warehouse.archive.spelling.columns import Column
from warehouse.archive.spelling.dates import LIKE_A_DATE, is_like_a_date
from warehouse.archive.spelling.numbers import LIKE_A_NUMBER, ungrouped
from warehouse.archive.spelling.synonyms import ALL_RUNS, CLASSES, NO, YES
from warehouse.archive.spelling.text import fold_word

FITS: Final = 0.8
"""The least share of the cells that must be what the column holds; the rest can be faults."""
_LIKE_A_TIME: Final = re.compile(r"[0-9]{1,2}\s*[:.uhUH]\s*[0-9]{2}.*")
_LIKE_RUNS: Final = re.compile(
    r"b?[0-9]{1,2}(\s*([,;+&\s.-]|en|and|und|et|t/m|tm|bis|to|à)\s*b?[0-9]{1,2}){2,}"
    r"|[0-9]{1,2}\s*(-|t/m|tm|bis|to|à)\s*[0-9]{1,2}"
)


def can_stand(table: type[dy.Schema], column: Column, cell: str) -> bool:
    """Whether a cell can belong to a column, whatever its limits in another unit."""
    if column.key in _LOOKS:
        return _LOOKS[column.key](cell)
    schema = table.columns().get(column.key)
    if isinstance(schema, dy.Date):
        return is_like_a_date(cell)
    if isinstance(schema, dy.Bool):
        return fold_word(cell) in YES | NO
    if isinstance(schema, dy.Float64 | dy.Int8 | dy.Int16 | dy.Int32 | dy.Int64):
        return _can_be_number(table, column, cell)
    return True


def _can_be_number(table: type[dy.Schema], column: Column, cell: str) -> bool:
    """Whether a cell is a number with a unit of the column, a whole one where it must."""
    match = LIKE_A_NUMBER.fullmatch(ungrouped(cell))
    if match is None or not (not match[2] or is_own_unit(column.key, column.dimension, match[2])):
        return False
    if isinstance(table.columns()[column.key], dy.Float64):
        return True
    lowest, highest = limits(table, column.key)
    return match[1].isdigit() and lowest <= int(match[1][:9]) <= highest


def _can_be_file(cell: str) -> bool:
    """Whether a cell can be the name of a file: neither a number, nor a date, nor a time."""
    patterns = (LIKE_A_NUMBER, LIKE_A_DATE, _LIKE_A_TIME)
    return len(cell) > 3 and not any(pattern.fullmatch(cell) for pattern in patterns)


_LOOKS: Final[Mapping[str, Callable[[str], bool]]] = {
    "crew_class": lambda cell: fold_word(cell) in {*CLASSES, *"mvwf"},
    "run": lambda cell: cell.isdigit() and len(cell) <= 2,
    "tow_id": lambda cell: LIKE_A_DATE.fullmatch(cell) is None,
    "fsn_no": lambda cell: BOAT_NUMBER.fullmatch(cell) is not None,
    "use_runs": lambda cell: (
        fold_word(cell) in ALL_RUNS or _LIKE_RUNS.fullmatch(fold_word(cell)) is not None
    ),
    "rowing_time_s": lambda cell: _LIKE_A_TIME.fullmatch(cell) is not None,
    "file": _can_be_file,
    "second_file": _can_be_file,
    "name": lambda cell: any(map(str.isalpha, cell)),
    "boat_type": lambda cell: any(map(str.isalpha, cell)),
}
"""What cells of text look like, of columns that do not take every text."""
