"""A step of a build: the tables it makes, the tables it is made from, and the function between.

Everything else follows from the declaration: the fingerprint of its tables, whether they are
stale, and (in `assets`) Dagster's assets and their edges. A function sees nothing but the inputs
that its step declares, so a declaration cannot leave one out.
"""

import datetime as dt
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Final

import duckdb
import polars as pl

from herijk.pipeline.errors import MissingKnowledgeError
from herijk.pipeline.method.definition import Method
from herijk.tables import lake
from herijk.tables.frames import dtypes
from herijk.tables.schemas import TABLES, conform
from herijk.warehouse.build.published import published_made_from, published_tables
from herijk.warehouse.intake import seasons as intake
from herijk.warehouse.store import decisions
from herijk.warehouse.store.code import code_hash
from herijk.warehouse.store.database import open_database
from herijk.warehouse.store.store import Store, fingerprint, table_digest

SEASON_TABLES: Final = intake.SEASON_TABLES
"""Tables of intake with a partition per season."""

LISTED: Final = (
    *(f"listed_{name}" for name in (*intake.LISTED, "files", "races")),
    *("list_faults", "about_archive"),
)
"""Tables of intake that are made again by every rebuild, so that their content is what counts."""

METHOD_TABLES: Final = (
    "run_points",
    "curves",
    "log_factors",
    "season_links",
    "retow_choice",
    "season_steps",
    "uncertainty_budget",
    "curve_points",
    "assessments",
    "ensemble",
)
"""Tables with a partition per method."""

PUBLISHED: Final = "published_"
"""What the names of tables of all published editions together begin with."""

DECISIONS: Final = "decisions"
"""The decisions of people about tows, as `decisions.decision_table` gives them."""


@dataclass(frozen=True)
class Check:
    """What must hold of a table that a step made.

    Attributes:
        name: what the check is called.
        table: the table it is about.
        faults: what does not hold, given the inputs of the step and its outputs; empty if all does.
    """

    name: str
    table: str
    faults: Callable[["Inputs", Mapping[str, pl.DataFrame]], Sequence[str]]


@dataclass(frozen=True)
class Step:
    """One step of a build.

    Attributes:
        name: what the step is called.
        says: what happens, for people who wait; `{}` is the name of the method.
        inputs: names of the tables it reads.
        outputs: names of the tables it makes.
        compute: makes the outputs; its docstring says what they are.
        checks: what must hold of the outputs.
        of_method: what else of a method its outputs depend on, beside options and name.
        is_whole: whether what it makes outside the lake is still there and undamaged.
    """

    name: str
    says: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    compute: Callable[["Inputs"], Mapping[str, pl.DataFrame]]
    checks: tuple[Check, ...] = ()
    of_method: Callable[[Method], object] = lambda _: None
    is_whole: Callable[[Store], bool] = lambda _: True

    @property
    def per_method(self) -> bool:
        """Whether the step is made once for every method."""
        return set(self.outputs) <= set(METHOD_TABLES)

    @property
    def knows_methods(self) -> bool:
        """Whether what it makes depends on methods at all."""
        return self.per_method or not set(self.inputs).isdisjoint(METHOD_TABLES)

    @property
    def code(self) -> str:
        """Hash of the code that computes the outputs."""
        return code_hash(self.compute.__module__)

    def made_from(self, store: Store, methods: Sequence[Method]) -> str:
        """Fingerprint of all that the outputs follow from."""
        return fingerprint(
            {name: _made_from(store, name, methods) for name in self.inputs},
            [
                (m.name, m.content_hash, str(self.of_method(m)))
                for m in methods
                if self.knows_methods
            ],
            {n: str(dtypes(TABLES[n])) for n in self.outputs if n in TABLES},
            self.code,
        )

    def is_stale(self, store: Store, methods: Sequence[Method]) -> bool:
        """Whether the outputs have to be made again."""
        made_from = self.made_from(store, methods)
        partition = self._partition(methods)
        kept = (store.made_from(name, partition) == made_from for name in self.outputs)
        return not all(kept) or not self.is_whole(store)

    def make(self, store: Store, methods: Sequence[Method], today: dt.date | None = None) -> "Made":
        """Makes the outputs and writes them.

        Args:
            store: the data folder.
            methods: those to apply, or the one where the step is made per method.
            today: the day that is noted where something is seen for the first time.
        """
        made_from = self.made_from(store, methods)
        inputs = Inputs(store, self.inputs, methods, today or dt.date.today())
        made = self.compute(inputs)
        partition = self._partition(methods)
        found = {
            name: conform(name, made[name]) if name in TABLES else made[name]
            for name in self.outputs
        }
        for name, frame in found.items():
            store.write(name, frame, made_from, partition)
        faults = {check: list(check.faults(inputs, found)) for check in self.checks}
        return Made(found, faults)

    def _partition(self, methods: Sequence[Method]) -> str | None:
        return methods[0].name if self.per_method else None


@dataclass(frozen=True)
class Made:
    """What a step made.

    Attributes:
        tables: the outputs, by name.
        faults: what does not hold of them, by check.
    """

    tables: Mapping[str, pl.DataFrame]
    faults: Mapping[Check, Sequence[str]]


@dataclass(frozen=True)
class Inputs:
    """The tables that a step declares, read when they are asked for.

    Attributes:
        store: where they lie.
        names: the declared inputs.
        methods: the methods to apply; the first is what others are compared with.
        today: the day that is noted where something is seen for the first time.
    """

    store: Store
    names: Sequence[str]
    methods: Sequence[Method]
    today: dt.date
    _read: dict[str, pl.DataFrame] = field(default_factory=dict, repr=False)

    def __getitem__(self, name: str) -> pl.DataFrame:
        """A declared input; a method's table holds the rows of all methods.

        Raises:
            KeyError: it is not declared.
        """
        if name not in self.names:
            raise KeyError(f"{name} is not a declared input: {', '.join(self.names)}")
        if name not in self._read:
            self._read[name] = self._find(name)
        return self._read[name]

    def _find(self, name: str) -> pl.DataFrame:
        if name.startswith(PUBLISHED):
            return self._published[name.removeprefix(PUBLISHED)]
        if name == DECISIONS:
            return _decisions(self.store)
        if name == "blocks":
            return intake.all_blocks(self.store)
        if name in SEASON_TABLES:
            return self.store.read_all(name) if self.store.partitions(name) else _no_season(name)
        if name in METHOD_TABLES:
            return self.store.read_all(name, [m.name for m in self.methods])
        return self.store.read(name)

    def earlier(self, table: str) -> pl.DataFrame:
        """A table as it was before; from the database where the lake lost it."""
        if self.store.made_from(table) is not None:
            return self.store.read(table)
        try:
            with open_database(self.store.database) as db:
                return pl.DataFrame(db.table(table).pl())
        except (MissingKnowledgeError, duckdb.Error):  # not made yet, or damaged too
            return TABLES[table].create_empty()

    @cached_property
    def _published(self) -> dict[str, pl.DataFrame]:
        return published_tables(self.store)


def _made_from(store: Store, name: str, methods: Sequence[Method]) -> Any:
    """What stands for an input in a fingerprint."""
    if name.startswith(PUBLISHED):
        return published_made_from(store)
    if name == DECISIONS:
        return table_digest(_decisions(store))
    if name in LISTED:
        return table_digest(store.read(name))
    if name in SEASON_TABLES:
        return {season: store.made_from(name, season) for season in store.partitions(name)}
    if name in METHOD_TABLES:
        return {m.name: store.made_from(name, m.name) for m in methods}
    return store.made_from(name)


def _no_season(name: str) -> pl.DataFrame:
    return lake.SEASON_TABLES[name].create_empty()


def _decisions(store: Store) -> pl.DataFrame:
    found = decisions.read_decisions(store.root / decisions.FILE_NAME)
    return decisions.decision_table(found)
