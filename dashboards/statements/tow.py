"""A tow on the quay: its number, whether it was to be expected, and what to do now."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from dashboards import labels
from dashboards.statements import Number, Statement, told
from dashboards.statements.boat import interval
from pipeline.messages import say
from pipeline.tables.row import Row
from warehouse.queries.audit import apart

if TYPE_CHECKING:
    from warehouse.queries.assess import Assessment

RUN_OFF: Final = 0.03
"""A run further than this from the curve is better towed again (inferred)."""


def statements(tow: "Assessment", log_known: bool) -> list[Statement]:
    """The number first, then what was expected, then what to do.

    Args:
        log_known: whether intervals of the method hold the error of the log.
    """
    advice = list(_advice(tow))
    said = [*_number(tow, log_known), *_expected(tow), *advice]
    return said if advice else [*said, told("let_go", say("Good: let go."), verdict="good")]


def _number(tow: "Assessment", log_known: bool) -> Iterator[Statement]:
    curve = tow.curve
    if curve["cw_kg_m"] is None:
        yield told("provisional", say("These runs give no curve."), verdict="none")
        return
    wording = say("Provisional: Cw is {cw_kg_m} kg/m at {declared_speed_m_s} m/s ({method}).")
    yield told("provisional", wording, curve, "curves", method=labels.method(tow.method))
    if curve["cw_lo_kg_m"] is not None and curve["cw_hi_kg_m"] is not None:
        yield interval(curve, log_known)


def _expected(tow: "Assessment") -> Iterator[Statement]:
    """What this boat's last tow and the other boats of its type have at that speed."""
    last, like = tow.own_before, tow.of_type
    if last is not None:
        wording = say("Its tow of {tow_date} gives {cw_kg_m} kg/m at that speed.")
        yield told("own_before", wording, last, "curves")
    if like["n"] and tow.tow["boat_type"]:
        wording = say(
            "The {n} other crews of type {boat_type} ({people}) have {median} kg/m there "
            "({lowest} to {highest})."
        )
        ends = {name: Number(like[name]) for name in ("median", "lowest", "highest")}
        people = labels.crew(tow.tow["crew_class"])
        yield told("like_boats", wording, tow.tow | like | ends, "curves", people=people)


def _advice(tow: "Assessment") -> Iterator[Statement]:
    """What to do before the boat is let go; nothing where all is well."""
    for run in tow.runs:
        yield from _run(run)
    if tow.curve["cw_kg_m"] is None:
        yield told("tow_again", say("Tow the boat again."), verdict="again")
    last = tow.own_before
    if last is not None and _apart(tow.curve, last):
        wording = say(
            "That is {by} % from its last tow, more than the uncertainty of both: look at the "
            "line, the trim and the bottom before you let go."
        )
        by = _off(tow.curve["cw_kg_m"] / last["cw_kg_m"])
        yield told("differs_from_last", wording, {}, "curves", verdict="differs", by=by)


def _run(run: Row) -> Iterator[Statement]:
    """A run that has to be towed again, and why."""
    if run["cw_kg_m"] is None:
        wording = say("Run {run} has no steady window: tow it again.")
        yield told("run_lost", wording, run, "run_points", verdict="again")
    elif run["fitted_cw_kg_m"] and abs(run["cw_kg_m"] / run["fitted_cw_kg_m"] - 1) > RUN_OFF:
        wording = say("Run {run} is {by} % off the curve of the others: tow it again.")
        by = _off(run["cw_kg_m"] / run["fitted_cw_kg_m"])
        yield told("run_off", wording, run, "run_points", verdict="again", by=by)


def _off(ratio: float) -> Number:
    return Number(100 * (ratio - 1), 1, "%", sign="+")


def _apart(new: Row, old: Row) -> bool:
    """Whether two numbers differ by more than their 95 % intervals together."""
    one, other = (tuple(row[f"cw_{end}kg_m"] for end in ("", "lo_", "hi_")) for row in (new, old))
    return None not in (*one, *other) and apart(one, other)
