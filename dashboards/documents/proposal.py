"""The document of a meeting: what a method would change, for whom, and how uncertain that is."""

import datetime as dt
from collections.abc import Iterator, Sequence
from typing import Any, Final, NamedTuple

import polars as pl

from dashboards import drawn, labels
from dashboards.documents import pdf
from dashboards.figures import FIGURES
from dashboards.guides import method_guide
from dashboards.html import keep_units
from dashboards.markdown import to_blocks
from dashboards.measured import picture
from dashboards.speech import Speech
from dashboards.statements import Statement
from dashboards.statements.edition import Effect, changes, effects, undecided
from dashboards.statements.method import BASES, EACH_STEP, VOTE, WORKED, Explained, explained
from dashboards.statements.race import stretched_fatigue
from pipeline.messages import in_per_cent, pgettext, say
from pipeline.register.register import draft_name
from warehouse.editions.compare import causes_of
from warehouse.queries.answers import compared, replayed
from warehouse.queries.views import Views
from warehouse.store.methods import KnownMethods

Part = dict[str, object]

HEADS: Final = (EACH_STEP, WORKED, VOTE)
"""Headings of the generated parts of the annex."""
LARGEST: Final = 10
"""Crews named on each side."""


class Letter(NamedTuple):
    """What makes a proposal a letter; what is not known is left out."""

    sender: str = ""
    date: dt.date | None = None
    valid_from: dt.date | None = None


PLAIN: Final = Letter()


def proposal(
    views: Views,
    methods: Sequence[str],
    against: str,
    language: str,
    known: KnownMethods,
    letter: Letter = PLAIN,
) -> bytes:
    """A proposal of one method, or a ballot of several, as PDF.

    Raises:
        MissingKnowledgeError: the last rebuild did not apply such a method, or there is no such
            edition.
    """
    speech = Speech(language)
    say = speech.say
    lines = {m: compared(views, against, draft_name(m), letter.valid_from) for m in methods}
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
        "letter": [letter.sender, "" if letter.date is None else speech.day(letter.date)],
        "motion": [_motion(titles[method], letter, speech) for method in methods],
        "opening": [
            say(
                "Cw is the tow force divided by the square of the speed, in kg/m: the lower it is, "
                "the easier the boat runs."
            ),
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
        "annex_title": say("Annex: the method in two pages"),
        "picture": picture(speech),
        "guide": {name: to_blocks(text) for name, text in method_guide(language)._asdict().items()},
        "methods": [_method(explained(views, method), speech) for method in methods],
        "footing": f"{say('Made by code')} {about.get('code_version', '')}",
    }
    return pdf("proposal.typ", content)


def _motion(title: str, letter: Letter, speech: Speech) -> str:
    """What the members are asked to decide."""
    if letter.valid_from is None:
        return speech.say("Motion: the register is computed by \u201c{method}\u201d.", method=title)
    return speech.say(
        "Motion: from {day} on the register is computed by \u201c{method}\u201d.",
        method=title,
        day=speech.day(letter.valid_from),
    )


def _part(
    title: str,
    *sentences: str,
    head: Sequence[str] = (),
    rows: Sequence[Sequence[str]] = (),
    chart: str = "",
) -> Part:
    """A part of the document: sentences, a chart, and a table where it has rows."""
    return {"title": title, "sentences": sentences, "head": head, "rows": rows, "chart": chart}


def _ballot(lines: dict[str, pl.DataFrame], speech: Speech) -> Part:
    """The methods side by side."""
    rows = []
    for method, compared_lines in lines.items():
        effect = effects(compared_lines)[0]
        row = (effect.median, effect.lowest, effect.highest)
        changed = str(compared_lines.filter(change="changed").height)
        name = speech.say(labels.method(method))
        rows.append([name, changed, _beyond(effect, speech), *(one(speech) for one in row)])
    heads = (
        say("Method"),
        labels.code("changed"),
        *map(labels.column, ("exceeds_interval", "median", "lowest_ratio", "highest_ratio")),
    )
    return _part(
        speech.say("The methods side by side"),
        head=[labels.unbroken(speech.say(head)) for head in heads],
        rows=rows,
    )


def _beyond(effect: Effect, speech: Speech) -> str:
    """How many lines change by more than their uncertainty; none of them need be known."""
    return speech.say("not known") if effect.beyond is None else str(effect.beyond)


def _parts(views: Views, method: str, lines: pl.DataFrame, speech: Speech) -> Iterator[Part]:
    """What a method changes, why, for whom, in races, and what it leaves undecided."""
    say = speech.say
    yield _part(
        say("What changes: {method}", method=say(labels.method(method))),
        changes(lines)(speech),
        head=[say(labels.column("step")), say("Median effect on Cw"), say(labels.column("number"))],
        rows=_steps(lines, speech),
    )
    yield _types(lines, speech)
    yield from _crews(lines, speech)
    yield _races(views, lines, speech)
    flagged = views.ask("flagged_boats").filter(method=method)["tow_id"]
    left = (statement(speech) for statement in undecided(lines, flagged))
    yield _part(say("What stays undecided"), *left)


def _steps(lines: pl.DataFrame, speech: Speech) -> list[list[str]]:
    """What each cause did, as the notice of an edition says it, the largest first."""
    causes = sorted(causes_of(lines), key=lambda cause: -abs(cause["median_factor"] - 1))
    return [
        [
            speech.say(labels.cause(cause)),
            speech.per_cent(cause["median_factor"]),
            str(cause["lines"]),
        ]
        for cause in causes
    ]


def _types(lines: pl.DataFrame, speech: Speech) -> Part:
    """What changes by type and class."""
    by_type = effects(lines, "boat_type", "crew_class")
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
        head=[labels.unbroken(speech.say(head)) for head in heads],
        rows=[
            [
                ", ".join((speech.say(labels.code(type_)), speech.say(labels.crew(crew_class)))),
                str(effect.lines),
                effect.median(speech),
                effect.seconds(speech),
                _beyond(effect, speech),
            ]
            for effect in by_type
            for type_, crew_class in [effect.of]
        ],
    )


def _crews(lines: pl.DataFrame, speech: Speech) -> Iterator[Part]:
    """The seconds of every crew as a chart, then those that gain and lose most."""
    gain = pl.col("gain_in_two_hours_s")
    moved = lines.drop_nulls("gain_in_two_hours_s").filter(change="changed").sort(gain, "fsn_no")
    if moved.is_empty():
        return
    drawn_columns = ("name", "fsn_no", "rowers", "crew_class", "gain_in_two_hours_s")
    spec = FIGURES["changes"](moved.select(drawn_columns), speech.say).to_dict()
    yield _part(
        speech.say("For whom: every crew"),
        speech.say(
            "A bar for each crew: above zero it may take longer, below it has to be faster."
        ),
        chart=drawn.svg(spec, speech.language),
    )
    heads = (
        say("Boat"),
        labels.column("old_cw_kg_m"),
        labels.column("new_cw_kg_m"),
        pgettext("proposal", "Change"),
        *map(labels.column, ("gain_in_two_hours_s", "exceeds_interval")),
    )
    head = [labels.unbroken(speech.say(head)) for head in heads]
    for title, shown in (
        (say("Who gains most"), moved.filter(gain > 0).reverse()),
        (say("Who loses most"), moved.filter(gain < 0)),
    ):
        rows = [_boat(line, speech) for line in shown.head(LARGEST).to_dicts()]
        if rows:
            yield _part(speech.say(title), head=head, rows=rows)


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
        *(one(speech).strip() for one in stretched_fatigue(_times(views, last))),
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
                f"{race['race']} {speech.day(race['race_date'])}, "
                f"{say(labels.crew(race['crew_class']))}",
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


def _method(told: Explained, speech: Speech) -> Part:
    """What each step of a method does, a boat worked through, and what is voted on."""
    say, boat = speech.say, told.worked
    spec = FIGURES["resistance_curve"](boat.drawn, say).to_dict() if boat else {}
    return {
        "title": say(labels.method(told.method.name)),
        "heads": [say(head) for head in HEADS],
        "bases": say(BASES),
        "steps": [(say(step.name), *_spoken(step.statements, speech)) for step in told.steps],
        "boat": _spoken(boat.statements, speech) if boat else [],
        "curve": drawn.svg(spec, speech.language) if boat else "",
        "uncertainty": _spoken(told.uncertainty, speech),
        "vote": _spoken(told.vote, speech),
    }


def _spoken(statements: Sequence[Statement], speech: Speech) -> list[str]:
    return [keep_units(statement(speech)) for statement in statements]


def _chance(chance: float | None, speech: Speech) -> str:
    return speech.say("not known") if chance is None else in_per_cent(chance)
