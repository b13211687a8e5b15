"""The pages of `herijk audit`: the answer, and tables of all that is behind it."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final

from dashboards import labels
from dashboards.statements.boat import Answer, answers_by_boat
from dashboards.statements.boat_type import (
    HEADINGS,
    Names,
    describe_row,
    judge_type,
    order_rows,
    sum_up_type,
)
from dashboards.statements.tow import name_run, name_runs
from dashboards.statements.tow import statements as tow_statements
from herijk.cli.render import (
    Part,
    Section,
    cell,
    codes,
    marked,
    set_aside,
    speech,
    table,
)
from pipeline.messages import say, tell
from pipeline.method.definition import COMPLETE
from pipeline.tables.first_assessment import RULES
from pipeline.tables.row import Row
from warehouse.queries.answers import current_edition
from warehouse.queries.audit import BoatAudit, TypesAudit
from warehouse.queries.views import Views
from warehouse.store.database import make_unknown_edition_error
from warehouse.store.store import Store

if TYPE_CHECKING:
    from warehouse.editions.lineage import Lineage
    from warehouse.queries.assess import Assessment

# A boat


def boat(report: BoatAudit, answers: Sequence[Answer], steps: bool) -> Iterator[Part]:
    """What there is to say of each crew of a boat; how it came about where that is asked."""
    fsn_no = report.boat["fsn_no"]
    yield marked(report.simulated)
    for answer in answers:
        title = f"{fsn_no} {report.boat['name']}, {answer.crew(speech())}"
        about = "{fsn_no} {rowers}{crew_class}".format(**answer.line)
        yield Section(title, answer.statements, about)
    if not steps:
        yield tell("All methods, tows and runs: herijk audit {} --steps", fsn_no)
        return
    none = tell("No tow of this boat was accepted.")
    yield Section(tell("Its tows"), rows=report.tows, columns=TOWS, empty=none)
    for tow in report.tows:
        yield from _tow_steps(tow)
    for table_of, heading, columns in BOAT:
        yield Section(tell(heading), rows=getattr(report, table_of), columns=f"method {columns}")
    title = tell("Set aside, by its number or the name of its file")
    yield Section(title, lines=list(map(set_aside, report.set_aside)))


def answers_of(store: Store, boat: Row, edition: str | None) -> list[Answer]:
    """The answers about the crews of a boat in an edition or draft, the newest where none is asked.

    Raises:
        MissingKnowledgeError: there is no such edition.
    """
    with Views(store) as views:
        chosen = edition or current_edition(views)
        known = views.table("register")["edition"].unique()
        if chosen not in known:
            raise make_unknown_edition_error(chosen, known)
        return answers_by_boat(views, chosen, boat["fsn_no"]).get(boat["fsn_no"], [])


def assessment(report: "Assessment", log_known: bool) -> Iterator[Part]:
    """What a tow on the quay shows, its runs, and what to look at."""
    tow = report.tow
    yield marked(report.simulated)
    yield Section(
        f"{tow['tow_id']} {tow['name'] or tow['fsn_no']}, {tow['rowers']}{tow['crew_class']}",
        tow_statements(report, log_known),
        tow["tow_id"],
    )
    rules = [_sum_up_rule(report, rule) for rule in RULES]
    yield Section(tell("First assessment"), rows=rules, columns="rule verdict runs")
    yield Section(tell("Its runs"), rows=report.runs, columns=TOW, heads=RUN_HEADS)
    for way in report.ways_to_use:
        title = tell(
            "To use {} in place of {}, write this",
            name_runs(way["runs"]),
            name_runs(way["instead_of"]),
        )
        lines = [tell("in column 'gebruik runs' of the list: {}", way["use_runs"])]
        lines += [tell("in archief.toml:"), *(f"  {line}" for line in way["plan"].splitlines())]
        yield Section(title, lines=[f"  {line}" for line in lines])
    yield Section(tell("Set aside"), lines=list(map(set_aside, report.lost)))
    yield tell("Nothing was stored; the next rebuild makes the number anew.")


def _sum_up_rule(report: "Assessment", rule: str) -> Row:
    """Return a rule of the first assessment with its worst verdict and the runs that it names."""
    mine = [row for row in report.first_assessment if row["rule"] == rule]
    again = [row["runs"] for row in mine if row["verdict"] == "tow_again"]
    runs = {run for of_finding in again for run in of_finding} if all(again) else set()
    named = [name_run(run) for run in sorted(runs)]
    return {"rule": rule, "verdict": mine[0]["verdict"], "runs": ", ".join(named)}


RUN_HEADS: Final = {"cw_kg_m": labels.column("run_cw_kg_m")}
"""A run has a Cw at its own speed."""
TOW: Final = (
    "run direction window_start_s window_end_s cut_reason speed_m_s cw_kg_m fitted_cw_kg_m reason"
)
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
BOAT: Final = (
    (
        "in_type",
        say("Its place among the other boats of its type"),
        "tow_id newest cw_standard_kg_m cw_expected_kg_m cw_deviation_sd cw_outside b_m_s "
        "b_expected_m_s b_deviation_sd b_outside candidates",
    ),
    (
        "in_type",
        say("Its tows beside its races"),
        "tow_id declared_speed_m_s power_w slow races raced_speed_m_s raced_beyond_curve "
        "raced_power_w raced_high power_ratio_raced",
    ),
    (
        "repeat_pairs",
        say("Its repeat tows (E_n above 1: they disagree)"),
        "tow_id_before tow_id ln_ratio e_n",
    ),
    (
        "predicted",
        say("As predicted from weight, length, beam and type by the other boats"),
        "tow_id cw_kg_m predicted_cw_kg_m predicted_lo_kg_m predicted_hi_kg_m disagrees",
    ),
    (
        "options",
        say("What other choices do to Cw, the largest first"),
        "tow_id study option cw_effect_ratio",
    ),
    (
        "register",
        say("In the registers"),
        "edition crew status a_kg_m b_m_s cw_kg_m declared_speed_m_s tow_id valid_until",
    ),
)
"""Tables about a boat: where their rows are, their headings, and the columns shown."""


def _tow_steps(tow: Row) -> Iterator[Part]:
    """What each step did to a tow, and its curve and runs under every method."""
    ladders: dict[tuple[str, str], Row] = {}
    for step in tow["steps"]:
        ends = {name: step[name] for name in ("from_method", "to_method")}
        ladder = ladders.setdefault(tuple(ends.values()), ends | {"total": 1.0})
        ladder["total"] *= step["factor"]
        if step["position"] > 0:
            ladder[step["step"]] = cell("cw_ratio", step["factor"])
    yield Section(
        tell("Tow {}: change of Cw by each step", tow["tow_id"]),
        rows=list(ladders.values()),
        columns=" ".join(dict.fromkeys(name for row in ladders.values() for name in row)),
        heads={step["step"]: labels.code(step["step"]) for step in tow["steps"]},
    )
    runs_alone = [c["method"] for c in tow["curves"] if c["interval"] != COMPLETE]
    yield Section(
        tell("Tow {}: curves", tow["tow_id"]),
        rows=tow["curves"],
        columns=CURVES,
        note=tell(
            "The interval of {} is the spread of the runs alone: the log's error is not in it.",
            ", ".join(runs_alone),
        )
        if runs_alone
        else "",
    )
    alike: dict[str, list[str]] = defaultdict(list)  # methods that agree share a table
    for curve in tow["curves"]:
        causes = [row for row in curve["budget"] if row["u_ratio"]]
        tables = (
            table(curve["run_points"], RUNS, RUN_HEADS),
            table(causes, "component shared u_ratio"),
        )
        alike["\n".join(filter(None, tables))].append(curve["method"])
    for runs, methods in alike.items():
        title = tell("Tow {}: runs under {}", tow["tow_id"], ", ".join(methods))
        yield Section(title, lines=[runs])


def lineage(report: "Lineage") -> Iterator[Part]:
    """From the lines of a published edition to files, runs and seconds."""
    about = report.about
    yield tell(
        "Edition {}, valid from {}, method {} ({}), code {}. Decision: {}",
        about["edition"],
        about["valid_from"],
        about["method"] or tell("as printed"),
        (about["method_hash"] or "-")[:12],
        about["code_version"],
        about["decision"],
    )
    for line in report.lines:
        printed = "; ".join(f"{header} {cell}" for header, cell in line["printed"].items() if cell)
        tow = line["tow"]
        yield Section(
            tell("Verification code {}", line["code"]),
            lines=[
                f"  {printed}",
                tell("Tow {} of {}, from", tow["tow_id"], tow["tow_date"])
                if tow
                else tell("No tow of the archive is behind this line."),
                *(f"  {file['path']}  sha256 {file['sha256']}" for file in line["files"]),
            ],
            rows=line["runs"],
            columns="run window_start_s window_end_s speed_m_s cw_kg_m used reason",
            heads=RUN_HEADS,
        )


# Types


def types(report: TypesAudit, steps: bool) -> Iterator[Part]:
    """Tell whether the boats of one or two types are equal; with statistics where asked."""
    newest = report.methods[-1]
    yield marked(report.simulated)
    for one in report.types:
        under = one["under"][newest]
        said = [
            sum_up_type(under["consistency"]),
            *judge_type(under["consistency"], under["outside"], _name_boats(one)),
        ]
        rows = _compare_methods(one, report.methods if steps else [report.methods[0], newest])
        told = [f"told_{place}" for place in range(len(HEADINGS))]
        yield Section(
            _facts(one),
            said,
            one["boat_type"],
            rows=rows,
            columns=f"quantity method n n_boats {' '.join(told[place] for place in SHOWN)}",
            heads=dict(zip(told, HEADINGS, strict=True)),
        )
    if differing := report.differences[newest]:
        named = (" / ".join(map(codes, difference.split())) for difference in differing)
        yield tell("What differs by more than chance: {}", ", ".join(named))
    if not steps:
        names = " ".join(f'"{one["boat_type"]}"' for one in report.types)
        yield tell("All methods and statistics: herijk audit {} --steps", names)
        return
    for name, (title, columns) in STEPS.items():
        rows = _rows(report, report.methods, name)
        yield Section(tell(title), rows=rows, columns=f"boat_type method {columns}")
    yield Section(
        tell("How well repeat tows of all types agree"),
        rows=report.reproducibility,
        columns="method scope within_sd_ratio sd_ratio lo hi n_pairs",
    )


def _facts(of_type: Row) -> str:
    return tell(
        "{boat_type}: {n_boats} boats, {n_towed} of them towed; {n_tows} tows of {first_season} to "
        "{last_season}; weight {lightest_kg} to {heaviest_kg} kg; declared speed {slowest_m_s} to "
        "{fastest_m_s} m/s",
        **{name: cell(name, value) for name, value in of_type.items() if name != "under"},
    )


def _name_boats(of_type: Row) -> Names:
    """Return the name of each boat of a type that is named, by its number."""
    names: dict[str, str] = {}
    for under in of_type["under"].values():
        names |= {row["farthest"]: row["farthest_name"] for row in under["consistency"]}
        names |= {row["fsn_no"]: row["name"] for row in under["outside"]}
    return names


def _compare_methods(of_type: Row, methods: Sequence[str]) -> list[Row]:
    """Return rows in words of Cw, B and A of a type, each under the methods side by side."""
    names = _name_boats(of_type)
    rows = []
    for method in dict.fromkeys(methods):
        for row in of_type["under"][method]["consistency"]:
            about = f"{of_type['boat_type']} {row['quantity']} {method}"
            cells = {f"told_{place}": told for place, told in enumerate(describe_row(row, names))}
            rows.append(row | cells | {"about": about})
    return order_rows(rows)


def _rows(report: TypesAudit, methods: Sequence[str], name: str) -> list[Row]:
    """What the statistics of every type and method have under a name, as rows."""
    return [
        row | {"boat_type": one["boat_type"], "method": method}
        for one in report.types
        for method in methods
        for row in one["under"][method][name]
    ]


SHOWN: Final = (0, 2, 3)
"""Places in `HEADINGS` that fit on a terminal; the others are in the sentences and in `--json`."""

STEPS: Final = {
    "consistency": (
        say("Are they equal?"),
        "quantity n n_boats mean verdict rest_verdict difference_that_matters spread_ratio "
        "spread_lo spread_hi error_ratio repeat_pairs noise_ratio zero_sd_n season_sd",
    ),
    "outside": (
        say("Boats that stand out"),
        "fsn_no name tow_id cw_standard_kg_m cw_expected_kg_m cw_deviation_sd b_m_s "
        "b_expected_m_s b_deviation_sd candidates",
    ),
    "slow_tows": (say("Slow tows"), "fsn_no name tow_id declared_speed_m_s power_w"),
    "eras": (say("Does an era stand apart?"), "era shift_ratio lo hi apart n reason"),
    "repeats": (say("Repeat tows"), "n_pairs sd_ratio n_e_n n_disagree"),
}
"""Statistics of a type with the columns shown."""
