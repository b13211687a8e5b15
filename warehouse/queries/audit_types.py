"""Everything behind one or two types of boat, as plain data: figures, and verdicts on them.

A verdict is true, false, or None where the figures do not decide. What was asked for, and a boat's
own page, are `warehouse.queries.audit`'s.
"""

from dataclasses import dataclass
from math import hypot, log
from typing import Final

import duckdb

from pipeline.consistency.observed import UNKNOWN_TYPE
from pipeline.history import ERAS
from pipeline.tables.row import Row
from warehouse.store.database import is_simulated, rows

WEIGHT_LINE: Final = {"quantity": "cw_standard_kg_m", "explaining": "weight_kg", "within": "all"}
"""The line about which the level of a type is judged."""

TYPE: Final = f"coalesce(b.boat_type, '{UNKNOWN_TYPE}')"
"""A boat's type in a query that calls the table of boats b."""


@dataclass(frozen=True, kw_only=True)
class Audit:
    """What the page of a boat and that of types share.

    Attributes:
        simulated: whether the archive is.
        methods: the methods shown.
    """

    simulated: bool
    methods: list[str]


@dataclass(frozen=True)
class TypeStatistics:
    """All statistics of a type under one method.

    Attributes:
        lines: rows of `type_lines` with `follows`.
        bends: the row of `type_homogeneity`, or `n`, `reason` and `equal_possible`.
        speed_trend: the row of that table with `follows`, or `n` and `reason`.
        shared: per pooling, what sharing a bend does to B and Cw.
        repeats: how repeat pairs spread, how many have an E_n, and of how many it is above 1.
        eras: a row of `era_shifts` each, or `era`, `n`, `apart` and `reason`.
        prediction: how far `predicted_cw` is off.
        newest: rows of `compared_tows`, the newest of each crew.
        weight_line: the row of `type_lines` of their Cw against weight.
        hull_speed, tows_outside, outside, slow_tows: rows of their tables.
    """

    lines: list[Row]
    newest: list[Row]
    weight_line: list[Row]
    hull_speed: list[Row]
    tows_outside: list[Row]
    bends: Row
    speed_trend: Row
    shared: list[Row]
    outside: list[Row]
    slow_tows: list[Row]
    repeats: Row
    eras: list[Row]
    prediction: Row


@dataclass(frozen=True)
class OneType:
    """How many boats and tows there are of a type, how they differ, its statistics by method."""

    boat_type: str
    n_boats: int
    n_towed: int
    n_tows: int
    first_season: int | None
    last_season: int | None
    lightest_kg: float | None
    heaviest_kg: float | None
    slowest_m_s: float | None
    fastest_m_s: float | None
    under: dict[str, TypeStatistics]


@dataclass(frozen=True, kw_only=True)
class TypesAudit(Audit):
    """The page of types.

    Attributes:
        types: each of them.
        differences: what differs between them, by method.
        reproducibility: rows of that table, for all types together.
    """

    about: str = "types"
    types: list[OneType]
    differences: dict[str, list[str]]
    reproducibility: list[Row]


def types_audit(db: duckdb.DuckDBPyConnection, types: list[str], methods: list[str]) -> TypesAudit:
    """Facts and figures of the types under each method, what holds for all, and what differs."""
    audited = [
        OneType(
            **rows(db, _FACTS, name)[0],
            under={m: _type_under(db, name, m) for m in methods},
        )
        for name in types
    ]
    return TypesAudit(
        simulated=is_simulated(db),
        methods=methods,
        types=audited,
        differences={m: differences(*(one.under[m] for one in audited)) for m in methods},
        reproducibility=rows(db, _REPRODUCIBILITY, methods),
    )


def _type_under(db: duckdb.DuckDBPyConnection, boat_type: str, method: str) -> TypeStatistics:
    """All statistics of a type under one method."""
    found = {name: rows(db, query, method, boat_type) for name, query in _STATISTICS.items()}
    reason = "no_type" if boat_type == UNKNOWN_TYPE else "no_curves"
    absent = {"n": 0, "reason": reason, "equal_possible": None, "follows": None}
    no_era = {"n": 0, "apart": None, "reason": "few_pairs"}
    eras = {row["era"]: row for row in found.pop("eras")}
    bends, trend, repeats, prediction = (
        (found.pop(name) or [absent])[0]
        for name in ("bends", "speed_trend", "repeats", "prediction")
    )
    return TypeStatistics(
        weight_line=[row for row in found["lines"] if row.items() >= WEIGHT_LINE.items()],
        bends=bends,
        speed_trend=trend,
        repeats=repeats,
        prediction=prediction,
        eras=[eras.get(era.name, {"era": era.name} | no_era) for era in ERAS[:-1]],
        **found,
    )


def differences(first: TypeStatistics, *others: TypeStatistics) -> list[str]:
    """What differs between two types: a slope or shift by more than both intervals, or a verdict.

    One that follows weight and one in which no trend is seen do not differ by that alone.

    Returns:
        `quantity explaining` of lines, `speed_trend`, the names of eras, `bends`; of one type,
        nothing.
    """
    found = []
    for second in others:
        own, other = _intervals(first), _intervals(second)
        found += [name for name in own if name in other and apart(own[name], other[name])]
        if {first.bends["equal_possible"], second.bends["equal_possible"]} == {True, False}:
            found.append("bends")
    return found


def _intervals(under: TypeStatistics) -> dict[str, tuple[float, float, float]]:
    """Every slope and shift with its interval; shifts as logarithms."""
    lines = (line for line in under.lines if line["within"] == "all")
    slopes = {f"{line['quantity']} {line['explaining']}": line for line in lines}
    slopes["speed_trend"] = under.speed_trend
    intervals = {
        name: (line["slope"], line["slope_lo"], line["slope_hi"])
        for name, line in slopes.items()
        if not line["reason"]
    }
    return intervals | {
        era["era"]: (log(era["shift_ratio"]), log(era["lo"]), log(era["hi"]))
        for era in under.eras
        if not era["reason"]
    }


def apart(one: tuple[float, float, float], other: tuple[float, float, float]) -> bool:
    """Whether two numbers, each with its interval, differ by more than both (root sum square)."""
    return abs(one[0] - other[0]) > hypot(*(0.5 * (hi - lo) for _, lo, hi in (one, other)))


_FACTS = f"""
SELECT {TYPE} AS boat_type, count(DISTINCT b.fsn_no) AS n_boats,
       count(DISTINCT t.fsn_no) AS n_towed, count(t.tow_id) AS n_tows,
       min(t.season) AS first_season, max(t.season) AS last_season,
       min(t.weight_kg) AS lightest_kg, max(t.weight_kg) AS heaviest_kg,
       min(t.declared_speed_m_s) AS slowest_m_s, max(t.declared_speed_m_s) AS fastest_m_s
FROM boats AS b LEFT JOIN tows AS t USING (fsn_no) WHERE {TYPE} = ? GROUP BY ALL
"""  # noqa: S608

_FOLLOWS = "CASE WHEN slope IS NOT NULL THEN slope_lo > 0 OR slope_hi < 0 END AS follows"
"""Whether the interval of a slope leaves out zero."""

_LINES = f"""
SELECT * EXCLUDE tows, {_FOLLOWS} FROM type_lines
WHERE method = ? AND boat_type = ? AND tows = 'newest'
ORDER BY quantity, explaining, within
"""  # noqa: S608

_TREND = f"SELECT *, {_FOLLOWS} FROM speed_trend WHERE method = ? AND boat_type = ?"  # noqa: S608

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

_REPEATS = f"""
SELECT count(*) AS n_pairs, sqrt(avg(p.ln_ratio * p.ln_ratio) / 2) AS sd_ratio,
       count(p.e_n) AS n_e_n, count(*) FILTER (WHERE abs(p.e_n) > 1) AS n_disagree
FROM repeat_pairs AS p JOIN boats AS b USING (fsn_no) WHERE p.method = ? AND {TYPE} = ?
"""  # noqa: S608

_PREDICTION = """
SELECT count(*) AS n, count(predicted_cw_kg_m) AS n_predicted,
       sqrt(avg(ln_ratio * ln_ratio)) AS rmse_ratio, avg(ln_ratio) AS mean_ratio,
       sqrt(avg(cw_sd_ratio * cw_sd_ratio)) AS tow_sd_ratio,
       count(*) FILTER (WHERE disagrees) AS n_disagree
FROM predicted_cw WHERE method = ? AND boat_type = ?
"""

_NAMED = """
SELECT t.*, b.name FROM {} AS t LEFT JOIN boats AS b USING (fsn_no)
WHERE t.method = ? AND t.boat_type = ? AND t.{} ORDER BY {}, tow_id
"""
"""Rows of tows for which a column says yes, with the boat's name."""

_STATISTICS: Final = {
    "lines": _LINES,
    "hull_speed": "SELECT * FROM hull_speed WHERE method = ? AND boat_type = ?",
    "tows_outside": _NAMED.format("compared_tows", "outside", "abs(deviation_sd) DESC"),
    "newest": _NAMED.format("compared_tows", "newest", "fsn_no"),
    "bends": "SELECT * FROM type_homogeneity WHERE method = ? AND boat_type = ?",
    "speed_trend": _TREND,
    "shared": _SHARED,
    "outside": _NAMED.format("type_outliers", "outside", "abs(deviation_sd) DESC"),
    "slow_tows": _NAMED.format("slow_tows", "slow", "power_w"),
    "repeats": _REPEATS,
    "eras": "SELECT * FROM era_shifts WHERE method = ? AND boat_type = ?",
    "prediction": _PREDICTION,
}
"""What is asked of a method and type, by the part of `TypeStatistics`."""

_REPRODUCIBILITY = """
SELECT * FROM reproducibility WHERE list_contains(?, method) ORDER BY method, scope
"""
