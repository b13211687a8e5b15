"""A row of a table."""

from collections.abc import Iterable, Mapping
from typing import Any

Row = dict[str, Any]
"""A row, by the names of its columns.

Its table declares their types: a `TypedDict` would say them a second time.
"""


def get_key(row: Mapping[str, Any], names: Iterable[str]) -> tuple[Any, ...]:
    """Return the values of some columns of a row, as `group_by` and `rows_by_key` have them."""
    return tuple(row[name] for name in names)


def pick_columns(row: Mapping[str, Any], names: Iterable[str]) -> Row:
    """Return a row with only some of its columns."""
    return {name: row[name] for name in names}
