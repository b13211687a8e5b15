"""`herijk methods`: list, show, begin, check and compare methods."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from herijk.cli.arguments import AsJson, DataFolder, as_json_text, show, show_files
from herijk.cli.overview import Overview
from pipeline.errors import HerijkError
from pipeline.messages import LANGUAGE, say, tell

if TYPE_CHECKING:
    from pipeline.method.definition import Method
    from pipeline.method.variant import Difference
    from warehouse.queries.rebase import RebaseReport
    from warehouse.store.methods import KnownMethods

app = typer.Typer(
    cls=Overview,
    help="The methods: those that ship, and your own.",
    rich_markup_mode=None,
)
Named = Annotated[
    str, typer.Argument(metavar="METHOD_OR_FILE", help="A method's name, or a TOML file.")
]


@dataclass(frozen=True)
class MethodReport:
    """A method in words.

    Attributes:
        method, title: what it is called.
        content_hash: SHA-256 of what it says.
        extends: the method it extends.
        words: what it says, step by step.
    """

    method: str
    title: str
    content_hash: str
    extends: str | None
    words: str


def known_methods(data: Path) -> "KnownMethods":
    """The methods of a data folder."""
    from warehouse.store.methods import KnownMethods
    from warehouse.store.store import Store

    return KnownMethods.of(Store(data))


@app.callback(invoke_without_command=True)
def methods(
    context: typer.Context, data: DataFolder = Path("data"), as_json: AsJson = False
) -> None:
    """List the methods: those that ship, and those in the folder `methods` of --data."""
    from herijk.cli import text

    if context.invoked_subcommand is None:
        known = known_methods(data)
        rows = [
            {
                "method": method.name,
                "title": method.titled(LANGUAGE.get()),
                "content_hash": method.content_hash,
                "ships": name not in known.own,
            }
            for name in known.names
            for method in [known.get(name)]
        ]
        show({"methods": rows}, text.methods, as_json)


@app.command("show")
def show_method(name: Named, data: DataFolder = Path("data"), as_json: AsJson = False) -> None:
    """One method in words, with what differs from the one it extends."""
    known = known_methods(data)
    show(_one(known.named(name), known), lambda report: report.words, as_json)


@app.command()
def check(file: Named, data: DataFolder = Path("data"), as_json: AsJson = False) -> None:
    """Read a method file and say in words what it does; an error is told with its line."""
    known = known_methods(data)
    sound = tell("The file is sound. Try it: herijk rebase {}", file)
    show(_one(known.named(file), known), lambda report: f"{report.words}\n\n{sound}", as_json)


@app.command()
def new(
    name: Annotated[str, typer.Argument(help="Name of the new method, for example ours-2027.")],
    base: Annotated[
        str, typer.Option("--from", metavar="METHOD", help="Method that it begins from.")
    ] = "rebased",
    data: DataFolder = Path("data"),
    as_json: AsJson = False,
) -> None:
    """Begin a method file NAME.toml here, which extends another; every option is listed in it."""
    from pipeline.method.writing import beginning_text
    from warehouse.store.files import write_new

    known = known_methods(data)
    file = Path(f"{name}.toml")
    if name in known.names:
        raise HerijkError("{} is the name of another method; choose another", name)
    text = beginning_text(name, known.get(base))
    try:
        write_new(file, text)
    except FileExistsError as error:
        raise HerijkError("{} is there already; choose another name", file) from error
    said = tell("{} extends {}. Change it, then: herijk methods check {}", file, base, file)
    show_files([file], as_json, said)


@app.command()
def diff(
    old: Named,
    new: Annotated[
        str, typer.Argument(metavar="METHOD_OR_FILE", help="The method it is compared with.")
    ],
    data: DataFolder = Path("data"),
    as_json: AsJson = False,
) -> None:
    """Which options differ between two methods, and what that does to Cw where --data has tows."""
    from pipeline.method.variant import differences
    from warehouse.store.store import Store

    known = known_methods(data)
    first, second = known.named(old), known.named(new)
    options, effect = differences(second, first), None
    store = Store(data)
    if store.database.exists():
        from warehouse.queries.rebase import rebase

        effect = rebase(store, second, first)
    if as_json:
        report = {"from": first.name, "to": second.name, "options": options}
        typer.echo(as_json_text(report if effect is None else report | {"effect": effect}))
    else:
        typer.echo(_diff_text(first.name, second.name, options, effect))


def _one(method: "Method", known: "KnownMethods") -> MethodReport:
    from herijk.cli.method_text import method_in_words

    parent = None if method.extends is None else known.get(method.extends)
    return MethodReport(
        method=method.name,
        title=method.titled(LANGUAGE.get()),
        content_hash=method.content_hash,
        extends=method.extends,
        words=method_in_words(method, parent),
    )


def _diff_text(
    first: str, second: str, options: "Sequence[Difference]", effect: "RebaseReport | None"
) -> str:
    """Options that differ, one per line, as a method's file has them, and the effect per season."""
    from herijk.cli import text
    from pipeline.method.writing import range_text

    if not options:
        return tell("{} and {} say the same of every season.", first, second)
    rows = [
        (
            f"{one.step}.{one.option}",
            range_text(one.first, one.last),
            ", ".join(map(json.dumps, one.before)),
            json.dumps(one.after),
        )
        for one in options
    ]
    parts = [text.table((say("option"), say("seasons"), first, second), rows)]
    if effect is not None:
        parts.append(text.rebase(effect))
    return "\n\n".join(parts)
