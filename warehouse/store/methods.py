"""The methods that a data folder knows: those that ship, and its own files in `methods/`.

A federation's own method is a file like those that ship. Its name is that of the file, and no
method that ships can be replaced.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Self

from pipeline.errors import MissingKnowledgeError
from pipeline.method.definition import Method
from pipeline.method.reading import (
    MethodFileError,
    list_shipped_methods,
    parse_method,
    read_shipped_method,
    read_shipped_text,
)
from pipeline.toml_text import decode_toml
from warehouse.store.files import write_beside
from warehouse.store.store import Store

SUFFIX: Final = ".toml"


@dataclass(frozen=True)
class KnownMethods:
    """Methods by name.

    Attributes:
        folder: holds the files of those that do not ship; need not exist.
    """

    folder: Path

    @classmethod
    def from_store(cls, store: Store) -> Self:
        """Return the methods that a data folder knows."""
        return cls(store.root / "methods")

    @property
    def own(self) -> tuple[str, ...]:
        """Names of the folder's own methods, in alphabetical order."""
        files = {file.stem for file in self.folder.glob(f"[!.]*{SUFFIX}")}
        return tuple(sorted(files - set(list_shipped_methods())))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all methods: those that ship, then the folder's own."""
        return list_shipped_methods() + self.own

    def get(self, name: str) -> Method:
        """Return a method by name.

        Raises:
            MissingKnowledgeError: there is no such method.
            MethodFileError: its file has an error, or the method in it has another name.
        """
        if name in list_shipped_methods():
            return read_shipped_method(name)
        file = self.folder / f"{name}{SUFFIX}"
        method = parse_method(self.text(name), str(file), self.text)
        if method.name != name:
            raise MethodFileError(
                "{}: name: {!r}, and the file is called {!r}", file, method.name, name
            )
        return method

    def text(self, name: str) -> str:
        """Return the TOML text of a method.

        Raises:
            MissingKnowledgeError: there is no such method.
        """
        if name in list_shipped_methods():
            return read_shipped_text(name)
        if name not in self.own:
            raise MissingKnowledgeError(
                "there is no method {!r}; the methods are {}", name, ", ".join(self.names)
            )
        return read_method_file(self.folder / f"{name}{SUFFIX}")

    def find(self, name_or_file: str) -> Method:
        """Read a method by its name, or from a file anywhere.

        Raises:
            HerijkError: there is no such method or file, or it has an error.
        """
        file = Path(name_or_file)
        if file.suffix != SUFFIX:
            if file.suffix and file.is_file():
                raise MissingKnowledgeError(
                    "{} is no method file: the name of one ends in {}", file, SUFFIX
                )
            return self.get(name_or_file)
        return parse_method(read_method_file(file), str(file), self.text)

    def keep(self, name_or_file: str) -> str:
        """Return the name under which a method is known; a file is first copied into the folder.

        Raises:
            HerijkError: it has an error, or the name of a method that ships.
        """
        method = self.find(name_or_file)
        if method.name == name_or_file:
            return method.name
        if method.name in list_shipped_methods():
            raise MethodFileError(
                "{}: name: {!r} is a method that ships; choose another name",
                name_or_file,
                method.name,
            )
        with write_beside(self.folder / f"{method.name}{SUFFIX}") as beside:
            beside.write_text(read_method_file(Path(name_or_file)), encoding="utf-8")
        return method.name


def methods_to_apply(store: Store, listed: Sequence[str], asked: Sequence[str] = ()) -> list[str]:
    """Return the names of the methods to apply; the others are compared with the first.

    A method that is asked for comes beside those of which the data folder holds tables. Those go
    with their file, or by a list that leaves them out.

    Args:
        store: the data folder.
        listed: what `beheer.toml` lists; nothing stands for all that ship beside those held.
        asked: methods asked for this time.
    """
    if listed and not asked:
        return list(listed)
    wanted = set(asked or list_shipped_methods())
    if store.read_fingerprint("methods") is not None:
        wanted.update(store.read("methods")["method"])
    in_order = dict.fromkeys(tuple(listed) + KnownMethods.from_store(store).names)
    return [name for name in in_order if name in wanted]


def read_method_file(file: Path) -> str:
    """Read the text of a method file.

    Raises:
        MissingKnowledgeError: it is not there.
        MethodFileError: it is not UTF-8.
    """
    if not file.is_file():
        raise MissingKnowledgeError("there is no method file {}", file)
    try:
        return decode_toml(file.read_bytes())
    except ValueError as error:
        raise MethodFileError("{}: {}", file, error) from error
