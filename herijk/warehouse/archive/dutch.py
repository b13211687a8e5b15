"""The sentences about the archive in Dutch, by their English text."""

from typing import Final

DUTCH: Final[dict[str, str]] = {}
