"""Two editions, drafts or methods side by side: who gains, who loses, and why."""

import datetime as dt
import json
from collections.abc import Iterator
from dataclasses import dataclass

import polars as pl

from dashboards import labels
from dashboards.statements.edition import changes
from herijk.cli.methods_text import options_table
from herijk.cli.render import Part, Section, codes, marked, prose, speech
from pipeline.messages import format_probability, say, tell
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


def compared(
    store: Store, old: str, new: str, rules: RaceRules, as_of: dt.date | None = None
) -> Compared:
    """Compares editions as they are, and drafts, methods and method files as their drafts are.

    Two drafts are compared over all of history: also lines whose tow has expired; as of a day, the
    lines that counted on it.

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
    of_a_day = as_of is not None or {old, new} & {*published}
    counting = ("valid",) if of_a_day else ("valid", "expired")
    first, second = (
        side if isinstance(side, Edition) else drafted(store, side, as_of, counting)
        for side in sides
    )
    return Compared(old, new, options, report_with_races(store, first, second, rules))


def text(report: Compared) -> Iterator[Part]:
    """Which options differ, and what that does to all boats and races."""
    if not report.options and report.effect is None:
        yield tell("{} and {} say the same of every season.", report.old, report.new)
    if report.effect is not None:
        yield marked(report.effect.simulated)
    yield options_table(report.options, report.old, report.new)
    if report.effect is not None:
        yield from _effect(report.effect)


def _effect(report: DiffReport) -> Iterator[Part]:
    """Who gains and loses, why, and what that does to races."""
    yield prose(changes(_lines(report))(speech()) if report.rows else tell("no lines"))
    groups = {say("more power for the same race"): report.gain, say("less"): report.loss}
    yield Section(
        tell("Who gains and who loses, by the median:"),
        rows=[group | {"what": tell(what)} for what, group in groups.items()],
        columns="what lines median_power_ratio median_seconds",
    )
    yield Section(
        tell("Causes, with their factor on Cw:"),
        rows=[cause | {"cause": tell(labels.cause(cause))} for cause in report.causes],
        columns="cause lines median_factor lowest_factor highest_factor",
    )
    yield Section(
        tell("Every line:"),
        rows=list(map(_line, report.rows)),
        columns="fsn_no name crew change old_a_kg_m new_a_kg_m old_b_m_s new_b_m_s old_cw_kg_m "
        "new_cw_kg_m old_power_w new_power_w power_ratio gain_in_two_hours_s old_speed_rank "
        "new_speed_rank causes",
        note=tell(
            "Power at the old declared speed. Speed rank: among all boats of the class at equal "
            "power."
        ),
    )
    yield from _races(report)


def _lines(report: DiffReport) -> pl.DataFrame:
    """The lines as `statements.edition` reads them."""
    known = {
        f"{side}_log_known": pl.lit(edition not in report.runs_alone)
        for side, edition in (("old", report.from_edition), ("new", report.to_edition))
    }
    names = ("from_edition", "to_edition", "change", "exceeds_interval")
    rows = [
        {name: row[name] for name in names} | {"causes": json.dumps(row["causes"])}
        for row in report.rows
    ]
    return pl.DataFrame(rows, infer_schema_length=None).with_columns(**known)


def _line(row: Row) -> Row:
    change = codes(row["change"])
    if row["change"] == "removed":
        change += f": {codes(row['new_status'] or 'gone')}"
    ranks = {f"{side}_speed_rank": row[f"{side}_rank"] for side in ("old", "new")}
    return row | {"change": change} | ranks


def _races(report: DiffReport) -> Iterator[Part]:
    if report.races is None or report.race_rules is None or report.winners is None:
        yield tell("Races: the archive holds none.")
        return
    ranked = [r for r in report.races if r["new_rank"] is not None]
    moved = [r for r in ranked if r["old_rank"] != r["new_rank"]]
    yield prose(
        tell(
            "Races, corrected for fatigue by the rule {}: {} results, {} of them ranked by both "
            "editions: {} change rank among those, {} on or off the podium.",
            report.race_rules.fatigue,
            len(report.races),
            len(ranked),
            len(moved),
            sum(r["podium_changed"] for r in ranked),
        )
    )
    yield Section(
        tell("Winners:"),
        rows=[winner | {"change_probability": _chance(winner)} for winner in report.winners],
        columns="race race_date crew_class old_winner new_winner winner_changed change_probability",
        note=tell(
            "The chance: in how many of the equally likely new registers the old winner loses."
        ),
    )
    yield Section(
        tell("Ranks that change:"),
        rows=moved,
        columns="race race_date fsn_no crew old_power_w new_power_w old_rank new_rank "
        "podium_changed",
    )


def _chance(winner: Row) -> str:
    chance = winner["change_probability"]
    return tell("not known") if chance is None else format_probability(chance)
