"""`herijk audit`: the answer about a boat or a type, and with --steps all that is behind it."""

import datetime as dt
from pathlib import Path
from typing import TYPE_CHECKING

import click

from herijk.cli.options import PATH, archive_option, data_option, json_option, show
from herijk.cli.registers import BEST
from herijk.cli.speaking import Command, argument, flag, option
from pipeline.errors import HerijkError
from pipeline.messages import LANGUAGE, tell

if TYPE_CHECKING:
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
    data: Path,
    edition: str | None,
    steps: bool,
    method: str | None,
    plots: Path | None,
    as_json: bool,
) -> None:
    """Where a boat's number comes from, or whether boats of a type are equal.

    With --edition also the files, runs and seconds behind a line of a published edition.
    """
    from herijk.cli import audit_text
    from warehouse.queries.audit import BoatAudit
    from warehouse.queries.audit import audit as audit_report
    from warehouse.store.editions import edition_names
    from warehouse.store.methods import KnownMethods
    from warehouse.store.store import Store

    if len(names) > 2:
        raise click.UsageError(tell("give a boat, or one or two types; quote a name with blanks"))
    store = Store(data)
    behind = None
    if edition in edition_names(store):
        from warehouse.editions.lineage import lineage

        behind = lineage(store, str(edition), names[0])
        if as_json or not store.database.exists():  # an edition says this by itself
            show(behind, audit_text.lineage_text, as_json)
            return
    if method is not None:
        KnownMethods.of(store).text(method)
    report = audit_report(store, names, method)
    drawn = [] if plots is None else _plots(store, report, plots)
    if isinstance(report, BoatAudit):
        answers = audit_text.answers_of(store, report.boat, edition)
        show(
            report,
            lambda report: audit_text.boat_text(report, answers, steps),
            as_json,
            lambda _: audit_text.said_of_boat(answers),
        )
    else:
        text, said = audit_text.types_text, audit_text.said_of_types
        show(report, lambda report: text(report, steps), as_json, said)
    if as_json:
        return
    if behind:
        click.echo("\n" + audit_text.lineage_text(behind))
    if drawn:
        click.echo("\n" + tell("{} plots in {}", len(drawn), plots))


@click.command(cls=Command)
@argument("tow_id", metavar="TOW", help="Number of the tow in the list of the season.")
@archive_option
@data_option
@option("--method", help="Method. Default: that of the newest edition, or rebased.")
@json_option
def assess(tow_id: str, archive: Path, data: Path, method: str | None, as_json: bool) -> None:
    """What a tow shows while the boat waits: provisional, and nothing is stored."""
    from dashboards.statements.tow import statements as tow_statements
    from herijk.cli.audit_text import assessment_text
    from pipeline.method.definition import COMPLETE
    from warehouse.editions.publish import latest_before
    from warehouse.queries import assess as tows
    from warehouse.store.editions import read_edition
    from warehouse.store.methods import KnownMethods
    from warehouse.store.store import Store

    store = Store(data)
    today = dt.date.today()
    edition = None if method else latest_before(store, today, today)
    in_force = None if edition is None else read_edition(store, edition).method
    chosen = in_force or KnownMethods.of(store).get(method or BEST)
    found = tows.assess(store, archive, tow_id, chosen)
    said = tow_statements(found, chosen.interval == COMPLETE)
    show(
        found,
        lambda report: assessment_text(report, said),
        as_json,
        lambda report: {report.tow["tow_id"]: said},
    )


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
