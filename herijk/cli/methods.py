"""`herijk methods`: list, show, begin and check methods; and `herijk compare`."""

import datetime as dt
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from herijk.cli.options import as_of_option, data_option, form_options, show, show_files
from herijk.cli.speaking import Command, Group, argument, option
from pipeline.errors import HerijkError
from pipeline.messages import LANGUAGE, tell

if TYPE_CHECKING:
    from warehouse.store.store import Store

method_argument = argument(
    "name", metavar="METHOD_OR_FILE", help="A method's name, or a TOML file."
)


METHOD_FIELDS: Final = ("method", "title", "description", "content_hash", "extends", "options")
"""What JSON has of a method."""


@click.group(cls=Group, invoke_without_command=True, examples=("herijk methods",))
@data_option
@form_options
@click.pass_context
def methods(context: click.Context, store: "Store") -> None:
    """List the methods: those that ship, and your own."""
    if context.invoked_subcommand is not None:
        return
    from warehouse.store.methods import KnownMethods

    known = KnownMethods.from_store(store)
    rows = [
        {
            "method": method.name,
            "title": method.get_title(LANGUAGE.get()),
            "content_hash": method.content_hash,
            "ships": method.name not in known.own,
        }
        for method in map(known.get, known.names)
    ]
    show("methods", {"methods": rows}, ("methods",))


@methods.command("show", examples=("herijk methods show rebased",))
@method_argument
@data_option
@form_options
def show_method(name: str, store: "Store") -> None:
    """Show what a method changes of the one it extends; all options where it extends none."""
    show("method_file", _describe(store, name) | {"checked": ""}, METHOD_FIELDS)


@methods.command(examples=("herijk methods check ours-2027.toml",))
@method_argument
@data_option
@form_options
def check(name: str, store: "Store") -> None:
    """Read a method file and say what it does; an error is named with its line."""
    show("method_file", _describe(store, name) | {"checked": name}, METHOD_FIELDS)


def _describe(store: "Store", name_or_file: str) -> dict[str, Any]:
    from dashboards.queries.methods import describe_method
    from warehouse.store.methods import KnownMethods

    return describe_method(KnownMethods.from_store(store), name_or_file, LANGUAGE.get())


@methods.command(examples=("herijk methods new ours-2027 --from rebased",))
@argument("name", help="Name of the new method, for example ours-2027.")
@option("--from", "base", default="rebased", help="Method that it begins from.")
@data_option
@form_options
def new(name: str, base: str, store: "Store") -> None:
    """Begin a method file NAME.toml here, which extends another; every option is listed in it."""
    from pipeline.method.writing import write_new_method_text
    from warehouse.store.files import write_new
    from warehouse.store.methods import KnownMethods

    known = KnownMethods.from_store(store)
    file = Path(f"{name}.toml")
    if name in known.names:
        raise HerijkError("{} is the name of another method; choose another", name)
    text = write_new_method_text(name, known.get(base))
    try:
        write_new(file, text)
    except FileExistsError as error:
        raise HerijkError("{} is there already; choose another name", file) from error
    said = tell("{} extends {}. Change it, then: herijk methods check {}", file, base, file)
    show_files([file], said)


@click.command(
    cls=Command,
    examples=(
        "herijk compare as-published rebased",
        "herijk compare 2018-1 concept-rebased",
        "herijk compare rebased our-method.toml",
    ),
)
@argument("old", help="An edition or draft, or a method by its name or file.")
@argument("new", help="What it is compared with, of the same kinds.")
@data_option
@option(
    "--fatigue",
    type=click.Choice(["none", "known", "extend"]),
    default="extend",
    help="Fatigue correction of races between editions: none, known (2 to 3 h only) or extend.",
)
@as_of_option
@form_options
def compare(old: str, new: str, store: "Store", fatigue: str, as_of: dt.date | None) -> None:
    """Compare two editions or methods: who gains, who loses, and why.

    Published editions are compared as they are, with races. For a draft, a method or a method file
    all tows are recomputed under both methods; nothing is published or stored.
    """
    from typing import cast

    from dashboards.queries.comparison import compare as compare_editions
    from pipeline.register.replay import Fatigue, RaceRules

    rules = RaceRules(fatigue=cast(Fatigue, fatigue))
    data = compare_editions(store, old, new, rules, as_of)
    show("compare", data, ("old", "new", "options", "effect"))
