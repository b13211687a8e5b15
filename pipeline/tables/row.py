"""A row of a table."""

from typing import Any

Row = dict[str, Any]
"""A row, by the names of its columns.

Its table declares their types: a `TypedDict` would say them a second time.
"""
