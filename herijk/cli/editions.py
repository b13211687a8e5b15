"""The commands about editions, and about who has to tow before the next one.

What they do is in `warehouse.editions` and `warehouse.queries.due`; how a result looks as text,
in `cli.editions_text` and `cli.due_text`.
"""

import datetime as dt
from pathlib import Path
from typing import Annotated, Literal

import typer

from herijk.cli.arguments import AsJson, AsOf, DataFolder, as_json_text, read_day, show
from herijk.cli.methods import known_methods


def add_to(app: typer.Typer) -> None:
    """Adds these commands to the command line."""
    for command in (register, publish, diff, verify, lineage, due):
        app.command()(command)


def register(
    edition: Annotated[
        str | None, typer.Argument(metavar="[EDITION]", help="Edition; the newest when left out.")
    ] = None,
    data: DataFolder = Path("data"),
    as_of: AsOf = None,
    as_json: AsJson = False,
) -> None:
    """The register: every line with its sizes, and whether it is valid on a day."""
    from herijk.cli import editions_text as text
    from warehouse.queries.register import register_report
    from warehouse.store.store import Store

    show(register_report(Store(data), edition, as_of), text.register, as_json)


def publish(
    edition: Annotated[
        str, typer.Argument(metavar="EDITION", help="Name of the new edition, for example 2026-1.")
    ],
    valid_from: Annotated[
        dt.date,
        typer.Option(parser=read_day, metavar="DATE", help="Day from which it counts: 2026-05-08."),
    ],
    decision: Annotated[str, typer.Option(help="Who decided it, and where.")],
    method: Annotated[
        str | None, typer.Option(metavar="NAME", help="Method that the last rebuild applied.")
    ] = None,
    printed: Annotated[
        int | None,
        typer.Option(metavar="YEAR", help="Instead of a method: the register printed that year."),
    ] = None,
    carry: Annotated[
        str | None,
        typer.Option(
            metavar="EDITION",
            help="Printed edition whose lines are re-based for boats without measurements.",
        ),
    ] = None,
    published_on: Annotated[
        dt.date | None,
        typer.Option(parser=read_day, metavar="DATE", help="Day of publication; else today."),
    ] = None,
    data: DataFolder = Path("data"),
    as_json: AsJson = False,
) -> None:
    """Freeze an edition of the register: it is never changed afterwards."""
    from herijk.cli import editions_text as text
    from warehouse.editions.publish import Terms, publish_printed, published
    from warehouse.editions.publish import publish as publish_edition
    from warehouse.store.store import Store

    if (method is None) == (printed is None):
        raise typer.BadParameter("give --method NAME, or --printed YEAR, and not both")
    if printed is not None and carry is not None:
        raise typer.BadParameter("--carry goes with --method")
    terms = Terms(edition, valid_from, decision, published_on or dt.date.today())
    store = Store(data)
    if printed is not None:
        folder = publish_printed(store, printed, terms)
    else:
        folder = publish_edition(store, known_methods(data).get(str(method)), terms, carry)
    made = published(store, folder)
    if as_json:
        rest = {name: value for name, value in vars(made).items() if name != "manifest"}
        typer.echo(as_json_text(made.manifest.model_dump(mode="json") | rest))
    else:
        typer.echo(text.published(made))


def diff(
    old: Annotated[str, typer.Argument(metavar="EDITION", help="The old edition.")],
    new: Annotated[str, typer.Argument(metavar="EDITION", help="The new edition.")],
    data: DataFolder = Path("data"),
    fatigue: Annotated[
        Literal["none", "known", "extend"],
        typer.Option(help="Fatigue correction of races: none, known (2 to 3 h only) or extend."),
    ] = "extend",
    as_json: AsJson = False,
) -> None:
    """Two editions side by side: who gains, who loses, why, and what it does to races."""
    from herijk.cli import editions_text as text
    from pipeline.register.replay import RaceRules
    from warehouse.editions import compare
    from warehouse.store.store import Store

    store = Store(data)
    comparison = compare.diff(store, old, new)
    report = compare.report_with_races(store, comparison, RaceRules(fatigue=fatigue))
    show(report, text.diff, as_json)


def verify(
    data: DataFolder = Path("data"),
    head: Annotated[
        str | None,
        typer.Option(metavar="HASH", help="The seal of the last edition, from the minutes."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Check that editions and archive are what they were, and make the editions again."""
    from herijk.cli import editions_text as text
    from pipeline.errors import MissingKnowledgeError
    from warehouse.editions.verify import verify as verify_editions
    from warehouse.store.editions import edition_names
    from warehouse.store.store import Store

    store = Store(data)
    if not edition_names(store) and not store.database.exists():
        raise MissingKnowledgeError(
            "{} holds no editions and no tables; is it the right data folder?",
            data,
        )
    report = verify_editions(store, head=head)
    show(report, text.verify, as_json)
    if report.wrong:
        raise typer.Exit(1)


def lineage(
    edition: Annotated[str, typer.Argument(metavar="EDITION", help="Name of an edition.")],
    boat: Annotated[str, typer.Argument(metavar="BOAT", help="By number or name.")],
    data: DataFolder = Path("data"),
    as_json: AsJson = False,
) -> None:
    """From a printed line to the files, runs and seconds behind it."""
    from herijk.cli import editions_text as text
    from warehouse.editions.lineage import lineage as find_lineage
    from warehouse.store.store import Store

    show(find_lineage(Store(data), edition, boat), text.lineage, as_json)


def due(
    data: DataFolder = Path("data"),
    method: Annotated[
        str, typer.Option(metavar="NAME", help="Method whose curves give the speeds.")
    ] = "rebased",
    as_of: AsOf = None,
    as_json: AsJson = False,
) -> None:
    """Whose tow expires when, at what speed to tow each next, and which boats to tow again."""
    from herijk.cli import due_text
    from warehouse.queries.due import due_report
    from warehouse.store.store import Store

    known_methods(data).text(method)
    show(due_report(Store(data), method, as_of), due_text.due, as_json)
