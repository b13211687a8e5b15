"""A row of a table."""

from collections.abc import Iterable, Mapping
from typing import Any

Row = dict[str, Any]
"""A row, by the names of its columns.

Its table declares their types: a `TypedDict` would say them a second time.
"""


def pick_columns(row: Mapping[str, Any], names: Iterable[str]) -> Row:
    """Return a row with only some of its columns."""
    return {name: row[name] for name in names}
