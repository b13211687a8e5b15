"""Whether the boats of a type are equal, and what B, A and Cw follow: rows of `type_consistency`.

Every sentence is one row of that table in words; nothing is judged here.
"""

from collections.abc import Iterable, Mapping, Sequence
from math import floor, log10
from types import MappingProxyType
from typing import Final

from dashboards import labels
from dashboards.statements import Number, Statement, Value, told
from pipeline.messages import Sentence, say
from pipeline.tables.row import Row

TABLE: Final = "type_consistency"

QUANTITIES: Final = {
    "cw_standard_kg_m": say("Cw at {speed} m/s"),
    "b_m_s": say("B"),
    "a_kg_m": say("A"),
}
"""Quantities in the order in which they are told."""

EQUALITY: Final = {
    "equal": say(
        "{name}: equal. The {n_boats} boats ({n} tows) differ by {spread} %, at most {upper} %; "
        "what matters is {matters} %."
    ),
    "differ": say(
        "{name}: not equal. The {n_boats} boats ({n} tows) differ by {spread} % ({lower} to "
        "{upper} %) beyond weight, tow speed and the measuring error ({error} %); what matters is "
        "{matters} %."
    ),
    "differ without bound": say(
        "{name}: not equal. The {n_boats} boats ({n} tows) differ by {spread} % (at least {lower} "
        "%) beyond weight, tow speed and the measuring error ({error} %); what matters is "
        "{matters} %."
    ),
    "open": say(
        "{name}: cannot be told. The {n_boats} boats ({n} tows) may differ by up to {upper} %; "
        "what matters is {matters} %, the measuring error is {error} %."
    ),
    "open without bound": say(
        "{name}: cannot be told. The {n_boats} boats ({n} tows) are too few to say how far they "
        "differ; what matters is {matters} %, the measuring error is {error} %."
    ),
}
"""What is said of the spread between boats, by its verdict."""

SHORT: Final = {
    "equal": say("equal: {spread} %, at most {upper} %"),
    "differ": say("not equal: {spread} % ({lower} to {upper} %)"),
    "differ without bound": say("not equal: {spread} %, at least {lower} %"),
    "open": say("cannot be told: at most {upper} %"),
    "open without bound": say("cannot be told"),
}
"""The same in a cell of a table."""

OTHER_CAUSES: Final = {
    "cw_standard_kg_m": say(
        " Or tows were pulled askew, or boats altered without a report ({pairs} pairs of repeat "
        "tows give the measuring error)."
    ),
    "b_m_s": say(
        " Or the zero of the load cell, or a log that is not proportional to speed, moved more "
        "from tow to tow than in the {pairs} pairs of repeat tows."
    ),
    "a_kg_m": say(
        " Or the zero of the load cell, or a log that is not proportional to speed, moved more "
        "from tow to tow than in the {pairs} pairs of repeat tows."
    ),
}
"""What else may make boats differ, by the quantity."""

SLOPES: Final = {
    "rises": say("rises {slope} % ({low} to {high})"),
    "falls": say("falls {slope} % ({low} to {high})"),
    "none": say("no trend: {slope} % ({low} to {high})"),
    "open": say("cannot be told: {slope} % ({low} to {high})"),
}
TERMS: Final = {
    "weight": say("Per 100 kg of weight"),
    "tow_speed": say("Per 0.1 m/s of tow speed, within a class"),
}
"""What a slope is on, with its heading."""

RELATIONS: Final = {
    ("weight", "rises"): say("{quantity} rises with weight"),
    ("weight", "falls"): say("{quantity} falls with weight"),
    ("weight", "none"): say("{quantity} does not follow weight"),
    ("weight", "open"): say("Whether {quantity} follows weight cannot be told"),
    ("tow_speed", "rises"): say("{quantity} rises with tow speed"),
    ("tow_speed", "falls"): say("{quantity} falls with tow speed"),
    ("tow_speed", "none"): say("{quantity} does not follow tow speed"),
    ("tow_speed", "open"): say("Whether {quantity} follows tow speed cannot be told"),
}
"""The finding of a chart, by what it is against and the verdict."""

NO_RELATION: Final = {
    "weight": say("{quantity} against weight: {reason}"),
    "tow_speed": say("{quantity} against tow speed: {reason}"),
}

HEADINGS: Final[list[Sentence]] = [
    say("Equal?"),
    say("Farthest from what the others predict"),
    *TERMS.values(),
    say("Women / men"),
    say("B / hull speed"),
]
"""Headings of `describe_row`."""

Names = Mapping[str, str]
"""Names of boats by their number."""

NO_NAMES: Final[Names] = MappingProxyType({})


def order_rows(rows: Iterable[Row]) -> list[Row]:
    """Return rows of `type_consistency` in the order in which quantities are told."""
    quantities = list(QUANTITIES)
    return sorted(rows, key=lambda row: quantities.index(row["quantity"]))


def sum_up_type(rows: Iterable[Row]) -> Statement:
    """Return the verdicts on a type in one line, from its rows under one method."""
    verdicts: list[Value] = [
        told(
            "verdict",
            say("{quantity}: {word}"),
            {},
            TABLE,
            quantity=labels.code(row["quantity"]),
            verdict=row["verdict"],
            word=labels.code(row["verdict"]),
        )
        for row in order_rows(rows)
    ]
    return told("type_verdict", say("{verdicts}"), {}, TABLE, verdicts=verdicts)


def judge_type(
    rows: Iterable[Row], tows: Iterable[Row] = (), names: Names = NO_NAMES
) -> list[Statement]:
    """Return what is said of a type under one method: a statement per quantity.

    Args:
        rows: its rows of `type_consistency`.
        tows: rows of `compared_tows` that stand out, with what could explain them.
        names: of boats.
    """
    outside = list(tows)
    return [_judge_quantity(row, outside, names) for row in order_rows(rows)]


def _judge_quantity(row: Row, tows: Sequence[Row], names: Names) -> Statement:
    return told(
        "equality",
        say("{equality}{causes}{farthest}{outside}"),
        {},
        TABLE,
        verdict=row["verdict"],
        equality=describe_equality(row),
        causes=_name_other_causes(row),
        farthest=_name_farthest(row, names),
        outside=_name_outside(row, tows, names),
    )


def describe_equality(row: Row, wordings: Mapping[str, Sentence] = EQUALITY) -> Statement:
    """Return whether the boats of a type are equal in one quantity.

    Args:
        row: of `type_consistency`.
        wordings: `EQUALITY`, or `SHORT` for a cell of a table.
    """
    verdict = row["verdict"]
    speed = Number(row["standard_speed_m_s"], unit="m/s")
    name = told("quantity", QUANTITIES[row["quantity"]], speed=speed)
    if verdict not in ("equal", "differ", "open"):
        wording = say("{name}: nothing is said ({reason}; {n_boats} boats, {n} tows).")
        short = say("{reason}")
        return told(
            "spread",
            wording if wordings is EQUALITY else short,
            row,
            TABLE,
            verdict=verdict,
            name=name,
            reason=labels.code(verdict),
        )
    known = verdict if row["spread_hi"] is not None else f"{verdict} without bound"
    return told(
        "spread",
        wordings[known],
        row,
        TABLE,
        verdict=verdict,
        name=name,
        spread=_percent(row["spread_ratio"]),
        lower=_percent(row["spread_lo"]),
        upper=_percent(row["spread_hi"]),
        error=_percent(row["error_ratio"]),
        matters=_percent(row["difference_that_matters"]),
    )


def _name_other_causes(row: Row) -> Value:
    if row["verdict"] != "differ":
        return ""
    wording = OTHER_CAUSES[row["quantity"]]
    return told("other_causes", wording, {}, TABLE, pairs=row["repeat_pairs"])


def _name_farthest(row: Row, names: Names) -> Value:
    if row["farthest"] is None:
        return ""
    farthest = describe_farthest(row, names)
    return told(
        "farthest_boat",
        say(" Farthest from what the others predict: {farthest}."),
        farthest=farthest,
    )


def describe_farthest(row: Row, names: Names = NO_NAMES) -> Statement:
    """Return the boat farthest from what the others predict, with its size."""
    if row["farthest"] is None:
        return told("farthest", say("-"), verdict="not known")
    off, low, high = (100.0 * (row[f"farthest_ratio{end}"] - 1.0) for end in ("", "_lo", "_hi"))
    return told(
        "farthest",
        say("{boat} {off} % ({low} to {high})"),
        {},
        TABLE,
        boat=_name_boat(row["farthest"], names),
        off=Number(off, 1, "%", low, high, "+"),
        low=Number(low, 1, "%", sign="+"),
        high=Number(high, 1, "%", sign="+"),
    )


def _name_outside(row: Row, tows: Sequence[Row], names: Names) -> Value:
    """Return which boats stand out, with what may explain it, and the verdict without them."""
    if row["verdict"] not in ("equal", "differ", "open"):
        return ""
    if not row["outside"]:
        return say(" No boat stands out.")
    boats: list[Value] = []
    for fsn_no in row["outside"]:
        codes = [code for tow in tows if tow["fsn_no"] == fsn_no for code in tow["candidates"]]
        causes: list[Value] = [labels.candidate(code) for code in dict.fromkeys(codes)]
        wording = say("{boat} ({causes})") if causes else say("{boat}")
        boats.append(told("boat_outside", wording, boat=_name_boat(fsn_no, names), causes=causes))
    return told(
        "outside",
        say(" These stand out: {boats}; without them: {rest}."),
        {},
        TABLE,
        "compared_tows",
        verdict=row["rest_verdict"],
        boats=boats,
        rest=labels.code(row["rest_verdict"]),
    )


def _name_boat(fsn_no: str, names: Names) -> str:
    """Return the name and number of a boat."""
    return f"{names[fsn_no]} {fsn_no}" if names.get(fsn_no) else fsn_no


def describe_row(row: Row, names: Names = NO_NAMES) -> list[Statement]:
    """Return a row in words, in the order of `HEADINGS`."""
    return [
        describe_equality(row, SHORT),
        describe_farthest(row, names),
        *(describe_slope(row, term) for term in TERMS),
        describe_classes(row),
        describe_hull_speed(row),
    ]


def describe_slope(row: Row, term: str) -> Statement:
    """Return how a quantity follows weight or tow speed, in per cent of the quantity.

    Args:
        row: of `type_consistency`.
        term: `weight` or `tow_speed`.
    """
    verdict = row[f"{term}_verdict"]
    if verdict not in SLOPES:
        reason = labels.code(verdict)
        return told("slope", say("{reason}"), {}, TABLE, verdict="not known", reason=reason)
    slope, low, high = (100.0 * row[f"{term}_slope{end}"] for end in ("", "_lo", "_hi"))
    digits = max(0, 1 - floor(log10(max(abs(low), abs(high)) or 1.0)))  # two that say something
    statement = told(
        "slope",
        SLOPES[verdict],
        {},
        TABLE,
        verdict=verdict,
        slope=Number(slope, digits, "%", low, high),
        low=Number(low, digits, "%"),
        high=Number(high, digits, "%"),
    )
    if term == "weight" and row["weight_r2"] is not None:
        wording, r2 = say("{slope}; R² {r2}"), Number(row["weight_r2"], unit="1")
        statement = told("slope", wording, {}, TABLE, verdict=verdict, slope=statement, r2=r2)
    if row[f"{term}_n"] != row["n"]:  # without boats that stand out
        statement = told(
            "slope",
            say("{slope}; {n} tows, {n_boats} boats"),
            {},
            TABLE,
            verdict=verdict,
            slope=statement,
            n=row[f"{term}_n"],
            n_boats=row[f"{term}_n_boats"],
        )
    return statement


def name_relation(row: Row, term: str) -> Sentence:
    """Return the finding of a chart of a quantity against weight or tow speed, as its title."""
    quantity, verdict = labels.code(row["quantity"]), row[f"{term}_verdict"]
    if verdict not in SLOPES:
        return say(NO_RELATION[term], quantity=quantity, reason=labels.code(verdict))
    return say(RELATIONS[term, verdict], quantity=quantity)


def describe_classes(row: Row) -> Statement:
    """Return the quantity of women's crews over that of men's, with its interval."""
    if row["women_ratio"] is None:
        return told("classes", say("one class"), {}, TABLE, verdict="not known")
    ratio, low, high = (row[f"women_ratio{end}"] for end in ("", "_lo", "_hi"))
    return told(
        "classes",
        say("{ratio} ({low} to {high}; {n_women} and {n_men} tows)"),
        row,
        TABLE,
        ratio=Number(ratio, 2, "1", low, high),
        low=Number(low, 2, "1"),
        high=Number(high, 2, "1"),
    )


def describe_hull_speed(row: Row) -> Statement:
    """Return B over hull speed: the median of the boats, with its interval."""
    if row["hull_ratio"] is None:
        return told("hull_speed", say("-"), {}, TABLE, verdict="not known")
    ratio, low, high = (row[f"hull_ratio{end}"] for end in ("", "_lo", "_hi"))
    return told(
        "hull_speed",
        say("{ratio} ({low} to {high})"),
        {},
        TABLE,
        ratio=Number(ratio, 2, "1", low, high),
        low=Number(low, 2, "1"),
        high=Number(high, 2, "1"),
    )


def _percent(ratio: float | None) -> Value:
    """Return a ratio as a per cent with one digit; nothing known is a dash."""
    return "-" if ratio is None else Number(100.0 * ratio, 1, "%")
