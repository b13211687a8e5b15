"""Frames made with the dtypes that a table declares."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cache
from typing import Any, TypeVar

import polars as pl

from pipeline.tables.declare import dy

S = TypeVar("S", bound=dy.Schema)


def get_dtypes(schema: type[dy.Schema], without: Collection[str] = ()) -> pl.Schema:
    """Return the declared dtypes, by column."""
    columns = schema.columns().items()
    return pl.Schema({name: column.dtype for name, column in columns if name not in without})


@cache  # asked for per cell of a list; dataframely makes all columns anew each time
def get_declared_column(schema: type[dy.Schema], name: str) -> dy.Column:
    """Return a declared column."""
    return schema.columns()[name]


@cache
def limits(schema: type[dy.Schema], name: str) -> tuple[Any, Any]:
    """Return the lowest and highest value that a column declares."""
    column = get_declared_column(schema, name)
    if not isinstance(column, dy.Float64 | dy.Int8 | dy.Int16 | dy.Int32 | dy.Int64):
        raise TypeError(f"{schema.__name__}.{name} has no limits")
    return column.min, column.max


def make_frame(
    schema: type[S], rows: Iterable[Mapping[str, Any]] | Iterable[Sequence[Any]]
) -> dy.DataFrame[S]:
    """Return a frame of rows with the declared columns and dtypes; limits are not checked."""
    frame = pl.DataFrame(list(rows), schema=get_dtypes(schema), orient="row", strict=True)
    return schema.cast(frame)
