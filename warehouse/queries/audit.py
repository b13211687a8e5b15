"""Everything behind one boat, or behind one or two types of boat: figures, and verdicts on them.

Reads only `warehouse.duckdb`. The statistics are made in `pipeline.consistency`; here rows are
collected. A verdict is true, false, or None where the figures do not decide. How it is said in
words is `cli.audit_text`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import log
from typing import Final, TypeAlias

import duckdb

from pipeline.consistency.observed import UNKNOWN_TYPE
from pipeline.consistency.types import QUANTITIES, TERM_NAMES
from pipeline.errors import MissingKnowledgeError
from pipeline.quantiles import differ_beyond_intervals
from pipeline.tables.row import Row
from warehouse.store.boats import (
    choose_boat,
    find_boats,
    match_names,
    normalize_name,
    suggest_names,
)
from warehouse.store.database import is_simulated, open_database, rows
from warehouse.store.store import Store

TYPE_METHODS: Final = ("as-published", "rebased-2015", "rebased")
"""Methods on a type's page when none is asked for: before, by the rules of 2015, and now."""

TYPE: Final = f"coalesce(b.boat_type, '{UNKNOWN_TYPE}')"
"""A boat's type in a query that calls the table of boats b."""

Statistics: TypeAlias = dict[str, list[Row]]
"""Rows about a type under a method, by what `_STATISTICS` asks."""


@dataclass(frozen=True)
class BoatAudit:
    """A boat's tows step by step, and its place among its like and in its own history.

    Attributes:
        simulated: whether the archive is.
        methods: the methods shown.
        boat: its row of `boats`.
        tows: rows of `tows` with `curves` (rows of that table with `interval`, `run_points` and
            `budget`) and `steps`, rows of `correction_steps`.
        in_type: rows of `compared_tows`.
        predicted: rows of `predicted_cw`.
        options: rows of `option_effects`.
        set_aside: rows of `quarantine`.
        repeat_pairs, register: rows of those tables.
    """

    simulated: bool
    methods: list[str]
    boat: Row
    tows: list[Row]
    in_type: list[Row]
    repeat_pairs: list[Row]
    predicted: list[Row]
    options: list[Row]
    register: list[Row]
    set_aside: list[Row]
    about: str = "boat"


@dataclass(frozen=True)
class TypesAudit:
    """One or two types of boat.

    Attributes:
        simulated: whether the archive is.
        methods: the methods shown.
        types: of each type how many boats and tows there are and how they differ, and `under`: its
            `Statistics` by method.
        differences: what differs between them, by method.
        reproducibility: rows of that table, for all types together.
    """

    simulated: bool
    methods: list[str]
    types: list[Row]
    differences: dict[str, list[str]]
    reproducibility: list[Row]
    about: str = "types"


def audit(store: Store, names: Sequence[str], method: str | None = None) -> BoatAudit | TypesAudit:
    """Return the page of a boat, or of one or two types.

    Args:
        store: where the database lies.
        names: an FSN number or name of a boat, or one or two names of types, or the beginning
            of any of these; case, blanks and accents do not matter.
        method: show this method only.

    Raises:
        MissingKnowledgeError: there is no such boat, type or method, or no database.
    """
    with open_database(store.database) as db:
        methods = _methods(db, method)
        usual: list[str] = [name for name in TYPE_METHODS if name in methods]
        of_types = methods if method or not usual else usual
        if len(names) == 1 and (boat := _find_boat(db, names[0])):
            return _boat_audit(db, boat, methods)
        known = dict.fromkeys(_choose_type(db, name) for name in names)
        return _types_audit(db, list(known), of_types)


def _methods(db: duckdb.DuckDBPyConnection, method: str | None) -> list[str]:
    known = [row["method"] for row in rows(db, "SELECT method FROM methods ORDER BY method")]
    if method is None:
        return known
    if method not in known:
        raise MissingKnowledgeError(
            "the tables hold no method {!r}; they hold {}", method, ", ".join(known)
        )
    return [method]


def _find_boat(db: duckdb.DuckDBPyConnection, wanted: str) -> Row | None:
    """Return the boat that a name stands for, unless a type answers to it.

    A whole number or name of a boat goes before the beginning of a type, and that before the
    beginning of a boat.

    Raises:
        MissingKnowledgeError: several boats answer to the name, and no type.
    """
    boats = db.sql("SELECT * FROM boats").pl()
    types = [row["boat_type"] for row in rows(db, _TYPES)]
    is_whole_type = normalize_name(wanted) in {normalize_name(name) for name in types}
    begins_type = bool(match_names(wanted, types))
    is_whole_boat = bool(find_boats(boats, wanted, whole=True))
    if is_whole_type or (begins_type and not is_whole_boat) or not find_boats(boats, wanted):
        return None
    fsn_no = choose_boat(boats, wanted)
    return rows(db, "SELECT * FROM boats WHERE fsn_no = ?", fsn_no)[0]


def _choose_type(db: duckdb.DuckDBPyConnection, wanted: str) -> str:
    """Return the type that a name, or its beginning, stands for.

    Raises:
        MissingKnowledgeError: no type answers to the name, or several do.
    """
    types = rows(db, _TYPES)
    found = match_names(wanted, [row["boat_type"] for row in types])
    if len(found) == 1:
        return found[0]
    if found:
        raise MissingKnowledgeError(
            "{!r} may be any of {} types: {}; write more of the name",
            wanted,
            len(found),
            ", ".join(found),
        )
    boats = db.sql("SELECT * FROM boats").pl()
    if find_boats(boats, wanted):
        fsn_no = choose_boat(boats, wanted)
        raise MissingKnowledgeError(
            "{} is a boat, not a type; a boat has a page of its own: herijk audit {}",
            fsn_no,
            fsn_no,
        )
    known = [*(row["boat_type"] for row in types), *boats["fsn_no"], *boats["name"].drop_nulls()]
    raise MissingKnowledgeError(
        "there is no boat and no type {!r}; the types, and how many boats: {}; boats are named by "
        "FSN number or name, for example {}.{}",
        wanted,
        ", ".join(f"{row['boat_type']} ({row['n']})" for row in types),
        rows(db, "SELECT min(fsn_no) AS fsn_no FROM tows")[0]["fsn_no"],
        suggest_names(wanted, known),
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
        in_type=of_boat("compared_tows"),
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


# Types


def _types_audit(db: duckdb.DuckDBPyConnection, types: list[str], methods: list[str]) -> TypesAudit:
    audited = [
        rows(db, _FACTS, name)[0]
        | {
            "under": {
                method: {
                    asked: rows(db, query, method, name) for asked, query in _STATISTICS.items()
                }
                for method in methods
            }
        }
        for name in types
    ]
    return TypesAudit(
        simulated=is_simulated(db),
        methods=methods,
        types=audited,
        differences={m: differences(*(one["under"][m] for one in audited)) for m in methods},
        reproducibility=rows(db, _REPRODUCIBILITY, methods),
    )


def differences(first: Statistics, *others: Statistics) -> list[str]:
    """Return what differs between two types: a slope or shift by more than both intervals.

    Returns:
        `quantity term` of slopes, `quantity verdict` where boats of one type are equal and those of
        the other are not, and the names of eras; of one type, nothing.
    """
    found = []
    for second in others:
        own, other = _intervals(first), _intervals(second)
        both = own.keys() & other.keys()
        found += [n for n in own if n in both and differ_beyond_intervals(own[n], other[n])]
        verdicts = {row["quantity"]: row["verdict"] for row in second["consistency"]}
        for row in first["consistency"]:
            if {row["verdict"], verdicts.get(row["quantity"])} == {"equal", "differ"}:
                found.append(f"{row['quantity']} verdict")
    return found


def _intervals(under: Statistics) -> dict[str, tuple[float, float, float]]:
    """Return every slope and shift with its interval; shifts as logarithms."""
    found = {}
    for row in under["consistency"]:
        for term, name in TERM_NAMES.items():
            slope = (row[f"{name}_slope"], row[f"{name}_slope_lo"], row[f"{name}_slope_hi"])
            if slope[0] is not None:
                found[f"{row['quantity']} {term}"] = slope
    for era in under["eras"]:
        if not era["reason"]:
            found[era["era"]] = (log(era["shift_ratio"]), log(era["lo"]), log(era["hi"]))
    return found


_FACTS = f"""
SELECT {TYPE} AS boat_type, count(DISTINCT b.fsn_no) AS n_boats,
       count(DISTINCT t.fsn_no) AS n_towed, count(t.tow_id) AS n_tows,
       min(t.season) AS first_season, max(t.season) AS last_season,
       min(t.weight_kg) AS lightest_kg, max(t.weight_kg) AS heaviest_kg,
       min(t.declared_speed_m_s) AS slowest_m_s, max(t.declared_speed_m_s) AS fastest_m_s
FROM boats AS b LEFT JOIN tows AS t USING (fsn_no) WHERE {TYPE} = ? GROUP BY ALL
"""  # noqa: S608

_REPEATS = f"""
SELECT count(*) AS n_pairs, sqrt(avg(p.ln_ratio * p.ln_ratio) / 2) AS sd_ratio,
       count(p.e_n) AS n_e_n, count(*) FILTER (WHERE abs(p.e_n) > 1) AS n_disagree
FROM repeat_pairs AS p JOIN boats AS b USING (fsn_no) WHERE p.method = ? AND {TYPE} = ?
"""  # noqa: S608

_NAMED = """
SELECT t.*, b.name FROM {} AS t LEFT JOIN boats AS b USING (fsn_no)
WHERE t.method = ? AND t.boat_type = ? AND t.{} ORDER BY {}, tow_id
"""
"""Rows of tows for which a column says yes, with the boat's name."""

_QUANTITIES = ", ".join(f"'{quantity.name}'" for quantity in QUANTITIES)

_CONSISTENCY = f"""
SELECT c.*, b.name AS farthest_name
FROM type_consistency AS c LEFT JOIN boats AS b ON b.fsn_no = c.farthest
WHERE c.method = ? AND c.boat_type = ? ORDER BY list_position([{_QUANTITIES}], quantity)
"""  # noqa: S608

_STATISTICS: Final = {
    "consistency": _CONSISTENCY,
    "outside": _NAMED.format(
        "compared_tows", "newest AND (t.cw_outside OR t.b_outside)", "abs(cw_deviation_sd) DESC"
    ),
    "slow_tows": _NAMED.format("compared_tows", "slow", "power_w"),
    "repeats": _REPEATS,
    "eras": "SELECT * FROM era_shifts WHERE method = ? AND boat_type = ?",
}
"""What is asked of a type under a method."""

_REPRODUCIBILITY = """
SELECT * FROM reproducibility WHERE list_contains(?, method) ORDER BY method, scope
"""
