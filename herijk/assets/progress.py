"""Someone who is told how far a rebuild is."""

from typing import Protocol


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
