"""The tables of the warehouse, each declared once: names, dtypes, units, ranges and meaning.

Other programs rely on these names; a column may be added, none is renamed or dropped without a
line in the changelog. Units are in the names (SI); ratios are ratios.
"""

import re
from inspect import cleandoc
from types import ModuleType
from typing import Final

import polars as pl

from pipeline.tables import (
    about,
    archive,
    consistency,
    curves,
    editions,
    register,
    runs,
    season_log,
    studies,
)
from pipeline.tables.declare import dy


def _collect_tables(*modules: ModuleType) -> dict[str, type[dy.Schema]]:
    """Return the tables of modules by name: that of the class, in snake case."""
    return {
        re.sub("(?<!^)(?=[A-Z])", "_", name).lower(): declared
        for module in modules
        for name, declared in vars(module).items()
        if isinstance(declared, type) and declared.__module__ == module.__name__
        if not name.startswith("_")
    }


TABLES: Final = _collect_tables(
    archive, runs, curves, season_log, register, editions, studies, consistency
)
"""Every class of these modules but those that begin with an underscore, which tables inherit."""

STUDY: Final = (
    "hand_windows", "season_links", "best_estimate_weights", "vote_curves",
    "type_line_points", "print_reproduction",
)  # fmt: skip
"""Tables that studies and pages work with: in the database they are in the schema `study`."""

ABOUT: Final = _collect_tables(about)
"""Tables of the database about itself."""


def summarize_table(schema: type[dy.Schema]) -> str:
    """Return the meaning of a table in one sentence; its Dutch is among the texts."""
    return cleandoc(schema.__doc__ or "").partition("\n")[0]


def put_in_order(name: str, frame: pl.DataFrame) -> pl.DataFrame:
    """Return the declared columns of a table, in order, sorted by its key."""
    schema = TABLES[name]
    return frame.select(schema.column_names()).sort(schema.primary_key() or schema.column_names())


def conform(name: str, frame: pl.DataFrame) -> pl.DataFrame:
    """Return the columns of a table in order, checked against its declaration.

    Whole numbers get the declared width: counts come wider than they are kept.

    Raises:
        dataframely.exc.ValidationError, SchemaError: the frame is not what was declared.
    """
    schema = TABLES[name]
    whole = [
        pl.col(column).cast(declared.dtype)
        for column, declared in schema.columns().items()
        if declared.dtype.is_integer() and frame.schema[column].is_integer()
    ]
    return schema.validate(put_in_order(name, frame.with_columns(whole)))
