"""The page of two types side by side, and what differs."""

from collections.abc import Callable

from herijk.audit_text.words import (
    AGAINST,
    NOTE,
    QUANTITIES,
    Report,
    apart,
    change,
    heading,
    line_of,
    section,
    share,
    wrapped,
    yes,
)
from herijk.text import table

Cell = Callable[[Report], tuple[bool | None, str]]
"""From the figures of a type: its verdict, and the words."""

Figure = tuple[str, Cell]


def _headline(eras: list[str]) -> list[Figure]:
    """Rows of the table: their label, and what stands in their cells."""
    lines: list[Figure] = [
        (f"{letter} against {against}", _line_cell(quantity, explaining))
        for explaining, (against, _, _) in AGAINST.items()
        for quantity, letter in QUANTITIES.items()
    ]
    return [
        *lines,
        ("spread about weight", _spread_cell),
        ("equal bends possible", _bends_cell),
        ("q per 10 % tow speed", _trend_cell),
        ("boats outside", _outside_cell),
        ("slow tows", lambda u: (None, f"{len(u['slow_tows'])} of n {u['bends']['n']}")),
        *((f"{era}, next tow", _era_cell(i)) for i, era in enumerate(eras)),
        ("repeats: s_R", _repeat_cell),
        ("off from dimensions", _prediction_cell),
    ]


def _no_cell(row: Report) -> str:
    return f"- {row['reason'].replace('_', ' ')}, n {row['n']}"


def _line_cell(quantity: str, explaining: str) -> Cell:
    def cell(under: Report) -> tuple[bool | None, str]:
        line = line_of(under, quantity, explaining)
        if line["reason"]:
            return None, _no_cell(line)
        return line["follows"], f"{yes(line['follows'])}, {share(line['r2'])}, n {line['n']}"

    return cell


def _spread_cell(under: Report) -> tuple[bool | None, str]:
    found = [line_of(under, quantity, "weight_kg") for quantity in QUANTITIES]
    if any(line["reason"] for line in found):
        return None, "-"
    b, a, cw = (line["residual_sd_ratio"] for line in found)
    return cw < min(a, b), f"B {100 * b:.1f}, A {100 * a:.1f}, Cw {100 * cw:.1f} %"


def _bends_cell(under: Report) -> tuple[bool | None, str]:
    test = under["bends"]
    if test["reason"]:
        return None, _no_cell(test)
    word = {True: "yes", False: "no", None: "not claimed"}[test["equal_possible"]]
    return (
        test["equal_possible"],
        f"{word}, p {test['p_value']:.3f}, noise {share(test['noise_share'])}",
    )


def _trend_cell(under: Report) -> tuple[bool | None, str]:
    trend = under["speed_trend"]
    if trend["reason"]:
        return None, _no_cell(trend)
    return trend["follows"], f"{yes(trend['follows'])}, {0.1 * trend['slope']:+.3f}, n {trend['n']}"


def _outside_cell(under: Report) -> tuple[bool | None, str]:
    judged = max((row["n"] for row in under["judged"]), default=0)
    return bool(under["outside"]) if judged else None, f"{len(under['outside'])} of n {judged}"


def _era_cell(index: int) -> Cell:
    def cell(under: Report) -> tuple[bool | None, str]:
        era = under["eras"][index]
        if era["reason"]:
            return None, _no_cell(era)
        return era["apart"], f"{apart(era)}, {change(era['shift_ratio'])} %, n {era['n']}"

    return cell


def _repeat_cell(under: Report) -> tuple[bool | None, str]:
    pairs = under["repeats"]
    return None, f"{share(pairs['sd_ratio'], 1)}, n {pairs['n_pairs']} pairs"


def _prediction_cell(under: Report) -> tuple[bool | None, str]:
    own = under["prediction"]
    return None, f"{share(own['rmse_ratio'], 1)}, n {own['n_predicted']}"


def two_types(report: Report) -> list[str]:
    """The parts of the page."""
    types, methods = report["types"], report["methods"]
    eras = types[0]["under"][methods[0]]["eras"]
    cells, differences = [], []
    for label, cell in _headline([era["era"] for era in eras]):
        for method in methods:
            found = [cell(one["under"][method]) for one in types]
            words = [said for _, said in found]
            cells.append((label if method == methods[0] else "", method, *words))
            verdicts = {verdict for verdict, _ in found}
            if verdicts == {True, False}:
                said = "; ".join(f"{t['boat_type']} {w}" for t, w in zip(types, words, strict=True))
                differences.append(wrapped(f"{label}, {method}: {said}"))
    names = [one["boat_type"] for one in types]
    intro = [f"{one['boat_type']}: {heading(one)}" for one in types]
    intro.append(f"{NOTE} Per cent after a verdict: share of the spread that the line explains.")
    return [
        "\n".join(wrapped(line, 0, 0) for line in intro),
        table(("", "method", *names), cells),
        section("What differs:", differences or ["  no verdict differs between the two"]),
    ]
