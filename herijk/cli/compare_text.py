"""Two editions, drafts or methods side by side: who gains, who loses, and why."""

from dataclasses import dataclass
from typing import Final

from dashboards import labels
from dashboards.labels import code_in_words
from herijk.cli.methods_text import options_text
from herijk.cli.render import cell, codes, interval_of_runs_alone, page, section, speech, table
from pipeline.messages import in_per_cent, say, tell
from pipeline.method.variant import Difference, differences
from pipeline.register.register import draft_name
from pipeline.register.replay import RaceRules
from pipeline.tables.row import Row
from warehouse.editions.compare import DiffReport, report_with_races
from warehouse.editions.publish import drafted
from warehouse.store.editions import Edition, edition_names, read_edition
from warehouse.store.methods import KnownMethods
from warehouse.store.store import Store


@dataclass(frozen=True)
class Compared:
    """Two editions, drafts or methods side by side.

    Attributes:
        old, new: what is compared.
        options: options that differ, where both have a method.
        effect: what that does to all boats; None where a draft is to be made and the data folder
            has no tows.
    """

    old: str
    new: str
    options: list[Difference]
    effect: DiffReport | None


def compared(store: Store, old: str, new: str, rules: RaceRules) -> Compared:
    """Compares editions as they are, and drafts, methods and method files as their drafts are.

    Two drafts are compared over all of history: also lines whose tow has expired.

    Raises:
        HerijkError: there is no such method or edition, or it cannot be computed.
    """
    known, published = KnownMethods.of(store), edition_names(store)
    sides = [
        read_edition(store, name)
        if name in published
        else known.named(name.removeprefix(draft_name("")))
        for name in (old, new)
    ]
    before, after = (side.method if isinstance(side, Edition) else side for side in sides)
    options = [] if before is None or after is None else list(differences(after, before))
    if not {old, new} <= {*published} and store.made_from("tows") is None:
        return Compared(old, new, options, None)
    counting = ("valid",) if {old, new} & {*published} else ("valid", "expired")
    first, second = (
        side if isinstance(side, Edition) else drafted(store, side, counting=counting)
        for side in sides
    )
    return Compared(old, new, options, report_with_races(store, first, second, rules))


def text(report: Compared) -> str:
    """Which options differ, and what that does to all boats and races."""
    if not report.options and report.effect is None:
        return tell("{} and {} say the same of every season.", report.old, report.new)
    options = options_text(report.options, report.old, report.new) if report.options else ""
    if report.effect is None:
        return options
    return page([options, *_effect(report.effect)], report.effect.simulated)


def seconds(value: float | None) -> str:
    """Seconds with their sign."""
    return "-" if value is None else f"{speech().number(value, 0, '+')}\u00a0s"


def _effect(report: DiffReport) -> list[str]:
    """Who gains and loses, why, and what that does to races."""
    counts = ", ".join(f"{n} {codes(change)}" for change, n in report.changes.items())
    known = report.changes.get("changed", 0) > report.interval_unknown
    causes = [cause | {"cause": tell(labels.cause(cause))} for cause in report.causes]
    return [
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


def _group(group: Row) -> str:
    if not group["lines"]:
        return tell("no lines")
    return tell(
        "{} lines, median {}, {} in two hours",
        group["lines"],
        cell("power_ratio", group["median_power_ratio"]),
        seconds(group["median_seconds"]),
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
