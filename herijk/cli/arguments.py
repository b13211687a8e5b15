"""Arguments that several commands share, and how a result is shown."""

import json
from collections.abc import Callable, Iterable
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import Annotated, TypeVar

import typer

R = TypeVar("R")

ArchiveFolder = Annotated[
    Path,
    typer.Option("--archive", envvar="HERIJK_ARCHIVE", help="The archive folder.", metavar="DIR"),
]
DataFolder = Annotated[
    Path,
    typer.Option(
        "--data",
        envvar="HERIJK_DATA",
        help="Folder with everything Herijk writes.",
        metavar="DIR",
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]


def show(report: R, as_text: Callable[[R], str], as_json: bool) -> None:
    """Prints a result for a person, or for a program."""
    typer.echo(json.dumps(report, default=_plain, indent=1) if as_json else as_text(report))


def show_files(files: Iterable[Path], as_json: bool, said: str | None = None) -> None:
    """Says which files were written: their names, or a sentence about them."""
    names = [str(file) for file in files]
    show({"files": names}, lambda _: said or "\n".join(names), as_json)


def _plain(value: object) -> object:
    """What JSON has no form for: a dataclass as its fields, anything else as text."""
    return asdict(value) if is_dataclass(value) and not isinstance(value, type) else str(value)
