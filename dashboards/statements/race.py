"""What becomes of races under another edition: who wins, how likely another does, who moves."""

from collections.abc import Iterator, Mapping
from typing import TypeAlias, cast

import polars as pl

from dashboards import labels
from dashboards.speech import Headline, duration
from dashboards.statements import EditionName, Statement, Value, together, told
from pipeline.messages import format_probability, say
from pipeline.races.race import FATIGUE_REFERENCE
from pipeline.tables.row import Row

Chances: TypeAlias = Mapping[tuple[str, str], float | None]
"""How likely another winner is, by race with its day and class."""


def place_in_race(race: Row) -> Statement:
    """The place of a crew in a race under both editions; a row of `select_own_races`."""
    if race["new_rank"] is None:
        why: list[Value] = [
            told(
                "no_place",
                say("{edition}: {remark}"),
                edition=EditionName(race[edition]),
                remark=labels.code(race[remark]),
            )
            for edition, remark in (("from_edition", "old_remark"), ("to_edition", "new_remark"))
            if race[remark]
        ]
        wording = say("{race} {race_date}: there are no two places to compare ({why}).")
        return told("race_place", wording, race, verdict="not ranked", why=why)
    moved = race["old_rank"] != race["new_rank"]
    wording = (
        say(
            "{race} {race_date}: place {new_rank} of the {race_size} crews that both editions "
            "rank; it was {old_rank}."
        )
        if moved
        else say(
            "{race} {race_date}: place {new_rank} of the {race_size} crews that both editions "
            "rank, as before."
        )
    )
    verdict = "moved" if moved else "same"
    return told("race_place", wording, race, "race_changes", verdict=verdict)


def winners(rows: pl.DataFrame, chances: Chances) -> Headline:
    """Who wins each class of a race, and how likely it is that another does."""
    classes = rows.partition_by("crew_class", maintain_order=True)
    said = [together(list(_winner(of_class, chances))) for of_class in classes]
    return lambda speech: " ".join(one(speech) for one in said)


def _winner(rows: pl.DataFrame, chances: Chances) -> Iterator[Statement]:
    few = list(_few_places(rows))
    yield from few
    old, new = (
        rows.filter(pl.col(rank) == 1)["name"].to_list() for rank in ("old_rank", "new_rank")
    )
    if not old or not new:
        return
    crew_class, same = rows["crew_class"][0], old[0] == new[0]
    wording = (
        say("Among the {people} {new} wins, as before.")
        if same
        else say("Among the {people} {new} wins instead of {old}.")
    )
    named = {"people": labels.crew(crew_class), "old": old[0], "new": new[0]}
    verdict = "same" if same else "another"
    yield told("winner", wording, {}, "race_changes", verdict=verdict, **named)
    if not same:
        yield from stretched_fatigue(rows.drop_nulls("new_rank")["rowing_time_s"])
    chance = chances.get((f"{rows['race'][0]} {rows['race_date'][0]}", crew_class))
    if chance is not None and not few:  # who else might have won is not known of the others
        wording = say(" Chance that another wins than before: {chance}.")
        yield told("winner_chance", wording, {}, "ensemble", chance=format_probability(chance))


def _few_places(rows: pl.DataFrame) -> Iterator[Statement]:
    """That places are among some of the crews only, where one edition lacks lines of others."""
    powers = rows.select(pl.any_horizontal(pl.col("old_power_w", "new_power_w").is_not_null()))
    known, placed = int(powers.to_series().sum()), rows["new_rank"].count()
    if placed < known:
        wording = (
            say(
                "Among the {people} only {number} of {all} crews have a valid line on that day "
                "in both editions; the places are among these. "
            )
            if placed
            else say(
                "Among the {people} none of {all} crews has a valid line on that day in both "
                "editions: there are no places to compare. "
            )
        )
        people = labels.crew(rows["crew_class"][0])
        yield told("few_places", wording, people=people, number=placed, all=known)


def stretched_fatigue(times_s: pl.Series) -> Iterator[Statement]:
    """That the correction for fatigue is used for times that it was not made for, where it is."""
    (first, _), (last, _) = FATIGUE_REFERENCE
    if times_s.is_between(first, last).all():
        return
    low, high = (duration(cast(float, time)) for time in (times_s.min(), times_s.max()))
    wording = say(
        " Where another wins, that rests in part on the correction for fatigue, which "
        "was made for 2 to 3 hours and is used outside them here ({low} to {high})."
    )
    yield told("fatigue", wording, low=low, high=high)
