"""Documents of the project that the site shows as pages: which, and where they lie.

Apart from the pages, as looking whether these are stale must not import what draws.
"""

from pathlib import Path
from typing import Final, NamedTuple

GUIDES: Final = ("method", "audit")
"""Documents of the project that have a page, by their name."""

_PACKAGE: Final = Path(__file__).parent


_FOLDERS: Final = {"nl": "docs/nl", "en": "docs"}
"""Where the documents of a language lie."""


def find_guide_file(name: str, language: str) -> Path:
    """Where the document is: packed with the program, or in its checkout."""
    packed = _PACKAGE / _FOLDERS[language] / f"{name}.md"
    return packed if packed.exists() else _PACKAGE.parent / _FOLDERS[language] / f"{name}.md"


class MethodGuide(NamedTuple):
    """The sections of the document on methods, in its order, each with its heading."""

    measured: str
    runs: str
    added: str
    certain: str
    register: str
    methods: str


def find_method_guide(language: str) -> MethodGuide:
    """Return the document on methods by section."""
    text = find_guide_file("method", language).read_bytes().decode()
    return MethodGuide(*(f"## {section}" for section in text.split("\n## ")[1:]))
