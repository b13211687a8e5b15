"""The page of two types side by side, and what differs."""

from collections.abc import Callable
from typing import NamedTuple

from dashboards.labels import code_in_words
from herijk.cli.audit_text.words import (
    AGAINST,
    QUANTITIES,
    apart,
    change,
    heading,
    line_of,
    note,
    section,
    share,
    step_of,
    wrapped,
)
from herijk.cli.text import table
from pipeline.messages import say, tell
from pipeline.tables.row import Row
from warehouse.queries.audit_types import TypesAudit, TypeStatistics

Cell = Callable[[TypeStatistics], str]
"""The words in a cell, from the figures of a type."""


class TableRow(NamedTuple):
    """A row of the table: its label, its name among the differences, and its cells."""

    label: str
    name: str
    cell: Cell


def _headline(eras: list[str]) -> list[TableRow]:
    lines = [
        TableRow(
            tell("{} against {}", letter, tell(against)),
            f"{quantity} {explaining}",
            _line(quantity, explaining),
        )
        for explaining, (against, _, _) in AGAINST.items()
        for quantity, letter in QUANTITIES.items()
    ]
    return [
        *lines,
        TableRow(tell("q against weight"), "q weight_kg", _line("q", "weight_kg")),
        TableRow(tell("spread about weight"), "closest", _spread),
        TableRow(tell("equal bends possible"), "bends", _bends),
        TableRow(tell("q per 10 % tow speed"), "speed_trend", _trend),
        TableRow(tell("boats outside"), "", _outside),
        TableRow(
            tell("slow tows"), "", lambda u: tell("{} of n {}", len(u.slow_tows), u.bends["n"])
        ),
        *(TableRow(tell("{}, next tow", era), era, _era(i)) for i, era in enumerate(eras)),
        TableRow(tell("repeats: s_R"), "", _repeat),
        TableRow(tell("off from dimensions"), "", _prediction),
    ]


def _trend_seen(line: Row) -> str:
    return tell("follows") if line["follows"] else tell("none seen")


def _nothing(row: Row) -> str:
    return f"- {code_in_words(row['reason'])}, n {row['n']}"


def _line(quantity: str, explaining: str) -> Cell:
    def cell(under: TypeStatistics) -> str:
        line = line_of(under, quantity, explaining)
        if line["reason"]:
            return _nothing(line)
        slope = tell("{:+.2f}", step_of(quantity, explaining)[0] * line["slope"])
        return f"{_trend_seen(line)}, {slope}, {share(line['r2'])}, n {line['n']}"

    return cell


def _spread(under: TypeStatistics) -> str:
    closest = under.closest
    if closest.reason:
        return _nothing(vars(closest))
    lines = [line_of(under, quantity, "weight_kg") for quantity in QUANTITIES]
    b, a, cw = (line["residual_sd_ratio"] for line in lines)
    return tell("B {:.1f}, A {:.1f}, Cw {:.1f} %, n {}", 100 * b, 100 * a, 100 * cw, closest.n)


def _bends(under: TypeStatistics) -> str:
    test = under.bends
    if test["reason"]:
        return _nothing(test)
    word = {True: tell("yes"), False: tell("no"), None: tell("not claimed")}[test["equal_possible"]]
    return tell(
        "{}, p {:.3f}, noise {}, n {}", word, test["p_value"], share(test["noise_share"]), test["n"]
    )


def _trend(under: TypeStatistics) -> str:
    trend = under.speed_trend
    if trend["reason"]:
        return _nothing(trend)
    return tell("{}, {:+.3f}, n {}", _trend_seen(trend), 0.1 * trend["slope"], trend["n"])


def _outside(under: TypeStatistics) -> str:
    judged = max((row["n"] for row in under.judged), default=0)
    return tell("{} of n {}", len(under.outside), judged)


def _era(index: int) -> Cell:
    def cell(under: TypeStatistics) -> str:
        era = under.eras[index]
        if era["reason"]:
            return _nothing(era)
        return f"{apart(era)}, {change(era['shift_ratio'])} %, n {era['n']}"

    return cell


def _repeat(under: TypeStatistics) -> str:
    pairs = under.repeats
    return tell("{}, n {} pairs", share(pairs.sd_ratio, 1), pairs.n_pairs)


def _prediction(under: TypeStatistics) -> str:
    own = under.prediction
    return f"{share(own['rmse_ratio'], 1)}, n {own['n_predicted']}"


def two_types(report: TypesAudit) -> list[str]:
    """The parts of the page."""
    types, methods = report.types, report.methods
    names = [one.boat_type for one in types]
    eras = [era["era"] for era in types[0].under[methods[0]].eras]
    cells, differing = [], []
    for row in _headline(eras):
        for method in methods:
            words = [row.cell(one.under[method]) for one in types]
            cells.append((row.label if method == methods[0] else "", method, *words))
            if row.name in report.differences[method]:
                said = "; ".join(f"{n} {w}" for n, w in zip(names, words, strict=True))
                differing.append(wrapped(f"{row.label}, {method}: {said}"))
    intro = [f"{one.boat_type}: {heading(one)}" for one in types]
    intro.append(
        tell(
            "{} Beside a verdict stand the slope, per 100 kg (q: 1000 kg) or 0.1 m/s, "
            "and the share of the spread that the line explains.",
            note(report.statistics_over),
        )
    )
    title = tell(
        "What differs: slopes and shifts by more than both intervals together, and verdicts"
    )
    return [
        "\n".join(wrapped(line, 0, 0) for line in intro),
        table(("", say("method"), *names), cells),
        section(title, differing or [tell("  nothing")]),
    ]
