"""A rebuild that nobody watches."""


class Quiet:
    """Progress that shows nothing."""

    def expect(self, tows: int) -> None:
        """Nothing is shown."""

    def tow_read(self, tow_id: str, set_aside: bool) -> None:
        """Nothing is shown."""

    def step(self, what: str) -> None:
        """Nothing is shown."""
