"""Everything behind one boat, or behind one type of boat, as plain data.

Reads only `warehouse.duckdb`. The statistics are made in `pipeline.consistency`; here rows are
collected, in `warehouse.queries.audit_types` also judged. How it is said in words is
`cli.audit_text`.
"""

from collections.abc import Sequence
from typing import Any, Final

import duckdb

from herijk.pipeline.consistency.observed import UNKNOWN_TYPE
from herijk.pipeline.errors import MissingKnowledgeError
from herijk.warehouse.queries.audit_types import TYPE, type_facts, types_page
from herijk.warehouse.store.database import is_simulated, open_results, rows
from herijk.warehouse.store.store import Store

Report = dict[str, Any]

TYPE_METHODS: Final = ("as-published", "rebased-2015", "rebased")
"""Methods on a type's page when none is asked for: before, by the rules of 2015, and now."""


def audit(store: Store, names: Sequence[str], method: str | None = None) -> Report:
    """The page of a boat, or of one or two types.

    Args:
        store: where the database lies.
        names: an FSN number, or one or two names of types; case and blanks do not matter.
        method: show this method only.

    Returns:
        A boat page or a page of types, with `about`: boat or types.

    Raises:
        MissingKnowledgeError: there is no such boat, type or method, or no database.
    """
    with open_results(store.database) as db:
        methods = _methods(db, method)
        boats = _boats_named(db, names[0]) if len(names) == 1 else []
        if boats:
            page = {"about": "boat"} | _boat_page(db, boats[0], methods)
        else:
            types = list(dict.fromkeys(_type_named(db, name) for name in names))
            chosen = methods if method else _usual(methods)
            page = {"about": "types"} | types_page(db, types, chosen)
        return {"simulated": is_simulated(db)} | page


def _methods(db: duckdb.DuckDBPyConnection, method: str | None) -> list[str]:
    known = [row["method"] for row in rows(db, "SELECT method FROM methods ORDER BY method")]
    if method is None:
        return known
    if method not in known:
        raise MissingKnowledgeError(
            f"the tables hold no method {method!r}; they hold {', '.join(known)}"
        )
    return [method]


def _usual(methods: list[str]) -> list[str]:
    return [name for name in TYPE_METHODS if name in methods] or methods


def _plain(name: str) -> str:
    return "".join(name.split()).casefold()


def _boats_named(db: duckdb.DuckDBPyConnection, name: str) -> list[Report]:
    boats = rows(db, "SELECT * FROM boats ORDER BY fsn_no")
    return [boat for boat in boats if _plain(boat["fsn_no"]) == _plain(name)]


def _type_named(db: duckdb.DuckDBPyConnection, name: str) -> str:
    query = f"SELECT {TYPE} AS boat_type, count(*) AS n FROM boats AS b GROUP BY ALL ORDER BY ALL"  # noqa: S608
    types = rows(db, query)
    for row in types:
        if _plain(row["boat_type"]) == _plain(name):
            return str(row["boat_type"])
    for boat in _boats_named(db, name):
        raise MissingKnowledgeError(
            f"{boat['fsn_no']} is a boat, not a type; a boat has a page of its own: "
            f"herijk audit {boat['fsn_no']}"
        )
    example = rows(db, "SELECT min(fsn_no) AS fsn_no FROM tows")[0]["fsn_no"]
    known = ", ".join(f"{row['boat_type']} ({row['n']} boats)" for row in types)
    raise MissingKnowledgeError(
        f"there is no boat and no type {name!r}; the types are {known}; boats are named by FSN "
        f"number, for example {example}"
    )


# A boat ------------------------------------------------------------------------------------------


def _boat_page(db: duckdb.DuckDBPyConnection, boat: Report, methods: list[str]) -> Report:
    """A boat's tows step by step, and its place among its like and in its own history."""
    fsn_no = boat["fsn_no"]
    return {
        "boat": boat,
        "methods": methods,
        "tows": [_tow(db, tow, methods) for tow in rows(db, _TOWS, fsn_no)],
        "in_type": _of_boat(db, "type_outliers", fsn_no, methods),
        "type_size": type_facts(db, boat["boat_type"] or UNKNOWN_TYPE),
        "pooled": _of_boat(db, "pooled_curves", fsn_no, methods),
        "slow_tows": _of_boat(db, "slow_tows", fsn_no, methods),
        "repeat_pairs": _of_boat(db, "repeat_pairs", fsn_no, methods),
        "predicted": _of_boat(db, "predicted_cw", fsn_no, methods),
        "register": _of_boat(db, "register", fsn_no, methods),
        "set_aside": rows(db, _SET_ASIDE, fsn_no, boat["name"]),
    }


def _of_boat(
    db: duckdb.DuckDBPyConnection, table: str, fsn_no: str, methods: list[str]
) -> list[Report]:
    query = f"SELECT * FROM {table} WHERE fsn_no = ? AND list_contains(?, method) ORDER BY ALL"  # noqa: S608
    return rows(db, query, fsn_no, methods)


def _tow(db: duckdb.DuckDBPyConnection, tow: Report, methods: list[str]) -> Report:
    """A tow with its curves, the runs and uncertainty of each, and what each step did."""
    tow_id = tow["tow_id"]
    curves = rows(db, _CURVES, tow_id, methods)
    for curve in curves:
        curve["run_points"] = rows(db, _RUN_POINTS, tow_id, curve["method"])
        curve["budget"] = rows(db, _BUDGET, tow_id, curve["method"])
    return tow | {"curves": curves, "steps": rows(db, _STEPS, tow_id, methods, methods)}


_TOWS = "SELECT * FROM tows WHERE fsn_no = ? ORDER BY tow_date, tow_id"

_CURVES = """
SELECT c.*, m.interval FROM curves AS c JOIN methods AS m USING (method)
WHERE tow_id = ? AND list_contains(?, method) ORDER BY method
"""

_RUN_POINTS = "SELECT * FROM run_points WHERE tow_id = ? AND method = ? ORDER BY run"

_BUDGET = """
SELECT component, shared, u_ratio, dof FROM uncertainty_budget
WHERE tow_id = ? AND method = ? ORDER BY u_ratio DESC, component
"""

_STEPS = """
SELECT * FROM correction_steps
WHERE tow_id = ? AND list_contains(?, from_method) AND list_contains(?, to_method)
ORDER BY from_method, to_method, position
"""

_SET_ASIDE = r"""
SELECT * FROM quarantine
WHERE regexp_matches(message, '\b' || regexp_escape(?) || '\b')
   OR starts_with(lower(parse_filename(path)), lower(?) || ' ')
ORDER BY path, line
"""
