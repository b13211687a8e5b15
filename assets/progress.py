"""How far a rebuild is, for whoever watches it."""

from typing import Protocol


class Progress(Protocol):
    """Shows how far a rebuild is, or nothing."""

    def expect(self, tows: int) -> None:
        """How many tows will be read."""

    def tow_read(self, tow_id: str, set_aside: bool) -> None:
        """A tow was read or set aside."""

    def step(self, what: str) -> None:
        """A step begins."""
