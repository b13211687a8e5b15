"""`herijk audit`: the answer about a boat or a type, and with --steps all that is behind it."""

import datetime as dt
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from herijk.cli.options import PATH, archive_option, as_json, data_option, json_option, show
from herijk.cli.speaking import Command, argument, flag, option
from pipeline.errors import HerijkError
from pipeline.messages import LANGUAGE, tell

if TYPE_CHECKING:
    from herijk.cli.render import Part
    from warehouse.queries.audit import BoatAudit, TypesAudit
    from warehouse.store.store import Store


@click.command(cls=Command)
@argument(
    "names",
    nargs=-1,
    required=True,
    metavar="BOAT|TYPE [TYPE]",
    help='A boat by number or name, FSN211 or "Razende Snol", or one or two types.',
)
@data_option
@option("--edition", help="Edition or draft that a boat's answer is about. Default: the newest.")
@flag("--steps", help="Also show the methods, tows, runs and statistics behind the answer.")
@option("--method", help="Show this method only.")
@option("--plots", type=PATH, help="Draw the plots in this folder.")
@json_option
def audit(
    names: tuple[str, ...],
    store: "Store",
    edition: str | None,
    steps: bool,
    method: str | None,
    plots: Path | None,
) -> None:
    """Where a boat's number comes from, or whether boats of a type are equal.

    With --edition also the files, runs and seconds behind a line of a published edition.
    """
    from herijk.cli import audit_text as text
    from warehouse.queries import audit as query
    from warehouse.store.editions import edition_names
    from warehouse.store.methods import KnownMethods

    if len(names) > 2:
        raise click.UsageError(tell("give a boat, or one or two types; quote a name with blanks"))
    behind = None
    if edition in edition_names(store):
        from warehouse.editions.lineage import lineage

        behind = lineage(store, str(edition), names[0])
    if behind and (as_json() or not store.database.exists()):  # an edition says this by itself
        show(behind, text.lineage)
        return
    if method is not None:
        KnownMethods.of(store).text(method)
    report = query.audit(store, names, method)
    drawn = [] if plots is None else _plots(store, report, plots)

    def page(report: "BoatAudit | TypesAudit") -> "Iterator[Part]":
        if isinstance(report, query.BoatAudit):
            yield from text.boat(report, text.answers_of(store, report.boat, edition), steps)
        else:
            yield from text.types(report, steps)
        if behind:
            yield from text.lineage(behind)
        if drawn:
            yield tell("{} plots in {}", len(drawn), plots)

    show(report, page)


@click.command(cls=Command)
@argument("tow_id", metavar="TOW", help="Number of the tow in the list of the season.")
@archive_option
@data_option
@option("--method", help="Method. Default: that of the newest edition, or rebased.")
@json_option
def assess(tow_id: str, archive: Path, store: "Store", method: str | None) -> None:
    """What a tow shows while the boat waits: provisional, and nothing is stored."""
    from herijk.cli import audit_text as text
    from pipeline.method.definition import COMPLETE
    from pipeline.register.register import STUDIED_METHOD
    from warehouse.editions.publish import latest_before
    from warehouse.queries import assess as tows
    from warehouse.store.editions import read_edition
    from warehouse.store.methods import KnownMethods

    today = dt.date.today()
    edition = None if method else latest_before(store, today, today)
    in_force = None if edition is None else read_edition(store, edition).method
    chosen = in_force or KnownMethods.of(store).get(method or STUDIED_METHOD)
    found = tows.assess(store, archive, tow_id, chosen)
    show(found, lambda report: text.assessment(report, chosen.interval == COMPLETE))


def _plots(store: "Store", report: "BoatAudit | TypesAudit", folder: Path) -> list[Path]:
    from dashboards.audit_plots import write_audit_plots

    try:
        return write_audit_plots(store, report, folder, LANGUAGE.get())
    except OSError as error:
        raise HerijkError(
            "no plots, for {} cannot be written ({}); give another folder with --plots",
            folder,
            error.strerror,
        ) from error
