"""Documents of the project that the site shows as pages: which, and where they lie.

Apart from the pages, as looking whether these are stale must not import what draws.
"""

from pathlib import Path
from typing import Final

GUIDES: Final = ("method", "audit")
"""Documents of the project that have a page, by their name."""

_PACKAGE: Final = Path(__file__).parents[1]


def guide_file(name: str) -> Path:
    """Where the document is: packed with the program, or in its checkout."""
    packed = _PACKAGE / "docs" / f"{name}.md"
    return packed if packed.exists() else _PACKAGE.parent / "docs" / f"{name}.md"
