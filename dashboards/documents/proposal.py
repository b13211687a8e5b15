"""The document of a meeting: what a method would change, for whom, and how uncertain that is."""

from collections.abc import Iterator, Sequence
from math import log
from typing import Any, Final

import polars as pl

from dashboards import headlines, labels
from dashboards.documents import pdf
from dashboards.speech import Speech, stretched_fatigue
from pipeline.messages import in_per_cent, pgettext, say
from pipeline.register.changes import largest_first
from pipeline.register.register import draft_name
from warehouse.editions.compare import causes_of
from warehouse.queries.answers import compared, replayed
from warehouse.queries.views import Views
from warehouse.store.methods import KnownMethods

Part = dict[str, object]

LARGEST: Final = 20
"""Boats named on each side."""


def proposal(
    views: Views, methods: Sequence[str], against: str, language: str, known: KnownMethods
) -> bytes:
    """A proposal of one method, or a ballot of several, as PDF.

    Raises:
        MissingKnowledgeError: the last rebuild did not apply such a method, or there is no such
            edition.
    """
    speech = Speech(language)
    say = speech.say
    lines = {method: compared(views, against, draft_name(method)) for method in methods}
    about = views.about()
    titles = {method: known.get(method).titled(language) for method in methods}
    content = {
        "language": language,
        "title": say(
            "Proposal: {method}" if len(methods) == 1 else "Ballot: {method}",
            method="; ".join(titles.values()),
        ),
        "kind": say("Proposal to the members"),
        "simulated": say(labels.SIMULATED) if about.get("simulated") == "true" else "",
        "opening": [
            say(
                "This document shows what happens to the register if all tow tests are "
                "computed by the proposed method, compared with: {old}.",
                old=speech.edition(against),
            ),
            say(
                "Why: through the years measuring and computing was done in several ways. Only "
                "with one method for all seasons can boats be compared fairly. Who gains or "
                "loses is no reason for or against a method."
            ),
        ],
        "parts": [
            *([_ballot(lines, speech)] if len(methods) > 1 else []),
            *(part for method in methods for part in _parts(views, method, lines[method], speech)),
            _part(
                say("Checking, and objecting"),
                say(
                    "Every boat has a page on the site with the old and new number, the causes, "
                    "and the measurements below. If something is wrong, tell the committee before "
                    "the vote, with the FSN number and what you think it should be."
                ),
            ),
        ],
        "annexes": [
            {
                "title": f"{say('Annex: the file of the method')}: {title}",
                "text": known.text(method),
            }
            for method, title in titles.items()
        ],
        "footing": f"{say('Made by code')} {about.get('code_version', '')}",
    }
    return pdf("proposal.typ", content)


def _part(
    title: str, *sentences: str, head: Sequence[str] = (), rows: Sequence[Sequence[str]] = ()
) -> Part:
    """A part of the document: sentences, and a table where it has rows."""
    return {"title": title, "sentences": sentences, "head": head, "rows": rows}


def _ballot(lines: dict[str, pl.DataFrame], speech: Speech) -> Part:
    """The methods side by side."""
    rows = []
    for method, changes in lines.items():
        known = changes.drop_nulls("cw_ratio")
        rows.append(
            [
                speech.say(labels.method(method)),
                str(changes.filter(change="changed").height),
                _beyond(changes["exceeds_interval"], speech),
                *(speech.per_cent(ratio) for ratio in _middle_and_ends(known)),
            ]
        )
    heads = (
        say("Method"),
        labels.code("changed"),
        *map(labels.column, ("exceeds_interval", "median", "lowest_ratio", "highest_ratio")),
    )
    return _part(
        speech.say("The methods side by side"), head=[*map(speech.unbroken, heads)], rows=rows
    )


def _middle_and_ends(changes: pl.DataFrame) -> tuple[float, float, float]:
    ratio = pl.col("cw_ratio")
    middle, low, high = changes.select(
        ratio.median().alias("middle"), ratio.min().alias("low"), ratio.max().alias("high")
    ).row(0)
    return middle, low, high


def _beyond(exceeds: pl.Series, speech: Speech) -> str:
    """How many lines change by more than their uncertainty; none of them need be known."""
    known = exceeds.drop_nulls()
    return speech.say("not known") if known.is_empty() else str(known.sum())


def _parts(views: Views, method: str, lines: pl.DataFrame, speech: Speech) -> Iterator[Part]:
    """What a method changes, why, for whom, in races, and what it leaves undecided."""
    say = speech.say
    yield _part(
        say("What changes: {method}", method=say(labels.method(method))),
        headlines.changes(lines)(speech),
        head=[say(labels.column("step")), say("Median effect on Cw"), say(labels.column("number"))],
        rows=_steps(lines, speech),
    )
    yield _types(lines, speech)
    yield _boats(lines, speech)
    yield _races(views, lines, speech)
    unknown = int(lines["exceeds_interval"].null_count())
    sure = (
        say(
            "Lines of which it cannot be told whether the change is larger than the "
            "uncertainty: {unknown}.",
            unknown=unknown,
        )
        if unknown
        else say("Of every line it can be told whether the change is larger than the uncertainty.")
    )
    flagged = views.ask("flagged_boats").filter(method=method)["tow_id"].implode()
    voted = lines.drop_nulls("new_cw_kg_m").select(pl.col("new_tow_id").is_in(flagged))
    flags = say(
        "Lines with a flag that the committee still has to look at: {flagged} of "
        "{lines}. Old numbers often have too small an uncertainty: the error of the "
        "log is not in it.",
        flagged=voted.to_series().sum(),
        lines=voted.height,
    )
    yield _part(say("What stays undecided"), sure, flags)


def _steps(lines: pl.DataFrame, speech: Speech) -> list[list[str]]:
    """What each cause did, as the notice of an edition says it, the largest first."""
    causes = sorted(causes_of(lines), key=lambda cause: -abs(log(cause["median_factor"])))
    return [
        [
            speech.say(labels.code(cause["step"] or cause["cause"])),
            speech.per_cent(cause["median_factor"]),
            str(cause["lines"]),
        ]
        for cause in causes
    ]


def _types(lines: pl.DataFrame, speech: Speech) -> Part:
    """What changes by type and class."""
    by_type = (
        lines.drop_nulls("cw_ratio")
        .with_columns(pl.col("boat_type").fill_null("unknown").replace("", "unknown"))
        .group_by("boat_type", "crew_class", maintain_order=True)
        .agg(
            number=pl.len(),
            ratio=pl.col("cw_ratio").median(),
            seconds=pl.col("gain_in_two_hours_s").median(),
            beyond=pl.col("exceeds_interval"),
        )
        .sort("boat_type", "crew_class", descending=[False, True])
    )
    heads = (
        say("Type"),
        labels.column("number"),
        say("Cw, median"),
        *map(labels.column, ("gain_in_two_hours_s", "exceeds_interval")),
    )
    return _part(
        speech.say("For whom: by type"),
        speech.say(
            "In 2 h: seconds that a crew may take longer (+) over a race of two hours at "
            "the same power, or has to be faster (\u2212). Last column: how many lines change "
            "by more than the uncertainty."
        ),
        head=[*map(speech.unbroken, heads)],
        rows=[
            [
                f"{speech.say(labels.code(boat_type))}, {speech.say(labels.crew(crew_class))}",
                str(number),
                speech.per_cent(ratio),
                speech.number(seconds, 0, "+"),
                _beyond(pl.Series(beyond), speech),
            ]
            for boat_type, crew_class, number, ratio, seconds, beyond in by_type.rows()
        ],
    )


def _boats(lines: pl.DataFrame, speech: Speech) -> Part:
    """The boats that change most, up or down."""
    moved = lines.drop_nulls("cw_ratio").filter(change="changed")
    shown = largest_first(moved).head(LARGEST)
    heads = (
        say("Boat"),
        labels.column("old_cw_kg_m"),
        labels.column("new_cw_kg_m"),
        pgettext("proposal", "Change"),
        *map(labels.column, ("gain_in_two_hours_s", "exceeds_interval")),
    )
    return _part(
        speech.say("The largest changes"),
        head=[*map(speech.unbroken, heads)],
        rows=[_boat(line, speech) for line in shown.to_dicts()],
    )


def _boat(line: dict[str, Any], speech: Speech) -> list[str]:
    crew = f"{line['rowers']}{line['crew_class']}"
    beyond = {None: say("not known"), True: say("yes"), False: say("no")}[line["exceeds_interval"]]
    return [
        " · ".join(filter(None, (line["name"], line["fsn_no"], crew))),
        speech.number(line["old_cw_kg_m"], 2),
        speech.number(line["new_cw_kg_m"], 2),
        speech.per_cent(line["new_cw_kg_m"] / line["old_cw_kg_m"]),
        speech.number(line["gain_in_two_hours_s"], 0, "+"),
        speech.say(beyond),
    ]


def _races(views: Views, lines: pl.DataFrame, speech: Speech) -> Part:
    """What it does to the races of the last season: how many places move, and who wins."""
    say = speech.say
    winners, moved = replayed(views, lines["from_edition"][0], lines["to_edition"][0])
    if winners.is_empty():
        return _part(say("Races"), say("The archive holds no races to compute again."))
    last = winners.filter(pl.col("race_date").dt.year() == winners["race_date"].dt.year().max())
    names = dict(views.table("boats").select("fsn_no", "name").rows())
    return _part(
        say("The races of {year}", year=last["race_date"][0].year),
        *filter(None, [stretched_fatigue(_times(views, last), speech).strip()]),
        say(
            "Of the {results} results of crews with a valid line on that day in both, "
            "{moved} change place. The winners of the last year:",
            moved=moved[0],
            results=moved[1],
        ),
        head=[
            say(labels.column("race")),
            say("Old"),
            say("New"),
            say("Chance of another"),
        ],
        rows=[
            [
                f"{race['race']} {race['race_date']}, {say(labels.crew(race['crew_class']))}",
                names.get(race["old_winner"]) or "\u2013",
                names.get(race["new_winner"]) or "\u2013",
                _chance(race["change_probability"], speech),
            ]
            for race in last.to_dicts()
        ],
    )


def _times(views: Views, winners: pl.DataFrame) -> pl.Series:
    """The times rowed in races of which a winner changes."""
    races = winners.filter("winner_changed").select("race", "race_date")
    results = views.store.read("listed_races")
    return results.join(races, on=["race", "race_date"], how="semi")["rowing_time_s"]


def _chance(chance: float | None, speech: Speech) -> str:
    return speech.say("not known") if chance is None else in_per_cent(chance)
