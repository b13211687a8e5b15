"""Registers and due lists as the command prints them, on the day on which they are judged.

The rule for the speed of the next tow is `pipeline.register.due`'s.
"""

import datetime as dt
from dataclasses import dataclass

from pipeline.errors import MissingKnowledgeError
from pipeline.register.register import default_method, draft_name
from pipeline.tables.row import Row
from warehouse.queries.answers import current_edition
from warehouse.queries.views import Views
from warehouse.store.database import make_unknown_edition_error
from warehouse.store.store import Store

EXPIRED, THIS_YEAR, LATER, NEVER = "expired", "this_year", "later", "without_curve"


@dataclass(frozen=True)
class RegisterReport:
    """The register of an edition or draft.

    Attributes:
        edition: its name.
        simulated: whether its tows are.
        as_of: the day on which validity is judged.
        lines: rows of `register` with `name`.
    """

    edition: str
    simulated: bool
    as_of: dt.date
    lines: list[Row]


@dataclass(frozen=True)
class DueReport:
    """Who is due under a method.

    Attributes:
        method: whose curves are used.
        simulated: whether the archive is.
        as_of: day on which validity is judged.
        lines: rows of `due_list` with `name`, `boat_type` and `urgency`.
    """

    method: str
    simulated: bool
    as_of: dt.date
    lines: list[Row]


def register_report(
    store: Store, edition: str | None = None, as_of: dt.date | None = None
) -> RegisterReport:
    """Return the lines of an edition or draft, with the name of each boat.

    Args:
        store: the data folder.
        edition: its name; the newest, or the best draft, when left out.
        as_of: the day on which validity is judged; that of the edition or draft when left out.

    Raises:
        MissingKnowledgeError: there is no such edition, or no tow by that day.
    """
    with Views(store, as_of) as views:
        chosen = edition or current_edition(views)
        lines = views.register()
        of_edition = lines.filter(edition=chosen)
        if of_edition.is_empty():
            raise make_unknown_edition_error(chosen, lines["edition"].unique())
        simulated = views.simulated(chosen)
    return RegisterReport(chosen, simulated, of_edition["as_of"][0], of_edition.to_dicts())


def due_report(store: Store, method: str | None = None, as_of: dt.date | None = None) -> DueReport:
    """Return who is due under a method, and at what speed.

    Args:
        store: the data folder.
        method: whose curves give the speeds; the best that was applied when left out.
        as_of: the day on which validity is judged; that of the last tow or race when left out.

    Raises:
        MissingKnowledgeError: the method was not applied by the last rebuild.
    """
    with Views(store, as_of) as views:
        due = views.ask("due_list")
        chosen = method or default_method(views.table("methods")["method"].to_list())
        simulated = views.simulated(draft_name(chosen))
    lines = due.filter(method=chosen).to_dicts()
    if not lines:
        raise MissingKnowledgeError(
            "there is no due list of method {}; make it with: herijk rebuild "
            "--archive DIR --data {} --method {}",
            chosen,
            store.root,
            chosen,
        )
    return DueReport(
        method=chosen,
        simulated=simulated,
        as_of=lines[0]["as_of"],
        lines=[line | {"urgency": _urgency(line)} for line in lines],
    )


def _urgency(line: Row) -> str:
    if line["valid_until"] is None:
        return NEVER
    if line["status"] == "expired":
        return EXPIRED
    return THIS_YEAR if line["valid_until"].year == line["as_of"].year else LATER
