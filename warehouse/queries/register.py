"""The register of an edition as the command prints it, on the day on which it is judged."""

import datetime as dt
from dataclasses import dataclass

from pipeline.tables.row import Row
from warehouse.queries.answers import current_edition
from warehouse.queries.views import Views
from warehouse.store.database import no_such_edition
from warehouse.store.store import Store


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


def register_report(
    store: Store, edition: str | None = None, as_of: dt.date | None = None
) -> RegisterReport:
    """The lines of an edition or draft, with the boat's name.

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
            raise no_such_edition(chosen, lines["edition"].unique())
        simulated = views.simulated(chosen)
    return RegisterReport(chosen, simulated, of_edition["as_of"][0], of_edition.to_dicts())
