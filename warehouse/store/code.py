"""Which code made a table: a hash of the packages that compute it, byte by byte.

Coarse on purpose: a comment in one of them makes a table again, and equal contents stop there.
Words, pages and commands are in none of them; what a method or a list says is in fingerprints.
"""

import hashlib
from functools import cache
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from typing import Final

HASH_LENGTH: Final = 12

READING: Final = ("warehouse.archive", "warehouse.intake.reading")
"""Samples are read with these: a changed byte in them reads all samples again."""

ADDING: Final = ("pipeline.blocks",)
"""Samples are added up to blocks with these."""

COMPUTING: Final = ("pipeline", "warehouse.archive", "warehouse.derive")
"""All tables that follow from lists, samples and blocks are computed with these."""


@cache
def hash_code(*packages: str) -> str:
    """Hash of the modules in some packages, with their paths."""
    hashed = hashlib.sha256()
    files: list[Path] = []
    for package in packages:
        files += _modules(package)
    for file in sorted(files):
        hashed.update(file.relative_to(_ROOT).as_posix().encode() + b"\0" + file.read_bytes())
    return hashed.hexdigest()[:HASH_LENGTH]


@cache
def code_version() -> str:
    """Return the version with a hash of the code that makes a register line from the archive.

    The hash needs no git and is equal wherever the same source is installed. Two lines with equal
    inputs, method and code version are equal.
    """
    return f"{metadata.version('herijk')}+{hash_code(*READING, *COMPUTING)}"


_ROOT: Final = Path(__file__).parents[2]
_CODE: Final = (".py", ".html", ".j2", ".typ", ".css", ".js", ".mo", ".md")
_NOT_HASHED: Final = ("tables", "compiled")
"""Folders left out: declared types are in fingerprints, compiled templates follow from others."""


def _modules(package: str) -> list[Path]:
    """Return the files of a package, or that of a single module."""
    spec = find_spec(package)
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError(package)
    file = Path(spec.origin)
    if not spec.submodule_search_locations:
        return [file]
    files = (f for f in file.parent.rglob("*.*") if f.suffix in _CODE)
    return [f for f in files if f.parent.name not in _NOT_HASHED]
