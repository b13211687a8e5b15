"""Arguments that several commands share, and how a result is shown."""

import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Annotated, Any

import typer

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


def show(report: dict[str, Any], as_text: Callable[[dict[str, Any]], str], as_json: bool) -> None:
    """Prints a result for a person, or for a program."""
    typer.echo(json.dumps(report, default=str, indent=1) if as_json else as_text(report))


def show_files(files: Iterable[Path], as_json: bool, said: str | None = None) -> None:
    """Says which files were written: their names, or a sentence about them."""
    names = [str(file) for file in files]
    show({"files": names}, lambda _: said or "\n".join(names), as_json)
