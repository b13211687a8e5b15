"""Documents of the project that the site shows as pages: which, and where they lie.

Apart from the pages, as looking whether these are stale must not import what draws.
"""

from pathlib import Path
from typing import Final

GUIDES: Final = ("method", "audit")
"""Documents of the project that have a page, by their name."""

_PACKAGE: Final = Path(__file__).parent


_FOLDERS: Final = {"nl": "docs/nl", "en": "docs"}
"""Where the documents of a language lie."""


def guide_file(name: str, language: str) -> Path:
    """Where the document is: packed with the program, or in its checkout."""
    packed = _PACKAGE / _FOLDERS[language] / f"{name}.md"
    return packed if packed.exists() else _PACKAGE.parent / _FOLDERS[language] / f"{name}.md"
