"""Options that several commands share, and how a result is printed."""

import datetime as dt
import re
from collections.abc import Callable, Iterable
from dataclasses import is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

import click

from herijk.cli.speaking import flag, option
from pipeline.messages import tell

if TYPE_CHECKING:
    from herijk.cli.render import Part
    from warehouse.store.store import Store

F = TypeVar("F", bound=Callable[..., Any])
R = TypeVar("R")

PATH: Final = click.Path(path_type=Path)
AS_JSON: Final = "herijk.as_json"
"""Where click keeps that the result is for a program."""


def folder_option(name: str, *parameter: str, **settings: Any) -> Callable[[F], F]:
    """The option of a folder, which may also be in the environment."""
    envvar = f"HERIJK_{name.upper()}"
    return option(f"--{name}", *parameter, type=PATH, envvar=envvar, show_envvar=True, **settings)


def _store(_: click.Context, __: click.Parameter, folder: Path) -> "Store":
    from warehouse.store.store import Store

    return Store(folder)


def _keep_as_json(context: click.Context, _: click.Parameter, wanted: bool) -> None:
    context.meta[AS_JSON] = wanted or as_json()


archive_option = folder_option("archive", required=True, help="The archive folder.")
data_option = folder_option(
    "data", "store", default="data", callback=_store, help="Folder with everything Herijk writes."
)
json_option = flag(
    "--json", expose_value=False, callback=_keep_as_json, help="Print the result as JSON."
)


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


def as_json() -> bool:
    """Whether the result is for a program."""
    return bool(click.get_current_context().meta.get(AS_JSON))


def show(report: R, as_page: "Callable[[R], Iterable[Part]]") -> None:
    """Prints a result: as a page for a person, or as JSON with its statements for a program."""
    if not as_json():
        from herijk.cli.render import page

        click.echo(page(as_page(report)))
        return
    from pydantic_core import to_json

    result: object = report
    if is_dataclass(report):
        from herijk.cli.render import statements

        result = vars(report) | {"statements": statements(as_page(report))}
    click.echo(to_json(result, indent=1, fallback=str).decode())


def show_files(files: Iterable[Path], said: str | None = None) -> None:
    """Says which files were written: their names, or a sentence about them."""
    names = [str(file) for file in files]
    show({"files": names}, lambda _: [said or "\n".join(names)])
