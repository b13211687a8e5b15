"""The pages of `herijk audit`: the answer, and tables of all that is behind it."""

from collections.abc import Iterator, Sequence
from math import exp
from typing import TYPE_CHECKING, Final

import polars as pl

from dashboards.labels import code_in_words
from dashboards.statements import Statement
from dashboards.statements.boat import Answer, answers_by_boat
from dashboards.statements.boat_type import LINES, SPREAD, homogeneity, level, slopes
from herijk.cli.options import Told
from herijk.cli.render import (
    cell,
    codes,
    interval_of_runs_alone,
    page,
    place,
    section,
    speech,
    table,
    why_set_aside,
    with_crew,
)
from pipeline.messages import say, tell
from pipeline.method.definition import COMPLETE
from pipeline.tables.row import Row
from warehouse.queries.answers import current_edition
from warehouse.queries.audit import WEIGHT_LINE, BoatAudit, TypesAudit
from warehouse.queries.views import Views
from warehouse.store.database import no_such_edition
from warehouse.store.store import Store

if TYPE_CHECKING:
    from warehouse.editions.lineage import Lineage
    from warehouse.queries.assess import Assessment

# A boat


def boat_text(report: BoatAudit, answers: Sequence[Answer], steps: bool) -> str:
    """What there is to say of each crew of a boat; how it came about where that is asked."""
    parts = [
        "\n".join(
            [
                f"{report.boat['fsn_no']} {report.boat['name']}, {answer.crew(speech())}",
                *map(_worded, answer.statements),
            ]
        )
        for answer in answers
    ]
    if steps:
        parts += list(_boat_steps(report))
    else:
        parts.append(
            tell("All methods, tows and runs: herijk audit {} --steps", report.boat["fsn_no"])
        )
    return page(parts, report.simulated)


def answers_of(store: Store, boat: Row, edition: str | None) -> list[Answer]:
    """The answers about the crews of a boat in an edition or draft, the newest where none is asked.

    Raises:
        MissingKnowledgeError: there is no such edition.
    """
    with Views(store) as views:
        chosen = edition or current_edition(views)
        known = views.table("register")["edition"].unique()
        if chosen not in known:
            raise no_such_edition(chosen, known)
        return answers_by_boat(views, chosen, boat["fsn_no"]).get(boat["fsn_no"], [])


def said_of_boat(answers: Sequence[Answer]) -> Told:
    """All that is said of each crew of a boat."""
    return {
        "{fsn_no} {rowers}{crew_class}".format(**answer.line): answer.statements
        for answer in answers
    }


TOW: Final = (
    "run direction window_start_s window_end_s cut_reason speed_m_s cw_kg_m fitted_cw_kg_m reason"
)


def assessment_text(report: "Assessment", said: Sequence[Statement]) -> str:
    """What a tow on the quay shows, its runs, and what to look at."""
    tow = with_crew(report.tow)
    parts = [
        f"{tow['tow_id']} {tow['name'] or tow['fsn_no']}, {tow['crew']}\n"
        + "\n".join(map(_worded, said)),
        section(tell("Its runs"), table(report.runs, TOW)),
        section(tell("To look at"), table(report.checks, "check observed limit unit")),
        section(
            tell("Set aside"), *(f"  {place(row)}: {why_set_aside(row)}" for row in report.lost)
        ),
        tell("Nothing was stored; the next rebuild makes the number anew."),
    ]
    return page(parts, report.simulated)


TOWS: Final = (
    "tow_id tow_date crew declared_speed_m_s waterline_length_m beam_m bow_height_m weight_kg "
    "altered"
)
CURVES: Final = (
    "method a_kg_m b_m_s b_lo_m_s b_hi_m_s cw_kg_m cw_lo_kg_m cw_hi_kg_m power_w status flags"
)
RUNS: Final = (
    "run window_start_s window_end_s cut_reason speed_factor speed_m_s gross_cw_kg_m "
    "inertia_cw_kg_m air_cw_kg_m still_air_cw_kg_m temperature_cw_kg_m cw_kg_m fitted_cw_kg_m "
    "reason"
)
BOAT: Final = {
    "in_type": (
        say("Its place among the other boats of its type"),
        "tow_id quantity value expected deviation_sd outside candidates",
    ),
    "pooled": (say("If it shared its type's bend"), "tow_id pooling b_m_s cw_kg_m"),
    "slow_tows": (say("Slow tow"), "tow_id declared_speed_m_s power_w slow"),
    "repeat_pairs": (
        say("Its repeat tows (E_n above 1: they disagree)"),
        "tow_id_before tow_id shift_ratio e_n",
    ),
    "predicted": (
        say("As predicted from weight, length, beam and type by the other boats"),
        "tow_id cw_kg_m predicted_cw_kg_m predicted_lo_kg_m predicted_hi_kg_m disagrees",
    ),
    "options": (
        say("What other choices do to Cw, the largest first"),
        "tow_id study option cw_effect_ratio",
    ),
    "register": (
        say("In the registers"),
        "edition crew status a_kg_m b_m_s cw_kg_m declared_speed_m_s tow_id valid_until",
    ),
}
"""Tables about a boat, with the columns shown."""


def _boat_steps(report: BoatAudit) -> Iterator[str]:
    """Tables of all that is known of a boat, in the order in which it is made."""
    tows = table(report.tows, TOWS)
    yield section(tell("Its tows"), tows or tell("  No tow of this boat was accepted."))
    for tow in report.tows:
        yield from _tow_steps(tow)
    for name, (heading, columns) in BOAT.items():
        rows = list(map(_shown, getattr(report, name)))
        yield section(tell(heading), table(rows, f"method {columns}"))
    faults = [f"  {place(row)}: {why_set_aside(row)}" for row in report.set_aside]
    yield section(tell("Set aside, by its number or the name of its file"), *faults)


def _shown(row: Row) -> Row:
    """A row with what columns show that the table has in another form."""
    shown = dict(row)
    if "ln_ratio" in row:
        shown["shift_ratio"] = None if row["ln_ratio"] is None else exp(row["ln_ratio"])
    return shown


def _tow_steps(tow: Row) -> Iterator[str]:
    """What each step did to a tow, and its curve and runs under every method."""
    ends = ("from_method", "to_method")
    ladders: dict[tuple[str, str], Row] = {}
    for step in tow["steps"]:
        ladder = ladders.setdefault((step[ends[0]], step[ends[1]]), {"total": 1.0})
        ladder["total"] *= step["factor"]
        if step["position"] > 0:
            ladder[step["step"]] = cell("cw_ratio", step["factor"])
    rows = [dict(zip(ends, pair, strict=True)) | row for pair, row in ladders.items()]
    names = dict.fromkeys(name for row in rows for name in row)
    heads = {name: code_in_words(name) for name in names if name not in (*ends, "total")}
    yield section(
        tell("Tow {}: change of Cw by each step", tow["tow_id"]),
        table(rows, " ".join(names), heads),
    )
    runs_alone = [c["method"] for c in tow["curves"] if c["interval"] != COMPLETE]
    yield section(
        tell("Tow {}: curves", tow["tow_id"]),
        table(tow["curves"], CURVES),
        interval_of_runs_alone(", ".join(runs_alone)) if runs_alone else "",
    )
    for methods, runs in _alike(tow["curves"]).items():
        yield section(tell("Tow {}: runs under {}", tow["tow_id"], methods), runs)


def _alike(curves: Sequence[Row]) -> dict[str, str]:
    """The runs of every curve with what makes it uncertain; methods that agree share a table."""
    methods: dict[str, list[str]] = {}
    for curve in curves:
        budget = [row for row in curve["budget"] if row["u_ratio"]]
        runs = table(curve["run_points"], RUNS)
        causes = table(budget, "component shared u_ratio")
        methods.setdefault(f"{runs}\n{causes}", []).append(curve["method"])
    return {", ".join(names): runs for runs, names in methods.items()}


def lineage_text(report: "Lineage") -> str:
    """From the lines of a published edition to files, runs and seconds."""
    about = report.about
    head = tell(
        "Edition {}, valid from {}, method {} ({}), code {}. Decision: {}",
        about["edition"],
        about["valid_from"],
        about["method"] or tell("as printed"),
        (about["method_hash"] or "-")[:12],
        about["code_version"],
        about["decision"],
    )
    return "\n\n".join([head, *map(_line_history, report.lines)])


def _line_history(line: Row) -> str:
    printed = "; ".join(f"{header} {cell}" for header, cell in line["printed"].items() if cell)
    head = tell("Verification code {}", line["code"])
    if line["tow"] is None:
        return section(head, printed, tell("No tow of the archive is behind this line."))
    runs = "run window_start_s window_end_s speed_m_s cw_kg_m used reason"
    return section(
        head,
        f"  {printed}",
        tell("Tow {} of {}, from", line["tow"]["tow_id"], line["tow"]["tow_date"]),
        *(f"  {file['path']}  sha256 {file['sha256']}" for file in line["files"]),
        table(line["runs"], runs),
    )


# Types


def said_of_types(report: TypesAudit) -> Told:
    """Whether the boats of each type are equal, and what their A, B and Cw follow."""
    newest = report.methods[-1]
    said = {one["boat_type"]: _equal(one, newest) for one in report.types}
    for one in slopes(_rows(report, _ends(report), "lines")):
        about = f"{one.boat_type} {one.quantity} {one.method}"
        said[about] = [*one.slopes, one.spread]
    return said


def _ends(report: TypesAudit) -> Sequence[str]:
    """The first and the last method."""
    return list(dict.fromkeys([report.methods[0], report.methods[-1]]))


def types_text(report: TypesAudit, steps: bool) -> str:
    """Whether the boats of one or two types are equal; with which statistics where asked."""
    newest = report.methods[-1]
    compared = report.methods if steps else _ends(report)
    parts = [_slopes(report, compared)]
    parts += ["\n".join([_facts(one), *map(_worded, _equal(one, newest))]) for one in report.types]
    if differing := report.differences[newest]:
        parts.append(
            tell("What differs by more than chance: {}", ", ".join(map(_named, differing)))
        )
    if steps:
        parts += list(_type_steps(report))
    else:
        names = " ".join(f'"{one["boat_type"]}"' for one in report.types)
        parts.append(tell("All methods and statistics: herijk audit {} --steps", names))
    return page(parts, report.simulated)


def _named(difference: str) -> str:
    return " / ".join(map(codes, difference.split()))


def _facts(of_type: Row) -> str:
    return tell(
        "{}: {} boats, {} of them towed; {} tows of {} to {}; weight {} to {} kg; declared "
        "speed {} to {} m/s",
        *(of_type[name] for name in ("boat_type", "n_boats", "n_towed", "n_tows")),
        *(cell(name, of_type[name]) for name in RANGES),
    )


RANGES: Final = (
    *("first_season", "last_season", "lightest_kg", "heaviest_kg"),
    *("slowest_m_s", "fastest_m_s"),
)


def _worded(statement: Statement) -> str:
    return statement(speech())


def _equal(of_type: Row, method: str) -> list[Statement]:
    """Whether they are equal, as the site says it, and which tows stand out."""
    under = of_type["under"][method]
    line = [row for row in under["lines"] if row.items() >= WEIGHT_LINE.items()]
    tested, newest, lines = (pl.DataFrame(rows) for rows in (under["bends"], under["newest"], line))
    return [homogeneity(tested), level(newest, lines)]


def _slopes(report: TypesAudit, methods: Sequence[str]) -> str:
    """B, A and Cw on weight and on tow speed, of every type by method."""
    names = {f"slope_{place}": tell(heading) for place, heading in enumerate(LINES.values())}
    rows = []
    for one in slopes(_rows(report, methods, "lines")):
        cells = dict(zip(names, (statement(speech()) for statement in one.slopes), strict=True))
        rows.append(one._asdict() | cells | {"spread": one.spread(speech())})
    title = tell(
        "Do B, A and Cw follow weight or tow speed? Cw at the standard speed, of the newest tow of "
        "each crew."
    )
    columns = f"boat_type quantity method n {' '.join(names)} spread"
    return section(title, table(rows, columns, names | {"spread": tell(SPREAD)}))


def _rows(report: TypesAudit, methods: Sequence[str], name: str) -> list[Row]:
    """What the statistics of every type and method have under a name, as rows."""
    return [
        row | {"boat_type": one["boat_type"], "method": method}
        for one in report.types
        for method in methods
        for row in one["under"][method][name]
    ]


STEPS: Final = {
    "bends": (
        say("Can all boats have the same bend?"),
        "n p_value power_at_10pct noise_share equal_possible reason",
    ),
    "speed_trend": (
        say("Does the bend q = (v/B)^2 / (1 - (v/B)^2) follow the tow speed?"),
        "n slope slope_lo slope_hi follows reason",
    ),
    "hull_speed": (say("Is B hull speed?"), "n b_ratio b_ratio_lo b_ratio_hi tow_ratio"),
    "shared": (
        say("If like boats shared one bend: B, and the most that Cw would move at 115 %"),
        "pooling n median_b_m_s b_sd_ratio most_115 most_fsn_no",
    ),
    "outside": (
        say("Boats outside their type"),
        "fsn_no name tow_id quantity value expected deviation_sd",
    ),
    "slow_tows": (say("Slow tows"), "fsn_no name tow_id declared_speed_m_s power_w"),
    "eras": (say("Does an era stand apart?"), "era shift_ratio lo hi apart n reason"),
    "repeats": (say("Repeat tows"), "n_pairs sd_ratio n_e_n n_disagree"),
    "prediction": (
        say("Cw from weight, length, beam and type"),
        "n_predicted rmse_ratio tow_sd_ratio n_disagree",
    ),
}
"""Statistics of a type with the columns shown."""


def _type_steps(report: TypesAudit) -> Iterator[str]:
    for name, (title, columns) in STEPS.items():
        rows = _rows(report, report.methods, name)
        yield section(tell(title), table(rows, f"boat_type method {columns}"))
    shown = table(report.reproducibility, "method scope within_sd_ratio sd_ratio lo hi n_pairs")
    yield section(tell("How well repeat tows of all types agree"), shown)
