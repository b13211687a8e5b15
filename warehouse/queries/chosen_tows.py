"""Which tows: all, the newest of each boat and crew, or those of some seasons; and what they say.

The statistics of types in the tables are over the newest tow of each boat and crew, and those of
lines and outliers over all tows too. Here, for one connection alone, they are replaced by what the
same functions make of all tows, or of those of some seasons. Statistics that treat repeat tows of a
boat as such (lines, outliers) are over all of these; the others are over the newest of them.
"""

import re
from collections.abc import Iterable, Sequence
from typing import Final

import duckdb
import numpy as np
import polars as pl

from pipeline.consistency.eras import season_ranges
from pipeline.consistency.observed import Observed, newest, observe, of_trusted
from pipeline.consistency.outliers import tow_outliers
from pipeline.consistency.tables import line_tables, type_tables
from pipeline.errors import MissingKnowledgeError

ALL, NEWEST = "all", "newest"

STATED: Final = (ALL, NEWEST)
"""Choices that are no seasons."""

BY_SEASON: Final = ("tows", "slow_tows")
PAIRS: Final = ("season", "season_before")


def choose(db: duckdb.DuckDBPyConnection, tows: str, methods: Sequence[str]) -> None:
    """Lets a connection see the statistics of chosen tows instead of the newest.

    Args:
        db: a connection; the file itself is not changed.
        tows: `newest`, which changes nothing, `all`, a season `2014` or a range `2012:2015`.
        methods: those whose statistics will be asked for.

    Raises:
        MissingKnowledgeError: there is no such choice, or no tow of those seasons.
    """
    if tows == NEWEST:
        return
    observed = chosen(_observed(db, methods), tows)
    if tows == ALL:
        made = {"type_outliers": tow_outliers(observed)}
    elif observed.table.is_empty():
        raise MissingKnowledgeError("no tow of {} has a curve that can be compared", tows)
    else:
        made = line_tables(observed) | type_tables(observed) | _of_seasons(db, _seasons(tows))
    for name, frame in made.items():
        db.register(f"made_{name}", frame)
        db.execute(f"CREATE TEMP TABLE {name} AS SELECT * FROM made_{name}")  # noqa: S608


def chosen(observed: Observed, tows: str) -> Observed:
    """The tows of a choice.

    Raises:
        MissingKnowledgeError: there is no such choice.
    """
    if tows in STATED:
        return newest(observed) if tows == NEWEST else observed
    own = observed.table["season"].is_in(_seasons(tows)).to_numpy()
    return observed.take(np.flatnonzero(own))


def rows_of(tows: str) -> pl.Expr:
    """Which rows, with `season` and `newest`, belong to a choice of tows.

    Raises:
        MissingKnowledgeError: there is no such choice.
    """
    if tows == ALL:
        return pl.lit(value=True)
    return pl.col("newest") if tows == NEWEST else pl.col("season").is_in(_seasons(tows))


def choices_of(seasons: Iterable[int]) -> list[str]:
    """Every choice that tables and pages hold, of tows of these seasons."""
    known = sorted(set(seasons))
    return [*STATED, *season_ranges(known), *map(str, known)]


def spoken_range(tows: str) -> str:
    """A season or range of seasons as people write it."""
    return tows.replace(":", "\u2013")


def _seasons(tows: str) -> list[int]:
    match = re.fullmatch(r"(\d{4})(?::(\d{4}))?", tows)
    if match is None:
        raise MissingKnowledgeError(
            "there are no tows {!r}; write all, newest, a season 2014 or a range 2012:2015", tows
        )
    return list(range(int(match[1]), int(match[2] or match[1]) + 1))


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


def _of_seasons(db: duckdb.DuckDBPyConnection, seasons: list[int]) -> dict[str, pl.DataFrame]:
    """Tables of tows, and of pairs of tows, that need no new statistics."""
    frames = {
        name: db.sql(f"SELECT * FROM {name}").pl()  # noqa: S608
        for name in (*BY_SEASON, "repeat_pairs")
    }
    kept = {name: frames[name].filter(pl.col("season").is_in(seasons)) for name in BY_SEASON}
    both = pl.all_horizontal(pl.col(PAIRS).is_in(seasons))
    return kept | {"repeat_pairs": frames["repeat_pairs"].filter(both)}
