"""Arguments that several commands share, and how a result is shown."""

import datetime as dt
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
    typer.echo(as_json_text(report) if as_json else as_text(report))


def as_json_text(report: object) -> str:
    """A result for a program."""
    return json.dumps(report, default=_plain, indent=1)


def show_files(files: Iterable[Path], as_json: bool, said: str | None = None) -> None:
    """Says which files were written: their names, or a sentence about them."""
    names = [str(file) for file in files]
    show({"files": names}, lambda _: said or "\n".join(names), as_json)


def _plain(value: object) -> object:
    """What JSON has no form for: a dataclass as its fields, anything else as text."""
    return asdict(value) if is_dataclass(value) and not isinstance(value, type) else str(value)


def read_day(value: str) -> dt.date:
    """Returns a day that was written as 2026-05-08."""
    try:
        return dt.date.fromisoformat(value)
    except ValueError as error:
        raise typer.BadParameter("write a day as 2026-05-08") from error


AsOf = Annotated[
    dt.date | None,
    typer.Option(
        "--as-of",
        parser=read_day,
        metavar="DATE",
        help="Judge on this day, as if nothing later were known; without: on the day of the "
        "archive's last tow or race.",
    ),
]
