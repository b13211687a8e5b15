"""What assets are given: the folders, and someone to tell how far they are.

Resources load nothing and compute nothing; they hand plain objects to `warehouse` and `pipeline`.
"""

from pathlib import Path
from typing import Protocol

import dagster as dg
from pydantic import Field

from pipeline.method import Method, shipped_method, shipped_methods
from warehouse.store import Store


class Setup(dg.ConfigurableResource):
    """The archive that comes in, the data folder that goes out, and the methods to apply."""

    archive: str
    data: str
    methods: list[str] = Field(default_factory=lambda: list(shipped_methods()))

    @property
    def archive_root(self) -> Path:
        """The archive."""
        return Path(self.archive)

    @property
    def store(self) -> Store:
        """The data folder."""
        return Store(Path(self.data))

    @property
    def chosen_methods(self) -> list[Method]:
        """The methods to apply; the first is what the others are compared with."""
        return [shipped_method(name) for name in self.methods]


class Progress(Protocol):
    """Is told what happens; shows it or keeps quiet."""

    def expect(self, tows: int) -> None:
        """So many tows are going to be read."""

    def tow_read(self, tow_id: str, set_aside: bool) -> None:
        """A tow was read or set aside."""

    def step(self, what: str) -> None:
        """A step begins."""


class Quiet:
    """Progress that shows nothing."""

    def expect(self, tows: int) -> None:
        """Nothing is shown."""

    def tow_read(self, tow_id: str, set_aside: bool) -> None:
        """Nothing is shown."""

    def step(self, what: str) -> None:
        """Nothing is shown."""
