"""The due list as text for a person."""

from collections import Counter
from typing import TYPE_CHECKING, Final

from dashboards.labels import code_in_words
from herijk.cli.text import boat, decimals, page, table
from pipeline.messages import headings, say, tell
from warehouse.queries.due import WORTH

if TYPE_CHECKING:
    from pipeline.tables.row import Row
    from warehouse.queries.due import DueReport

LAST_DAY: Final = say(", the day of the last tow or race")
URGENCIES: Final = {
    "expired": say("Expired: does not count any more"),
    "this_year": say("Expires at the end of this year: tow before the next season"),
    "without_curve": say("Without a curve: never towed, or no tow gave one"),
    "later": say("Later"),
}


def due(report: "DueReport") -> str:
    """Who is due, at what speed, and which boats to tow again."""
    counts = Counter(line["urgency"] for line in report.lines)
    by_urgency = [
        f"{tell(title)}\n{_lines([line for line in report.lines if line['urgency'] == urgency])}"
        for urgency, title in URGENCIES.items()
        if counts[urgency]
    ]
    parts = [
        tell(
            "Due list as of {}{}; curves of method {}. {} boats and crews: {} expired, "
            "{} expire this year, {} without a curve.",
            report.as_of,
            "" if report.asked else tell(LAST_DAY),
            report.method,
            len(report.lines),
            *(counts[urgency] for urgency in ("expired", "this_year", "without_curve")),
        ),
        *by_urgency,
        tell(
            "The speed takes 70-90 W per rower (men) or 40-55 W (women) on the known "
            "curve. A boat that was altered\nsince may be towed at another one. * "
            "lies outside 85-115 % of the last declared speed, where its curve does "
            "not hold."
        ),
        _choice(report.retow_choice),
    ]
    return page(parts, report.simulated)


def _lines(lines: list["Row"]) -> str:
    head = (
        *headings("valid until", "boat", "name", "crew", "last tow", "declared", "W", "raced"),
        *headings("from", "to", "tow at m/s", "why"),
    )
    return table(head, [_line(line) for line in lines])


def _line(line: "Row") -> tuple[object, ...]:
    tow_at = decimals(line["tow_speed_m_s"], 2) + ("*" if line["beyond_curve"] else "")
    return (
        line["valid_until"],
        *boat(line),
        line["tow_date"],
        decimals(line["declared_speed_m_s"], 2),
        decimals(line["power_w"], 0),
        *(decimals(line[f"{which}_speed_m_s"], 2) for which in ("raced", "lowest", "highest")),
        tow_at,
        code_in_words(line["speed_reason"]),
    )


def _choice(choice: list["Row"]) -> str:
    title = tell("To narrow the season factors most, tow these again, in this order")
    if not choice:
        return tell(
            "{}: nobody, this method estimates no log error, so no tow would narrow it.", title
        )
    rows = [
        (
            c["position"],
            *boat(c),
            c["seasons"],
            c["valid_until"],
            decimals(c["tow_speed_m_s"], 2),
            tell("{:.3f} %", 100 * c["factor_sd_after_ratio"]),
        )
        for c in choice
    ]
    head = headings(
        "", "boat", "name", "crew", "towed in", "valid until", "tow at m/s", "uncertainty then"
    )
    before = 100 * choice[0]["factor_sd_before_ratio"]
    after = 100 * choice[-1]["factor_sd_after_ratio"]
    worth = tell("It is not worth it for that alone.") if after >= WORTH * before else ""
    return tell(
        "{}.\nAll of them together bring the uncertainty of a season's log error from "
        "{:.3f} % to {:.3f} % of speed (standard\ndeviation); the last column says "
        "how far it is after each. {}\n{}",
        title,
        before,
        after,
        worth,
        table(head, rows),
    )
