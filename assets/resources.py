"""What assets are given: the folders, the methods to apply, and who helps."""

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import TypeVar

import dagster as dg
from pydantic import Field

from assets.settings import Settings, read_settings
from assets.workers import in_parallel
from pipeline.errors import MissingKnowledgeError
from pipeline.method.definition import Method
from warehouse.derive.inputs import Scope
from warehouse.store.lock import only_writer
from warehouse.store.machine_faults import machine_faults_explained
from warehouse.store.methods import KnownMethods, methods_to_apply
from warehouse.store.store import Store

T = TypeVar("T")
R = TypeVar("R")


class Setup(dg.ConfigurableResource["Setup"]):
    """The archive that comes in, the data folder that goes out, and the methods to apply.

    While assets are made, nobody else writes in the data folder: another waits for its turn.
    """

    archive: str = Field(description="the archive folder")
    data: str = Field(description="the data folder, made if it is not there")
    methods: list[str] = Field(
        default_factory=list,
        description="methods to apply; the others are compared with the first",
    )
    seasons: list[int] = Field(default_factory=list, description="to read; none: all asked for")

    @contextmanager
    def yield_for_execution(self, context: dg.InitResourceContext) -> Iterator["Setup"]:  # noqa: ARG002 - Dagster's signature
        """The folders, with the right to write.

        Raises:
            MissingKnowledgeError: a server works on other folders.
        """
        served = os.environ.get("HERIJK_ARCHIVE"), os.environ.get("HERIJK_DATA")
        if os.environ.get("HERIJK_SITE") and (self.archive, self.data) != served:
            raise MissingKnowledgeError("this server works on {} and {} alone", *served)
        with machine_faults_explained(Path(self.data)), only_writer(Path(self.data), wait=True):
            yield self

    @property
    def archive_root(self) -> Path:
        """The archive."""
        return Path(self.archive)

    @property
    def store(self) -> Store:
        """The data folder."""
        return Store(Path(self.data))

    @cached_property
    def settings(self) -> Settings:
        """What `beheer.toml` says."""
        return read_settings(Path(self.data))

    @property
    def chosen_methods(self) -> list[Method]:
        """The methods to apply; the first is what the others are compared with."""
        known = KnownMethods.of(self.store)
        return [known.get(name) for name in methods_to_apply(self.store, self.methods)]

    @property
    def scope(self) -> Scope:
        """What all methods together see of the data folder."""
        return Scope(self.store, self.chosen_methods)

    def wanted(self, partitions: Sequence[str]) -> list[int]:
        """Those of some seasons that are to be made, or confirmed."""
        return [int(s) for s in partitions if not self.seasons or int(s) in self.seasons]

    def map(self, work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[T, R]]:
        """Each task with what came of it, done side by side."""
        return in_parallel(work, tasks, self.settings.dask)
