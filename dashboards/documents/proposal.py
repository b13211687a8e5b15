"""The document of a meeting: what a method would change, for whom, and how uncertain that is."""

import datetime as dt
from collections.abc import Iterator, Sequence
from typing import Any, Final, NamedTuple

import polars as pl

from dashboards import drawn, labels
from dashboards.documents import pdf
from dashboards.guides import method_guide
from dashboards.html import keep_units
from dashboards.markdown import to_blocks
from dashboards.measured import picture
from dashboards.speech import Speech, Text
from dashboards.statements import Change, Number, Statement, number
from dashboards.statements.edition import changes, effects, undecided
from dashboards.statements.method import BASES, EACH_STEP, VOTE, WORKED, Explained, explained
from dashboards.statements.race import stretched_fatigue
from pipeline.messages import Sentence, format_probability, pgettext, say
from pipeline.register.register import draft_name
from pipeline.tables.row import Row
from warehouse.editions.compare import causes_of
from warehouse.queries.answers import compared, replayed
from warehouse.queries.views import Views
from warehouse.store.methods import KnownMethods

HEADS: Final = (EACH_STEP, WORKED, VOTE)
"""Headings of the generated parts of the annex."""
LARGEST: Final = 10
"""Crews named on each side."""
UNKNOWN: Final = say("not known")


class Letter(NamedTuple):
    """What makes a proposal a letter; what is not known is left out."""

    sender: str = ""
    date: dt.date | None = None
    valid_from: dt.date | None = None


PLAIN: Final = Letter()


class Part(NamedTuple):
    """A part of the document: sentences, a chart of a figure's rows, and a table."""

    title: Sentence
    sentences: Sequence[Text] = ()
    head: Sequence[Sentence] = ()
    rows: Sequence[Sequence[Text]] = ()
    figure: str = ""
    drawn: pl.DataFrame | None = None

    def spoken(self, speech: Speech) -> dict[str, object]:
        """What the template is given."""
        return {
            "title": speech.say(self.title),
            "sentences": [speech.words(one).strip() for one in self.sentences],
            "head": [labels.unbroken(speech.say(one)) for one in self.head],
            "rows": [[speech.words(cell) for cell in row] for row in self.rows],
            "chart": _chart(self.figure, self.drawn, speech),
        }


def _chart(figure: str, rows: pl.DataFrame | None, speech: Speech) -> str:
    if rows is None:
        return ""
    return drawn.svg(drawn.specification(figure, speech.language), rows, speech.language)


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
    titles = {method: known.get(method).get_title(language) for method in methods}
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
            part.spoken(speech)
            for part in (
                *([_ballot(lines)] if len(methods) > 1 else []),
                *(
                    part
                    for method in methods
                    for part in _parts(views, against, method, lines[method])
                ),
                OBJECTING,
            )
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


OBJECTING: Final = Part(
    say("Checking, and objecting"),
    [
        say(
            "Every boat has a page on the site with the old and new number, the causes, "
            "and the measurements below. If something is wrong, tell the committee before "
            "the vote, with the FSN number and what you think it should be."
        )
    ],
)


def _ballot(lines: dict[str, pl.DataFrame]) -> Part:
    """The methods side by side."""
    rows = []
    for method, of_method in lines.items():
        changed = of_method.filter(change="changed").height
        for effect in effects(of_method):  # one; none where no line has a number on both sides
            own = (effect.beyond, effect.median, effect.lowest, effect.highest)
            rows.append([labels.method(method), changed, *own])
    names = ("exceeds_interval", "median", "lowest_ratio", "highest_ratio")
    head = (say("Method"), labels.code("changed"), *map(labels.column, names))
    return Part(say("The methods side by side"), (), head, rows)


def _parts(views: Views, against: str, method: str, lines: pl.DataFrame) -> Iterator[Part]:
    """What a method changes, why, for whom, in races, and what it leaves undecided."""
    yield Part(
        say("What changes: {method}", method=labels.method(method)),
        [changes(lines)],
        (labels.column("step"), say("Median effect on Cw"), labels.column("number")),
        [
            [labels.cause(cause), Change(cause["median_factor"]), cause["lines"]]
            for cause in sorted(
                causes_of(lines), key=lambda cause: -abs(cause["median_factor"] - 1)
            )
        ],
    )
    yield _types(lines)
    yield from _crews(lines)
    yield _races(views, against, draft_name(method))
    flagged = views.ask("flagged_boats").filter(method=method)["tow_id"]
    yield Part(say("What stays undecided"), undecided(lines, flagged))


def _types(lines: pl.DataFrame) -> Part:
    """What changes by type and class."""
    return Part(
        say("For whom: by type"),
        [
            say(
                "In 2 h: seconds that a crew may take longer (+) over a race of two hours at "
                "the same power, or has to be faster (\u2212). Last column: how many lines change "
                "by more than the uncertainty."
            )
        ],
        (
            say("Type"),
            labels.column("number"),
            say("Cw, median"),
            *map(labels.column, ("gain_in_two_hours_s", "exceeds_interval")),
        ),
        [
            [
                say("{}, {}", labels.code(boat_type), labels.crew(crew_class)),
                effect.lines,
                effect.median,
                effect.seconds,
                effect.beyond,
            ]
            for effect in effects(lines, "boat_type", "crew_class")
            for boat_type, crew_class in [effect.of]
        ],
    )


def _crews(lines: pl.DataFrame) -> Iterator[Part]:
    """The seconds of every crew as a chart, then those that gain and lose most."""
    gain = pl.col("gain_in_two_hours_s")
    moved = lines.drop_nulls("gain_in_two_hours_s").filter(change="changed").sort(gain, "fsn_no")
    if moved.is_empty():
        return
    said = say("A bar for each crew: above zero it may take longer, below it has to be faster.")
    shown = moved.select("name", "fsn_no", "rowers", "crew_class", "gain_in_two_hours_s")
    yield Part(say("For whom: every crew"), [said], figure="changes", drawn=shown)
    head = (
        say("Boat"),
        labels.column("old_cw_kg_m"),
        labels.column("new_cw_kg_m"),
        pgettext("proposal", "Change"),
        *map(labels.column, ("gain_in_two_hours_s", "exceeds_interval")),
    )
    for title, crews in (
        (say("Who gains most"), moved.filter(gain > 0).reverse()),
        (say("Who loses most"), moved.filter(gain < 0)),
    ):
        rows = list(map(_crew, crews.head(LARGEST).to_dicts()))
        if rows:
            yield Part(title, (), head, rows)


def _crew(line: Row) -> list[Text]:
    """The row of a crew: its numbers, what changes, and whether beyond the uncertainty."""
    crew = f"{line['rowers']}{line['crew_class']}"
    return [
        " · ".join(filter(None, (line["name"], line["fsn_no"], crew))),
        number(line, "old_cw_kg_m"),
        number(line, "new_cw_kg_m"),
        Change(line["new_cw_kg_m"] / line["old_cw_kg_m"]),
        Number(line["gain_in_two_hours_s"], 0, "s", sign="+"),
        {None: UNKNOWN, True: say("yes"), False: say("no")}[line["exceeds_interval"]],
    ]


def _races(views: Views, old: str, new: str) -> Part:
    """What it does to the races of the last season: how many places move, and who wins."""
    winners, (moved, results) = replayed(views, old, new)
    if winners.is_empty():
        return Part(say("Races"), [say("The archive holds no races to compute again.")])
    last = winners.filter(pl.col("race_date").dt.year() == winners["race_date"].dt.year().max())
    names = dict(views.table("boats").select("fsn_no", "name").rows())
    counted = say(
        "Of the {results} results of crews with a valid line on that day in both, "
        "{moved} change place. The winners of the last year:",
        moved=moved,
        results=results,
    )
    return Part(
        say("The races of {year}", year=last["race_date"][0].year),
        [*stretched_fatigue(_times(views, last)), counted],
        (labels.column("race"), say("Old"), say("New"), say("Chance of another")),
        [
            [
                _race_name(race),
                names.get(race["old_winner"]) or "\u2013",
                names.get(race["new_winner"]) or "\u2013",
                UNKNOWN
                if race["change_probability"] is None
                else format_probability(race["change_probability"]),
            ]
            for race in last.to_dicts()
        ],
    )


def _race_name(race: Row) -> Text:
    return lambda speech: (
        f"{race['race']} {speech.day(race['race_date'])}, "
        f"{speech.say(labels.crew(race['crew_class']))}"
    )


def _times(views: Views, winners: pl.DataFrame) -> pl.Series:
    """The times rowed in races of which a winner changes."""
    races = winners.filter("winner_changed").select("race", "race_date")
    results = views.store.read("listed_races")
    return results.join(races, on=["race", "race_date"], how="semi")["rowing_time_s"]


def _method(told: Explained, speech: Speech) -> dict[str, Any]:
    """What each step of a method does, a boat worked through, and what is voted on."""
    say, boat = speech.say, told.worked
    return {
        "title": say(labels.method(told.method.name)),
        "heads": [say(head) for head in HEADS],
        "bases": say(BASES),
        "steps": [(say(step.name), *_spoken(step.statements, speech)) for step in told.steps],
        "boat": _spoken(boat.statements, speech) if boat else [],
        "curve": _chart("resistance_curve", boat.drawn, speech) if boat else "",
        "uncertainty": _spoken(told.uncertainty, speech),
        "vote": _spoken(told.vote, speech),
    }


def _spoken(statements: Sequence[Statement], speech: Speech) -> list[str]:
    return [keep_units(statement(speech)) for statement in statements]
