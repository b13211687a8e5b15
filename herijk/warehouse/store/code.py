"""Which code made a table: the version number and a hash of what computes."""

import hashlib
from collections.abc import Iterable
from functools import cache
from importlib import metadata
from pathlib import Path

import herijk.pipeline
import herijk.tables
import herijk.warehouse

HASH_LENGTH = 12
ROOMS = (herijk.tables, herijk.pipeline, herijk.warehouse)


@cache
def code_version() -> str:
    """Version of the package and a hash of the source of `tables`, `pipeline` and `warehouse`.

    The hash needs no git and is equal wherever the same source is installed. Two tables with
    equal inputs, method and code version are equal.
    """
    rooms = (Path(str(room.__file__)).parent for room in ROOMS)
    files = sorted(f for room in rooms for f in room.rglob("*") if _is_source(f))
    return f"{metadata.version('herijk')}+{source_hash(files)}"


def source_hash(files: Iterable[Path]) -> str:
    """Hash of the given source files, in the order given."""
    total = hashlib.sha256()
    for file in files:
        total.update(hashlib.sha256(file.read_bytes()).digest())
    return total.hexdigest()[:HASH_LENGTH]


def _is_source(file: Path) -> bool:
    return file.suffix in {".py", ".toml"} and "__pycache__" not in file.parts
