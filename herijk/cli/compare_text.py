"""Two editions or two methods side by side: who gains, who loses, and why."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from dashboards import labels
from dashboards.labels import code_in_words
from herijk.cli.methods_text import options_text
from herijk.cli.render import cell, codes, interval_of_runs_alone, page, section, speech, table
from pipeline.messages import in_per_cent, say, tell
from pipeline.method.variant import Difference, differences
from pipeline.register.register import draft_name
from pipeline.tables.row import Row
from warehouse.editions.compare import DiffReport, Group
from warehouse.queries.scenario import RebaseReport, against_print, rebase
from warehouse.store.editions import edition_names, method_of_edition, read_edition
from warehouse.store.methods import KnownMethods
from warehouse.store.store import Store

# Methods


@dataclass(frozen=True)
class MethodComparison:
    """Two methods side by side.

    Attributes:
        old, new: what is compared.
        options: options that differ, where both have a method.
        effect: what that does to all boats; None where the data folder has no tows.
    """

    old: str
    new: str
    options: list[Difference]
    effect: RebaseReport | None


def of_methods(store: Store, old: str, new: str) -> MethodComparison:
    """Compares the methods of two editions or drafts, or methods themselves.

    Raises:
        MissingKnowledgeError: there is no such method or edition, or the new one is a printed
            edition, which has no method.
    """
    known, editions = KnownMethods.of(store), edition_names(store)
    if new in editions:
        method = method_of_edition(store, new)
    else:
        method = known.named(new.removeprefix(draft_name("")))
    printed = read_edition(store, old) if old in editions else None
    if printed is not None and printed.method is None:
        return MethodComparison(old, method.name, [], against_print(store, method, printed))
    before = (
        method_of_edition(store, old) if printed else known.named(old.removeprefix(draft_name("")))
    )
    options = list(differences(method, before))
    effect = rebase(store, method, before) if store.made_from("tows") else None
    return MethodComparison(before.name, method.name, options, effect)


def methods(report: MethodComparison) -> str:
    """Which options differ, and what that does per season and to the boats most affected."""
    if not report.options and report.effect is None:
        return tell("{} and {} say the same of every season.", report.old, report.new)
    effect = report.effect
    parts = [options_text(report.options, report.old, report.new)]
    if effect is not None:
        parts += _effect(effect)
    return page(parts, effect is not None and effect.simulated)


def _effect(report: RebaseReport) -> list[str]:
    counts = ", ".join(f"{row['count']} {code_in_words(row['change'])}" for row in report.changes)
    steps = [name for name in (report.by_season or [{}])[0] if name not in SEASON]
    heads = {name: code_in_words(name) for name in steps}
    seasons = [row | _as_changes(row, steps) for row in report.by_season]
    boats = [row | _as_changes(row, steps) | {"in_2_h": in_two_hours(row)} for row in report.boats]
    shown = " ".join(steps)
    return [
        tell("{} against {}; nothing was stored.", report.method, report.against),
        tell("Register lines: {}.", counts),
        section(
            tell(
                "Change of Cw at the declared speed by each step, median of the season's tows; a "
                "tow's\nown steps multiply to its total, medians need not:"
            ),
            table(seasons, f"season tows {shown} total", heads),
        ),
        section(
            tell("Register lines most affected:"),
            table(boats, f"fsn_no name crew {shown} cw_ratio in_2_h", heads | CW),
        ),
    ]


CW: Final = {"cw_ratio": say("Cw")}
SEASON: Final = ("season", "tows", "total")


def _as_changes(row: Row, steps: Sequence[str]) -> Row:
    return {name: cell("cw_ratio", row.get(name)) for name in steps}


def in_two_hours(row: Row) -> str:
    """What a line of the register gives in a race of two hours."""
    return seconds(7200 * (row["time_ratio"] - 1))


def seconds(value: float | None) -> str:
    """Seconds with their sign."""
    return "-" if value is None else f"{speech().number(value, 0, '+')}\u00a0s"


# Editions


def editions(report: DiffReport) -> str:
    """Two editions side by side."""
    counts = ", ".join(f"{n} {codes(change)}" for change, n in report.changes.items())
    known = report.changes.get("changed", 0) > report.interval_unknown
    causes = [cause | {"cause": tell(labels.cause(cause))} for cause in report.causes]
    parts = [
        f"{report.from_edition} -> {report.to_edition}: {counts or tell('no lines')}.",
        tell(
            "Gain (more power for the same race): {}\nLose: {}\nLarger than the "
            "uncertainty: {}; uncertainty not known for {}.",
            _group(report.gain),
            _group(report.loss),
            str(report.exceeds_interval) if known else tell("not known"),
            report.interval_unknown,
        ),
        interval_of_runs_alone(", ".join(report.runs_alone)) if report.runs_alone else "",
        section(tell("Causes, with their factor on Cw:"), table(causes, CAUSES)),
        section(
            tell(
                "Every line: A and Cw in kg/m, B in m/s, W per rower at the old declared "
                "speed, seconds that the new register gives in\na two-hour race, rank at "
                "equal power among all boats of the class:"
            ),
            table(list(map(_line, report.rows)), LINE),
        ),
        _races(report),
    ]
    return page(parts, report.simulated)


CAUSES: Final = "cause lines median_factor lowest_factor highest_factor"
LINE: Final = (
    "fsn_no name crew change old_a_kg_m new_a_kg_m old_b_m_s new_b_m_s old_cw_kg_m new_cw_kg_m "
    "old_power_w new_power_w power_ratio in_2_h old_rank new_rank causes"
)


def _line(row: Row) -> Row:
    change = code_in_words(row["change"])
    if row["change"] == "removed":
        change += f": {code_in_words(row['new_status'] or 'gone')}"
    in_2_h = seconds(row["gain_in_two_hours_s"])
    return row | {"change": change, "in_2_h": in_2_h}


def _group(group: Group) -> str:
    if not group.lines:
        return tell("no lines")
    return tell(
        "{} lines, median {}, {} in two hours",
        group.lines,
        cell("power_ratio", group.median_power_ratio),
        seconds(group.median_seconds),
    )


FATIGUE: Final = {
    "none": say("Races, not corrected for fatigue: "),
    "known": say("Races, corrected for fatigue as published: "),
    "extend": (
        say("Races, corrected for fatigue (beyond 2 to 3 hours by the same power law, inferred): ")
    ),
}


def _races(report: DiffReport) -> str:
    if report.races is None or report.race_rules is None or report.winners is None:
        return tell("Races: the archive holds none.")
    ranked = [r for r in report.races if r["new_rank"] is not None]
    moved = [r for r in ranked if r["old_rank"] != r["new_rank"]]
    text = tell(
        "{}{} results, {} of them ranked by both editions: {} change rank among those, "
        "{} on or off the podium.",
        tell(FATIGUE[report.race_rules.fatigue]),
        len(report.races),
        len(ranked),
        len(moved),
        sum(r["podium_changed"] for r in ranked),
    )
    winners = [winner | {"chance": _chance(winner)} for winner in report.winners]
    parts = [
        text,
        section(tell("Winners:"), table(winners, WINNER)),
        tell("  The chance: in how many of the equally likely new registers the old winner loses."),
        section(tell("Ranks that change:"), table(moved, MOVED)),
    ]
    return "\n".join(filter(None, parts))


WINNER: Final = "race race_date crew_class old_winner new_winner winner_changed chance"
MOVED: Final = "race race_date fsn_no crew old_power_w new_power_w old_rank new_rank podium_changed"


def _chance(winner: Row) -> str:
    chance = winner["change_probability"]
    return tell("not known") if chance is None else in_per_cent(chance)
