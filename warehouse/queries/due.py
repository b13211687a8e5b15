"""The due list as the command prints it, with the boats to tow again.

The rule for the speed is `pipeline.register.due`'s.
"""

import datetime as dt
from dataclasses import dataclass
from typing import Final

from pipeline.errors import MissingKnowledgeError
from pipeline.tables.row import Row
from warehouse.store.database import is_simulated, open_results, rows
from warehouse.store.store import Store

EXPIRED, THIS_YEAR, LATER, NEVER = "expired", "this_year", "later", "without_curve"

WORTH: Final = 0.9
"""A set of tows is worth its trouble where it takes a tenth or more off the uncertainty."""


@dataclass(frozen=True)
class DueReport:
    """Who is due under a method.

    Attributes:
        method: whose curves are used.
        simulated: whether the archive is.
        as_of: day on which validity is judged.
        asked: whether that day was asked for; else it is that of the last tow or race.
        lines: rows of `due_list` with `name`, `boat_type` and `urgency`.
        retow_choice: rows of that table with `name`, `valid_until` and `tow_speed_m_s`.
    """

    method: str
    simulated: bool
    as_of: dt.date
    asked: bool
    lines: list[Row]
    retow_choice: list[Row]


def due_report(store: Store, method: str, as_of: dt.date | None = None) -> DueReport:
    """Who is due under a method, at what speed, and which boats to tow again.

    Args:
        store: the data folder.
        method: whose curves give the speeds.
        as_of: the day on which validity is judged; that of the last tow or race when left out.

    Raises:
        MissingKnowledgeError: the method was not applied by the last rebuild.
    """
    with open_results(store.database) as db:
        if as_of is not None:
            from warehouse.queries.as_of import lay_over  # noqa: PLC0415 - much, and seldom needed

            lay_over(db, store, as_of)
        lines = rows(db, _LINES, method)
        choice = [row for row in rows(db, RETOW_CHOICE) if row["method"] == method]
        simulated = is_simulated(db)
    if not lines:
        raise MissingKnowledgeError(
            "there is no due list of method {}; make it with: herijk rebuild "
            "--archive DIR --data {} --method {}",
            method,
            store.root,
            method,
        )
    urgent = [line | {"urgency": _urgency(line)} for line in lines]
    asked = as_of is not None
    return DueReport(method, simulated, lines[0]["as_of"], asked, urgent, choice)


def _urgency(line: Row) -> str:
    if line["valid_until"] is None:
        return NEVER
    if line["status"] == "expired":
        return EXPIRED
    return THIS_YEAR if line["valid_until"].year == line["as_of"].year else LATER


_LINES = """
SELECT d.*, b.name, b.boat_type FROM due_list AS d LEFT JOIN boats AS b USING (fsn_no)
WHERE d.method = ? ORDER BY d.valid_until NULLS LAST, d.fsn_no, d.rowers, d.crew_class
"""

RETOW_CHOICE: Final = """
SELECT c.*, b.name, d.valid_until, d.tow_speed_m_s
FROM retow_choice AS c LEFT JOIN boats AS b USING (fsn_no)
LEFT JOIN (
    SELECT method, fsn_no, rowers, crew_class, max(valid_until) AS valid_until,
           arg_max(tow_speed_m_s, valid_until) AS tow_speed_m_s
    FROM due_list GROUP BY method, fsn_no, rowers, crew_class
) AS d USING (method, fsn_no, rowers, crew_class)
ORDER BY c.method, c.position
"""
"""Boats to tow again, with last day and next speed of the line that lasts longest."""
