"""Arguments that several commands share, and how a result is shown."""

import datetime as dt
import json
from collections.abc import Callable
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


def read_day(value: str | dt.date) -> dt.date:
    """Returns a day that was written as 2026-05-08."""
    if isinstance(value, dt.date):
        return value
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
        help="Judge on this day, as if nothing of later were known; without: on the day of the "
        "archive's last tow.",
    ),
]
