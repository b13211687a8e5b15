"""The due list: its rows in the warehouse, and what the command prints of them.

Here the facts are brought together: registers under the decisions of today, races, and the day on
which is looked. The rule for the speed stands in `pipeline.register.due`.
"""

import datetime as dt
from collections.abc import Sequence
from typing import Any, Final

import polars as pl

from herijk.pipeline.errors import MissingKnowledgeError
from herijk.pipeline.method.definition import Method
from herijk.pipeline.register.due import due_list
from herijk.pipeline.register.register import draft_register
from herijk.warehouse.store import decisions
from herijk.warehouse.store.database import is_simulated, open_database, rows
from herijk.warehouse.store.store import Store, table_digest

Report = dict[str, Any]

EXPIRED, THIS_YEAR, LATER, NEVER = "expired", "this_year", "later", "without_curve"
URGENCIES: Final = (EXPIRED, THIS_YEAR, NEVER, LATER)


def due_made_from(store: Store) -> list[object]:
    """What the due list is made from, beside curves, tows and boats: races and decisions."""
    decided = decisions.read_decisions(store.root / decisions.FILE_NAME)
    races = table_digest(store.read("listed_races"))
    return [races, [d.model_dump(mode="json") for d in decided]]


def due_rows(store: Store, methods: Sequence[Method], curves: pl.DataFrame) -> pl.DataFrame:
    """Rows of the table `due_list` of every method.

    Looked at on the day of the last tow or race, not today: the same archive gives the same table.
    """
    tows, boats = store.read("tows"), store.read("boats")
    results = store.read("listed_races")
    as_of: dt.date = max([*tows["tow_date"], *results["race_date"]])
    decided = decisions.decision_table(decisions.read_decisions(store.root / decisions.FILE_NAME))
    crews = store.read("listed_boats")
    found = []
    for method in methods:
        of_method = curves.filter(pl.col("method") == method.name)
        register = draft_register(of_method, tows, crews, as_of, method.validity, decided)
        found.append(
            due_list(register, boats, results, as_of).select(
                pl.lit(method.name).alias("method"), pl.all()
            )
        )
    return pl.concat(found)


def due_report(store: Store, method: str) -> Report:
    """Who is due under a method, at what speed, and which boats would tie the seasons together.

    Raises:
        MissingKnowledgeError: the method was not applied by the last rebuild.
    """
    with open_database(store.database) as db:
        lines = rows(db, _LINES, method)
        choice = rows(db, _CHOICE, method)
        simulated = is_simulated(db)
    if not lines:
        raise MissingKnowledgeError(
            f"there is no due list of method {method}; make it with: herijk rebuild --archive DIR "
            f"--data {store.root} --method {method}"
        )
    return {
        "method": method,
        "simulated": simulated,
        "as_of": lines[0]["as_of"],
        "lines": [line | {"urgency": _urgency(line)} for line in lines],
        "retow_choice": choice,
    }


def _urgency(line: Report) -> str:
    if line["valid_until"] is None:
        return NEVER
    if line["status"] == "expired":
        return EXPIRED
    return THIS_YEAR if line["valid_until"].year == line["as_of"].year else LATER


_LINES = """
SELECT d.*, b.name, b.boat_type FROM due_list AS d LEFT JOIN boats AS b USING (fsn_no)
WHERE d.method = ? ORDER BY d.valid_until NULLS LAST, d.fsn_no, d.rowers, d.crew_class
"""

_CHOICE = """
SELECT c.*, b.name, d.valid_until, d.tow_speed_m_s
FROM retow_choice AS c LEFT JOIN boats AS b USING (fsn_no)
LEFT JOIN due_list AS d USING (method, fsn_no, rowers, crew_class)
WHERE c.method = ? ORDER BY c.position
"""
