"""Which code made a table: a hash of the modules that compute it.

A module counts with all modules of this package that it imports, directly or through others. Of
each the syntax tree counts, without docstrings and comments, so that only a change of what is
computed makes another hash. Left out are the declared tables, as what a step writes is part of its
fingerprint (`warehouse.build.step`), and the Dutch of sentences, which are made in English.
"""

import ast
import hashlib
import importlib.util
import json
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path
from typing import Final, Self

from herijk.warehouse.store.files import written_beside

PACKAGE: Final = "herijk"
FAULTS_IN_DUTCH: Final = f"{PACKAGE}.words.archive"
"""The Dutch of faults: no number depends on it, but tables hold it beside the English."""

SENTENCES_IN_DUTCH: Final = (
    *(f"{PACKAGE}.words.command", f"{PACKAGE}.words.errors"),
    FAULTS_IN_DUTCH,
)
LEFT_OUT: Final = (f"{PACKAGE}.tables", *SENTENCES_IN_DUTCH)
"""Modules that count only where they are named."""

HASH_LENGTH: Final = 12

READERS: Final = (
    "herijk.warehouse.archive.samples.tow",
    "herijk.warehouse.archive.samples.resolution",
    "herijk.warehouse.archive.plausibility.judge",
)
"""Modules that turn a file into samples: when they compute otherwise, files are read again."""

ADDERS: Final = ("herijk.pipeline.blocks.sums",)
"""Modules that add samples up: when they compute otherwise, the lake's samples are added again."""

Facts = tuple[str, list[str]]
"""The hash of a module's tree, and the names that it imports from the package."""


@dataclass
class Sources:
    """The modules of the package as they lie in a folder, and what is known of them.

    Attributes:
        folder: holds the package.
        known: facts of each module, by the content hash of its file.
    """

    folder: Path
    known: dict[str, Facts] = field(default_factory=dict)

    @classmethod
    def installed(cls) -> Self:
        """The package that is running, with what earlier processes found out about it."""
        sources = cls(Path(__file__).parents[3])
        with suppress(OSError, ValueError):
            sources.known = json.loads(_cache_file().read_text(encoding="utf-8"))
        return sources

    def hash_of(self, *modules: str) -> str:
        """Hash of the given modules and all that they import from the package."""
        before = len(self.known)
        lines = [f"{name}:{self._facts(name)[0]}\n" for name in sorted(self.closure(modules))]
        if len(self.known) > before:
            self._keep()
        return hashlib.sha256("".join(lines).encode()).hexdigest()[:HASH_LENGTH]

    def closure(self, modules: Iterable[str]) -> set[str]:
        """The given modules and all that they import from the package."""
        closure: set[str] = set()
        to_do = set(modules)
        while to_do:
            name = to_do.pop()
            closure.add(name)
            imported = filter(None, map(self._module, self._facts(name)[1]))
            to_do |= {name for name in imported if not name.startswith(LEFT_OUT)} - closure
        return closure

    def _module(self, imported: str) -> str | None:
        """The module that an imported name is, or is in; None for other packages."""
        if imported in self._modules:
            return imported
        parent = imported.rpartition(".")[0]
        return parent if parent in self._modules else None

    @cached_property
    def _modules(self) -> dict[str, Path]:
        return {
            ".".join(file.relative_to(self.folder).with_suffix("").parts).removesuffix(
                ".__init__"
            ): file
            for file in (self.folder / PACKAGE).rglob("*.py")
        }

    @cached_property
    def _facts(self) -> Callable[[str], Facts]:
        return cache(self._find_facts)

    def _find_facts(self, module: str) -> Facts:
        source = self._modules[module].read_bytes()
        key = hashlib.sha256(source).hexdigest()
        if key not in self.known:
            tree = ast.parse(source)
            text = "\x1f".join(_canonical(tree))
            tree_hash = hashlib.sha256(text.encode()).hexdigest()
            self.known[key] = (tree_hash, sorted(_imports(tree)))
        return self.known[key]

    def _keep(self) -> None:
        """Remembers the hashes where Python keeps its compiled files, if it may."""
        with suppress(OSError), written_beside(_cache_file()) as beside:
            beside.write_text(json.dumps(self.known), encoding="utf-8")


def _cache_file() -> Path:
    return Path(importlib.util.cache_from_source(__file__)).with_suffix(".json")


def _canonical(node: object) -> Iterator[str]:
    """A syntax tree as text, without docstrings, positions and fields that are empty.

    Not `ast.dump`, whose text depends on the version of Python.
    """
    if isinstance(node, ast.AST):
        yield type(node).__name__
        for name, value in ast.iter_fields(node):
            if value is not None and value != []:
                yield name
                yield from _canonical(value)
    elif isinstance(node, list):
        yield "["
        for item in node:
            if not _is_text(item):
                yield from _canonical(item)
        yield "]"
    else:
        yield repr(node)


def _is_text(node: object) -> bool:
    """Whether a statement is only text: a docstring of a module, class, function or constant."""
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def _imports(node: ast.AST) -> Iterator[str]:
    """Names that a tree imports from the package, but for those that only type checkers read."""
    if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
        return
    if isinstance(node, ast.Import):
        yield from (name.name for name in node.names if name.name.startswith(PACKAGE))
    elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith(PACKAGE):
        yield from (f"{node.module}.{name.name}" for name in node.names)
    for child in ast.iter_child_nodes(node):
        yield from _imports(child)


@cache
def code_hash(*modules: str) -> str:
    """Hash of the code with which the given modules of the running package compute."""
    return _installed().hash_of(*modules)


@cache
def _installed() -> Sources:
    return Sources.installed()
