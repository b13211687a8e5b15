"""The commands about registers: `register`, `seasons`, `publish` and `verify`."""

import datetime as dt
from typing import TYPE_CHECKING

import click

from herijk.cli.options import (
    Day,
    as_of_option,
    data_option,
    form_options,
    show,
    show_results,
)
from herijk.cli.speaking import Command, argument, flag, option
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import tell

if TYPE_CHECKING:
    from warehouse.store.store import Store


@click.command(
    cls=Command,
    examples=(
        "herijk register",
        "herijk register 2026-1 --as-of 2026-06-01",
        "herijk register --due",
        "herijk register concept-rebased --years",
    ),
)
@argument("edition", required=False, help="Edition or draft. Default: the newest.")
@flag(
    "--due",
    help="When each tow expires, and at what speed to tow next, by the curves of the edition's "
    "method.",
)
@flag(
    "--years",
    help="The register of every past year, as published and as the edition's method would have "
    "had it.",
)
@data_option
@as_of_option
@form_options
def register(
    edition: str | None, due: bool, years: bool, store: "Store", as_of: dt.date | None
) -> None:
    """Show the register: every line with its sizes, and whether it is valid on a day."""
    from dashboards.queries import pages

    if years:
        method = _choose_method(store, edition)
        show_results(
            store,
            "register_years",
            lambda results: pages.read_years(results, method),
            ("method", "simulated", "years", "causes", "lines", "winners"),
            follows=("method",),
        )
    elif due:
        method = _choose_method(store, edition)
        show_results(
            store,
            "due_list",
            lambda results: pages.read_due_list(results, method),
            ("method", "simulated", "as_of", "lines"),
            as_of=as_of,
        )
    else:
        show_results(
            store,
            "register_list",
            lambda results: pages.read_register(results, edition),
            ("edition", "simulated", "as_of", "lines"),
            as_of=as_of,
        )


def _choose_method(store: "Store", edition: str | None) -> str | None:
    """Return the method of an edition or draft; None where none is named."""
    if edition is None:
        return None
    from pipeline.register.register import name_draft
    from warehouse.store.editions import list_edition_names, read_edition_method
    from warehouse.store.methods import KnownMethods

    if edition in list_edition_names(store):
        return read_edition_method(store, edition).name
    return KnownMethods.from_store(store).get(edition.removeprefix(name_draft(""))).name


@click.command(
    cls=Command,
    examples=(
        "herijk seasons",
        "herijk seasons --method rebased-2015",
    ),
)
@data_option
@option("--method", help="Method whose factors are shown. Default: the best that was applied.")
@form_options
def seasons(store: "Store", method: str | None) -> None:
    """Show what was wrong with log, force and wind in each season, and how sure that is."""
    from dashboards.queries import pages
    from warehouse.store.methods import KnownMethods

    if method is not None:
        KnownMethods.from_store(store).text(method)
    fields = ("method", "simulated", "factors", "parts", "diagnosis", "unseen")
    show_results(store, "season_list", lambda results: pages.read_seasons(results, method), fields)


@click.command(
    cls=Command,
    examples=(
        'herijk publish 2026-1 --valid-from 2026-05-08 --decision "ALV 8 mei" --method rebased',
    ),
)
@argument("edition", help="Name of the new edition, for example 2026-1.")
@option("--valid-from", type=Day(), required=True, help="Day from which it counts: 2026-05-08.")
@option("--decision", required=True, help="Who decided it, and where.")
@option("--method", help="Method that the last rebuild applied.")
@option("--printed", type=int, help="Instead of a method: the register printed that year.")
@option("--carry", help="Printed edition whose lines are re-based for boats without measurements.")
@option("--published-on", type=Day(), help="Day of publication. Default: today.")
@data_option
@form_options
def publish(
    edition: str,
    valid_from: dt.date,
    decision: str,
    method: str | None,
    printed: int | None,
    carry: str | None,
    published_on: dt.date | None,
    store: "Store",
) -> None:
    """Freeze an edition of the register: it is never changed afterwards."""
    from warehouse.editions import publish as editions
    from warehouse.store.methods import KnownMethods

    if (method is None) == (printed is None):
        raise click.UsageError(tell("give --method NAME, or --printed YEAR, and not both"))
    if printed is not None and carry is not None:
        raise click.UsageError(tell("--carry goes with --method"))
    terms = editions.Terms(edition, valid_from, decision, published_on or dt.date.today())
    if printed is not None:
        folder = editions.publish_printed(store, printed, terms)
    else:
        chosen = KnownMethods.from_store(store).get(str(method))
        folder = editions.publish(store, chosen, terms, carry)
    made = editions.summarize_published(store, folder)
    data = vars(made) | {"simulated": made.manifest.simulated}
    show("published", data, tuple(vars(made)))


@click.command(
    cls=Command,
    examples=("herijk verify",),
)
@data_option
@option("--head", help="The seal of the last edition, from the minutes.")
@form_options
def verify(store: "Store", head: str | None) -> None:
    """Check that editions and archive are what they were, and make the editions again."""
    from warehouse.editions.verify import verify as verify_editions
    from warehouse.store.editions import list_edition_names

    if not list_edition_names(store) and not store.database.exists():
        raise MissingKnowledgeError(
            "{} holds no editions and no tables; is it the right data folder?", store.root
        )
    report = verify_editions(store, head=head)
    show("verify", vars(report), tuple(vars(report)))
    if report.wrong:
        raise click.exceptions.Exit(1)
