"""Options that several commands share, and how a result is printed."""

import datetime as dt
import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

import click

from herijk.cli.speaking import flag, option
from pipeline.messages import LANGUAGE, tell

if TYPE_CHECKING:
    from dashboards.queries.results import Results
    from warehouse.store.store import Store

F = TypeVar("F", bound=Callable[..., Any])

PATH: Final = click.Path(path_type=Path)
AS_JSON, WIDE = "herijk.as_json", "herijk.wide"
"""Where click keeps that the result is for a program, and that tables may be wide."""


def folder_option(name: str, *parameter: str, **settings: Any) -> Callable[[F], F]:
    """Return the option of a folder, which may also be in the environment."""
    envvar = f"HERIJK_{name.upper()}"
    return option(f"--{name}", *parameter, type=PATH, envvar=envvar, show_envvar=True, **settings)


def _store(_: click.Context, __: click.Parameter, folder: Path) -> "Store":
    from warehouse.store.store import Store

    return Store(folder)


def _keep_as_json(context: click.Context, _: click.Parameter, wanted: bool) -> None:
    context.meta[AS_JSON] = wanted or wants_json()


archive_option = folder_option("archive", required=True, help="The archive folder.")
data_option = folder_option(
    "data", "store", default="data", callback=_store, help="Folder with everything Herijk writes."
)


def _keep_wide(context: click.Context, _: click.Parameter, wanted: bool) -> None:
    context.meta[WIDE] = wanted


json_option = flag(
    "--json", expose_value=False, callback=_keep_as_json, help="Print the result as JSON."
)
wide_option = flag(
    "--wide",
    expose_value=False,
    callback=_keep_wide,
    help="Show all columns of tables, however wide the terminal is.",
)


def form_options(command: F) -> F:
    """Add how the result of a command is printed: `--json` and `--wide`."""
    return json_option(wide_option(command))


class Day(click.ParamType[dt.date]):
    """A day, written as 2026-05-08."""

    name = "date"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> dt.date:
        """Return the day."""
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
        """Return the seasons, both ends included."""
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


def wants_json() -> bool:
    """Whether the result is for a program."""
    return bool(click.get_current_context().meta.get(AS_JSON))


def show(
    template: str,
    data: Mapping[str, Any],
    fields: Sequence[str],
    *,
    chosen: Mapping[str, str] | None = None,
    folded: bool = False,
    about: Mapping[str, str] | None = None,
) -> None:
    """Print a document: as text for a person, or its data and statements as JSON for a program.

    Args:
        template: its name.
        data: what its query found.
        fields: names of `data` that JSON has (docs/json.md).
        chosen: what selectors of the page say; rows of other choices are left out.
        folded: whether to show what is folded on a page.
        about: facts about the database.
    """
    from dashboards.document import Document
    from dashboards.language import Language

    choices = dict(chosen or {})
    shown = {name: _choose_rows(value, choices) for name, value in data.items()}
    document = Document(Language(LANGUAGE.get(), about), "", choices, pictures=False)
    frame = dict.fromkeys(("path", "site_root", "other", "other_page", "code_version"), "")
    html = document.render(template, **{"simulated": False, "has_reports": False, **frame, **shown})
    if wants_json():
        click.echo(_to_json({name: shown[name] for name in fields}, html))
    else:
        from dashboards.terminal import UNLIMITED_WIDTH, to_text

        is_wide = bool(click.get_current_context().meta.get(WIDE))
        width = UNLIMITED_WIDTH if is_wide else None
        is_coloured = "NO_COLOR" not in os.environ  # and in a terminal: Click sees to that
        click.echo(to_text(html, folded=folded, width=width, coloured=is_coloured))


def _choose_rows(value: Any, chosen: Mapping[str, str]) -> Any:
    """Return a frame without rows of other choices; any other value as it is."""
    import polars as pl

    if not isinstance(value, pl.DataFrame):
        return value
    for name, choice in chosen.items():
        if choice and name in value.columns:
            value = value.filter(pl.col(name).cast(pl.String) == choice)
    return value


def _to_json(data: Mapping[str, Any], html: str) -> str:
    """Return the data of a document, frames as rows, and its statements, as JSON."""
    from pydantic_core import to_json

    from dashboards.reading import read_blocks

    statements = []
    for block in read_blocks(html, folded=True):
        if block.said:
            kind, _, verdict = block.said.partition(" ")
            statements.append(
                {"about": block.about, "kind": kind, "verdict": verdict, "text": block.text}
            )
    result = dict(data) | {"statements": statements}
    return to_json(result, indent=1, fallback=_to_plain).decode()


def _to_plain(value: Any) -> Any:
    """Return a frame as rows, and anything else that JSON does not know as text."""
    return value.to_dicts() if hasattr(value, "to_dicts") else str(value)


def show_results(
    store: "Store",
    template: str,
    query: "Callable[[Results], Mapping[str, Any]]",
    fields: Sequence[str],
    *,
    as_of: dt.date | None = None,
    follows: Sequence[str] | None = None,
    folded: bool = False,
) -> None:
    """Print what a page of the site shows; see `show`.

    Args:
        store: the data folder.
        template: the name of the template.
        query: gives what it shows from the tables.
        fields: names in what `query` gives that JSON has.
        as_of: the day on which lines are judged.
        follows: the selectors of the page whose first choice is shown; all when left out.
        folded: whether to show what is folded on a page.
    """
    from dashboards.queries.results import Results
    from warehouse.queries.views import Views

    with Views(store, as_of) as views:
        data = dict(query(Results(views)))
        edition = data.get("edition")
        about = views.about()
        about_archive = about.get("simulated") == "true"
        simulated = views.simulated(edition) if edition else about_archive
        chosen = data.get("chosen", {})
        choices = {name: chosen[name] for name in (chosen if follows is None else follows)}
        shown = {"simulated": simulated} | data
        show(template, shown, fields, chosen=choices, folded=folded, about=about)


def show_files(files: Iterable[Path], said: str | None = None) -> None:
    """Print which files were written: their names, or a sentence about them."""
    show("files", {"files": list(map(str, files)), "said": said}, ("files",))
