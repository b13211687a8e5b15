"""What a step may read: the tables of the lake, published editions and decisions of people.

Of each kind of input, `_read` says how it is read, and `made_from` what of it is in the fingerprint
of what is made from it.
"""

import datetime as dt
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import duckdb
import polars as pl

from herijk.pipeline.blocks.run_blocks import PLACE, RunBlocks, stack_blocks
from herijk.pipeline.errors import HerijkError
from herijk.pipeline.method.definition import Method
from herijk.tables.lake import SEASON_TABLES
from herijk.tables.schemas import TABLES
from herijk.warehouse.build.published import published_made_from, published_tables
from herijk.warehouse.intake import seasons as intake
from herijk.warehouse.store import decisions, unforeseen
from herijk.warehouse.store.database import open_database
from herijk.warehouse.store.store import Store, fingerprint, table_digest

BLOCKS: Final = "blocks"
FAILED: Final = unforeseen.FAILED_TOWS
DECISIONS: Final = "decisions"
"""The decisions of people about tows, as `decisions.decision_table` gives them."""

PUBLISHED: Final = tuple(
    f"published_{name}"
    for name in ("editions", "register", "register_history", "register_changes", "lineage")
)
"""Tables of all published editions together."""

ARCHIVE_TABLES: Final = ("boats", "seasons", "tows", "tow_runs", "hand_windows", "quarantine")
"""Tables of what the archive holds, made together."""

METHOD_TABLES: Final = (
    "run_points",
    "curves",
    "log_factors",
    "season_links",
    "retow_choice",
    "season_steps",
    "season_diagnosis",
    "tow_instruments",
    "best_estimate_weights",
    "uncertainty_budget",
    "curve_points",
    "assessments",
    "ensemble",
)
"""Tables with a partition per method."""


def forget_other_methods(store: Store, applied: Collection[str]) -> None:
    """Removes the tables of methods that are not applied any more."""
    for table in METHOD_TABLES:
        for name in set(store.partitions(table)) - set(applied):
            store.remove(table, name)


@dataclass(frozen=True)
class Inputs:
    """The inputs that a step declares, read when they are asked for.

    Attributes:
        store: the data folder.
        names: the declared inputs.
        methods: the methods to apply; the first is what others are compared with.
        today: the day that is noted where something is seen for the first time.
        tows: those to work on; None for all.
    """

    store: Store
    names: Sequence[str]
    methods: Sequence[Method]
    today: dt.date
    tows: frozenset[str] | None = None
    _read: dict[str, pl.DataFrame] = field(default_factory=dict, repr=False)

    def __getitem__(self, name: str) -> pl.DataFrame:
        """A declared input; a method's table holds the rows of all methods.

        Raises:
            KeyError: it is not declared.
        """
        if name not in self.names:
            raise KeyError(f"{name} is not a declared input: {', '.join(self.names)}")
        if name not in self._read:
            self._read[name] = self._chosen(_read(self, name))
        return self._read[name]

    def made_from(self, *names: str) -> str:
        """Fingerprint of declared inputs that do not depend on methods."""
        known = {name: made_from(self.store, name, ()) for name in names}
        return fingerprint(str(self.store.root), known, sorted(self.tows or ()))

    def only(self, tows: Collection[str]) -> "Inputs":
        """The same of some tows."""
        return replace(self, tows=frozenset(tows), _read={})

    def tow_ids(self) -> list[str]:
        """The tows that a step works on, sorted."""
        listed = next((name for name in ("tows", "season_tows") if name in self.names), None)
        column = self.blocks("tow_id")["tow_id"] if listed is None else self[listed]["tow_id"]
        return sorted(column.unique())

    def _chosen(self, frame: pl.DataFrame) -> pl.DataFrame:
        if self.tows is None or "tow_id" not in frame.columns:
            return frame
        return frame.filter(pl.col("tow_id").is_in(self.tows))

    def take(self, name: str) -> pl.DataFrame:
        """A declared input that is asked for once, and not kept."""
        frame = self[name]
        del self._read[name]
        return frame

    def blocks(self, *columns: str) -> pl.DataFrame:
        """Some columns of the declared input `blocks`: all are most of what a step holds."""
        if BLOCKS not in self.names:
            raise KeyError(f"{BLOCKS} is not a declared input: {', '.join(self.names)}")
        if self.tows is None:
            return intake.all_blocks(self.store, columns)
        with_tows = intake.all_blocks(self.store, list(dict.fromkeys(("tow_id", *columns))))
        return self._chosen(with_tows).select(columns)

    def run_blocks(self, runs: pl.DataFrame) -> RunBlocks:
        """The blocks of runs, their sums read when they are asked for."""
        return stack_blocks(self.blocks(*PLACE), runs, lambda name: self.blocks(name)[name])

    def earlier(self, table: str) -> pl.DataFrame:
        """A table as it was before; from the database where the lake lost it."""
        if self.store.made_from(table) is not None:
            return self.store.read(table)
        try:
            with open_database(self.store.database) as db:
                return pl.DataFrame(db.table(table).pl())
        except (HerijkError, duckdb.Error):  # not made yet, or damaged too
            return TABLES[table].create_empty()

    @cached_property
    def published(self) -> Mapping[str, pl.DataFrame]:
        """Rows of all published editions, by table."""
        return published_tables(self.store)


def _read(inputs: Inputs, name: str) -> pl.DataFrame:
    store = inputs.store
    if name in METHOD_TABLES:
        return store.read_all(name, [method.name for method in inputs.methods])
    if name in PUBLISHED:
        return inputs.published[name.removeprefix("published_")]
    if name in _ABOUT_TOWS:
        return _ABOUT_TOWS[name](store)
    if name in intake.INDEXED:
        return _listed(store, name)
    return _of_seasons(store, name) if name in SEASON_TABLES else store.read(name)


def made_from(store: Store, name: str, methods: Sequence[Method]) -> object:
    """What of an input is in a fingerprint."""
    if name in METHOD_TABLES:
        return {method.name: store.made_from(name, method.name) for method in methods}
    if name in PUBLISHED:
        return published_made_from(store)
    if name in _ABOUT_TOWS:
        return table_digest(_ABOUT_TOWS[name](store))
    if name in intake.INDEXED or name in ARCHIVE_TABLES:
        return _content(store, name)
    if name == BLOCKS or name in SEASON_TABLES:
        return {season: store.made_from(name, season) for season in store.partitions(name)}
    return store.made_from(name)


def _content(store: Store, name: str) -> str | None:
    """Hash of a table that is made again whenever a file was touched, often as it was."""
    return None if store.made_from(name) is None else table_digest(_listed(store, name))


def _of_seasons(store: Store, name: str) -> pl.DataFrame:
    return store.read_all(name) if store.partitions(name) else SEASON_TABLES[name].create_empty()


def _listed(store: Store, name: str) -> pl.DataFrame:
    """Without the place of the archive: where it lies changes no table."""
    return store.read(name).drop("root", strict=False)


def _decisions(store: Store) -> pl.DataFrame:
    decided = decisions.read_decisions(store.root / decisions.FILE_NAME)
    return decisions.decision_table(decided)


_ABOUT_TOWS: Final = {DECISIONS: _decisions, FAILED: unforeseen.failed_tows}
"""What was decided about tows: by people, and by us where we failed on them."""
