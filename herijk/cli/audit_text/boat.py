"""The page of a boat: its tows step by step, its place in its type, and its own history."""

from collections.abc import Iterator
from itertools import groupby
from math import exp
from typing import Final

from dashboards.labels import code_in_words
from herijk.cli.audit_text.words import (
    change,
    codes,
    distance,
    explained,
    nothing,
    second_opinion,
    section,
    share,
    slow_tow,
    wrapped,
)
from herijk.cli.text import decimals, place, table, why_set_aside, window
from pipeline.messages import headings, say, tell
from pipeline.method.definition import COMPLETE
from pipeline.tables.row import Row
from warehouse.queries.audit import BoatAudit

RUNS_ALONE_MEANS: Final = say("runs alone: spread of the runs alone: the log's error is not in it")
LEAST_FELT: Final = 5e-4
"""Change of Cw below which a step or choice does nothing that is worth a word."""

LEAST_TOLD: Final = 5e-5
"""Part of Cw below which a cause of uncertainty is nothing in two decimals of a per cent."""


def boat_page(report: BoatAudit) -> list[str]:
    """The parts of the page."""
    boat = report.boat
    parts = [_boat_title(boat, report.tows)]
    parts += [_tow(tow) for tow in report.tows]
    if not report.tows:
        parts.append(tell("No tow of this boat was accepted."))
    sections = [
        (_place_title(report), _place(report)),
        (
            tell("If it shared its type's bend:"),
            [_pooled(row) for row in _not_own(report.pooled)],
        ),
        (
            tell("Slow tow:"),
            [f"  {r['method']}: {slow_tow(r | {'name': ''})}" for r in report.slow_tows],
        ),
        (
            tell(
                "Its repeat tows (without an alteration between them; E_n above 1: they disagree):"
            ),
            [_pair(row) for row in report.repeat_pairs] or [tell("  none: n 0")],
        ),
        (
            tell("As predicted from weight, length, beam and type by the other boats:"),
            [_predicted(row) for row in report.predicted] or [tell("  not predicted: n 0")],
        ),
        (
            tell(
                "What other choices do to Cw, the largest first (the tool of 2015 let one tick: "
                "tool):"
            ),
            list(_options(report.options)),
        ),
        (
            tell("In the registers:"),
            [_register(row) for row in report.register] or [tell("  no line")],
        ),
        (
            tell("Set aside, by its number or the name of its file:"),
            [f"  {place(row)}: {why_set_aside(row)}" for row in report.set_aside]
            or [tell("  nothing")],
        ),
    ]
    laid = [(title, [wrapped(line.strip()) for line in lines]) for title, lines in sections]
    return [*parts, *(section(*one) for one in laid if one[1])]


def _boat_title(boat: Row, tows: list[Row]) -> str:
    title = tell(
        "{} {}, type {}", boat["fsn_no"], boat["name"], boat["boat_type"] or tell("not known")
    )
    crews = sorted({f"{tow['rowers']}{tow['crew_class']}" for tow in tows})
    if len(crews) < 2:
        return title
    return wrapped(
        tell(
            "{}; towed for {} crews ({}): each has a register line and repeats of its "
            "own; in the statistics of a type they are one boat",
            title,
            len(crews),
            ", ".join(crews),
        ),
        0,
    )


def _place_title(report: BoatAudit) -> str:
    size = report.type_size
    return tell(
        "Its place among {} towed boats of its type ({}), newest tow of each boat and crew:",
        size.n_towed,
        size.boat_type,
    )


def _place(report: BoatAudit) -> list[str]:
    lines = []
    for row in report.in_type:
        why = explained(row)
        place = tell("outside") if row["outside"] else tell("within")
        lines.append(
            tell(
                "  {}, {}{}, {}: {}, {:+.1f} sd, {}{}",
                row["method"],
                row["rowers"],
                row["crew_class"],
                row["tow_id"],
                distance(row),
                row["deviation_sd"],
                place,
                why and f" ({why})",
            )
        )
    size = report.type_size
    unknown = report.boat["boat_type"] is None
    reason = {"reason": "no_type" if unknown else "few_boats", "n": 0, "n_boats": size.n_towed}
    return lines or [f"  {nothing(reason)}"]


def _not_own(pooled: list[Row]) -> Iterator[Row]:
    """Curves with a bend drawn to the type's, with the own Cw beside them."""
    own = {(row["method"], row["tow_id"]): row for row in pooled if row["pooling"] == "own"}
    for row in pooled:
        if row["pooling"] != "own":
            yield row | {"own": own[row["method"], row["tow_id"]]}


def _pooled(row: Row) -> str:
    own = row["own"]
    words = {"partial": tell("in part"), "shared": tell("wholly")}[row["pooling"]]
    b = [
        tell("{:.2f} m/s", c["b_m_s"]) if c["b_m_s"] else tell("not determined") for c in (own, row)
    ]
    at_115 = [c["cw_115_kg_m"] for c in (own, row)]
    moved = "" if None in at_115 else tell(", Cw at 115 % {} %", change(at_115[1] / at_115[0]))
    return tell(
        "  {}, {}, {}: B {} to {}, Cw at the declared speed {} %{}",
        row["method"],
        row["tow_id"],
        words,
        b[0],
        b[1],
        change(row["cw_kg_m"] / own["cw_kg_m"]),
        moved,
    )


def _pair(row: Row) -> str:
    e_n = tell("not known") if row["e_n"] is None else tell("{:+.2f}", row["e_n"])
    return tell(
        "  {}, {}{}, {} to {}: Cw {} %, E_n {}",
        row["method"],
        row["rowers"],
        row["crew_class"],
        row["tow_id_before"],
        row["tow_id"],
        change(exp(row["ln_ratio"])),
        e_n,
    )


def _predicted(row: Row) -> str:
    if row["predicted_cw_kg_m"] is None:
        return f"  {row['method']}: {nothing({'reason': row['reason'] or 'few_boats', 'n': 0})}"
    verdict = tell("they disagree") if row["disagrees"] else tell("they agree")
    return f"  {row['method']}, {row['tow_id']}: {second_opinion(row)}; {verdict}"


def _options(effects: list[Row]) -> Iterator[str]:
    """A line per tow, method and study; choices that do nothing are left out."""
    for key, group in groupby(effects, key=lambda e: (e["tow_id"], e["method"], e["study"])):
        felt = [
            f"{e['option']} {change(e['cw_effect_ratio'])} %"
            for e in group
            if abs(e["cw_effect_ratio"] - 1.0) > LEAST_FELT
        ]
        if felt:
            yield f"  {', '.join(key)}: {', '.join(felt)}"


def _register(row: Row) -> str:
    line = f"  {row['edition']}, {row['rowers']}{row['crew_class']}: {code_in_words(row['status'])}"
    if row["cw_kg_m"] is None:
        return line
    b = tell("B not determined") if row["b_m_s"] is None else tell("B {:.2f}", row["b_m_s"])
    return tell(
        "{}, A {:.2f}, {}, Cw {:.2f} at {:.2f} m/s, tow {}, until {}",
        line,
        row["a_kg_m"],
        b,
        row["cw_kg_m"],
        row["declared_speed_m_s"],
        row["tow_id"],
        row["valid_until"],
    )


def _tow(tow: Row) -> str:
    weight = tell("weight not known") if tow["weight_kg"] is None else f"{tow['weight_kg']:.0f} kg"
    sizes = (tow[key] for key in ("waterline_length_m", "beam_m", "bow_height_m"))
    head = tell(
        "Tow {} of {}: {}{}, declared {:.2f} m/s, {} m, {}, from {}",
        tow["tow_id"],
        tow["tow_date"],
        tow["rowers"],
        tow["crew_class"],
        tow["declared_speed_m_s"],
        " x ".join(decimals(size, 2) for size in sizes),
        weight,
        tow["samples_path"],
    )
    return "\n".join([head, *_steps(tow["steps"]), *(_curve(curve) for curve in tow["curves"])])


def _steps(steps: list[Row]) -> list[str]:
    """What each step of a correction does to the tow's Cw; steps that do nothing are left out."""
    lines = []
    for ends in dict.fromkeys((step["from_method"], step["to_method"]) for step in steps):
        own = [s for s in steps if (s["from_method"], s["to_method"]) == ends]
        felt = [
            f"{code_in_words(s['step'])} {change(s['factor'])} %"
            for s in own
            if abs(s["factor"] - 1) > LEAST_FELT
        ]
        total = change(own[-1]["cw_kg_m"] / own[0]["cw_kg_m"])
        lines.append(
            tell(
                "  {} to {}: Cw {} %{}{}",
                ends[0],
                ends[1],
                total,
                " = " if felt else "",
                ", ".join(felt),
            )
        )
    return lines


def _curve(curve: Row) -> str:
    head = headings(
        "run",
        "window s",
        "cut because",
        "factor",
        "v m/s",
        "gross kg/m",
        "-inertia",
        "-air",
        "+still",
        "+temp",
        "Cw kg/m",
        "curve",
        "",
    )
    rows = [
        (
            p["run"],
            window(p),
            codes(p["cut_reason"].split(",")),
            p["speed_factor"],
            p["speed_m_s"],
            p["gross_cw_kg_m"],
            p["inertia_cw_kg_m"],
            p["air_cw_kg_m"],
            p["still_air_cw_kg_m"],
            p["temperature_cw_kg_m"],
            p["cw_kg_m"],
            p["fitted_cw_kg_m"],
            codes([p["reason"]]),
        )
        for p in curve["run_points"]
    ]
    parts = [f"  {curve['method']}: {_result(curve)}", table(head, rows), _budget(curve["budget"])]
    return "\n".join(part for part in parts if part)


def _budget(budget: list[Row]) -> str:
    """What makes Cw uncertain, the largest first; with whom it is shared where it is."""
    felt = [
        f"{code_in_words(row['component'])} {share(row['u_ratio'], 2)}"
        + ("" if row["shared"] == "single" else f" ({code_in_words(row['shared'])})")
        for row in budget
        if row["u_ratio"] and row["u_ratio"] >= LEAST_TOLD
    ]
    return wrapped(tell("standard uncertainty of Cw: {}", ", ".join(felt)), 4) if felt else ""


def _result(curve: Row) -> str:
    flags = f" ({codes(curve['flags'])})" if curve["flags"] else ""
    if curve["cw_kg_m"] is None:
        return tell("no curve, {}{}", code_in_words(curve["status"]), flags)
    b = tell("B not determined") if curve["b_m_s"] is None else tell("B {:.2f} m/s", curve["b_m_s"])
    numbers = tell(
        "A {:.2f} kg/m, {} ({}), Cw {:.2f} kg/m ({}: {:.2f} to {:.2f}), {:.1f} W per rower, {}{}",
        curve["a_kg_m"],
        b,
        _interval_of_b(curve),
        curve["cw_kg_m"],
        _named(curve),
        curve["cw_lo_kg_m"],
        curve["cw_hi_kg_m"],
        curve["power_w"],
        code_in_words(curve["status"]),
        flags,
    )
    left_out = [] if curve["interval"] == COMPLETE else [tell(RUNS_ALONE_MEANS)]
    return "; ".join([numbers, *left_out])


def _interval_of_b(curve: Row) -> str:
    if curve["b_lo_m_s"] is None:
        return tell("no interval")
    upper = (
        tell("no upper bound") if curve["b_hi_m_s"] is None else tell("{:.2f}", curve["b_hi_m_s"])
    )
    return tell("{}: {:.2f} to {}", _named(curve), curve["b_lo_m_s"], upper)


def _named(curve: Row) -> str:
    """What an interval is called: without the log's error in it, it is not a 95 % interval."""
    return "95 %" if curve["interval"] == COMPLETE else tell("runs alone")
