"""The owner's answer in sentences: what changes for a boat, why, how certainly, what follows.

The numbers come from `warehouse.queries.answers`.
"""

import json
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import exp
from typing import Final

from markupsafe import Markup

from dashboards import labels
from dashboards.pictures import curve_picture, waterfall_picture
from dashboards.speech import Speech
from pipeline.messages import say
from pipeline.tables.row import Row
from warehouse.queries.answers import answers, own_races, season_faults
from warehouse.queries.documents import Curve, curve_of
from warehouse.queries.views import DRAFT, Views

FEW: Final = 2
"""A place among fewer says nothing."""
UNKNOWN_VERDICT: Final = say(
    "Whether the change is larger than the uncertainty cannot be told: that of one "
    "of the numbers is not known."
)
SHOWN: Final = 5e-4
"""A cause that moves Cw by less than this is 0.0 % and is summed with the others."""


@dataclass(frozen=True)
class Answer:
    """What there is to say of a boat and crew under an edition.

    Attributes:
        line: a row of `warehouse.queries.answers.answers`.
        races: rows of `own_races` of this boat and crew.
        curve: its curve, as `warehouse.queries.documents.curve_of` gives it.
        faults: rows of `season_diagnosis` of its season that a person should look at.
    """

    line: Row
    races: Sequence[Row]
    curve: Curve
    faults: Sequence[Row] = ()


def answers_by_boat(views: Views, edition: str, only: str | None = None) -> dict[str, list[Answer]]:
    """What there is to say of each crew under an edition or draft, by boat.

    Args:
        only: the number of the one boat that is asked for; all when left out.
    """
    lines = answers(views, edition)
    races = own_races(views, next(iter(lines["from_edition"].drop_nulls()), None), edition)
    crew = ["fsn_no", "rowers", "crew_class"]
    by_crew = races.partition_by(crew, as_dict=True, maintain_order=True)
    faults = season_faults(views) if edition.startswith(DRAFT) else {}  # an edition holds none
    by_boat: dict[str, list[Answer]] = defaultdict(list)
    for line in (lines if only is None else lines.filter(fsn_no=only)).to_dicts():
        by_boat[line["fsn_no"]].append(
            Answer(
                line=line,
                races=by_crew.get(tuple(line[name] for name in crew), races.head(0)).to_dicts(),
                curve=curve_of(line),
                faults=faults.get((line["method"], line["season"]), ()),
            )
        )
    return by_boat


@dataclass(frozen=True)
class Told:
    """An answer in one language.

    Attributes:
        crew: which crew it is about.
        headline: the number, or why there is none.
        sentences: the rest, in order of what people ask.
        waterfall, curve: pictures; empty where there is nothing to draw.
        certificate: key by which the certificate can be asked for.
    """

    crew: str
    headline: str
    sentences: Sequence[str]
    waterfall: Markup
    curve: Markup


def told(answer: Answer, speech: Speech) -> Told:
    """The answer in a language."""
    line = answer.line
    crew = crew_name(line, speech)
    title = f"{line['name']} {crew}"
    return Told(
        crew=crew,
        headline=_headline(line, speech),
        sentences=list(_sentences(answer, speech)),
        waterfall=_waterfall(line, speech, title),
        curve=curve_picture(
            answer.curve, line, speech, f"{speech.say('Resistance curve')}: {title}"
        ),
    )


def crew_name(line: Row, speech: Speech) -> str:
    """How many rowers of which class: 8 rowers, women."""
    people = speech.say(labels.crew(line["crew_class"]))
    return speech.say("{rowers} rowers, {people}", rowers=line["rowers"], people=people)


def _headline(line: Row, speech: Speech) -> str:
    if line["cw_kg_m"] is None:
        return speech.say(
            "No valid number: {status}.", status=speech.say(labels.code(line["status"]))
        )
    new = speech.number(line["cw_kg_m"], 2)
    if line["cw_ratio"] is None:
        return speech.say("Cw is {new} kg/m.", new=new)
    ratio = line["cw_kg_m"] / line["old_cw_kg_m"]  # of the two that are shown, each at its speed
    if abs(ratio - 1) <= SHOWN:
        return speech.say("Cw stays {new} kg/m.", new=new)
    change = (
        say("Cw goes from {old} to {new} kg/m: {by} % lower.")
        if ratio < 1
        else say("Cw goes from {old} to {new} kg/m: {by} % higher.")
    )
    old = speech.number(line["old_cw_kg_m"], 2)
    by = speech.number(100 * abs(ratio - 1), 1)
    return speech.say(change, old=old, new=new, by=by)


def _sentences(answer: Answer, speech: Speech) -> Iterator[str]:
    line = answer.line
    if line["cw_kg_m"] is not None:
        yield from _change(line, speech)
        yield from _certainty(line, speech)
        yield from _best(line, speech)
        yield from _instruments(answer, speech)
        yield from _place(line, speech)
    yield from (_race(race, speech) for race in answer.races)
    yield from _validity(line, speech)
    yield _objection(line, speech)


def _change(line: Row, speech: Speech) -> Iterator[str]:
    """Compared with what, why, and what it is worth in a race."""
    if line["cw_ratio"] is None:
        return
    yield speech.say(
        "Compared: \u201c{new}\u201d with \u201c{old}\u201d.",
        new=speech.edition(line["edition"]),
        old=speech.edition(line["from_edition"]),
    )
    if line["old_declared_speed_m_s"] != line["declared_speed_m_s"]:
        yield speech.say(
            "The declared speed is another one: {new} instead of {old} m/s. At the old "
            "speed Cw changes by {by}; what follows is about that.",
            old=speech.number(line["old_declared_speed_m_s"], 2),
            new=speech.number(line["declared_speed_m_s"], 2),
            by=speech.per_cent(line["cw_ratio"]),
        )
    if line["change"] == "same":
        return
    causes = "; ".join(f"{name} {speech.per_cent(f)}" for name, f in causes_of(line, speech))
    yield speech.say("Why: {causes}.", causes=causes)
    seconds = line["gain_in_two_hours_s"]
    if seconds is not None:
        yield speech.say(
            "For the same power the crew may take {seconds} s longer over a race of two hours."
            if seconds > 0
            else "For the same power the crew has to row a race of two hours {seconds} s faster.",
            seconds=speech.number(abs(seconds), 0),
        )


def causes_of(line: Row, speech: Speech) -> list[tuple[str, float]]:
    """Name and factor of what made the change, the largest first; small ones as one."""
    causes = [
        (speech.say(labels.code(cause.get("step", cause["cause"]))), float(cause["factor"]))
        for cause in json.loads(line["causes"] or "[]")
    ]
    small = [factor for _, factor in causes if abs(factor - 1) < SHOWN]
    large = [(name, factor) for name, factor in causes if abs(factor - 1) >= SHOWN]
    rest = 1.0
    for factor in small:
        rest *= factor
    large.sort(key=lambda cause: -abs(cause[1] - 1))
    return [*large, *([(speech.say(labels.code("rest")), rest)] if abs(rest - 1) >= SHOWN else [])]


def _certainty(line: Row, speech: Speech) -> Iterator[str]:
    """The interval, what it leaves out, and whether the change exceeds it."""
    low, high = line["cw_lo_kg_m"], line["cw_hi_kg_m"]
    if low is not None and high is not None:
        yield interval_in_words(low, high, line["new_log_known"], speech)
    if line["change"] != "changed":
        return
    of_one_tow = line["old_tow_id"] == line["tow_id"]
    yield speech.say(VERDICTS[line["exceeds_interval"]][of_one_tow])
    if line["exceeds_interval"] is not None and not line["old_log_known"]:
        yield speech.say(
            "The uncertainty of the old number leaves out the error of the log: it is too small."
        )


def interval_in_words(low: float, high: float, log_known: bool, speech: Speech) -> str:
    """The interval of Cw [kg/m], and whether the error of the log is in it."""
    return speech.say(
        "With 95 % confidence Cw lies between {low} and {high} kg/m."
        if log_known
        else "The scatter of the runs alone leaves Cw between {low} and {high} kg/m; the "
        "error of the log comes on top of that and is not known under this method.",
        low=speech.number(low, 2),
        high=speech.number(high, 2),
    )


VERDICTS: Final = {
    True: (
        say("The change is larger than the uncertainty of both numbers together."),
        say(
            "Both numbers come from the same tow; the new one lies outside the interval of the old."
        ),
    ),
    False: (
        say("The change lies within the uncertainty of both numbers together."),
        say(
            "Both numbers come from the same tow; the new one lies within the interval of the old."
        ),
    ),
    None: (UNKNOWN_VERDICT, UNKNOWN_VERDICT),
}
"""Whether a change exceeds the uncertainty: of two tows, and of one."""


def _best(line: Row, speech: Speech) -> Iterator[str]:
    """What the whole archive makes of the tow, and of its difference from the last one."""
    if line["cw_best_kg_m"] is None or line["own_weight"] is None:
        return
    best = (line[f"cw_best_{end}kg_m"] for end in ("", "lo_", "hi_"))
    value, low, high = (speech.number(number, 2) for number in best)
    share = speech.number(100 * line["own_weight"], 0)
    yield speech.say(
        "The best estimate from all tows of the archive is {best} kg/m ({low} to "
        "{high}); {share} % of it rests on this tow.",
        best=value,
        low=low,
        high=high,
        share=share,
    )
    if line["best_moved_ratio"] is not None and abs(line["moved_ratio"] - 1) >= SHOWN:
        yield speech.say(
            "Against the tow of {before} Cw at equal speed is {moved}; by the best "
            "estimate {kept}. What differs between the two comes from measuring rather "
            "than from the boat.",
            before=line["season_before"],
            moved=speech.per_cent(line["moved_ratio"]),
            kept=speech.per_cent(line["best_moved_ratio"]),
        )


def _instruments(answer: Answer, speech: Speech) -> Iterator[str]:
    """What is known of the log of its season, and what may be wrong with the instruments."""
    line = answer.line
    if line["log_source"] == "estimated":
        factor, low, high = (line[f"log_{part}"] for part in ("factor", "lo", "hi"))
        yield speech.say(
            "In {season} the log read {by} % too low (95 %: {low} to {high}); that is corrected."
            if factor > 1
            else "In {season} the log read {by} % too high (95 %: {low} to {high}); that is "
            "corrected.",
            season=line["season"],
            by=speech.number(100 * abs(1 - 1 / factor), 1),
            low=speech.per_cent(1 / high),
            high=speech.per_cent(1 / low),
        )
    # A search that did not settle is said once, and not of every instrument.
    yield from dict.fromkeys(_fault(fault, speech) for fault in answer.faults)


FAULTS: Final = {
    "fault": say(
        "In {season} something is probably wrong: {instrument}, {size} (chance {chance} %)."
    ),
    "cannot be told": say(
        "Whether something was wrong in {season} ({instrument}) cannot be told (chance {chance} %)."
    ),
    "not settled": say(
        "The search for the errors of the instruments did not settle. What is "
        "estimated of {season} cannot be relied on."
    ),
    "alarm": say(
        "In {season} an instrument lies far from what is assumed: {instrument}, "
        "{size}. A person should look."
    ),
}
"""What is said of a season, by the verdict on an instrument."""


def _fault(fault: Row, speech: Speech) -> str:
    """What may be wrong with one instrument."""
    chance = fault["p_fault"]
    return speech.say(
        FAULTS[fault["verdict"]],
        instrument=speech.say(labels.code(fault["instrument"])),
        season=fault["season"],
        chance="" if chance is None else speech.number(100 * chance, 0),
        size=_size(fault["estimate"], fault["unit"], speech),
    )


def _size(value: float, unit: str, speech: Speech) -> str:
    """A force, or the logarithm of a factor as a change."""
    if unit == "N":
        return f"{speech.number(value, 1, '+')}\u00a0N"
    return speech.per_cent(exp(value))


def _place(line: Row, speech: Speech) -> Iterator[str]:
    """Its place at equal power, within its type."""
    if line["new_type_place"] is None or not line["boat_type"] or line["type_size"] < FEW:
        return
    same = line["old_type_place"] in (None, line["new_type_place"])
    yield speech.say(
        "At equal power per rower this boat ranks {place} of {size} of type {type} by "
        "speed ({people})."
        if same
        else "At equal power per rower this boat now ranks {place} of {size} of type {type} "
        "by speed ({people}); it was {old}.",
        place=line["new_type_place"],
        old=line["old_type_place"],
        size=line["type_size"],
        type=line["boat_type"],
        people=speech.say(labels.crew(line["crew_class"])),
    )


def _race(race: Row, speech: Speech) -> str:
    if race["new_rank"] is None:
        why = [
            f"{speech.edition(race[edition])}: {speech.say(labels.code(race[remark]))}"
            for edition, remark in (("from_edition", "old_remark"), ("to_edition", "new_remark"))
            if race[remark]
        ]
        return speech.say(
            "{race} {day}: there are no two places to compare ({why}).",
            race=race["race"],
            day=race["race_date"],
            why="; ".join(why),
        )
    moved = race["old_rank"] != race["new_rank"]
    return speech.say(
        "{race} {day}: place {new} of the {size} crews that both editions rank; it was {old}."
        if moved
        else "{race} {day}: place {new} of the {size} crews that both editions rank, as before.",
        race=race["race"],
        day=race["race_date"],
        size=race["race_size"],
        old=race["old_rank"],
        new=race["new_rank"],
    )


def _validity(line: Row, speech: Speech) -> Iterator[str]:
    """Until when it counts, and the next tow."""
    if line["valid_until"] is not None:
        yield speech.say(
            "The tow of {tow} counts up to and including {until}."
            if line["status"] == "valid"
            else "The tow of {tow} counted up to and including {until}.",
            until=line["valid_until"],
            tow=line["tow_date"],
        )
    if line["tow_speed_m_s"] is not None:
        yield speech.say(
            "Next tow: at {speed} m/s ({reason}).",
            speed=speech.number(line["tow_speed_m_s"], 2),
            reason=speech.say(labels.code(line["speed_reason"])),
        )


def _objection(line: Row, speech: Speech) -> str:
    code = line["verification_code"]
    asked = speech.say(" and verification code {code}", code=code) if code else ""
    return speech.say(
        "Is something wrong? Tell the committee, and name {fsn_no}{code}. How the "
        "number was made is shown below.",
        fsn_no=line["fsn_no"],
        code=asked,
    )


def _waterfall(line: Row, speech: Speech, title: str) -> Markup:
    if line["cw_ratio"] is None or line["change"] == "same":
        return Markup()
    old = line["cw_ratio"] and line["old_cw_kg_m"]
    caption = f"{speech.say('From the old number to the new, Cw in kg/m')}: {title}"
    new = old * line["cw_ratio"]
    return waterfall_picture((old, new), causes_of(line, speech), speech, caption)
