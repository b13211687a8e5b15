"""Which tows: all, or the newest of each boat and crew.

The statistics of types in the tables are over the newest tow of each boat and crew, and those of
lines and outliers over all tows too. Here, for one connection alone, outliers are over all.
"""

from collections.abc import Sequence
from typing import Final

import duckdb
import polars as pl

from pipeline.consistency.observed import Observed, newest, observe, of_trusted
from pipeline.consistency.outliers import tow_outliers

ALL, NEWEST = "all", "newest"
CHOICES: Final = (ALL, NEWEST)


def choose(db: duckdb.DuckDBPyConnection, tows: str, methods: Sequence[str]) -> None:
    """Lets a connection see the outliers among chosen tows.

    Args:
        db: a connection; the file itself is not changed.
        tows: one of `CHOICES`; `newest` changes nothing.
        methods: those whose statistics will be asked for.
    """
    if tows == ALL:
        db.register("of_all_tows", tow_outliers(_observed(db, methods)))
        db.execute("CREATE TEMP TABLE type_outliers AS SELECT * FROM of_all_tows")


def chosen(observed: Observed, tows: str) -> Observed:
    """The tows of a choice."""
    return observed if tows == ALL else newest(observed)


def rows_of(tows: str) -> pl.Expr:
    """Which rows, with a column `newest`, belong to a choice of tows."""
    return pl.lit(value=True) if tows == ALL else pl.col("newest")


def _observed(db: duckdb.DuckDBPyConnection, methods: Sequence[str]) -> Observed:
    curves, run_points, tows, boats = (
        db.sql(f"SELECT * FROM {name}").pl()  # noqa: S608
        for name in ("curves", "run_points", "tows", "boats")
    )
    own = [
        of_trusted(frame.filter(pl.col("method").is_in(methods)), tows)
        for frame in (curves, run_points)
    ]
    return observe(own[0], tows, boats, own[1])
