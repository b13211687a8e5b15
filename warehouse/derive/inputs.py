"""What a step function can be given: it asks by the names of its parameters.

The name of a table gives the table; other names are those of `OTHERS`. What of each is in the
fingerprint of what is made from it is said beside how it is read.
"""

import datetime as dt
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Final, NamedTuple

import duckdb
import polars as pl

from pipeline.blocks.run_blocks import PLACE, RunBlocks, stack_blocks
from pipeline.consistency.observed import Observed, observe, of_trusted
from pipeline.errors import HerijkError
from pipeline.method.definition import Method
from pipeline.recompute.run_cache import RunCache
from pipeline.tables.lake import SEASON_TABLES
from pipeline.tables.schemas import TABLES
from warehouse.derive.registers import published_made_from, published_tables
from warehouse.intake import seasons as intake
from warehouse.store import decisions, unforeseen
from warehouse.store.database import open_database
from warehouse.store.store import Store, fingerprint, table_digest

ARCHIVE_TABLES: Final = ("boats", "seasons", "tows", "tow_runs", "hand_windows", "quarantine")
"""Tables of what the archive holds, made together."""

METHOD_TABLES: Final = (
    *("run_points", "curves", "log_factors", "season_links", "season_steps"),
    *("season_diagnosis", "tow_instruments", "best_estimate_weights", "uncertainty_budget"),
    *("curve_points", "assessments", "ensemble"),
)
"""All tows under one method."""

STUDY_TABLES: Final = ("correction_steps", "option_effects", "option_curves")
LINE_TABLES: Final = ("type_lines", "type_line_points")
TYPE_TABLES: Final = (
    *("compared_tows", "hull_speed", "type_outliers", "type_homogeneity", "pooled_curves"),
    *("speed_trend", "predicted_cw", "prediction_error"),
)
PER_METHOD: Final = frozenset(
    (*METHOD_TABLES, *STUDY_TABLES, *LINE_TABLES, *TYPE_TABLES, "variance_components")
)
"""Tables of which each method's rows are made, and kept, apart."""

OF_FIRST: Final = ("tow_instruments",)
"""Tables of which a step for one method also reads those of the first, where ladders begin."""

LAKE_ONLY: Final = ("ensemble",)
"""Tables that are not in the database: 200 rows per tow would make up most of it."""

IN_DATABASE: Final = tuple(name for name in TABLES if name not in LAKE_ONLY)

OBSERVED: Final = ("curves", "tows", "boats", "run_points")
"""What boats are compared by."""

RUNS: Final = ("boats", "tows", "tow_runs", "hand_windows", "blocks")
"""What a method is applied to."""


def forget_other_methods(store: Store, applied: Collection[str]) -> None:
    """Removes the tables of methods that are not applied any more."""
    for table in PER_METHOD:
        for name in set(store.partitions(table)) - set(applied):
            store.remove(table, name)


@dataclass(frozen=True)
class Scope:
    """For whom a step is made.

    Attributes:
        store: the data folder.
        methods: those to apply; the first is what the others are compared with.
        method: the one at hand, where a step is made once for each.
        today: the day that is noted where something is seen for the first time.
        tows: those to work on; None for all.
    """

    store: Store
    methods: Sequence[Method]
    method: Method | None = None
    today: dt.date = field(default_factory=dt.date.today)
    tows: frozenset[str] | None = None

    def only(self, tows: Collection[str]) -> "Scope":
        """The same of some tows."""
        return replace(self, tows=frozenset(tows))

    @property
    def at_hand(self) -> Method:
        """The method at hand."""
        return self.methods[0] if self.method is None else self.method

    def partitions(self, table: str) -> list[str] | None:
        """The partitions of a table that are read; None where it has none.

        A step for one method sees its rows alone; those in `OF_FIRST` of the first method too.
        """
        if table in PER_METHOD:
            first = self.methods[:1] if table in OF_FIRST else ()
            methods = self.methods if self.method is None else (*first, self.method)
            return list(dict.fromkeys(method.name for method in methods))
        if table in SEASON_TABLES or table == "blocks":
            return self.store.partitions(table)
        return None

    def chosen(self, frame: pl.DataFrame) -> pl.DataFrame:
        """The rows of the tows to work on."""
        if self.tows is None or "tow_id" not in frame.columns:
            return frame
        return frame.filter(pl.col("tow_id").is_in(self.tows))


@dataclass(frozen=True)
class Blocks:
    """Blocks of all seasons, read when they are asked for: all are most of what a step holds."""

    scope: Scope

    def columns(self, *names: str) -> pl.DataFrame:
        """Some of their columns."""
        if self.scope.tows is None:
            return intake.all_blocks(self.scope.store, names)
        with_tows = intake.all_blocks(self.scope.store, list(dict.fromkeys(("tow_id", *names))))
        return self.scope.chosen(with_tows).select(names)

    def of_runs(self, runs: pl.DataFrame) -> RunBlocks:
        """The blocks of runs, their sums read when they are asked for."""
        return stack_blocks(self.columns(*PLACE), runs, lambda name: self.columns(name)[name])


class Other(NamedTuple):
    """How something that is no table is read; what is in a fingerprint: a state, and tables."""

    read: Callable[[Scope], object]
    state: Callable[[Scope], object] = lambda _: None
    tables: tuple[str, ...] = ()


def read_table(scope: Scope, name: str) -> pl.DataFrame:
    """A table of the lake; a method's has the rows of all methods that the scope reads."""
    partitions = scope.partitions(name)
    if partitions is None:
        return scope.chosen(scope.store.read(name))
    if not partitions:
        return SEASON_TABLES[name].create_empty()
    return scope.chosen(scope.store.read_all(name, partitions))


def state_of_table(scope: Scope, name: str) -> object:
    """The contents of a table, as a hash; of each of its partitions where it has them."""
    store, partitions = scope.store, scope.partitions(name)
    if name == "about_archive" and store.made_from(name) is not None:
        return table_digest(store.read(name).drop("root"))  # where the archive lies changes nothing
    if partitions is None:
        return store.contents(name)
    return {partition: store.contents(name, partition) for partition in partitions}


def argument(scope: Scope, name: str) -> object:
    """What a parameter of that name is given."""
    return OTHERS[name].read(scope) if name in OTHERS else read_table(scope, name)


def tables_behind(name: str) -> tuple[str, ...]:
    """The tables that a parameter of that name makes a step read."""
    return OTHERS[name].tables if name in OTHERS else (name,)


def state(scope: Scope, name: str) -> object:
    """What of a parameter is in the fingerprint of what is made from it."""
    own = OTHERS[name].state(scope) if name in OTHERS else None
    return own, {table: state_of_table(scope, table) for table in tables_behind(name)}


def observe_trusted(
    curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame, run_points: pl.DataFrame
) -> Observed:
    """What statistics look at: the tows that nothing is doubted about."""
    return observe(of_trusted(curves, tows), tows, boats, of_trusted(run_points, tows))


def _decisions(scope: Scope) -> pl.DataFrame:
    decided = decisions.read_decisions(scope.store.root / decisions.FILE_NAME)
    return decisions.decision_table(decided)


def _failed_tows(scope: Scope) -> pl.DataFrame:
    return unforeseen.failed_tows(scope.store)


def _read_earlier(scope: Scope, table: str) -> pl.DataFrame:
    """Return a table as the last rebuild made it; from the database where the lake lost it."""
    if scope.store.made_from(table) is not None:
        return scope.store.read(table)
    try:
        with open_database(scope.store.database) as db:
            return pl.DataFrame(db.table(table).pl())
    except (HerijkError, duckdb.Error):  # not made yet, or damaged too
        return TABLES[table].create_empty()


def _run_cache(scope: Scope) -> RunCache:
    """What this process has computed of the runs, as long as these do not change."""
    states = {name: state(scope, name) for name in RUNS}
    return _cache_of(fingerprint(str(scope.store.root), states, sorted(scope.tows or ())))


@lru_cache(maxsize=1)
def _cache_of(_: str) -> RunCache:
    return RunCache()


def _rules(scope: Scope) -> object:
    """What a register takes from methods, beside what they compute."""
    said = [(m.validity, m.title, m.title_en, m.interval) for m in scope.methods]
    return [
        (m.name, m.content_hash, str(rules)) for m, rules in zip(scope.methods, said, strict=True)
    ]


OTHERS: Final[Mapping[str, Other]] = {
    "method": Other(
        lambda scope: scope.at_hand,
        lambda scope: (scope.at_hand.name, scope.at_hand.content_hash),
    ),
    "first_method": Other(
        lambda scope: scope.methods[0],
        lambda scope: (scope.methods[0].name, scope.methods[0].content_hash),
    ),
    "methods": Other(lambda scope: scope.methods, _rules),
    "blocks": Other(Blocks, tables=("blocks",)),
    "observed": Other(
        lambda scope: observe_trusted(*(read_table(scope, name) for name in OBSERVED)),
        tables=OBSERVED,
    ),
    "decisions": Other(_decisions, lambda scope: table_digest(_decisions(scope))),
    "failed_tows": Other(_failed_tows, lambda scope: table_digest(_failed_tows(scope))),
    "published": Other(
        lambda scope: published_tables(scope.store),
        lambda scope: published_made_from(scope.store),
    ),
    "all_tables": Other(
        lambda scope: {name: read_table(scope, name) for name in IN_DATABASE},
        tables=IN_DATABASE,
    ),
    "run_cache": Other(_run_cache),
    "quarantine_before": Other(lambda scope: _read_earlier(scope, "quarantine")),
    "has_earlier_tows": Other(lambda scope: not _read_earlier(scope, "tows").is_empty()),
    "today": Other(lambda scope: scope.today),
    "store": Other(lambda scope: scope.store),
}
"""What can be asked for beside tables."""
