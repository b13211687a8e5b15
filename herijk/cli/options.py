"""Options that several commands share, and how a result is printed."""

import datetime as dt
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeAlias, TypeVar

import click

from herijk.cli.speaking import flag, option
from pipeline.messages import LANGUAGE, tell

if TYPE_CHECKING:
    from dashboards.statements import Statement

Told: TypeAlias = "Mapping[str, Sequence[Statement]]"
"""The statements about each thing."""
F = TypeVar("F", bound=Callable[..., Any])
R = TypeVar("R")

PATH: Final = click.Path(path_type=Path)


def folder_option(name: str, **settings: Any) -> Callable[[F], F]:
    """The option of a folder, which may also be in the environment."""
    envvar = f"HERIJK_{name.upper()}"
    return option(f"--{name}", type=PATH, envvar=envvar, show_envvar=True, **settings)


archive_option = folder_option("archive", required=True, help="The archive folder.")
data_option = folder_option("data", default="data", help="Folder with everything Herijk writes.")
json_option = flag("--json", "as_json", help="Print the result as JSON.")


class Day(click.ParamType[dt.date]):
    """A day, written as 2026-05-08."""

    name = "date"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> dt.date:
        """The day."""
        try:
            return dt.date.fromisoformat(value)
        except ValueError:
            self.fail(tell("write a day as 2026-05-08"), param, ctx)


class Seasons(click.ParamType[range]):
    """A season, written as 2014, or a range of them, 2009:2018."""

    name = "a:b"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> range:
        """The seasons, both ends included."""
        match = re.fullmatch(r"(\d{4})(?::(\d{4}))?", value)
        if match is None or int(match[2] or match[1]) < int(match[1]):
            self.fail(tell("write a season, 2014, or a range, 2009:2018"), param, ctx)
        return range(int(match[1]), int(match[2] or match[1]) + 1)


as_of_option = option(
    "--as-of",
    type=Day(),
    help="Judge on this day, ignoring everything later. Default: the day of the archive's last "
    "tow or race.",
)


def show(
    report: R, as_text: Callable[[R], str], as_json: bool, said: "Callable[[R], Told] | None" = None
) -> None:
    """Prints a result for a person, or for a program with what is said of it."""
    click.echo(as_json_text(report, said and said(report)) if as_json else as_text(report))


def as_json_text(report: object, said: "Told | None" = None) -> str:
    """A result for a program, with the statements about it."""
    from pydantic_core import to_json

    if said is not None:
        from dashboards.speech import Speech

        speech = Speech(LANGUAGE.get())
        told = [one.said(speech, about) for about, of in said.items() for one in of]
        report = vars(report) | {"statements": told}
    return to_json(report, indent=1, fallback=str).decode()


def show_files(files: Iterable[Path], as_json: bool, said: str | None = None) -> None:
    """Says which files were written: their names, or a sentence about them."""
    names = [str(file) for file in files]
    show({"files": names}, lambda _: said or "\n".join(names), as_json)
