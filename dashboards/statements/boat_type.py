"""Whether the boats of a type are equal: in the bend of their curves, and in level."""

from collections.abc import Iterable, Sequence
from math import floor, log10
from typing import Final, NamedTuple

import numpy as np
import polars as pl
import scipy

from dashboards import labels
from dashboards.statements import Number, Statement, Value, told
from pipeline.consistency.homogeneity import LEVEL
from pipeline.consistency.lines import LN_CW
from pipeline.messages import say
from pipeline.quantiles import NORMAL
from pipeline.tables.row import Row

BENDS: Final = {
    True: (
        "equal",
        say("No evidence that the curves of these {n} tows bend differently (p = {p})."),
    ),
    False: (
        "differ",
        say("The curves of these {n} tows differ in bend by more than noise explains (p = {p})."),
    ),
    None: (
        "cannot be told",
        say("The test is too weak to show whether the curves of these {n} tows bend differently."),
    ),
}
"""The verdict on the bends of a type and what is said of it, by `equal_possible`."""


def homogeneity(test: pl.DataFrame) -> Statement:
    """Whether the boats of a type have equal curves, as their row of `type_homogeneity` says."""
    if test.is_empty() or test["p_value"][0] is None:
        return told("bends", say("Too few boats to tell whether they are equal."))
    verdict, wording = BENDS[test["equal_possible"][0]]
    p = Number(test["p_value"][0], unit="")
    return told("bends", wording, {}, "homogeneity", verdict=verdict, n=test["n"][0], p=p)


def level(tows: pl.DataFrame, line: pl.DataFrame, outliers: pl.DataFrame) -> Statement:
    """Whether their Cw at one speed differs by more than weight and the uncertainty explain.

    The squared scatter about the weight line over that of the tows' own uncertainty is compared
    with chi-squared; tows of a season share part of it, so that the test is on the careful side.

    Args:
        tows: rows of `compared_tows` of a type under one method, the newest of each crew.
        line: their row of `type_lines` of Cw against weight, men and women together.
        outliers: their rows of `type_outliers`; those of Cw that are outside are named.
    """
    spread = None if line.is_empty() else line["residual_sd_ratio"][0]
    if spread is None:
        return told("level", say("Too few boats to compare their level."), verdict="few")
    known = tows.drop_nulls("cw_standard_kg_m")
    half = pl.col("cw_standard_hi_kg_m") - pl.col("cw_standard_lo_kg_m")
    ratio = known.select(half / (2 * NORMAL * pl.col("cw_standard_kg_m"))).to_series()
    noise = float(np.sqrt(np.mean(ratio.to_numpy() ** 2))) if ratio.null_count() == 0 else None
    dof = line["n"][0] - 2
    differ = noise is not None and scipy.special.chdtrc(dof, dof * (spread / noise) ** 2) < LEVEL
    wording = (
        say(
            "Not equal in level: at {speed} m/s Cw runs from {lowest} to {highest} kg/m; the {n} "
            "newest tows scatter {spread} % about their weight line, and their uncertainty "
            "explains {noise} %.{outside}"
        )
        if differ
        else say(
            "At {speed} m/s Cw runs from {lowest} to {highest} kg/m; the {n} newest tows scatter "
            "{spread} % about their weight line, no more than their uncertainty explains "
            "({noise} %).{outside}"
        )
        if noise is not None
        else say(
            "At {speed} m/s Cw runs from {lowest} to {highest} kg/m; the {n} newest tows scatter "
            "{spread} % about their weight line. Their uncertainty is not known.{outside}"
        )
    )
    cw = known["cw_standard_kg_m"].to_numpy()
    return told(
        "level",
        wording,
        {},
        "compared_tows",
        "type_lines",
        "type_outliers",
        verdict="not known" if noise is None else "differ" if differ else "equal",
        speed=Number(known["standard_speed_m_s"][0], unit="m/s"),
        lowest=Number(float(cw.min()), 1),
        highest=Number(float(cw.max()), 1),
        n=line["n"][0],
        spread=Number(100 * spread, 1, "%"),
        noise="" if noise is None else Number(100 * noise, 1, "%"),
        outside=_outside([row for row in outliers.to_dicts() if is_outside_in_cw(row)]),
    )


def is_outside_in_cw(row: Row) -> bool:
    """Return whether a row of `type_outliers` says that a boat stands out by its Cw."""
    return bool(row["outside"]) and row["quantity"] == LN_CW


def _outside(tows: list[Row]) -> Value:
    """Which boats stand out, with what may have caused it; nothing where none does."""
    if not tows:
        return ""
    named: list[Value] = [
        told(
            "boat_outside",
            say("{fsn_no} ({candidates})") if tow["candidates"] else say("{fsn_no}"),
            tow,
            candidates=list(map(labels.candidate, tow["candidates"])),
        )
        for tow in tows
    ]
    return told("outside", say(" These stand out: {boats}."), boats=named)


QUANTITIES: Final = ("b_m_s", "a_kg_m", "cw_standard_kg_m")
LINES: Final = {
    ("weight_kg", "all"): say("Per kg of weight"),
    ("declared_speed_m_s", "men"): say("Per m/s of tow speed, men"),
    ("declared_speed_m_s", "women"): say("Per m/s of tow speed, women"),
}
"""What a slope is on, and among which crews, with its heading."""
SPREAD: Final = say("Spread about the weight line")


class Slopes(NamedTuple):
    """How a quantity of a type follows weight and tow speed under a method.

    Attributes:
        quantity: its name as a code.
        n: tows of the weight line.
        slopes: in the order of `LINES`.
    """

    boat_type: str
    method: str
    quantity: str
    n: int
    slopes: Sequence[Statement]
    spread: Statement


def slopes(lines: Iterable[Row]) -> list[Slopes]:
    """The slopes of B, A and Cw at the standard speed, from rows of `type_lines` of one choice.

    Types and methods keep the order of the rows.
    """
    of: dict[tuple[str, str, str], dict[tuple[str, str], Row]] = {}
    for line in lines:
        if line["quantity"] in QUANTITIES:
            own = of.setdefault((line["boat_type"], line["quantity"], line["method"]), {})
            own[line["explaining"], line["within"]] = line
    of_weight = next(iter(LINES))
    found = [
        Slopes(
            boat_type,
            method,
            quantity,
            own[of_weight]["n"] if of_weight in own else 0,
            [slope(own.get(against)) for against in LINES],
            _spread(own.get(of_weight)),
        )
        for (boat_type, quantity, method), own in of.items()
    ]
    types = list(dict.fromkeys(one.boat_type for one in found))
    return sorted(found, key=lambda s: (types.index(s.boat_type), QUANTITIES.index(s.quantity)))


def slope(line: Row | None) -> Statement:
    """The slope of a line with its 95 % interval, and whether that leaves out zero."""
    if line is None or line["slope"] is None:
        reason = labels.code(line["reason"] if line else "few_boats")
        return told("slope", say("{reason}"), verdict="not known", reason=reason)
    low, high = line["slope_lo"], line["slope_hi"]
    wording, verdict = say("no trend: {slope} ({low} to {high})"), "none"
    if low > 0:
        wording, verdict = say("rises: {slope} ({low} to {high})"), "rises"
    elif high < 0:
        wording, verdict = say("falls: {slope} ({low} to {high})"), "falls"
    digits = max(0, 1 - floor(log10(max(abs(low), abs(high)) or 1.0)))  # two that say something
    slope = Number(line["slope"], digits, line["explaining"], low, high)
    ends = {"low": Number(low, digits), "high": Number(high, digits)}
    return told("slope", wording, {}, "type_lines", verdict=verdict, slope=slope, **ends)


def _spread(line: Row | None) -> Statement:
    """How far the tows lie from their line, and what share of their spread it explains."""
    if line is None or line["residual_sd_ratio"] is None:
        return told("spread", say("not known"), verdict="not known")
    spread = Number(100 * line["residual_sd_ratio"], 1, "%")
    if line["r2"] is None:
        return told("spread", say("{spread} %"), {}, "type_lines", spread=spread)
    wording, r2 = say("{spread} % (R² {r2})"), Number(line["r2"])
    return told("spread", wording, {}, "type_lines", spread=spread, r2=r2)
