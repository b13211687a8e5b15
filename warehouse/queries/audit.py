"""Everything behind one boat, or behind one type of boat, as plain data.

Reads only `warehouse.duckdb`. The statistics are made in `pipeline.consistency`; here rows are
collected, in `warehouse.queries.audit_types` also judged. How it is said in words is
`cli.audit_text`.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import duckdb

from pipeline.consistency.observed import UNKNOWN_TYPE
from pipeline.errors import MissingKnowledgeError
from pipeline.tables.row import Row
from warehouse.queries.audit_types import (
    TYPE,
    Audit,
    TypeFacts,
    TypesAudit,
    type_facts,
    types_audit,
)
from warehouse.queries.chosen_tows import NEWEST, choose
from warehouse.store.boats import boats_named, plain, the_boat
from warehouse.store.database import is_simulated, open_results, rows
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
        type_size: the facts of its type.
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
    type_size: TypeFacts
    pooled: list[Row]
    slow_tows: list[Row]
    repeat_pairs: list[Row]
    predicted: list[Row]
    options: list[Row]
    register: list[Row]
    set_aside: list[Row]


def audit(
    store: Store, names: Sequence[str], method: str | None = None, tows: str = NEWEST
) -> BoatAudit | TypesAudit:
    """The page of a boat, or of one or two types.

    Args:
        store: where the database lies.
        names: an FSN number or name of a boat, or one or two names of types; case, blanks and
            accents do not matter.
        method: show this method only.
        tows: over which tows a type's statistics are: see `chosen_tows`.

    Raises:
        MissingKnowledgeError: there is no such boat, type or method, or no database.
    """
    with open_results(store.database) as db:
        methods = _methods(db, method)
        usual: list[str] = [name for name in TYPE_METHODS if name in methods]
        of_types = methods if method or not usual else usual
        types = {plain(row["boat_type"]): row for row in rows(db, _TYPES)}
        asked = {name: types.get(plain(name)) for name in names}
        if len(names) == 1 and asked[names[0]] is None and (boat := _boat(db, names[0])):
            choose(db, tows, methods)
            return _boat_audit(db, boat, methods, tows)
        for name, found in asked.items():
            if found is None:
                raise _no_such_type(db, name, list(types.values()))
        choose(db, tows, of_types)
        known = dict.fromkeys(row["boat_type"] for row in asked.values() if row)
        return types_audit(db, list(known), of_types, tows)


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

# A boat ------------------------------------------------------------------------------------------


def _boat_audit(
    db: duckdb.DuckDBPyConnection, boat: Row, methods: list[str], tows: str
) -> BoatAudit:
    fsn_no = boat["fsn_no"]
    return BoatAudit(
        simulated=is_simulated(db),
        statistics_over=tows,
        methods=methods,
        boat=boat,
        tows=_tows(db, fsn_no, methods),
        in_type=_of_boat(db, "type_outliers", fsn_no, methods),
        type_size=type_facts(db, boat["boat_type"] or UNKNOWN_TYPE),
        pooled=_of_boat(db, "pooled_curves", fsn_no, methods),
        slow_tows=_of_boat(db, "slow_tows", fsn_no, methods),
        repeat_pairs=_of_boat(db, "repeat_pairs", fsn_no, methods),
        predicted=_of_boat(db, "predicted_cw", fsn_no, methods),
        options=rows(db, _OPTIONS, fsn_no, methods),
        register=_of_boat(db, "register", fsn_no, methods),
        set_aside=rows(db, _SET_ASIDE, fsn_no, boat["name"]),
    )


def _of_boat(
    db: duckdb.DuckDBPyConnection, table: str, fsn_no: str, methods: list[str]
) -> list[Row]:
    query = f"SELECT * FROM {table} WHERE fsn_no = ? AND list_contains(?, method) ORDER BY ALL"  # noqa: S608
    return rows(db, query, fsn_no, methods)


def _tows(db: duckdb.DuckDBPyConnection, fsn_no: str, methods: list[str]) -> list[Row]:
    """A boat's tows with their curves, the runs and uncertainty of each, and what each step did."""
    curves = rows(db, _CURVES, fsn_no, methods)
    run_points = _by(rows(db, _RUN_POINTS, fsn_no, methods), "tow_id", "method")
    budgets = _by(rows(db, _BUDGET, fsn_no, methods), "tow_id", "method")
    for curve in curves:
        own = curve["tow_id"], curve["method"]
        curve["run_points"] = run_points[own]
        curve["budget"] = [{name: row[name] for name in _BUDGET_COLUMNS} for row in budgets[own]]
    curves_of = _by(curves, "tow_id")
    steps_of = _by(rows(db, _STEPS, fsn_no, methods, methods), "tow_id")
    return [
        tow | {"curves": curves_of[tow["tow_id"],], "steps": steps_of[tow["tow_id"],]}
        for tow in rows(db, _TOWS, fsn_no)
    ]


def _by(listed: list[Row], *names: str) -> defaultdict[tuple[object, ...], list[Row]]:
    """Rows by the values of some columns, in their order."""
    grouped = defaultdict(list)
    for row in listed:
        grouped[tuple(row[name] for name in names)].append(row)
    return grouped


_TOWS = "SELECT * FROM tows WHERE fsn_no = ? ORDER BY tow_date, tow_id"

_OF_BOAT = "tow_id IN (SELECT tow_id FROM tows WHERE fsn_no = ?)"

_CURVES = f"""
SELECT c.*, m.interval FROM curves AS c JOIN methods AS m USING (method)
WHERE {_OF_BOAT} AND list_contains(?, method) ORDER BY method
"""  # noqa: S608

_RUN_POINTS = f"""
SELECT * FROM run_points WHERE {_OF_BOAT} AND list_contains(?, method) ORDER BY run
"""  # noqa: S608

_BUDGET = f"""
SELECT * FROM uncertainty_budget WHERE {_OF_BOAT} AND list_contains(?, method)
ORDER BY u_ratio DESC, component
"""  # noqa: S608

_BUDGET_COLUMNS: Final = ("component", "shared", "u_ratio", "dof")

_STEPS = f"""
SELECT * FROM correction_steps
WHERE {_OF_BOAT} AND list_contains(?, from_method) AND list_contains(?, to_method)
ORDER BY from_method, to_method, position
"""  # noqa: S608

_OPTIONS = """
SELECT o.* FROM option_effects AS o JOIN tows AS t USING (tow_id)
WHERE t.fsn_no = ? AND list_contains(?, method) AND cw_effect_ratio IS NOT NULL
ORDER BY tow_id, method, study, abs(ln(cw_effect_ratio)) DESC, option
"""

_SET_ASIDE = r"""
SELECT * FROM quarantine
WHERE regexp_matches(message, '\b' || regexp_escape(?) || '\b')
   OR starts_with(lower(parse_filename(path)), lower(?) || ' ')
ORDER BY path, line
"""
