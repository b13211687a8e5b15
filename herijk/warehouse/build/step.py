"""A step of a build: the tables it makes, the tables it is made from, and the function between.

Everything else follows from the declaration: the fingerprint of its tables, whether they are
stale, and (in `assets`) Dagster's assets and their edges. A function sees nothing but the inputs
that its step declares, so a declaration cannot leave one out.
"""

import datetime as dt
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import polars as pl
import pyarrow as pa  # type: ignore[import-untyped]

from herijk.pipeline.method.definition import Method
from herijk.tables.frames import dtypes
from herijk.tables.schemas import TABLES, conform
from herijk.warehouse.build.archive_tables import NothingSoundError
from herijk.warehouse.build.border import failed_tows
from herijk.warehouse.build.database import database_without_tows
from herijk.warehouse.build.inputs import ARCHIVE_TABLES, METHOD_TABLES, Inputs, made_from
from herijk.warehouse.store.code import code_hash
from herijk.warehouse.store.store import Store, fingerprint
from herijk.warehouse.store.unforeseen import failures, forget, is_unforeseen, note, traced

QUARANTINE: Final = "quarantine"

FIRST_ROWS: Final = 20
"""Rows of a table that Dagster's page shows."""


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
    faults: Callable[[Inputs, Mapping[str, pl.DataFrame]], Sequence[str]]


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
        words: modules with texts that the outputs hold; texts count nowhere else.
        also: what else the outputs follow from, beside inputs, methods and code.
        is_whole: whether what it makes outside the lake is still there and undamaged.
    """

    name: str
    says: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    compute: Callable[[Inputs], Mapping[str, pl.DataFrame]]
    checks: tuple[Check, ...] = ()
    of_method: Callable[[Method], object] = lambda _: None
    words: tuple[str, ...] = ()
    also: str = ""
    is_whole: Callable[[Store], bool] = lambda _: True

    @property
    def per_method(self) -> bool:
        """Whether the step is made once for every method."""
        return set(self.outputs) <= set(METHOD_TABLES)

    @property
    def may_fail(self) -> bool:
        """Whether a rebuild goes on without its rows: without those of all tows there is none."""
        return set(self.outputs) <= set(TABLES) and set(self.outputs).isdisjoint(ARCHIVE_TABLES)

    @property
    def knows_methods(self) -> bool:
        """Whether what it makes depends on methods at all."""
        return self.per_method or not set(self.inputs).isdisjoint(METHOD_TABLES)

    @property
    def code(self) -> str:
        """Hash of the code that computes the outputs, and of the texts that they hold."""
        return code_hash(self.compute.__module__, *self.words)

    def made_from(self, store: Store, methods: Sequence[Method]) -> str:
        """Fingerprint of all that the outputs follow from."""
        return fingerprint(
            {name: made_from(store, name, methods) for name in self.inputs},
            [
                (m.name, m.content_hash, str(self.of_method(m)))
                for m in methods
                if self.knows_methods
            ],
            {n: str(dtypes(TABLES[n])) for n in self.outputs if n in TABLES},
            self.also,
            self.code,
        )

    def is_stale(self, store: Store, methods: Sequence[Method]) -> bool:
        """Whether the outputs have to be made again."""
        made_from = self.made_from(store, methods)
        partition = self._partition(methods)
        kept = (store.made_from(name, partition) == made_from for name in self.outputs)
        return not all(kept) or not self.is_whole(store)

    def make(
        self,
        store: Store,
        methods: Sequence[Method],
        today: dt.date | None = None,
        wanted: Collection[str] | None = None,
    ) -> "Made":
        """Makes the outputs and writes them.

        Args:
            store: the data folder.
            methods: those to apply, or the one where the step is made per method.
            today: the day that is noted where something is seen for the first time.
            wanted: the outputs to write; None for all. Others stay as they are, and stale.
        """
        try:
            return self._make(store, methods, today or dt.date.today(), wanted)
        finally:
            pa.system_memory_pool().release_unused()  # the C library keeps what arrays took

    def _make(
        self,
        store: Store,
        methods: Sequence[Method],
        today: dt.date,
        wanted: Collection[str] | None,
    ) -> "Made":
        made_from = self.made_from(store, methods)
        inputs = Inputs(store, self.inputs, methods, today)
        failure = " ".join(("step", self.name, *(m.name for m in methods if self.per_method)))
        try:
            made = dict(self.compute(inputs))
        except NothingSoundError as error:
            store.write(QUARANTINE, conform(QUARANTINE, error.tables[QUARANTINE]), "")
            database_without_tows(store, error.tables)
            raise
        except BaseException as error:
            if not is_unforeseen(error):
                raise
            failed = failed_tows(self.compute, inputs, error)
            if failed is not None:
                raise failed from error
            if not self.may_fail:
                raise
            note(store.root, failure, traced(error))
            made = {name: TABLES[name].create_empty() for name in self.outputs}
        else:
            forget(store.root, failure)
        partition = self._partition(methods)
        tables = {
            name: conform(name, made.pop(name)) if name in TABLES else made.pop(name)
            for name in self.outputs
            if wanted is None or name in wanted
        }
        for name, frame in tables.items():
            store.write(name, frame, made_from, partition)
        faults = {
            check: list(check.faults(inputs, tables))
            for check in self.checks
            if check.table in tables and failure not in failures(store.root)
        }
        return Made({name: Summary.of(frame) for name, frame in tables.items()}, faults)

    def _partition(self, methods: Sequence[Method]) -> str | None:
        return methods[0].name if self.per_method else None


@dataclass(frozen=True)
class Summary:
    """What is told of a table; whole, those of all methods would fill the memory.

    Attributes:
        rows: how many it has.
        statuses: how many of them have each status, where they have one.
        first: the first of them.
    """

    rows: int
    statuses: Mapping[str, int]
    first: pl.DataFrame

    @classmethod
    def of(cls, frame: pl.DataFrame) -> "Summary":
        """The summary of a table."""
        known = "status" in frame.columns
        statuses = frame["status"].value_counts().sort("status").rows() if known else ()
        first = pl.all().gather(range(min(FIRST_ROWS, frame.height)))  # a slice would keep all
        return cls(frame.height, dict(statuses), frame.select(first))


@dataclass(frozen=True)
class Made:
    """What a step made.

    Attributes:
        tables: summaries of the outputs, by name.
        faults: what does not hold of them, by check.
    """

    tables: Mapping[str, Summary]
    faults: Mapping[Check, Sequence[str]]
