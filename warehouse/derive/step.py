"""A step of a build: a function from tables to tables, and the tables that it makes.

Everything else follows: what it reads from the names of its parameters, the fingerprint of its
tables, whether they are stale, and (in `assets`) Dagster's assets and their edges.
"""

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import polars as pl
import pyarrow as pa  # type: ignore[import-untyped]

from pipeline.method.definition import Method
from pipeline.tables.frames import dtypes
from pipeline.tables.schemas import TABLES, conform
from warehouse.derive.inputs import (
    ARCHIVE_TABLES,
    PER_METHOD,
    Scope,
    argument,
    read_table,
    state,
    tables_behind,
)
from warehouse.derive.mending import failed_tows
from warehouse.store.code import COMPUTING, code_hash
from warehouse.store.store import Store, fingerprint
from warehouse.store.unforeseen import forget, is_unforeseen, note, traced

Made = Mapping[str, pl.DataFrame] | pl.DataFrame

QUARANTINE: Final = "quarantine"


@dataclass(frozen=True)
class Step:
    """One step of a build.

    Attributes:
        group: what it is about.
        compute: makes the outputs, by name, or the only one; its docstring says what they are, its
            parameters what it reads.
        outputs: names of the tables it makes.
        code: packages with which it computes.
        also: what else the outputs follow from, beside inputs and code.
        is_whole: whether what it makes outside the lake is still there and undamaged.
    """

    group: str
    compute: Callable[..., Made]
    outputs: tuple[str, ...]
    code: tuple[str, ...] = COMPUTING
    also: str = ""
    is_whole: Callable[[Store], bool] = lambda _: True

    @property
    def name(self) -> str:
        """What the step is called."""
        return self.compute.__name__

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """What the step reads, as `warehouse.derive.inputs` knows it."""
        return tuple(inspect.signature(self.compute).parameters)

    @cached_property
    def reads(self) -> tuple[str, ...]:
        """The tables that the step reads."""
        return tuple(dict.fromkeys(table for name in self.inputs for table in tables_behind(name)))

    @property
    def per_method(self) -> bool:
        """Whether the step is made once for every method."""
        return set(self.outputs) <= PER_METHOD

    @property
    def may_fail(self) -> bool:
        """Whether a rebuild goes on without its rows: without those of all tows there is none."""
        return set(self.outputs) <= set(TABLES) and set(self.outputs).isdisjoint(ARCHIVE_TABLES)

    def scopes(self, store: Store, methods: Sequence[Method]) -> list[Scope]:
        """One for each time that the step is made.

        Methods that estimate take longest, so they begin: all processes are busy to the end.
        """
        scope = Scope(store, methods)
        if not self.per_method:
            return [scope]
        longest_first = sorted(methods, key=lambda method: method.estimates_logs, reverse=True)
        return [replace(scope, method=method) for method in longest_first]

    def stale(self, store: Store, methods: Sequence[Method]) -> list[Scope]:
        """Those for which the outputs have to be made again."""
        return [scope for scope in self.scopes(store, methods) if self.is_stale(scope)]

    def is_stale(self, scope: Scope) -> bool:
        """Whether the outputs have to be made again."""
        made_from, partition = self.made_from(scope), self._partition(scope)
        kept = (scope.store.made_from(name, partition) == made_from for name in self.outputs)
        return not all(kept) or not self.is_whole(scope.store)

    def made_from(self, scope: Scope) -> str:
        """Fingerprint of all that the outputs follow from."""
        return fingerprint(
            {name: state(scope, name) for name in self.inputs},
            {name: str(dtypes(TABLES[name])) for name in self.outputs if name in TABLES},
            self.also,
            code_hash(*self.code),
        )

    def make(self, scope: Scope) -> None:
        """Makes the outputs and writes them.

        Raises:
            FailedTowsError: some tows make the step fail; without them it can be made.
            MissingKnowledgeError: no tow is sound.
        """
        try:
            made_from = self.made_from(scope)
            made = self._tables(scope)
            for name in self.outputs:
                frame = conform(name, made[name]) if name in TABLES else made[name]
                scope.store.write(name, frame, made_from, self._partition(scope))
        finally:
            pa.system_memory_pool().release_unused()  # the C library keeps what arrays took

    def _tables(self, scope: Scope) -> Mapping[str, pl.DataFrame]:
        """What the function makes; empty tables where it fails, and that is kept."""
        root, failure = scope.store.root, self._failure(scope)
        try:
            made = self._computed(scope)
        except BaseException as error:
            if not is_unforeseen(error):
                raise
            failed = failed_tows(
                lambda tows: self._computed(scope.only(tows)), self._tow_ids(scope), error
            )
            if failed is not None:
                raise failed from error
            if not self.may_fail:
                raise
            note(root, failure, traced(error))
            return {name: TABLES[name].create_empty() for name in self.outputs}
        forget(root, failure)
        return made

    def _computed(self, scope: Scope) -> Mapping[str, pl.DataFrame]:
        made = self.compute(**{name: argument(scope, name) for name in self.inputs})
        return {self.outputs[0]: made} if isinstance(made, pl.DataFrame) else made

    def _tow_ids(self, scope: Scope) -> list[str]:
        """The tows that the step works on, sorted; none where it knows of no tow."""
        listed = next((name for name in ("tows", "season_tows") if name in self.reads), None)
        return [] if listed is None else sorted(read_table(scope, listed)["tow_id"].unique())

    def _failure(self, scope: Scope) -> str:
        return " ".join(filter(None, ("step", self.name, self._partition(scope))))

    def _partition(self, scope: Scope) -> str | None:
        return scope.at_hand.name if self.per_method else None
