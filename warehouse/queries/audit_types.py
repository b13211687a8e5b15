"""Everything behind one or two types of boat, as plain data: figures, and verdicts on them.

A verdict is true, false, or None where the figures do not decide. What was asked for, and a boat's
own page, are `warehouse.queries.audit`'s.
"""

from dataclasses import dataclass
from math import hypot, log
from typing import Final

import duckdb
import scipy

from pipeline.consistency.eras import ERAS
from pipeline.consistency.homogeneity import LEVEL
from pipeline.consistency.observed import UNKNOWN_TYPE
from pipeline.tables.row import Row
from warehouse.store.database import is_simulated, rows

ENOUGH_POWER: Final = 0.8
"""Chance of seeing a spread of B of 10 % from which on "equal bends are possible" is said."""

TYPE: Final = f"coalesce(b.boat_type, '{UNKNOWN_TYPE}')"
"""A boat's type in a query that calls the table of boats b."""


@dataclass(frozen=True, kw_only=True)
class Audit:
    """What the page of a boat and that of types share.

    Attributes:
        simulated: whether the archive is.
        statistics_over: the tows that statistics of types are over; see `chosen_tows`.
        methods: the methods shown.
    """

    simulated: bool
    statistics_over: str
    methods: list[str]


@dataclass(frozen=True)
class TypeFacts:
    """How many boats and tows there are of a type, and how they differ."""

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


@dataclass(frozen=True)
class Closest:
    """Whether Cw at one speed spreads less about the line on weight than A and than B."""

    n: int
    cw_closest: bool | None
    reason: str


@dataclass(frozen=True)
class Repeats:
    """How repeat pairs of a type spread, how many have an E_n, and of how many it is above 1."""

    n_pairs: int
    sd_ratio: float | None
    n_e_n: int
    n_disagree: int


@dataclass(frozen=True)
class TypeStatistics:
    """All statistics of a type under one method.

    Attributes:
        lines: rows of `type_consistency` with `follows`.
        all_tows: rows of `type_lines` over all tows with `follows`.
        bends: the row of `type_homogeneity` with `equal_possible`, or `n` and `reason`.
        speed_trend: the row of that table with `follows`, or `n` and `reason`.
        shared: per pooling, what sharing a bend does to B and Cw.
        judged: per quantity, how many tows were judged.
        eras: a row of `era_shifts` each, or `era`, `n`, `apart` and `reason`.
        prediction: how far `predicted_cw` is off.
        hull_speed, tows_outside, outside, slow_tows, disagreeing: rows of their tables.
    """

    lines: list[Row]
    closest: Closest
    all_tows: list[Row]
    hull_speed: list[Row]
    tows_outside: list[Row]
    bends: Row
    speed_trend: Row
    shared: list[Row]
    judged: list[Row]
    outside: list[Row]
    slow_tows: list[Row]
    repeats: Repeats
    eras: list[Row]
    prediction: Row
    disagreeing: list[Row]


@dataclass(frozen=True)
class OneType(TypeFacts):
    """A type, with its statistics under each method."""

    under: dict[str, TypeStatistics]


@dataclass(frozen=True)
class Fleet:
    """What holds for all types together under a method: rows of the tables, eras by name."""

    reproducibility: list[Row]
    components: list[Row]
    eras: dict[str, Row]
    prediction_error: Row | None


@dataclass(frozen=True, kw_only=True)
class TypesAudit(Audit):
    """The page of types: each, what differs between them, and all types, by method."""

    about: str = "types"
    types: list[OneType]
    differences: dict[str, list[str]]
    fleet: dict[str, Fleet]


def types_audit(
    db: duckdb.DuckDBPyConnection, types: list[str], methods: list[str], tows: str
) -> TypesAudit:
    """Facts and figures of the types under each method, what holds for all, and what differs."""
    audited = [
        OneType(**vars(type_facts(db, name)), under={m: _type_under(db, name, m) for m in methods})
        for name in types
    ]
    return TypesAudit(
        simulated=is_simulated(db),
        statistics_over=tows,
        methods=methods,
        types=audited,
        differences={m: differences(*(one.under[m] for one in audited)) for m in methods},
        fleet={method: _fleet(db, method) for method in methods},
    )


def type_facts(db: duckdb.DuckDBPyConnection, boat_type: str) -> TypeFacts:
    """How many boats and tows there are of a type, and how they differ."""
    (facts,) = rows(
        db,
        f"""SELECT {TYPE} AS boat_type, count(DISTINCT b.fsn_no) AS n_boats,
                   count(DISTINCT t.fsn_no) AS n_towed, count(t.tow_id) AS n_tows,
                   min(t.season) AS first_season, max(t.season) AS last_season,
                   min(t.weight_kg) AS lightest_kg, max(t.weight_kg) AS heaviest_kg,
                   min(t.declared_speed_m_s) AS slowest_m_s,
                   max(t.declared_speed_m_s) AS fastest_m_s
            FROM boats AS b LEFT JOIN tows AS t USING (fsn_no)
            WHERE {TYPE} = ? GROUP BY ALL""",  # noqa: S608
        boat_type,
    )
    return TypeFacts(**facts)


def _type_under(db: duckdb.DuckDBPyConnection, boat_type: str, method: str) -> TypeStatistics:
    """All statistics of a type under one method."""
    own = (method, boat_type)
    lines = rows(db, _LINES, *own)
    return TypeStatistics(
        lines=[_judged_line(line) for line in lines],
        closest=closest(lines),
        all_tows=[_judged_line(line) for line in rows(db, _ALL_TOWS, *own)],
        hull_speed=rows(db, _HULL_SPEED, *own),
        tows_outside=_named(db, "compared_tows", "outside", _FURTHEST, *own),
        bends=_bends(_one(db, "type_homogeneity", *own)),
        speed_trend=_trend(_one(db, "speed_trend", *own)),
        shared=rows(db, _SHARED, *own),
        judged=rows(db, _JUDGED, *own),
        outside=_named(db, "type_outliers", "outside", _FURTHEST, *own),
        slow_tows=_named(db, "slow_tows", "slow", "power_w", *own),
        repeats=_repeats(rows(db, _PAIRS, *own)),
        eras=[_era(db, *own, era.name) for era in ERAS[:-1]],
        prediction=rows(db, _PREDICTION, *own)[0],
        disagreeing=_named(db, "predicted_cw", "disagrees", "abs(ln_ratio) DESC", *own),
    )


_FURTHEST: Final = "abs(deviation_sd) DESC"


def _named(
    db: duckdb.DuckDBPyConnection, table: str, which: str, order: str, method: str, boat_type: str
) -> list[Row]:
    """Rows of a method and type for which a column says yes, with the boat's name."""
    query = f"""
        SELECT t.*, b.name FROM {table} AS t LEFT JOIN boats AS b USING (fsn_no)
        WHERE t.method = ? AND t.boat_type = ? AND t.{which} ORDER BY {order}, tow_id"""  # noqa: S608
    return rows(db, query, method, boat_type)


def _one(db: duckdb.DuckDBPyConnection, table: str, method: str, boat_type: str) -> Row:
    """The one row of a method and type; there is none without a curve, or where types are asked."""
    query = f"SELECT * FROM {table} WHERE method = ? AND boat_type = ?"  # noqa: S608
    matching = rows(db, query, method, boat_type)
    reason = "no_type" if boat_type == UNKNOWN_TYPE else "no_curves"
    return matching[0] if matching else {"n": 0, "reason": reason}


def _judged_line(line: Row) -> Row:
    """A line with its verdict: whether the interval of its slope leaves out zero."""
    follows = None if line["slope"] is None else line["slope_lo"] > 0 or line["slope_hi"] < 0
    return line | {"follows": follows}


def closest(lines: list[Row]) -> Closest:
    """Whether Cw at one speed spreads less about the line on weight than A and than B.

    `cw_closest` is None where the variances differ no more than an F test at 5 % lets them. The
    three come from the same runs, so the test is on the safe side.
    """
    on_weight = {line["quantity"]: line for line in lines if line["explaining"] == "weight_kg"}
    unknown = {"n": 0, "reason": "no_curves"}
    three = [on_weight.get(name, unknown) for name in ("cw_standard_kg_m", "a_kg_m", "b_m_s")]
    for line in three:
        if line["reason"]:
            return Closest(line["n"], None, line["reason"])
    cw, a, b = ((line["n_boats"] - 2, line["residual_sd_ratio"] ** 2) for line in three)
    closer = all(_larger(other, cw) for other in (a, b))
    further = any(_larger(cw, other) for other in (a, b))
    verdict = False if further else True if closer else None
    return Closest(min(line["n"] for line in three), verdict, "")


def _larger(one: tuple[int, float], other: tuple[int, float]) -> bool:
    """Whether a variance, with its degrees of freedom, is larger than another at 5 %."""
    dof = max(one[0], 1), max(other[0], 1)
    return one[1] > float(scipy.special.fdtri(*dof, 1.0 - LEVEL)) * other[1]


def _bends(test: Row) -> Row:
    """The test of equal bends with its verdict: None where it could not have seen a difference."""
    if test["reason"]:
        return test | {"equal_possible": None}
    different = test["p_value"] < LEVEL
    strong = (test["power_at_10pct"] or 0.0) >= ENOUGH_POWER
    return test | {"equal_possible": False if different else True if strong else None}


def _trend(trend: Row) -> Row:
    return trend | {"follows": None} if trend["reason"] else _judged_line(trend)


def _repeats(pairs: list[Row]) -> Repeats:
    squares = [pair["ln_ratio"] ** 2 for pair in pairs]
    known = [abs(pair["e_n"]) for pair in pairs if pair["e_n"] is not None]
    return Repeats(
        n_pairs=len(pairs),
        sd_ratio=(sum(squares) / len(pairs) / 2) ** 0.5 if pairs else None,
        n_e_n=len(known),
        n_disagree=sum(e_n > 1 for e_n in known),
    )


def _era(db: duckdb.DuckDBPyConnection, method: str, boat_type: str, era: str) -> Row:
    """Whether an era stands apart; the table has no row where a type has no pair at all."""
    matching = rows(db, _ERA, method, boat_type, era)
    if matching:
        return matching[0]
    return {"era": era, "n": 0, "apart": None, "reason": "few_pairs"}


def differences(first: TypeStatistics, *others: TypeStatistics) -> list[str]:
    """What differs between two types: a slope or shift by more than both intervals, or a verdict.

    One that follows weight and one in which no trend is seen do not differ by that alone.

    Returns:
        `quantity explaining` of lines, `speed_trend`, the names of eras, `bends`, `closest`; of one
        type, nothing.
    """
    return [name for second in others for name in _differing(first, second)]


def _differing(first: TypeStatistics, second: TypeStatistics) -> list[str]:
    intervals = [_intervals(first), _intervals(second)]
    verdicts = [
        {"bends": one.bends["equal_possible"], "closest": one.closest.cw_closest}
        for one in (first, second)
    ]
    apart = [n for n in intervals[0] if n in intervals[1] and _apart(*(i[n] for i in intervals))]
    return apart + [n for n in verdicts[0] if {v[n] for v in verdicts} == {True, False}]


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
    shifts = {era["era"]: era for era in under.eras if not era["reason"]}
    return intervals | {
        name: (log(era["shift_ratio"]), log(era["lo"]), log(era["hi"]))
        for name, era in shifts.items()
    }


def _apart(one: tuple[float, float, float], other: tuple[float, float, float]) -> bool:
    half = hypot(*(0.5 * (hi - lo) for _, lo, hi in (one, other)))
    return abs(one[0] - other[0]) > half


def _fleet(db: duckdb.DuckDBPyConnection, method: str) -> Fleet:
    error = rows(db, "SELECT * FROM prediction_error WHERE method = ?", method)
    return Fleet(
        reproducibility=rows(
            db, "SELECT * FROM reproducibility WHERE method = ? ORDER BY scope", method
        ),
        components=rows(
            db,
            "SELECT * FROM variance_components WHERE method = ? AND scope = 'within_type' "
            "ORDER BY component",
            method,
        ),
        eras={row["era"]: row for row in rows(db, _ERAS_OF_ALL, method)},
        prediction_error=error[0] if error else None,
    )


_LINES = """
SELECT * FROM type_consistency WHERE method = ? AND boat_type = ?
ORDER BY quantity, explaining, within
"""

_ALL_TOWS = """
SELECT * FROM type_lines
WHERE method = ? AND boat_type = ? AND tows = 'all' AND explaining = 'weight_kg' ORDER BY quantity
"""

_HULL_SPEED = "SELECT * FROM hull_speed WHERE method = ? AND boat_type = ? AND tows = 'all'"

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

_PAIRS = f"""
SELECT p.* FROM repeat_pairs AS p JOIN boats AS b USING (fsn_no)
WHERE p.method = ? AND {TYPE} = ? ORDER BY p.tow_id
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
