"""The page of one type: are equal boats equal?"""

from collections.abc import Callable, Iterator, Mapping
from typing import Final, TypeVar

from dashboards.labels import code_in_words
from herijk.cli.audit_text.words import (
    AGAINST,
    LETTERS,
    LINES,
    QUANTITIES,
    apart,
    change,
    heading,
    interval,
    line_of,
    listed,
    note,
    nothing,
    outsider,
    second_opinion,
    section,
    share,
    slow_tow,
    step_of,
    who,
    wrapped,
    yes,
)
from herijk.cli.text import decimals, table
from pipeline.consistency.eras import ERAS
from pipeline.history import SLOW_POWER_W
from pipeline.messages import headings, tell
from pipeline.tables.row import Row
from warehouse.queries.audit_types import Fleet, TypesAudit, TypeStatistics

T = TypeVar("T")

CAUSES: Final = ("boat", "season", "boat_season", "run")
"""Causes of spread, by the codes in `variance_components`."""


def one_type(report: TypesAudit) -> list[str]:
    """The parts of the page."""
    of_type, fleet = report.types[0], report.fleet
    under = of_type.under
    repeats = [
        *_eras(under, fleet),
        *_agreement(fleet),
        *_each(under, _repeats),
        *_each(fleet, _causes),
    ]
    opinion = [line for m in under for line in _prediction(m, under[m], fleet[m])]
    sections = [
        (_in_short_title(report.statistics_over), _each(under, _in_short)),
        (_first_title(under), _lines(under)),
        (tell("2. Can all boats have the same bend?"), _each(under, _equal_bends)),
        (
            tell(
                "3. Does the bend q = (v/B)^2 / (1 - (v/B)^2) follow the tow speed? A true "
                "hyperbola's does not."
            ),
            _each(under, _speed_trend),
        ),
        (
            tell(
                "4. If like boats shared one bend: B, and most change of a register's Cw by speed"
            ),
            _shared(under),
        ),
        (tell("5. Which boats lie outside their type?"), _each(under, _outside)),
        (_slow_title(), _each(under, _slow)),
        (tell("7. Do repeat tows of unaltered boats agree, before and after correction?"), repeats),
        (tell("8. Second opinion without towing: Cw from weight, length, beam and type"), opinion),
    ]
    top = (
        tell("{}: are equal boats equal?", of_type.boat_type),
        heading(of_type),
        note(report.statistics_over),
    )
    return ["\n".join(wrapped(line, 0, 0) for line in top), *(section(*one) for one in sections)]


def _in_short_title(tows: str) -> str:
    whole = tows in ("all", "newest")
    return tell("In short, over all tows of {}", tell("all seasons") if whole else tows)


def _in_short(under: TypeStatistics) -> list[str]:
    """The verdicts over all tows, each with its figure."""
    lines = [line for line in under.all_tows if not line["reason"]]
    if not lines:
        return [nothing(under.bends | {"reason": under.bends["reason"] or "few_boats"})]
    said = [
        tell(
            "{} (n {} of {} boats).",
            "; ".join(map(_verdict, lines)),
            lines[0]["n"],
            lines[0]["n_boats"],
        )
    ]
    said += [_hull(row) for row in under.hull_speed if row["b_is_hull_speed"] is not None]
    names = ", ".join(f"{who(row)} {row['season']}" for row in under.tows_outside)
    judged = tell("Outside the type: ") + (names or tell("no tow")) + "."
    return [" ".join([*said, judged])]


def _verdict(line: Row) -> str:
    letter, against = LETTERS[line["quantity"]], tell(AGAINST[line["explaining"]][0])
    seen = (
        tell("{} follows {}", letter, against)
        if line["follows"]
        else tell("{} and {} no trend", letter, against)
    )
    return tell("{}, {} explained", seen, share(line["r2"]))


def _hull(row: Row) -> str:
    """Whether B is hull speed."""
    is_it = tell("may be") if row["b_is_hull_speed"] else tell("is not")
    ends = tell("{:.2f} to {:.2f}", row["b_ratio_lo"], row["b_ratio_hi"])
    return tell(
        "B {} hull speed: {:.2f} times it ({}); towed at {} of it.",
        is_it,
        row["b_ratio"],
        ends,
        share(row["tow_ratio"]),
    )


def _first_title(under: Mapping[str, TypeStatistics]) -> str:
    lines = [line_of(figures, "cw_standard_kg_m", "weight_kg") for figures in under.values()]
    speeds = {
        tell("{:.2f} m/s", x["standard_speed_m_s"]) for x in lines if "standard_speed_m_s" in x
    }
    at = tell(" at a standard {}", tell(" or ").join(sorted(speeds))) if speeds else ""
    return tell("1. Do A [kg/m] and B [m/s] follow weight or tow speed, q weight? Cw [kg/m]{}?", at)


def _each(under: Mapping[str, T], say: Callable[[T], list[str]]) -> list[str]:
    """What a section says of every method; methods of which the same holds share a line."""
    said: dict[tuple[str, ...], list[str]] = {}
    for method, figures in under.items():
        said.setdefault(tuple(say(figures)), []).append(method)
    lines = []
    for (first, *rest), methods in said.items():
        lines += [wrapped(f"{', '.join(methods)}: {first}"), *(wrapped(r, 4) for r in rest)]
    return lines


def _lines(under: Mapping[str, TypeStatistics]) -> list[str]:
    """The table of lines, what is not claimed, and which quantity lies closest together."""
    cells, silent = [], []
    for quantity, explaining, crews in LINES:
        within = "" if crews == "all" else f", {code_in_words(crews)}"
        letter, against = LETTERS[quantity], tell(AGAINST[explaining][0]) + within
        step = step_of(quantity, explaining)[1]
        label = f"  {letter}{within}" if within else tell("{} per {}", letter, step)
        for method, figures in under.items():
            line = line_of(figures, quantity, explaining, crews)
            if line["reason"]:
                silent.append((method, tell("{} against {}", letter, against), nothing(line)))
                continue
            cells.append((label, method, _slope(line), *_line_figures(line)))
            label = ""
    label = tell("Cw, power of m")
    for method, figures in under.items():
        line = line_of(figures, "ln_cw_standard", "ln_displacement")
        if not line["reason"]:
            power = interval(line["slope"], line["slope_lo"], line["slope_hi"], digits=2)
            cells.append((label, method, power, *_line_figures(line)))
            label = ""
    head = headings("", "method", "slope", "explained", "spread", "noise", "n", "")
    shown = [table(head, cells)] if cells else []
    return shown + _silent(silent) + (_each(under, _closest) if cells else [])


def _slope(line: Row) -> str:
    step, _ = step_of(line["quantity"], line["explaining"])
    return interval(*(step * line[end] for end in ("slope", "slope_lo", "slope_hi")), digits=2)


def _line_figures(line: Row) -> tuple[object, ...]:
    digits = 0 if line["quantity"] == "q" else 1  # q spreads by many per cent
    return (
        share(line["r2"]),
        share(line["residual_sd_ratio"], digits),
        share(line["noise_sd_ratio"], digits),
        line["n"],
        yes(line["follows"]),
    )


def _silent(silent: list[tuple[str, str, str]]) -> list[str]:
    """What is not claimed, for methods and lines of the same reason at once."""
    methods: dict[str, dict[str, None]] = {}
    lines: dict[str, dict[str, None]] = {}
    for method, what, reason in silent:
        methods.setdefault(reason, {})[method] = None
        lines.setdefault(reason, {})[what] = None
    return [
        wrapped(f"{', '.join(methods[reason])}: {reason}: {', '.join(lines[reason])}")
        for reason in methods
    ]


def _closest(under: TypeStatistics) -> list[str]:
    """Spread about the line on weight: does Cw at one speed lie closer together than A and B?"""
    closest = under.closest
    if closest.reason:
        return [nothing(vars(closest))]
    verdict = {
        True: tell("Cw lies closer together than both"),
        False: tell("Cw lies further apart"),
        None: tell("these differ no more than chance lets them"),
    }[closest.cw_closest]
    by_letter = {letter: line_of(under, q, "weight_kg") for q, letter in QUANTITIES.items()}
    spreads = ", ".join(
        f"{letter} {share(line['residual_sd_ratio'], 1)} (n {line['n']})"
        for letter, line in by_letter.items()
    )
    return [tell("spread about weight: {}: {}.", spreads, verdict)]


def _equal_bends(under: TypeStatistics) -> list[str]:
    test = under.bends
    if test["reason"]:
        return [nothing(test)]
    verdict = {
        True: tell("yes, equal bends are possible"),
        False: tell("no, they differ by more than noise"),
        None: tell("not claimed, too weak a test"),
    }[test["equal_possible"]]
    said = tell(
        "{}: p {:.3f} (F {:.2f} on {} and {}, n {}).",
        verdict,
        test["p_value"],
        test["f_value"],
        test["dof_between"],
        test["dof_within"],
        test["n"],
    )
    if test["power_at_5pct"] is None:
        return [tell("{} The shared curve does not bend upwards: there is no B to compare.", said)]
    return [
        tell(
            "{} Chance to see a true spread of B of 5 %: {}, of 10 %: {}. {}",
            said,
            share(test["power_at_5pct"]),
            share(test["power_at_10pct"]),
            _noise(test),
        )
    ]


def _noise(test: Row) -> str:
    noise = tell("Noise alone gives {} of the variance of the bends", share(test["noise_share"]))
    if test["b_sd_ratio"] is None or test["ab_correlation"] is None:
        return f"{noise}."
    return tell(
        "{}, B a spread of {} (seen {}), A and B a correlation of {:.2f} (seen {:.2f}).",
        noise,
        share(test["b_noise_sd_ratio"], 1),
        share(test["b_sd_ratio"], 1),
        test["ab_noise_correlation"],
        test["ab_correlation"],
    )


def _speed_trend(under: TypeStatistics) -> list[str]:
    trend = under.speed_trend
    if trend["reason"]:
        return [nothing(trend)]
    ends = interval(*(0.1 * trend[end] for end in ("slope", "slope_lo", "slope_hi")), digits=3)
    return [tell("{}: 10 % more tow speed, q {}, n {}.", yes(trend["follows"]), ends, trend["n"])]


def _shared(under: Mapping[str, TypeStatistics]) -> list[str]:
    """What becomes of the register when boats share their bend: B, and how far Cw would move."""
    cells, silent = [], []
    for method, figures in under.items():
        by_pooling = {row["pooling"]: row for row in figures.shared}
        if "shared" not in by_pooling:
            reason = {"reason": figures.bends["reason"] or "few_boats"}
            silent.append((method, tell("shared bend"), nothing(figures.bends | reason)))
            continue
        own, part, shared = (by_pooling[pooling] for pooling in ("own", "partial", "shared"))
        b = shared["median_b_m_s"]
        spreads = [share(row["b_sd_ratio"], 1) for row in (own, part)]
        moves = [share(shared[f"most_{at}"], 1) for at in ("085", "100", "115")]
        place = tell("none") if b is None else tell("{:.2f} m/s", b)
        cells.append((method, place, *spreads, *moves, shared["most_fsn_no"], shared["n"]))
    head = headings(
        "method", "shared B", "own B spread", "in part", "85 %", "100 %", "115 %", "boat", "n"
    )
    return ([table(head, cells)] if cells else []) + _silent(silent)


def _judged(under: TypeStatistics) -> str:
    counts = {row["quantity"]: row["n"] for row in under.judged}
    return ", ".join(
        tell("n {} by {}", counts[code], words)
        if code in counts
        else tell("too few boats to judge {}", words)
        for code, words in (("ln_cw_standard", "Cw"), ("bend", tell("the bend")))
    )


def _outside(under: TypeStatistics) -> list[str]:
    if not under.judged:
        reason = under.bends["reason"] or "few_boats"
        return [nothing(under.bends | {"reason": reason})]
    boats = [outsider(row) for row in under.outside]
    return [tell("{} outside ({}).", len(boats), _judged(under)), *listed(boats)]


def _slow_title() -> str:
    men, women = SLOW_POWER_W["H"], SLOW_POWER_W["D"]
    return tell("6. Slow tows: under {:.0f} W (men) or {:.0f} W (women) a rower", men, women)


def _slow(under: TypeStatistics) -> list[str]:
    lines = [slow_tow(row) for row in under.slow_tows]
    return [tell("{} of n {}", len(lines), under.bends["n"]) + ".", *listed(lines)]


def _eras(under: Mapping[str, TypeStatistics], fleet: Mapping[str, Fleet]) -> list[str]:
    """Whether the tows of an era stand apart from the next tow of the same boats."""
    cells = []
    for index, era in enumerate(next(iter(under.values())).eras):
        label = tell("{} to later", era["era"])
        for method, figures in under.items():
            own, everyone = figures.eras[index], fleet[method].eras.get(era["era"], era)
            cells.append((label, method, *_shift(own), *_shift(everyone)))
            label = ""
    head = headings("towed in", "method", "new / old Cw, %", "", "n", "all types, %", "", "n")
    return [table(head, cells), *_each(fleet, _ageing)]


def _shift(era: Row) -> tuple[str, str, int]:
    if era["reason"]:
        return code_in_words(era["reason"]), "-", era["n"]
    shift, lo, hi = (change(era[end]) for end in ("shift_ratio", "lo", "hi"))
    return tell("{} ({} to {})", shift, lo, hi), apart(era), era["n"]


def _ageing(fleet: Fleet) -> list[str]:
    """How boats age by the pairs of the last era, which is not in the shift of an era."""
    known = [era for era in fleet.eras.values() if era["ageing_per_year"] is not None]
    if not known:
        return [tell("ageing is not taken out: fewer than six pairs within the last era.")]
    yearly = (100 * known[0][f"ageing_{end}"] for end in ("per_year", "lo", "hi"))
    return [
        tell(
            "ageing taken out: Cw {} % a year, from n {} pairs of all types within the last era.",
            interval(*yearly, digits=2),
            known[0]["n_ageing"],
        )
    ]


def _agreement(fleet: Mapping[str, Fleet]) -> list[str]:
    """How well repeat tows of all types agree, per method and era (ISO 5725)."""
    cells = [
        (
            method if row["scope"] == figures.reproducibility[0]["scope"] else "",
            code_in_words(row["scope"]),
            share(row["within_sd_ratio"], 1),
            _between(row),
            *(share(row[f"share_{which}"]) for which in ("within_1pct", "within_2pct")),
            share(row["share_e_n_above_1"]),
            row["n_pairs"],
            decimals(row["distinct_categories"], 1),
        )
        for method, figures in fleet.items()
        for row in figures.reproducibility
    ]
    head = headings(
        "all types",
        "older tow",
        "s_r",
        "s_R",
        "in 1 %",
        "in 2 %",
        "E_n > 1",
        "pairs",
        "classes",
    )
    meaning = tell(
        "s_r: within a tow; s_R: between tows of one boat (ISO 5725); classes: how many classes of "
        "boats of a type can be told apart."
    )
    return [table(head, cells), wrapped(meaning)]


def _between(row: Row) -> str:
    if not row["n_pairs"]:
        return "-"
    return tell(
        "{} ({} to {})", share(row["sd_ratio"], 1), share(row["lo"], 1), share(row["hi"], 1)
    )


def _repeats(figures: TypeStatistics) -> list[str]:
    """How well repeat tows of this type agree."""
    pairs = figures.repeats
    if not pairs.n_pairs:
        return [tell("no repeat pairs of this type (n 0).")]
    return [
        tell(
            "this type: s_R {} (n {} pairs, {} of {} disagree by E_n).",
            share(pairs.sd_ratio, 1),
            pairs.n_pairs,
            pairs.n_disagree,
            pairs.n_e_n,
        )
    ]


def _cause(row: Row) -> str:
    if row["lo"] is None:
        return share(row["sd_ratio"], 1)
    upper = tell("no bound") if row["hi"] is None else share(row["hi"], 1)
    return tell("{} ({} to {})", share(row["sd_ratio"], 1), share(row["lo"], 1), upper)


def _causes(fleet: Fleet) -> list[str]:
    """Spread of Cw within types by cause."""
    by_component = {row["component"]: row for row in fleet.components}
    if "boat" not in by_component or by_component["boat"]["reason"]:
        reason = by_component["boat"]["reason"] if "boat" in by_component else "no_curves"
        return [tell("spread by cause: nothing claimed, {}.", code_in_words(reason))]
    causes = ", ".join(f"{code_in_words(name)} {_cause(by_component[name])}" for name in CAUSES)
    return [tell("within types, at one speed: {} (n {}).", causes, by_component["boat"]["n"])]


def _newest_reproducibility(fleet: Fleet) -> str:
    """s_R of the last era, what a tow test can do now."""
    rows = [row for row in fleet.reproducibility if row["scope"] == ERAS[-1].name]
    known = [row for row in rows if row["n_pairs"]]
    if not known:
        return tell("not known (n 0 pairs)")
    return tell(
        "{} ({}, n {} pairs)", share(known[0]["sd_ratio"], 1), ERAS[-1].name, known[0]["n_pairs"]
    )


def _prediction(method: str, under: TypeStatistics, fleet: Fleet) -> Iterator[str]:
    own, everyone = under.prediction, fleet.prediction_error
    if not own["n_predicted"] or everyone is None:
        yield wrapped(f"{method}: {nothing({'reason': 'few_boats', 'n': own['n']})}")
        return
    yield wrapped(
        tell(
            "{}: off by {} (n {}; all types {}, n {}); the tow test itself {}, between "
            "seasons {}; {} of {} disagree.",
            method,
            share(own["rmse_ratio"], 1),
            own["n_predicted"],
            share(everyone["rmse_ratio"], 1),
            everyone["n"],
            share(own["tow_sd_ratio"], 1),
            _newest_reproducibility(fleet),
            own["n_disagree"],
            own["n_predicted"],
        )
    )
    boats = [f"{who(row)}: {second_opinion(row)}" for row in under.disagreeing]
    yield from (wrapped(line, 4) for line in listed(boats))
