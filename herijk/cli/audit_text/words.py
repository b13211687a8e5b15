"""Words and figures that the pages of `herijk audit` share.

Belongs here: how a number, an interval, a verdict, a boat or a reason is said. Does not belong
here: what is on which page.
"""

import re
import textwrap
from collections.abc import Iterable
from math import exp
from typing import Final

from dashboards.labels import candidate, code_in_words
from pipeline.messages import number, say, tell
from pipeline.tables.row import Row
from warehouse.queries.audit_types import TypeFacts, TypeStatistics

QUANTITIES: Final = {"b_m_s": "B", "a_kg_m": "A", "cw_standard_kg_m": "Cw"}
LETTERS: Final = QUANTITIES | {"q": "q"}
"""Quantities of which straight lines are told; of q that on weight, as its own test is on speed."""
AGAINST: Final = {
    "weight_kg": (say("weight"), 100.0, "100 kg"),
    "declared_speed_m_s": (say("tow speed"), 0.1, say("0.1 m/s")),
}
"""Explaining variables: their name, and the step for which a slope is told."""

LINES: Final = (
    *((name, "weight_kg", "all") for name in LETTERS),
    *((name, "declared_speed_m_s", "all") for name in QUANTITIES),
    *(("cw_standard_kg_m", "declared_speed_m_s", crews) for crews in ("men", "women")),
)
"""What is told of the table of lines: quantity, explaining variable and within which crews."""

MOST_LISTED: Final = 4
WIDTH: Final = 100

_NOTE: Final = say(
    "two crews of one boat are not taken for two boats. Intervals are 95 %; a trend or shift is "
    "named where its interval leaves out zero: 'none seen' is no proof that there is none."
)


def note(tows: str) -> str:
    """Over which tows the statistics are, and how to read them."""
    counted = {
        "newest": tell("n counts the newest tow of each boat and crew"),
        "all": tell(
            "lines and outliers over all tows, repeats of a boat taken as such; the other "
            "statistics over the newest tow of each boat and crew"
        ),
    }.get(
        tows,
        tell(
            "only tows of {}, the newest of each boat and crew among them; eras and "
            "agreement of all types over all seasons",
            tows,
        ),
    )
    return f"{counted[0].upper()}{counted[1:]}; {tell(_NOTE)}"


def step_of(quantity: str, explaining: str) -> tuple[float, str]:
    """The step for which a slope is told, and its name; q changes little, its step is a tonne."""
    if quantity == "q":
        return 1000.0, "1000 kg"
    _, step, unit = AGAINST[explaining]
    return step, tell(unit)


def wrapped(text: str, indent: int = 2, hanging: int = 2) -> str:
    """Lines of at most `WIDTH`; a figure stays with its sign and n with its number."""
    bound = re.sub(r"(?<=\d) (?=%)|(?<=\bn) (?=\d)|(?<=\bp) (?=\d)", "\xa0", text)
    lines = textwrap.fill(
        bound, WIDTH, initial_indent=" " * indent, subsequent_indent=" " * (indent + hanging)
    )
    return lines.replace("\xa0", " ")


def codes(names: Iterable[str]) -> str:
    """Codes of the tables in words; an empty one says nothing."""
    return ", ".join(code_in_words(name) for name in names if name)


def share(ratio: float | None, digits: int = 0) -> str:
    """A ratio in per cent."""
    return "-" if ratio is None else number(100 * ratio, f".{digits}f") + " %"


def change(ratio: float) -> str:
    """How much a ratio differs from 1, in per cent without the sign."""
    return tell("{:+.1f}", 100 * (ratio - 1))


def nothing(row: Row) -> str:
    """That nothing is claimed, why, and from how many boats."""
    n = row.get("n_boats", row["n"])
    counted = tell("{} boats", n) if "n_boats" in row else f"n {n}"
    return tell("nothing claimed: {} ({})", code_in_words(row["reason"]), counted)


def yes(verdict: bool | None) -> str:
    """The verdict on a slope."""
    return {True: tell("follows"), False: tell("no trend seen"), None: "-"}[verdict]


def interval(value: float, lo: float, hi: float, *, digits: int) -> str:
    """A number with its interval, signed."""
    return tell("{} ({} to {})", *(number(x, f"+.{digits}f") for x in (value, lo, hi)))


def who(row: Row) -> str:
    """A boat with its crew."""
    return f"{row['fsn_no']} {row['name'] or ''} {row['rowers']}{row['crew_class']}"


def listed(lines: list[str]) -> list[str]:
    """The first few, and how many more there are."""
    more = len(lines) - MOST_LISTED
    return lines[:MOST_LISTED] + ([tell("and {} more: see --json", more)] if more > 0 else [])


def section(title: str, lines: list[str]) -> str:
    """A title with its lines below."""
    return "\n".join([title, *lines])


def line_of(under: TypeStatistics, quantity: str, explaining: str, within: str = "all") -> Row:
    """The straight line of a quantity on an explaining variable, or why there is none."""
    for line in under.lines:
        if (line["quantity"], line["explaining"], line["within"]) == (quantity, explaining, within):
            return line
    return {"n": 0, "n_boats": 0, "slope": None, "follows": None, "reason": "no_curves"}


def heading(facts: TypeFacts) -> str:
    """How many boats and tows of a type there are, and how they differ."""
    boats = tell(
        "{} boats, {} of them towed; {} tows",
        facts.n_boats,
        facts.n_towed,
        facts.n_tows,
    )
    if not facts.n_tows:
        return tell("{} accepted.", boats)
    seasons = f"{facts.first_season}-{facts.last_season}"
    weight = (
        tell("weight not known")
        if facts.lightest_kg is None
        else f"{facts.lightest_kg:.0f}-{facts.heaviest_kg:.0f} kg"
    )
    speeds = tell("{:.2f}-{:.2f} m/s", facts.slowest_m_s, facts.fastest_m_s)
    return tell("{}, {}; {}; declared speed {}.", boats, seasons, weight, speeds)


def apart(era: Row) -> str:
    """The verdict on an era."""
    return {True: "apart", False: tell("none seen"), None: "-"}[era["apart"]]


def explained(row: Row) -> str:
    """What could explain a boat's place."""
    return ", ".join(tell(candidate(name)) for name in row["candidates"])


def outsider(row: Row) -> str:
    """A boat outside its type: how far, and what could explain it."""
    return tell(
        "{}, {}: {}, {:+.1f} sd; {}",
        who(row),
        row["tow_id"],
        distance(row),
        row["deviation_sd"],
        explained(row) or tell("nothing known explains it"),
    )


def distance(row: Row) -> str:
    """How far a boat lies from what the other boats of its type predict."""
    if row["quantity"] == "bend":
        return tell("(v/B)^2 {:.2f}, expected {:.2f}", row["value"], row["expected"])
    ratio = exp(row["value"] - row["expected"])
    return tell("Cw at {:.2f} m/s {} % from the expected", row["standard_speed_m_s"], change(ratio))


def slow_tow(row: Row) -> str:
    """A slow tow, and what its own curve asks at the speed that like crews row."""
    towed = tell("{:.2f} m/s, {:.0f} W per rower", row["declared_speed_m_s"], row["power_w"])
    ratios = [row[f"power_ratio_rowed{end}"] for end in ("", "_lo", "_hi")]
    if None in ratios:
        return tell("{}, {}: {}; no like crews to compare with", who(row), row["tow_id"], towed)
    power, lo, hi = map(change, ratios)
    rowed, above = row["rowed_speed_m_s"], row["rowed_speed_m_s"] / row["declared_speed_m_s"]
    return tell(
        "{}, {}: {}; at {:.2f} m/s, where like crews row ({} of its speed), its "
        "curve asks {} % ({} to {}) of the power by its type's bend",
        who(row),
        row["tow_id"],
        towed,
        rowed,
        share(above),
        power,
        lo,
        hi,
    )


def second_opinion(row: Row) -> str:
    """Cw of the tow and as the other boats predict it."""
    return tell(
        "Cw at {:.2f} m/s {:.2f}, predicted {:.2f} ({:.2f} to {:.2f}) kg/m",
        row["standard_speed_m_s"],
        row["cw_kg_m"],
        row["predicted_cw_kg_m"],
        row["predicted_lo_kg_m"],
        row["predicted_hi_kg_m"],
    )
