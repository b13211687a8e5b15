"""The pages of `herijk audit` in plain words, each statement with its figures and its n.

Words only: every figure and every verdict comes from `warehouse.audit`. True, false and None of a
verdict are three different things: yes, not seen, and not claimed.
"""

import re
import textwrap
from collections.abc import Callable, Iterator
from math import exp
from typing import Any, Final

from herijk.text import SIMULATED, table

Report = dict[str, Any]

REASONS: Final = {
    "no_type": "boats without a type are not compared",
    "few_boats": "too few boats",
    "equal_values": "all boats have the same value",
    "no_scatter": "runs without scatter",
    "no_curves": "no curve of this type",
    "few_pairs": "fewer than six pairs",
    "too_few_repeats": "too few repeat tows",
}
"""Why nothing is claimed, by the codes in the tables."""

EXPLANATIONS: Final = {
    "weight": "unusual weight",
    "length": "unusual length",
    "season": "its season lies to the same side",
    "slow_tow": "slow tow",
    "askew": "perhaps pulled askew",
    "b_at_cap": "B at its cap",
    "b_not_determined": "B not determined",
}
"""What could explain a boat's place, by the codes in `type_outliers`."""

QUANTITIES: Final = {"b_m_s": "B", "a_kg_m": "A", "cw_standard_kg_m": "Cw"}
AGAINST: Final = {
    "weight_kg": ("weight", 100.0, "100 kg"),
    "declared_speed_m_s": ("tow speed", 0.1, "0.1 m/s"),
}
"""Explaining variables: their name, and the step for which a slope is told."""

MOST_LISTED: Final = 4
WIDTH: Final = 100


def audit(report: Report) -> str:
    """The page of a boat, of one type, or of two types side by side."""
    parts = [SIMULATED] if report["simulated"] else []
    if report["about"] == "boat":
        parts += _boat(report)
    elif len(report["types"]) == 1:
        parts += _one_type(report)
    else:
        parts += _two_types(report)
    return "\n\n".join(parts)


# Words and figures -------------------------------------------------------------------------------


def _wrapped(text: str, indent: int = 2, hanging: int = 2) -> str:
    """Lines of at most `WIDTH`; a figure stays with its sign and n with its number."""
    bound = re.sub(r"(?<=\d) (?=%)|(?<=\bn) (?=\d)|(?<=\bp) (?=\d)", "\xa0", text)
    lines = textwrap.fill(
        bound, WIDTH, initial_indent=" " * indent, subsequent_indent=" " * (indent + hanging)
    )
    return lines.replace("\xa0", " ")


def _share(ratio: float | None, digits: int = 0) -> str:
    return "-" if ratio is None else f"{100 * ratio:.{digits}f} %"


def _change(ratio: float) -> str:
    return f"{100 * (ratio - 1):+.1f}"


def _nothing(row: Report) -> str:
    n = row.get("n_boats", row["n"])
    counted = f"{n} boats" if "n_boats" in row else f"n {n}"
    return f"nothing claimed: {REASONS.get(row['reason'], row['reason'])} ({counted})"


def _yes(verdict: bool | None) -> str:
    return {True: "follows", False: "no trend seen", None: "-"}[verdict]


def _interval(value: float, lo: float, hi: float, digits: int) -> str:
    return f"{value:+.{digits}f} ({lo:+.{digits}f} to {hi:+.{digits}f})"


def _who(row: Report) -> str:
    return f"{row['fsn_no']} {row['name'] or ''} {row['rowers']}{row['crew_class']}"


def _listed(lines: list[str]) -> list[str]:
    more = len(lines) - MOST_LISTED
    return lines[:MOST_LISTED] + ([f"and {more} more: see --json"] if more > 0 else [])


def _line(under: Report, quantity: str, explaining: str) -> Report:
    for line in under["lines"]:
        if (line["quantity"], line["explaining"]) == (quantity, explaining):
            return dict(line)
    return {"n": 0, "n_boats": 0, "slope": None, "follows": None, "reason": "no_curves"}


def _slope(line: Report, explaining: str) -> str:
    step = AGAINST[explaining][1]
    return _interval(*(step * line[end] for end in ("slope", "slope_lo", "slope_hi")), digits=2)


# One type ----------------------------------------------------------------------------------------


NOTE: Final = (
    "n counts the newest tow of each boat and crew. Intervals are 95 %; a trend or shift is named "
    "where its interval leaves out zero: 'none seen' is no proof that there is none."
)


def _one_type(report: Report) -> list[str]:
    found, fleet = report["types"][0], report["fleet"]
    under = found["under"]
    repeats = [_eras(under, fleet), *_repeats(under, fleet)]
    opinion = [line for m in under for line in _prediction(m, under[m], fleet[m])]
    sections = [
        (_first_title(under), _lines(under)),
        ("2. Can all boats have the same bend?", _each(under, _equal_bends)),
        (
            "3. Does the bend follow the tow speed? By a true hyperbola it would not.",
            _each(under, _speed_trend),
        ),
        (
            "4. If like boats shared one bend: B, and most change of a register's Cw by speed",
            _shared(under),
        ),
        ("5. Which boats lie outside their type?", _each(under, _outside)),
        ("6. Slow tows", _each(under, _slow)),
        ("7. Do repeat tows of unaltered boats agree, before and after correction?", repeats),
        ("8. Second opinion without towing: Cw from weight, length, beam and type", opinion),
    ]
    heading = [f"{found['boat_type']}: are equal boats equal?", _heading(found)]
    heading = [_wrapped(line, 0, 0) for line in (*heading, NOTE)]
    return ["\n".join(heading), *map(_section, sections)]


def _first_title(under: Report) -> str:
    lines = [_line(figures, "cw_standard_kg_m", "weight_kg") for figures in under.values()]
    speeds = {f"{x['standard_speed_m_s']:.2f} m/s" for x in lines if "standard_speed_m_s" in x}
    at = f" at a standard {' or '.join(sorted(speeds))}" if speeds else ""
    return f"1. Do A [kg/m] and B [m/s] follow weight or tow speed? Does Cw [kg/m]{at}?"


def _section(section: tuple[str, list[str]]) -> str:
    return "\n".join([section[0], *section[1]])


def _each(under: Report, say: Callable[[Report], list[str]]) -> list[str]:
    """What a section says of every method; methods of which the same holds share a line."""
    said: dict[tuple[str, ...], list[str]] = {}
    for method, figures in under.items():
        said.setdefault(tuple(say(figures)), []).append(method)
    lines = []
    for (first, *rest), methods in said.items():
        lines += [_wrapped(f"{', '.join(methods)}: {first}"), *(_wrapped(r, 4) for r in rest)]
    return lines


def _heading(found: Report) -> str:
    """How many boats and tows of a type there are, and how they differ."""
    boats = f"{found['n_boats']} boats, {found['n_towed']} of them towed; {found['n_tows']} tows"
    if not found["n_tows"]:
        return f"{boats} accepted."
    seasons = f"{found['first_season']}-{found['last_season']}"
    weight = (
        "weight not known"
        if found["lightest_kg"] is None
        else f"{found['lightest_kg']:.0f}-{found['heaviest_kg']:.0f} kg"
    )
    speeds = f"{found['slowest_m_s']:.2f}-{found['fastest_m_s']:.2f} m/s"
    return f"{boats}, {seasons}; {weight}; declared speed {speeds}."


def _lines(under: Report) -> list[str]:
    """The table of lines, what is not claimed, and which quantity lies closest together."""
    cells, silent = [], []
    for quantity, letter in QUANTITIES.items():
        for explaining, (against, _, unit) in AGAINST.items():
            label = f"{letter} per {unit}"
            for method, figures in under.items():
                line = _line(figures, quantity, explaining)
                if line["reason"]:
                    silent.append((method, f"{letter} against {against}", _nothing(line)))
                    continue
                cells.append((label, method, _slope(line, explaining), *_line_figures(line)))
                label = ""
    label = "Cw, power of m"
    for method, figures in under.items():
        line = _line(figures, "ln_cw_standard", "ln_displacement")
        if not line["reason"]:
            power = _interval(line["slope"], line["slope_lo"], line["slope_hi"], digits=2)
            explained, verdict = _share(line["r2"]), _yes(line["follows"])
            cells.append((label, method, power, explained, "", "", line["n"], verdict))
            label = ""
    head = ("", "method", "slope", "explained", "spread", "noise", "n", "")
    shown = [table(head, cells)] if cells else []
    return shown + _silent(silent) + (_each(under, _closest) if cells else [])


def _line_figures(line: Report) -> tuple[Any, ...]:
    return (
        _share(line["r2"]),
        _share(line["residual_sd_ratio"], 1),
        _share(line["noise_sd_ratio"], 1),
        line["n"],
        _yes(line["follows"]),
    )


def _silent(silent: list[tuple[str, str, str]]) -> list[str]:
    """What is not claimed, for methods and lines of the same reason at once."""
    methods: dict[str, dict[str, None]] = {}
    lines: dict[str, dict[str, None]] = {}
    for method, what, reason in silent:
        methods.setdefault(reason, {})[method] = None
        lines.setdefault(reason, {})[what] = None
    return [
        _wrapped(f"{', '.join(methods[reason])}: {reason}: {', '.join(lines[reason])}")
        for reason in methods
    ]


def _closest(under: Report) -> list[str]:
    """Spread about the line on weight: does Cw at one speed lie closer together than A and B?"""
    found = {letter: _line(under, q, "weight_kg") for q, letter in QUANTITIES.items()}
    for line in found.values():
        if line["reason"]:
            return [_nothing(line)]
    spread = {letter: line["residual_sd_ratio"] for letter, line in found.items()}
    closer = "lies closer" if spread["Cw"] < min(spread["A"], spread["B"]) else "lies no closer"
    return [
        f"about weight Cw spreads {_share(spread['Cw'], 1)} (n {found['Cw']['n']}), A "
        f"{_share(spread['A'], 1)}, B {_share(spread['B'], 1)}: Cw {closer} together."
    ]


def _equal_bends(under: Report) -> list[str]:
    test = under["bends"]
    if test["reason"]:
        return [_nothing(test)]
    verdict = {
        True: "yes, equal bends are possible",
        False: "no, they differ by more than noise",
        None: "not claimed, too weak a test",
    }[test["equal_possible"]]
    said = (
        f"{verdict}: p {test['p_value']:.3f} (F {test['f_value']:.2f} on {test['dof_between']} and "
        f"{test['dof_within']}, n {test['n']})."
    )
    if test["power_at_5pct"] is None:
        return [f"{said} The shared curve does not bend upwards: there is no B to compare."]
    return [
        f"{said} Chance to see a true spread of B of 5 %: {_share(test['power_at_5pct'])}, of "
        f"10 %: {_share(test['power_at_10pct'])}. {_noise(test)}"
    ]


def _noise(test: Report) -> str:
    noise = f"Noise alone gives {_share(test['noise_share'])} of the variance of the bends"
    if test["b_sd_ratio"] is None or test["ab_correlation"] is None:
        return f"{noise}."
    return (
        f"{noise}, B a spread of {_share(test['b_noise_sd_ratio'], 1)} (seen "
        f"{_share(test['b_sd_ratio'], 1)}), A and B a correlation of "
        f"{test['ab_noise_correlation']:.2f} (seen {test['ab_correlation']:.2f})."
    )


def _speed_trend(under: Report) -> list[str]:
    trend = under["speed_trend"]
    if trend["reason"]:
        return [_nothing(trend)]
    ends = _interval(*(0.1 * trend[end] for end in ("slope", "slope_lo", "slope_hi")), digits=3)
    return [f"{_yes(trend['follows'])}: 10 % more tow speed, q {ends}, n {trend['n']}."]


def _shared(under: Report) -> list[str]:
    """What becomes of the register when boats share their bend: B, and how far Cw would move."""
    cells, silent = [], []
    for method, figures in under.items():
        found = {row["pooling"]: row for row in figures["shared"]}
        if "shared" not in found:
            reason = {"reason": figures["bends"]["reason"] or "few_boats"}
            silent.append((method, "shared bend", _nothing(figures["bends"] | reason)))
            continue
        own, part, shared = (found[pooling] for pooling in ("own", "partial", "shared"))
        b = shared["median_b_m_s"]
        spreads = [_share(row["b_sd_ratio"], 1) for row in (own, part)]
        moves = [_share(shared[f"most_{at}"], 1) for at in ("085", "100", "115")]
        place = "none" if b is None else f"{b:.2f} m/s"
        cells.append((method, place, *spreads, *moves, shared["most_fsn_no"], shared["n"]))
    head = ("method", "B", "own B spread", "in part", "85 %", "100 %", "115 %", "boat", "n")
    return ([table(head, cells)] if cells else []) + _silent(silent)


def _judged(under: Report) -> str:
    counts = {row["quantity"]: row["n"] for row in under["judged"]}
    return f"n {counts.get('ln_cw_standard', 0)} by Cw, n {counts.get('q', 0)} by the bend"


def _outside(under: Report) -> list[str]:
    if not under["judged"]:
        reason = under["bends"]["reason"] or "few_boats"
        return [_nothing(under["bends"] | {"reason": reason})]
    boats = [_outsider(row) for row in under["outside"]]
    return [f"{len(boats) or 'none'} outside ({_judged(under)}).", *_listed(boats)]


def _outsider(row: Report) -> str:
    codes = ", ".join(EXPLANATIONS.get(code, code) for code in row["candidates"])
    return (
        f"{_who(row)}, {row['tow_id']}: {_distance(row)}, {row['deviation_sd']:+.1f} sd; "
        f"{codes or 'nothing known explains it'}"
    )


def _distance(row: Report) -> str:
    """How far a boat lies from what the other boats of its type predict."""
    if row["quantity"] == "q":
        return f"q {row['value']:.2f}, expected {row['expected']:.2f}"
    ratio = exp(row["value"] - row["expected"])
    return f"Cw at {row['standard_speed_m_s']:.2f} m/s {_change(ratio)} % from the expected"


def _slow(under: Report) -> list[str]:
    counted = f"of n {under['bends']['n']}"
    lines = [_slow_tow(row) for row in under["slow_tows"]]
    return [f"{len(lines) or 'none'} {counted}.", *_listed(lines)]


def _slow_tow(row: Report) -> str:
    towed = f"{row['declared_speed_m_s']:.2f} m/s, {row['power_w']:.0f} W a rower"
    ratios = [row[f"power_ratio_120{end}"] for end in ("", "_lo", "_hi")]
    if None in ratios:
        return f"{_who(row)}, {row['tow_id']}: {towed}; no other boats to compare with"
    power, lo, hi = map(_change, ratios)
    return (
        f"{_who(row)}, {row['tow_id']}: {towed}; at 120 % of that its curve asks {power} % "
        f"({lo} to {hi}) of the power by its type's bend"
    )


def _eras(under: Report, fleet: Report) -> str:
    cells = []
    for index in range(len(next(iter(under.values()))["repeats"]["eras"])):
        label = ""
        for method, figures in under.items():
            era = figures["repeats"]["eras"][index]
            everyone = _scope(fleet[method], era["era"])
            again = f"{era['era']} to {era['against']}"
            cells.append(
                (
                    "" if label else again,
                    method,
                    era["n"],
                    _era(era),
                    _apart(era),
                    _reproducibility(everyone),
                    everyone["n_pairs"],
                )
            )
            label = again
    head = ("towed in", "method", "n", "new / old Cw, %", "shift", "all types: s_R, %", "n")
    return table(head, cells)


def _scope(fleet: Report, scope: str) -> Report:
    rows = [row for row in fleet["reproducibility"] if row["scope"] == scope]
    return rows[0] if rows else {"n_pairs": 0, "n_tows": 0}


def _era(era: Report) -> str:
    if era["reason"]:
        return REASONS[era["reason"]]
    return f"{_change(era['shift_ratio'])} ({_change(era['lo'])} to {_change(era['hi'])})"


def _apart(era: Report) -> str:
    """Whether an era stands apart from later ones; within the last era a shift is a drift."""
    if era["reason"]:
        return "-"
    if era["apart"]:
        return "drifts" if era["against"] == era["era"] else "apart"
    return "none seen"


def _reproducibility(row: Report) -> str:
    if not row["n_pairs"]:
        return "-"
    return f"{100 * row['sd_ratio']:.1f} ({100 * row['lo']:.1f} to {100 * row['hi']:.1f})"


def _repeats(under: Report, fleet: Report) -> list[str]:
    """How well repeat tows agree, per method."""
    lines = []
    for method, figures in under.items():
        pairs, within = figures["repeats"], _scope(fleet[method], "all").get("within_sd_ratio")
        said = "no repeat pairs of this type (n 0)"
        if pairs["n_pairs"]:
            said = (
                f"s_R {_share(pairs['sd_ratio'], 1)} (n {pairs['n_pairs']} pairs, "
                f"{pairs['n_disagree']} of {pairs['n_e_n']} disagree by E_n)"
            )
        causes = _components(fleet[method])
        lines.append(_wrapped(f"{method}: {said}. All types: s_r {_share(within, 1)}; {causes}"))
    return lines


def _components(fleet: Report) -> str:
    found = {row["component"]: row for row in fleet["components"]}
    if "boat" not in found or found["boat"]["reason"]:
        reason = found["boat"]["reason"] if "boat" in found else "no_curves"
        return f"spread by cause: nothing claimed, {REASONS[reason]}."
    boat, season, rest = (found[name]["sd_ratio"] for name in ("boat", "season", "boat_season"))
    return (
        f"within types boats spread {_share(boat, 1)}, seasons {_share(season, 1)}, the rest "
        f"{_share(rest, 1)} (n {found['boat']['n']})."
    )


def _prediction(method: str, under: Report, fleet: Report) -> Iterator[str]:
    own, everyone = under["prediction"], fleet["prediction_error"]
    if not own["n_predicted"] or everyone is None:
        yield _wrapped(f"{method}: {_nothing({'reason': 'few_boats', 'n': own['n']})}")
        return
    yield _wrapped(
        f"{method}: off by {_share(own['rmse_ratio'], 1)} (n {own['n_predicted']}; all types "
        f"{_share(everyone['rmse_ratio'], 1)}, n {everyone['n']}), noise of a tow "
        f"{_share(own['tow_sd_ratio'], 1)}; {own['n_disagree']} of {own['n_predicted']} disagree."
    )
    boats = [f"{_who(row)}: {_second_opinion(row)}" for row in under["disagreeing"]]
    yield from (_wrapped(line, 4) for line in _listed(boats))


def _second_opinion(row: Report) -> str:
    return (
        f"Cw at {row['standard_speed_m_s']:.2f} m/s {row['cw_kg_m']:.2f}, predicted "
        f"{row['predicted_cw_kg_m']:.2f} ({row['predicted_lo_kg_m']:.2f} to "
        f"{row['predicted_hi_kg_m']:.2f}) kg/m"
    )


# Two types ---------------------------------------------------------------------------------------

Figure = tuple[str, Callable[[Report], tuple[bool | None, str]]]


def _headline(eras: list[str]) -> list[Figure]:
    """Rows of the table side by side: label, and from a type's figures its verdict and words."""
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


def _line_cell(quantity: str, explaining: str) -> Callable[[Report], tuple[bool | None, str]]:
    def cell(under: Report) -> tuple[bool | None, str]:
        line = _line(under, quantity, explaining)
        if line["reason"]:
            return None, _no_cell(line)
        return line["follows"], f"{_yes(line['follows'])}, {_share(line['r2'])}, n {line['n']}"

    return cell


def _spread_cell(under: Report) -> tuple[bool | None, str]:
    found = [_line(under, quantity, "weight_kg") for quantity in QUANTITIES]
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
        f"{word}, p {test['p_value']:.3f}, noise {_share(test['noise_share'])}",
    )


def _trend_cell(under: Report) -> tuple[bool | None, str]:
    trend = under["speed_trend"]
    if trend["reason"]:
        return None, _no_cell(trend)
    return trend[
        "follows"
    ], f"{_yes(trend['follows'])}, {0.1 * trend['slope']:+.3f}, n {trend['n']}"


def _outside_cell(under: Report) -> tuple[bool | None, str]:
    judged = max((row["n"] for row in under["judged"]), default=0)
    return bool(under["outside"]) if judged else None, f"{len(under['outside'])} of n {judged}"


def _era_cell(index: int) -> Callable[[Report], tuple[bool | None, str]]:
    def cell(under: Report) -> tuple[bool | None, str]:
        era = under["repeats"]["eras"][index]
        if era["reason"]:
            return None, _no_cell(era)
        return era["apart"], f"{_apart(era)}, {_change(era['shift_ratio'])} %, n {era['n']}"

    return cell


def _repeat_cell(under: Report) -> tuple[bool | None, str]:
    pairs = under["repeats"]
    return None, f"{_share(pairs['sd_ratio'], 1)}, n {pairs['n_pairs']} pairs"


def _prediction_cell(under: Report) -> tuple[bool | None, str]:
    own = under["prediction"]
    return None, f"{_share(own['rmse_ratio'], 1)}, n {own['n_predicted']}"


def _two_types(report: Report) -> list[str]:
    types, methods = report["types"], report["methods"]
    eras = types[0]["under"][methods[0]]["repeats"]["eras"]
    cells, differences = [], []
    for label, cell in _headline([era["era"] for era in eras]):
        for method in methods:
            found = [cell(one["under"][method]) for one in types]
            words = [said for _, said in found]
            cells.append((label if method == methods[0] else "", method, *words))
            verdicts = {verdict for verdict, _ in found}
            if verdicts == {True, False}:
                said = "; ".join(f"{t['boat_type']} {w}" for t, w in zip(types, words, strict=True))
                differences.append(_wrapped(f"{label}, {method}: {said}"))
    names = [one["boat_type"] for one in types]
    intro = [f"{one['boat_type']}: {_heading(one)}" for one in types]
    intro.append(f"{NOTE} Per cent after a verdict: share of the spread that the line explains.")
    return [
        "\n".join(_wrapped(line, 0, 0) for line in intro),
        table(("", "method", *names), cells),
        _section(("What differs:", differences or ["  no verdict differs between the two"])),
    ]


# A boat ------------------------------------------------------------------------------------------


def _boat(report: Report) -> list[str]:
    boat = report["boat"]
    parts = [f"{boat['fsn_no']} {boat['name']}, type {boat['boat_type'] or 'not known'}"]
    parts += [_tow(tow) for tow in report["tows"]]
    if not report["tows"]:
        parts.append("No tow of this boat was accepted.")
    sections = [
        (_place_title(report), _place(report)),
        ("If it shared its type's bend:", [_pooled(row) for row in _not_own(report["pooled"])]),
        (
            "Slow tow:",
            [f"  {r['method']}: {_slow_tow(r | {'name': ''})}" for r in report["slow_tows"]],
        ),
        (
            "Its repeat tows (without an alteration between them; E_n above 1: they disagree):",
            [_pair(row) for row in report["repeat_pairs"]] or ["  none: n 0"],
        ),
        (
            "As predicted from weight, length, beam and type by the other boats:",
            [_predicted(row) for row in report["predicted"]] or ["  not predicted: n 0"],
        ),
        ("In the registers:", [_register(row) for row in report["register"]] or ["  no line"]),
        (
            "Set aside, by its number or the name of its file:",
            [_set_aside(row) for row in report["set_aside"]] or ["  nothing"],
        ),
    ]
    wrapped = [(title, [_wrapped(line.strip()) for line in lines]) for title, lines in sections]
    return [*parts, *(_section(section) for section in wrapped if section[1])]


def _place_title(report: Report) -> str:
    size = report["type_size"]
    return (
        f"Its place among {size['n_towed']} towed boats of its type ({size['boat_type']}), newest "
        "tow of each boat and crew:"
    )


def _place(report: Report) -> list[str]:
    lines = []
    for row in report["in_type"]:
        codes = ", ".join(EXPLANATIONS.get(code, code) for code in row["candidates"])
        place = "outside" if row["outside"] else "within"
        lines.append(
            f"  {row['method']}, {row['rowers']}{row['crew_class']}, {row['tow_id']}: "
            f"{_distance(row)}, {row['deviation_sd']:+.1f} sd, {place}{codes and f' ({codes})'}"
        )
    size = report["type_size"]
    unknown = report["boat"]["boat_type"] is None
    reason = {"reason": "no_type" if unknown else "few_boats", "n": 0, "n_boats": size["n_towed"]}
    return lines or [f"  {_nothing(reason)}"]


def _not_own(pooled: list[Report]) -> Iterator[Report]:
    """Curves with a bend drawn to the type's, with the own Cw beside them."""
    own = {(row["method"], row["tow_id"]): row for row in pooled if row["pooling"] == "own"}
    for row in pooled:
        if row["pooling"] != "own":
            yield row | {"own": own[row["method"], row["tow_id"]]}


def _pooled(row: Report) -> str:
    own = row["own"]
    words = {"partial": "in part", "shared": "wholly"}[row["pooling"]]
    b = [f"{c['b_m_s']:.2f} m/s" if c["b_m_s"] else "not determined" for c in (own, row)]
    at_115 = [c["cw_115_kg_m"] for c in (own, row)]
    change = "" if None in at_115 else f", Cw at 115 % {_change(at_115[1] / at_115[0])} %"
    return (
        f"  {row['method']}, {row['tow_id']}, {words}: B {b[0]} to {b[1]}, Cw at the declared "
        f"speed {_change(row['cw_kg_m'] / own['cw_kg_m'])} %{change}"
    )


def _pair(row: Report) -> str:
    e_n = "not known" if row["e_n"] is None else f"{row['e_n']:+.2f}"
    return (
        f"  {row['method']}, {row['rowers']}{row['crew_class']}, {row['tow_id_before']} to "
        f"{row['tow_id']}: Cw {_change(exp(row['ln_ratio']))} %, E_n {e_n}"
    )


def _predicted(row: Report) -> str:
    if row["predicted_cw_kg_m"] is None:
        return f"  {row['method']}: {_nothing({'reason': row['reason'] or 'few_boats', 'n': 0})}"
    verdict = "they disagree" if row["disagrees"] else "they agree"
    return f"  {row['method']}, {row['tow_id']}: {_second_opinion(row)}; {verdict}"


def _register(row: Report) -> str:
    line = f"  {row['edition']}, {row['rowers']}{row['crew_class']}: {row['status']}"
    if row["cw_kg_m"] is None:
        return line
    b = "B not determined" if row["b_m_s"] is None else f"B {row['b_m_s']:.2f}"
    return (
        f"{line}, A {row['a_kg_m']:.2f}, {b}, Cw {row['cw_kg_m']:.2f} at "
        f"{row['declared_speed_m_s']:.2f} m/s, tow {row['tow_id']}, until {row['valid_until']}"
    )


def _set_aside(row: Report) -> str:
    tow = "" if row["tow_id"] is None else f" (tow {row['tow_id']})"
    line = "" if row["line"] is None else f", line {row['line']}"
    return f"  {row['path']}{line}{tow}: {row['message']}"


def _tow(tow: Report) -> str:
    weight = "weight not known" if tow["weight_kg"] is None else f"{tow['weight_kg']:.0f} kg"
    head = (
        f"Tow {tow['tow_id']} of {tow['tow_date']}: {tow['rowers']}{tow['crew_class']}, declared "
        f"{tow['declared_speed_m_s']:.2f} m/s, {tow['waterline_length_m']:.2f} x "
        f"{tow['beam_m']:.2f} x {tow['bow_height_m']:.2f} m, {weight}, from {tow['samples_path']}"
    )
    return "\n".join([head, *_steps(tow["steps"]), *(_curve(curve) for curve in tow["curves"])])


def _steps(steps: list[Report]) -> list[str]:
    """What each step of a correction does to the tow's Cw; steps that do nothing are left out."""
    lines = []
    for ends in dict.fromkeys((step["from_method"], step["to_method"]) for step in steps):
        own = [s for s in steps if (s["from_method"], s["to_method"]) == ends]
        felt = [f"{s['step']} {_change(s['factor'])} %" for s in own if abs(s["factor"] - 1) > 5e-4]
        total = _change(own[-1]["cw_kg_m"] / own[0]["cw_kg_m"])
        lines.append(
            f"  {ends[0]} to {ends[1]}: Cw {total} %{' = ' if felt else ''}{', '.join(felt)}"
        )
    return lines


def _curve(curve: Report) -> str:
    head = (
        "run",
        "window s",
        "cut because",
        "factor",
        "v m/s",
        "gross",
        "-inertia",
        "-air",
        "+still",
        "+temp",
        "Cw",
        "curve",
        "",
    )
    rows = [
        (
            p["run"],
            "-"
            if p["window_start_s"] is None
            else f"{p['window_start_s']:.0f}-{p['window_end_s']:.0f}",
            p["cut_reason"],
            p["speed_factor"],
            p["speed_m_s"],
            p["gross_cw_kg_m"],
            p["inertia_cw_kg_m"],
            p["air_cw_kg_m"],
            p["still_air_cw_kg_m"],
            p["temperature_cw_kg_m"],
            p["cw_kg_m"],
            p["fitted_cw_kg_m"],
            p["reason"],
        )
        for p in curve["run_points"]
    ]
    return f"  {curve['method']}: {_result(curve)}\n{table(head, rows)}"


def _result(curve: Report) -> str:
    flags = f" ({', '.join(curve['flags'])})" if curve["flags"] else ""
    if curve["cw_kg_m"] is None:
        return f"no curve, {curve['status']}{flags}"
    b = "B not determined" if curve["b_m_s"] is None else f"B {curve['b_m_s']:.2f} m/s"
    upper = "no upper bound" if curve["b_hi_m_s"] is None else f"{curve['b_hi_m_s']:.2f}"
    return (
        f"A {curve['a_kg_m']:.2f} kg/m, {b} (95 %: {curve['b_lo_m_s']:.2f} to {upper}), Cw "
        f"{curve['cw_kg_m']:.2f} kg/m (95 %: {curve['cw_lo_kg_m']:.2f} to "
        f"{curve['cw_hi_kg_m']:.2f}), {curve['power_w']:.1f} W a rower, {curve['status']}{flags}"
    )
