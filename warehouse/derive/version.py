"""The version of the code that made a register line, from the files of the archive on."""

from functools import cache
from importlib import metadata

from warehouse.store.code import COMPUTING, READING, code_hash


@cache
def code_version() -> str:
    """Version of the package and a hash of what computes a register line.

    The hash needs no git and is equal wherever the same source is installed. Two lines with equal
    inputs, method and code version are equal.
    """
    return f"{metadata.version('herijk')}+{code_hash(*READING, *COMPUTING)}"
