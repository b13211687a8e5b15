"""Everything behind one boat, or behind one type of boat, as plain data.

Reads only `warehouse.duckdb`. The statistics are made in `pipeline.consistency`; here rows are
collected, counted and turned into verdicts that are true, false, or None where the figures do not
decide. How it is said in words is `herijk.audit_text`.
"""

from collections.abc import Sequence
from typing import Any, Final

import duckdb

from pipeline.consistency import ERAS
from pipeline.consistency.homogeneity import LEVEL
from pipeline.consistency.observed import UNKNOWN_TYPE
from pipeline.errors import MissingKnowledgeError
from warehouse.database import is_simulated, open_database, rows
from warehouse.store import Store

Report = dict[str, Any]

TYPE_METHODS: Final = ("as-published", "rebased-2015", "rebased")
"""Methods on a type's page when none is asked for: before, by the rules of 2015, and now."""

ENOUGH_POWER: Final = 0.8
"""Chance of seeing a spread of B of 10 % from which on "equal bends are possible" is said."""

_TYPE: Final = f"coalesce(b.boat_type, '{UNKNOWN_TYPE}')"


def audit(store: Store, names: Sequence[str], method: str | None = None) -> Report:
    """The page of a boat, or of one or two types.

    Args:
        store: where the database lies.
        names: an FSN number, or one or two names of types; case and blanks do not matter.
        method: show this method only.

    Returns:
        The report of `_boat_page` or `_types_page`, with `about`: boat or types.

    Raises:
        MissingKnowledgeError: there is no such boat, type or method, or no database.
    """
    with open_database(store.database) as db:
        methods = _methods(db, method)
        boats = _boats_named(db, names[0]) if len(names) == 1 else []
        if boats:
            page = {"about": "boat"} | _boat_page(db, boats[0], methods)
        else:
            types = list(dict.fromkeys(_type_named(db, name) for name in names))
            chosen = methods if method else _usual(methods)
            page = {"about": "types"} | _types_page(db, types, chosen)
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
    query = f"SELECT {_TYPE} AS boat_type, count(*) AS n FROM boats AS b GROUP BY ALL ORDER BY ALL"  # noqa: S608
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


# A type ------------------------------------------------------------------------------------------


def _types_page(db: duckdb.DuckDBPyConnection, types: list[str], methods: list[str]) -> Report:
    return {
        "methods": methods,
        "types": [
            _type_facts(db, name) | {"under": {m: _type_under(db, name, m) for m in methods}}
            for name in types
        ],
        "fleet": {method: _fleet(db, method) for method in methods},
    }


def _type_facts(db: duckdb.DuckDBPyConnection, boat_type: str) -> Report:
    """How many boats and tows there are of a type, and how they differ."""
    return rows(
        db,
        f"""SELECT {_TYPE} AS boat_type, count(DISTINCT b.fsn_no) AS n_boats,
                   count(DISTINCT t.fsn_no) AS n_towed, count(t.tow_id) AS n_tows,
                   min(t.season) AS first_season, max(t.season) AS last_season,
                   min(t.weight_kg) AS lightest_kg, max(t.weight_kg) AS heaviest_kg,
                   min(t.declared_speed_m_s) AS slowest_m_s,
                   max(t.declared_speed_m_s) AS fastest_m_s
            FROM boats AS b LEFT JOIN tows AS t USING (fsn_no)
            WHERE {_TYPE} = ? GROUP BY ALL""",  # noqa: S608
        boat_type,
    )[0]


def _type_under(db: duckdb.DuckDBPyConnection, boat_type: str, method: str) -> Report:
    """All statistics of a type under one method."""
    own = (method, boat_type)
    return {
        "lines": [line | {"follows": _away_from_zero(line)} for line in rows(db, _LINES, *own)],
        "bends": _bends(_one(db, "type_homogeneity", *own)),
        "speed_trend": _trend(_one(db, "speed_trend", *own)),
        "shared": rows(db, _SHARED, *own),
        "judged": rows(db, _JUDGED, *own),
        "outside": rows(db, _OUTSIDE, *own),
        "slow_tows": rows(db, _SLOW, *own),
        "repeats": _repeats(rows(db, _PAIRS, *own)),
        "eras": [_era(db, *own, era.name) for era in ERAS[:-1]],
        "prediction": rows(db, _PREDICTION, *own)[0],
        "disagreeing": rows(db, _DISAGREEING, *own),
    }


def _one(db: duckdb.DuckDBPyConnection, table: str, method: str, boat_type: str) -> Report:
    """The one row of a method and type; there is none without a curve, or where types are asked."""
    query = f"SELECT * FROM {table} WHERE method = ? AND boat_type = ?"  # noqa: S608
    found = rows(db, query, method, boat_type)
    reason = "no_type" if boat_type == UNKNOWN_TYPE else "no_curves"
    return found[0] if found else {"n": 0, "reason": reason}


def _away_from_zero(line: Report) -> bool | None:
    """Whether the interval of a slope leaves out zero."""
    if line["slope"] is None:
        return None
    return bool(line["slope_lo"] > 0 or line["slope_hi"] < 0)


def _bends(test: Report) -> Report:
    """The test of equal bends with its verdict: None where it could not have seen a difference."""
    if test["reason"]:
        return test | {"equal_possible": None}
    different = test["p_value"] < LEVEL
    strong = (test["power_at_10pct"] or 0.0) >= ENOUGH_POWER
    return test | {"equal_possible": False if different else True if strong else None}


def _trend(trend: Report) -> Report:
    return trend | {"follows": None if trend["reason"] else _away_from_zero(trend)}


def _repeats(pairs: list[Report]) -> Report:
    """Repeat pairs of a type: how they spread, and how many disagree."""
    squares = [pair["ln_ratio"] ** 2 for pair in pairs]
    known = [abs(pair["e_n"]) for pair in pairs if pair["e_n"] is not None]
    return {
        "n_pairs": len(pairs),
        "sd_ratio": (sum(squares) / len(pairs) / 2) ** 0.5 if pairs else None,
        "n_e_n": len(known),
        "n_disagree": sum(e_n > 1 for e_n in known),
    }


def _era(db: duckdb.DuckDBPyConnection, method: str, boat_type: str, era: str) -> Report:
    """Whether an era stands apart; the table has no row where a type has no pair at all."""
    found = rows(db, _ERA, method, boat_type, era)
    if found:
        return found[0]
    return {"era": era, "n": 0, "apart": None, "reason": "few_pairs"}


def _fleet(db: duckdb.DuckDBPyConnection, method: str) -> Report:
    """What holds for all types together."""
    error = rows(db, "SELECT * FROM prediction_error WHERE method = ?", method)
    return {
        "reproducibility": rows(
            db, "SELECT * FROM reproducibility WHERE method = ? ORDER BY scope", method
        ),
        "components": rows(
            db,
            "SELECT * FROM variance_components WHERE method = ? AND scope = 'within_type' "
            "ORDER BY component",
            method,
        ),
        "eras": {row["era"]: row for row in rows(db, _ERAS_OF_ALL, method)},
        "prediction_error": error[0] if error else None,
    }


_LINES = """
SELECT * FROM type_consistency WHERE method = ? AND boat_type = ? ORDER BY quantity, explaining
"""

_SHARED = """
SELECT p.pooling, count(*) AS n, any_value(p.standard_speed_m_s) AS standard_speed_m_s,
       count(p.b_m_s) AS n_b, median(p.b_m_s) AS median_b_m_s,
       stddev_samp(p.b_m_s) / avg(p.b_m_s) AS b_sd_ratio,
       max(abs(ln(p.cw_085_kg_m / o.cw_085_kg_m))) AS most_085,
       max(abs(ln(p.cw_kg_m / o.cw_kg_m))) AS most_100,
       max(abs(ln(p.cw_115_kg_m / o.cw_115_kg_m))) AS most_115,
       arg_max(p.fsn_no, abs(ln(p.cw_115_kg_m / o.cw_115_kg_m))) AS most_fsn_no
FROM pooled_curves AS p JOIN pooled_curves AS o USING (method, tow_id)
WHERE o.pooling = 'own' AND method = ? AND p.boat_type = ? GROUP BY p.pooling ORDER BY p.pooling
"""

_JUDGED = """
SELECT quantity, count(*) AS n, count(DISTINCT fsn_no) AS n_boats,
       any_value(standard_speed_m_s) AS standard_speed_m_s
FROM type_outliers WHERE method = ? AND boat_type = ? GROUP BY quantity ORDER BY quantity
"""

_OUTSIDE = """
SELECT o.*, b.name FROM type_outliers AS o LEFT JOIN boats AS b USING (fsn_no)
WHERE o.method = ? AND o.boat_type = ? AND o.outside ORDER BY abs(deviation_sd) DESC, tow_id
"""

_SLOW = """
SELECT s.*, b.name FROM slow_tows AS s LEFT JOIN boats AS b USING (fsn_no)
WHERE s.method = ? AND s.boat_type = ? ORDER BY power_w, tow_id
"""

_PAIRS = f"""
SELECT p.* FROM repeat_pairs AS p JOIN boats AS b USING (fsn_no)
WHERE p.method = ? AND {_TYPE} = ? ORDER BY p.tow_id
"""  # noqa: S608

_ERA = "SELECT * FROM era_shifts WHERE method = ? AND boat_type = ? AND era = ?"

_ERAS_OF_ALL = """
SELECT * FROM era_shifts WHERE method = ? AND boat_type = 'all' ORDER BY era
"""

_PREDICTION = """
SELECT count(*) AS n, count(predicted_cw_kg_m) AS n_predicted,
       sqrt(avg(ln_ratio * ln_ratio)) AS rmse_ratio, avg(ln_ratio) AS mean_ratio,
       sqrt(avg(cw_sd_ratio * cw_sd_ratio)) AS tow_sd_ratio,
       count(*) FILTER (WHERE disagrees) AS n_disagree
FROM predicted_cw WHERE method = ? AND boat_type = ?
"""

_DISAGREEING = """
SELECT p.*, b.name FROM predicted_cw AS p LEFT JOIN boats AS b USING (fsn_no)
WHERE p.method = ? AND p.boat_type = ? AND p.disagrees ORDER BY abs(ln_ratio) DESC, tow_id
"""


# A boat ------------------------------------------------------------------------------------------


def _boat_page(db: duckdb.DuckDBPyConnection, boat: Report, methods: list[str]) -> Report:
    """A boat's tows step by step, and its place among its like and in its own history."""
    fsn_no = boat["fsn_no"]
    return {
        "boat": boat,
        "methods": methods,
        "tows": [_tow(db, tow, methods) for tow in rows(db, _TOWS, fsn_no)],
        "in_type": _of_boat(db, "type_outliers", fsn_no, methods),
        "type_size": _type_facts(db, boat["boat_type"] or UNKNOWN_TYPE),
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
    """A tow with its curves, the runs behind each, and what each step of a correction did."""
    tow_id = tow["tow_id"]
    curves = rows(db, _CURVES, tow_id, methods)
    for curve in curves:
        curve["run_points"] = rows(db, _RUN_POINTS, tow_id, curve["method"])
    return tow | {"curves": curves, "steps": rows(db, _STEPS, tow_id, methods, methods)}


_TOWS = "SELECT * FROM tows WHERE fsn_no = ? ORDER BY tow_date, tow_id"

_CURVES = "SELECT * FROM curves WHERE tow_id = ? AND list_contains(?, method) ORDER BY method"

_RUN_POINTS = "SELECT * FROM run_points WHERE tow_id = ? AND method = ? ORDER BY run"

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
