"""The races computed again: a page for each."""

from collections.abc import Iterator, Sequence
from typing import TypeAlias

import polars as pl

from dashboards import labels
from dashboards.site.parts import (
    Page,
    Section,
    Table,
    draft_of,
    editions_select,
    race_path,
)
from dashboards.speech import Headline, Speech, stretched_fatigue
from pipeline.messages import in_per_cent, say
from warehouse.queries.answers import newest_edition, race_chances
from warehouse.queries.views import Views

Chances: TypeAlias = dict[tuple[str, str], float | None]
"""How likely another winner is, by race with its day and class."""

COLUMNS = (
    *("name", "fsn_no", "crew_class", "rowers", "rowing_time_s", "old_power_w", "new_power_w"),
    *("old_rank", "new_rank", "podium_changed", "old_remark", "new_remark"),
)
CARDS = ("name", "fsn_no", "new_power_w", "old_rank", "new_rank")


def race_pages(views: Views, methods: Sequence[str]) -> Iterator[Page]:
    """A page for each race."""
    races = views.ask("races") if views.has("race_changes") else pl.DataFrame()
    if races.is_empty():
        return
    editions = races["to_edition"].unique().sort().to_list()
    chosen = newest_edition(editions, draft_of(methods))
    chances = race_chances(views, races.filter(to_edition=chosen)["from_edition"][0], chosen)
    for race, day in views.race_days():
        own = races.filter(race=race, race_date=day)
        yield _race(race_path(race, day), f"{race} {day}", own, editions, chosen, chances)


def _race(
    path: str,
    name: str,
    rows: pl.DataFrame,
    editions: Sequence[str],
    chosen: str,
    chances: Chances,
) -> Page:
    now = rows.filter(to_edition=chosen)
    table = Table(
        "race_changes", rows, COLUMNS, say("Races"), ["to_edition"], search=True, cards=CARDS
    )
    return Page(
        path,
        say("Races"),
        [
            Section(
                "race_results",
                say("Results by both editions"),
                say(
                    "Power per rower in this race, and the place by it, by class: among the crews "
                    "that have a valid line on that day in both editions."
                ),
                tables=[table],
                headline=_winners(now, chances),
            )
        ],
        name=name,
        selects=[editions_select("to_edition", editions, chosen)],
    )


def _winners(rows: pl.DataFrame, chances: Chances) -> Headline:
    """Who wins each class, and how likely it is that another does."""

    def sentence(speech: Speech) -> str:
        return " ".join(
            _winner(speech, str(crew_class), of_class, chances)
            for (crew_class,), of_class in rows.group_by("crew_class", maintain_order=True)
        )

    return sentence


def _winner(
    speech: Speech,
    crew_class: str,
    rows: pl.DataFrame,
    chances: Chances,
) -> str:
    old, new = (
        rows.filter(pl.col(rank) == 1)["name"].to_list() for rank in ("old_rank", "new_rank")
    )
    few = _few_places(speech, crew_class, rows)
    if not old or not new:
        return few
    people = speech.say(labels.crew(crew_class))
    text = speech.say(
        "Among the {people} {new} wins, as before."
        if old[0] == new[0]
        else "Among the {people} {new} wins instead of {old}.",
        people=people,
        old=old[0],
        new=new[0],
    )
    if old[0] != new[0]:
        text += stretched_fatigue(rows.drop_nulls("new_rank")["rowing_time_s"], speech)
    if few:
        return few + text  # who else might have won is not known of the others
    chance = chances.get((f"{rows['race'][0]} {rows['race_date'][0]}", crew_class))
    if chance is None:
        return text
    return text + speech.say(
        " Chance that another wins than before: {chance}.", chance=in_per_cent(chance)
    )


def _few_places(speech: Speech, crew_class: str, rows: pl.DataFrame) -> str:
    """That places are among some of the crews only, where one edition lacks lines of others."""
    powers = rows.select(pl.any_horizontal(pl.col("old_power_w", "new_power_w").is_not_null()))
    known, placed = int(powers.to_series().sum()), rows["new_rank"].count()
    if placed == known:
        return ""
    return speech.say(
        "Among the {people} only {number} of {all} crews have a valid line on that day "
        "in both editions; the places are among these. "
        if placed
        else "Among the {people} none of {all} crews has a valid line on that day in both "
        "editions: there are no places to compare. ",
        people=speech.say(labels.crew(crew_class)),
        number=placed,
        all=known,
    )
