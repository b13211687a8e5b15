"""Everything behind one boat, or behind one type of boat, as plain data.

Reads only `warehouse.duckdb`. The statistics are made in `pipeline.consistency`; here rows are
collected, in `warehouse.queries.audit_types` also judged. How it is said in words is
`cli.audit_text`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import duckdb

from pipeline.errors import MissingKnowledgeError
from pipeline.tables.row import Row
from warehouse.queries.audit_types import TYPE, Audit, TypesAudit, types_audit
from warehouse.store.boats import boats_named, plain, the_boat
from warehouse.store.database import is_simulated, open_database, rows
from warehouse.store.store import Store

TYPE_METHODS: Final = ("as-published", "rebased-2015", "rebased")
"""Methods on a type's page when none is asked for: before, by the rules of 2015, and now."""


@dataclass(frozen=True, kw_only=True)
class BoatAudit(Audit):
    """A boat's tows step by step, and its place among its like and in its own history.

    Attributes:
        boat: its row of `boats`.
        tows: rows of `tows` with `curves` (rows of that table with `interval`, `run_points` and
            `budget`) and `steps`, rows of `correction_steps`.
        in_type: rows of `type_outliers`.
        predicted: rows of `predicted_cw`.
        options: rows of `option_effects`.
        set_aside: rows of `quarantine`.
        pooled: rows of `pooled_curves`.
        slow_tows, repeat_pairs, register: rows of those tables.
    """

    about: str = "boat"
    boat: Row
    tows: list[Row]
    in_type: list[Row]
    pooled: list[Row]
    slow_tows: list[Row]
    repeat_pairs: list[Row]
    predicted: list[Row]
    options: list[Row]
    register: list[Row]
    set_aside: list[Row]


def audit(store: Store, names: Sequence[str], method: str | None = None) -> BoatAudit | TypesAudit:
    """The page of a boat, or of one or two types.

    Args:
        store: where the database lies.
        names: an FSN number or name of a boat, or one or two names of types; case, blanks and
            accents do not matter.
        method: show this method only.

    Raises:
        MissingKnowledgeError: there is no such boat, type or method, or no database.
    """
    with open_database(store.database) as db:
        methods = _methods(db, method)
        usual: list[str] = [name for name in TYPE_METHODS if name in methods]
        of_types = methods if method or not usual else usual
        types = {plain(row["boat_type"]): row for row in rows(db, _TYPES)}
        asked = {name: types.get(plain(name)) for name in names}
        if len(names) == 1 and asked[names[0]] is None and (boat := _boat(db, names[0])):
            return _boat_audit(db, boat, methods)
        for name, found in asked.items():
            if found is None:
                raise _no_such_type(db, name, list(types.values()))
        known = dict.fromkeys(row["boat_type"] for row in asked.values() if row)
        return types_audit(db, list(known), of_types)


def _methods(db: duckdb.DuckDBPyConnection, method: str | None) -> list[str]:
    known = [row["method"] for row in rows(db, "SELECT method FROM methods ORDER BY method")]
    if method is None:
        return known
    if method not in known:
        raise MissingKnowledgeError(
            "the tables hold no method {!r}; they hold {}", method, ", ".join(known)
        )
    return [method]


def _boat(db: duckdb.DuckDBPyConnection, name: str) -> Row | None:
    """The boat of that number or name."""
    boats = db.sql("SELECT * FROM boats").pl()
    if not boats_named(boats, name):
        return None
    return rows(db, "SELECT * FROM boats WHERE fsn_no = ?", the_boat(boats, name))[0]


def _no_such_type(
    db: duckdb.DuckDBPyConnection, name: str, types: list[Row]
) -> MissingKnowledgeError:
    if boat := _boat(db, name):
        return MissingKnowledgeError(
            "{} is a boat, not a type; a boat has a page of its own: herijk audit {}",
            boat["fsn_no"],
            boat["fsn_no"],
        )
    return MissingKnowledgeError(
        "there is no boat and no type {!r}; the types, and how many boats: {}; boats are named by "
        "FSN number or name, for example {}",
        name,
        ", ".join(f"{row['boat_type']} ({row['n']})" for row in types),
        rows(db, "SELECT min(fsn_no) AS fsn_no FROM tows")[0]["fsn_no"],
    )


_TYPES = f"SELECT {TYPE} AS boat_type, count(*) AS n FROM boats AS b GROUP BY ALL ORDER BY ALL"  # noqa: S608

# A boat


def _boat_audit(db: duckdb.DuckDBPyConnection, boat: Row, methods: list[str]) -> BoatAudit:
    fsn_no = boat["fsn_no"]

    def of_boat(table: str) -> list[Row]:
        return rows(db, _OF_BOAT.format(table), fsn_no, methods)

    return BoatAudit(
        simulated=is_simulated(db),
        methods=methods,
        boat=boat,
        tows=rows(db, _TOWS, fsn_no, methods),
        in_type=of_boat("type_outliers"),
        pooled=of_boat("pooled_curves"),
        slow_tows=of_boat("slow_tows"),
        repeat_pairs=of_boat("repeat_pairs"),
        predicted=of_boat("predicted_cw"),
        options=rows(db, _OPTIONS, fsn_no, methods),
        register=of_boat("register"),
        set_aside=rows(db, _SET_ASIDE, fsn_no, boat["name"]),
    )


_OF_BOAT: Final = "SELECT * FROM {} WHERE fsn_no = $1 AND list_contains($2, method) ORDER BY ALL"

_TOWS: Final = """
WITH own AS (SELECT * FROM tows WHERE fsn_no = $1),
points AS (
    SELECT method, tow_id, list(p ORDER BY run) AS run_points
    FROM run_points AS p SEMI JOIN own USING (tow_id) GROUP BY ALL
), budgets AS (
    SELECT method, tow_id, list(
        {component: component, shared: shared, u_ratio: u_ratio, dof: dof}
        ORDER BY u_ratio DESC, component
    ) AS budget
    FROM uncertainty_budget SEMI JOIN own USING (tow_id) GROUP BY ALL
), of_curve AS (
    SELECT c.*, m.interval, coalesce(run_points, []) AS run_points, coalesce(budget, []) AS budget
    FROM curves AS c SEMI JOIN own USING (tow_id) JOIN methods AS m USING (method)
    LEFT JOIN points USING (method, tow_id) LEFT JOIN budgets USING (method, tow_id)
    WHERE list_contains($2, method)
), curve_lists AS (
    SELECT tow_id, list(c ORDER BY method) AS curves FROM of_curve AS c GROUP BY ALL
), step_lists AS (
    SELECT tow_id, list(s ORDER BY from_method, to_method, position) AS steps
    FROM correction_steps AS s SEMI JOIN own USING (tow_id)
    WHERE list_contains($2, from_method) AND list_contains($2, to_method) GROUP BY ALL
)
SELECT own.*, coalesce(curves, []) AS curves, coalesce(steps, []) AS steps
FROM own LEFT JOIN curve_lists USING (tow_id) LEFT JOIN step_lists USING (tow_id)
ORDER BY tow_date, tow_id
"""
"""A boat's tows with their curves, the runs and uncertainty of each, and what each step did."""

_OPTIONS: Final = """
SELECT o.* FROM option_effects AS o JOIN tows AS t USING (tow_id)
WHERE t.fsn_no = ? AND list_contains(?, method)
ORDER BY tow_id, method, study, abs(ln(cw_effect_ratio)) DESC, option
"""

_SET_ASIDE: Final = r"""
SELECT * FROM quarantine
WHERE regexp_matches(message, '\b' || regexp_escape(?) || '\b')
   OR starts_with(lower(parse_filename(path)), lower(?) || ' ')
ORDER BY path, line
"""
