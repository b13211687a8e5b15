"""`herijk audit`: a boat or types, as their pages have it; `herijk assess`: a tow on the quay."""

import datetime as dt
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from herijk.cli.options import archive_option, data_option, form_options, show, wants_json
from herijk.cli.speaking import Command, argument, flag, option
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import tell

if TYPE_CHECKING:
    from dashboards.queries.results import Results
    from warehouse.store.store import Store

BOAT_FIELDS: Final = (
    "simulated",
    "methods",
    "boat",
    "edition",
    "answers",
    "register",
    "tows",
    "curves",
    "steps",
    "runs",
    "currents",
    "budget",
    "checks",
    "acceptances",
    "in_type",
    "repeat_pairs",
    "predicted",
    "set_aside",
)
TYPE_FIELDS: Final = (
    "simulated",
    "method",
    "methods",
    "types",
    "differences",
    "reproducibility",
)
TOW_FIELDS: Final = (
    "method",
    "simulated",
    "tow",
    "curve",
    "runs",
    "checks",
    "verdict",
    "redo",
    "first_assessment",
    "ways_to_use",
    "lost",
    "own_before",
    "of_type",
)
ACCEPTANCE_FIELDS: Final = ("method", "verdict", "flags", "path", "header", "line", "written")
"""What JSON has of a boat, of types, of a tow on the quay, and of its acceptance."""


@click.command(
    cls=Command,
    examples=(
        "herijk audit FSN114",
        'herijk audit "Razende Snol" --steps --method rebased',
        "herijk audit Kromhoutwhaler Kuikensloep",
        "herijk audit FSN114 --edition 2026-1",
    ),
)
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
@option("--tow", help="With --steps: show this tow only.")
@form_options
def audit(
    names: tuple[str, ...],
    store: "Store",
    edition: str | None,
    steps: bool,
    method: str | None,
    tow: str | None,
) -> None:
    """Show where a boat's number comes from, or whether boats of a type are equal.

    With --edition also the files, runs and seconds behind a line of a published edition.
    """
    from dashboards.queries import boats, types
    from warehouse.queries.types import choose_type, find_boat
    from warehouse.store.editions import list_edition_names
    from warehouse.store.methods import KnownMethods

    if len(names) > 2:
        raise click.UsageError(tell("give a boat, or one or two types; quote a name with blanks"))
    is_published = edition in list_edition_names(store)
    if is_published and (wants_json() or not store.database.exists()):
        show_lineage(store, str(edition), names[0])  # an edition says this by itself
        return
    if method is not None:
        KnownMethods.from_store(store).text(method)

    from dashboards.queries.results import Results
    from warehouse.queries.views import Views

    with Views(store) as views:
        results = Results(views)
        shown_methods = _choose_methods(results, method)
        fsn_no = find_boat(views, names[0]) if len(names) == 1 else None
        about = views.about()
        simulated = about.get("simulated") == "true"
        if fsn_no is not None:
            data = boats.read_boat(results, fsn_no, edition=edition, methods=shown_methods)
            data |= {"steps_shown": steps, "simulated": simulated}
            known_tows = data["tows"]["tow_id"].to_list()
            if tow and tow not in known_tows:
                raise MissingKnowledgeError(
                    "boat {} has no tow {!r}; it has {}", fsn_no, tow, ", ".join(known_tows)
                )
            chosen = {"tow_id": tow or "", "method": method or ""}
            show("audit_boat", data, BOAT_FIELDS, chosen=chosen, folded=steps, about=about)
        else:
            known = dict.fromkeys(choose_type(views, name) for name in names)
            methods = _choose_type_methods(shown_methods, steps, method)
            data = types.compare_types(results, list(known), methods)
            quoted = " ".join(f'"{name}"' for name in known)
            data |= {"steps_shown": steps, "simulated": simulated, "quoted_names": quoted}
            show("audit_types", data, TYPE_FIELDS, folded=steps, about=about)
    if is_published:
        show_lineage(store, str(edition), names[0])


def _choose_methods(results: "Results", method: str | None) -> list[str]:
    """Return the methods that an audit shows: all of the last rebuild, or the one asked for.

    Raises:
        MissingKnowledgeError: the last rebuild did not apply the method.
    """
    known: list[str] = results.views.table("methods")["method"].sort().to_list()
    if method is None:
        return known
    if method not in known:
        raise MissingKnowledgeError(
            "the tables hold no method {!r}; they hold {}", method, ", ".join(known)
        )
    return [method]


def _choose_type_methods(known: list[str], steps: bool, method: str | None) -> list[str]:
    """Return the methods by which types are compared; the last gives the verdicts."""
    from warehouse.queries.types import USUAL_METHODS

    usual: list[str] = [name for name in USUAL_METHODS if name in known]
    shown = known if method or not usual else usual
    return shown if steps else list(dict.fromkeys((shown[0], shown[-1])))


def show_lineage(store: "Store", edition: str, name: str) -> None:
    """Print the files, runs and seconds behind the lines of a boat in an edition."""
    from warehouse.editions.lineage import lineage

    show("lineage", vars(lineage(store, edition, name)), ("about", "lines"))


@click.command(
    cls=Command,
    examples=(
        "herijk assess 2018-007",
        'herijk assess 2018-007 --accept "J. de Vries" --redo 2,5 --note "steering"',
    ),
)
@argument("tow_id", metavar="TOW", help="Number of the tow in the list of the season.")
@archive_option
@data_option
@option("--method", help="Method. Default: that of the newest edition, or rebased.")
@option("--accept", metavar="NAME", help="Accept the tow, and print the line that records it.")
@option("--redo", metavar="RUNS", help="With --accept: runs that were towed again, as 2,5.")
@option("--note", metavar="TEXT", help="With --accept: why.")
@flag("--write", help="With --accept: add the line to beoordelingen.csv of the archive.")
@form_options
def assess(
    tow_id: str,
    archive: Path,
    store: "Store",
    method: str | None,
    accept: str | None,
    redo: str | None,
    note: str | None,
    write: bool,
) -> None:
    """Assess a tow while the boat waits: provisional, and nothing is stored.

    With --accept also say who accepts it; only with --write is that stored, in the archive.
    """
    from dashboards.queries.quay import describe_tow
    from pipeline.method.definition import COMPLETE
    from pipeline.register.register import STUDIED_METHOD
    from warehouse.archive.acceptance import Acceptance, compose_line
    from warehouse.editions.publish import find_latest_before
    from warehouse.queries import assess as tows
    from warehouse.store.editions import read_edition
    from warehouse.store.methods import KnownMethods

    if accept is None and (redo or note or write):
        raise click.UsageError(tell("--redo, --note and --write go with --accept NAME"))
    if accept is not None and not accept.strip():
        raise click.UsageError(tell("say who accepts the tow: --accept NAME"))
    today = dt.date.today()
    edition = None if method else find_latest_before(store, today, today)
    in_force = None if edition is None else read_edition(store, edition).method
    chosen = in_force or KnownMethods.from_store(store).get(method or STUDIED_METHOD)
    found = tows.assess(store, archive, tow_id, chosen)
    if accept is None:
        data = describe_tow(found, log_known=chosen.interval == COMPLETE)
        show("tow", data, TOW_FIELDS)
        return
    acceptance = Acceptance(
        tow_id=tow_id,
        towed_on=found.tow["tow_date"],
        planned_runs=found.planned_runs,
        accepted_by=accept,
        accepted_on=today,
        redone_runs=redo or "",
        note=note or "",
        known_checks=found.curve["flags"],
    )
    line = compose_line(archive, acceptance)
    if write:
        line.write()
    data = vars(found) | vars(line) | {"is_new": line.before is None, "written": write}
    show("acceptance", data | {"flags": found.curve["flags"]}, ACCEPTANCE_FIELDS)
