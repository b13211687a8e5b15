"""Options that several commands share, and how a result is printed."""

import datetime as dt
import json
import re
from collections.abc import Callable, Iterable
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import Any, Final, TypeVar

import click

from herijk.cli.speaking import Option, flag, option
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import tell
from pipeline.toml_text import decoded, parse_toml

F = TypeVar("F", bound=Callable[..., Any])
R = TypeVar("R")

FOLDERS_FILE: Final = "herijk.toml"
FOLDERS: Final = ("archive", "data")
PATH: Final = click.Path(path_type=Path)


def folders_here(start: Path) -> dict[str, str]:
    """The folders that the nearest `herijk.toml` names, as paths; none where there is no such file.

    Args:
        start: the folder in which the search upwards begins.

    Raises:
        MissingKnowledgeError: the file cannot be understood.
    """
    for folder in (start, *start.parents):
        file = folder / FOLDERS_FILE
        if file.is_file():
            return {key: str(folder / value) for key, value in _read(file).items()}
    return {}


def _read(file: Path) -> dict[str, Any]:
    try:
        settings = parse_toml(decoded(file.read_bytes()))
    except (ValueError, OSError) as error:
        raise MissingKnowledgeError("{} cannot be read: {}", file, error) from error
    wrong = [k for k, value in settings.items() if k not in FOLDERS or not isinstance(value, str)]
    if wrong:
        raise MissingKnowledgeError(
            '{}: {!r}: it may hold archive = "folder" and data = "folder"', file, wrong[0]
        )
    return settings


class FolderOption(Option):
    """The option of a folder, which `herijk.toml` may name."""

    def get_default(self, ctx: click.Context, call: bool = True) -> Any:
        """What `herijk.toml` says, or else the default; that alone is shown in the help."""
        named = folders_here(Path.cwd()) if call else {}
        return named.get(str(self.name)) or super().get_default(ctx, call)


def folder_option(name: str, **settings: Any) -> Callable[[F], F]:
    """The option of a folder, which may also be in the environment or in `herijk.toml`."""
    envvar = f"HERIJK_{name.upper()}"
    return option(
        f"--{name}",
        cls=FolderOption,
        type=PATH,
        envvar=envvar,
        show_envvar=True,
        **settings,
    )


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
    help="Judge on this day, as if nothing later were known; without: on the day of the "
    "archive's last tow or race.",
)


def show(report: R, as_text: Callable[[R], str], as_json: bool) -> None:
    """Prints a result for a person, or for a program."""
    click.echo(as_json_text(report) if as_json else as_text(report))


def as_json_text(report: object) -> str:
    """A result for a program."""
    return json.dumps(report, default=_plain, indent=1)


def show_files(files: Iterable[Path], as_json: bool, said: str | None = None) -> None:
    """Says which files were written: their names, or a sentence about them."""
    names = [str(file) for file in files]
    show({"files": names}, lambda _: said or "\n".join(names), as_json)


def _plain(value: object) -> object:
    """What JSON has no form for: a record as its fields, anything else as text."""
    if hasattr(value, "model_dump"):  # of pydantic, which few commands need
        return value.model_dump(mode="json")
    return asdict(value) if is_dataclass(value) and not isinstance(value, type) else str(value)
