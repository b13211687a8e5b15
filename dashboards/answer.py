"""The owner's answer in sentences: what changes for a boat, why, how certainly, what follows.

The numbers come from `warehouse.queries.answers`, the texts from `pipeline.words.answers`.
"""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import exp
from typing import Final

from markupsafe import Markup

from dashboards.pictures import curve_picture, waterfall_picture
from dashboards.speech import Speech
from pipeline.tables.row import Row
from warehouse.queries.documents import Curve

FEW: Final = 2
"""A place among fewer says nothing."""
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
        curve=curve_picture(answer.curve, line, speech, f"{speech.say('boat_curve')}: {title}"),
    )


def crew_name(line: Row, speech: Speech) -> str:
    """How many rowers of which class: 8 rowers, women."""
    people = speech.say(f"crew.{line['crew_class']}")
    return speech.say("crew_of").format(rowers=line["rowers"], people=people)


def _headline(line: Row, speech: Speech) -> str:
    if line["cw_kg_m"] is None:
        return speech.say("answer_none").format(status=speech.say(f"code.{line['status']}"))
    new = speech.number(line["cw_kg_m"], 2)
    if line["cw_ratio"] is None:
        return speech.say("answer_number").format(new=new)
    ratio = line["cw_kg_m"] / line["old_cw_kg_m"]  # of the two that are shown, each at its speed
    if abs(ratio - 1) <= SHOWN:
        return speech.say("answer_same").format(new=new)
    key = "answer_lower" if ratio < 1 else "answer_higher"
    old = speech.number(line["old_cw_kg_m"], 2)
    by = speech.number(100 * abs(ratio - 1), 1)
    return speech.say(key).format(old=old, new=new, by=by)


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
    yield speech.say("answer_compared").format(
        new=speech.edition(line["edition"]), old=speech.edition(line["from_edition"])
    )
    if line["old_declared_speed_m_s"] != line["declared_speed_m_s"]:
        yield speech.say("answer_other_speed").format(
            old=speech.number(line["old_declared_speed_m_s"], 2),
            new=speech.number(line["declared_speed_m_s"], 2),
            by=speech.per_cent(line["cw_ratio"]),
        )
    if line["change"] == "same":
        return
    causes = "; ".join(f"{name} {speech.per_cent(f)}" for name, f in causes_of(line, speech))
    yield speech.say("answer_causes").format(causes=causes)
    seconds = line["gain_in_two_hours_s"]
    if seconds is not None:
        key = "answer_slower" if seconds > 0 else "answer_faster"
        yield speech.say(key).format(seconds=speech.number(abs(seconds), 0))


def causes_of(line: Row, speech: Speech) -> list[tuple[str, float]]:
    """Name and factor of what made the change, the largest first; small ones as one."""
    causes = [
        (speech.say(f"code.{cause.get('step', cause['cause'])}"), float(cause["factor"]))
        for cause in json.loads(line["causes"] or "[]")
    ]
    small = [factor for _, factor in causes if abs(factor - 1) < SHOWN]
    large = [(name, factor) for name, factor in causes if abs(factor - 1) >= SHOWN]
    rest = 1.0
    for factor in small:
        rest *= factor
    large.sort(key=lambda cause: -abs(cause[1] - 1))
    return [*large, *([(speech.say("code.rest"), rest)] if abs(rest - 1) >= SHOWN else [])]


def _certainty(line: Row, speech: Speech) -> Iterator[str]:
    """The interval, what it leaves out, and whether the change exceeds it."""
    low, high = line["cw_lo_kg_m"], line["cw_hi_kg_m"]
    if low is not None and high is not None:
        key = "answer_interval" if line["new_log_known"] else "answer_spread"
        yield speech.say(key).format(low=speech.number(low, 2), high=speech.number(high, 2))
    if line["change"] != "changed":
        return
    verdict = {True: "answer_exceeds", False: "answer_within", None: "answer_unknown"}
    key = verdict[line["exceeds_interval"]]
    of_one_tow = key != "answer_unknown" and line["old_tow_id"] == line["tow_id"]
    yield speech.say(f"{key}_old" if of_one_tow else key)
    if line["exceeds_interval"] is not None and not line["old_log_known"]:
        yield speech.say("answer_old_spread")


def _best(line: Row, speech: Speech) -> Iterator[str]:
    """What the whole archive makes of the tow, and of its difference from the last one."""
    if line["cw_best_kg_m"] is None or line["own_weight"] is None:
        return
    best = (line[f"cw_best_{end}kg_m"] for end in ("", "lo_", "hi_"))
    value, low, high = (speech.number(number, 2) for number in best)
    share = speech.number(100 * line["own_weight"], 0)
    yield speech.say("answer_best").format(best=value, low=low, high=high, share=share)
    if line["best_moved_ratio"] is not None and abs(line["moved_ratio"] - 1) >= SHOWN:
        yield speech.say("answer_moved").format(
            before=line["season_before"],
            moved=speech.per_cent(line["moved_ratio"]),
            kept=speech.per_cent(line["best_moved_ratio"]),
        )


def _instruments(answer: Answer, speech: Speech) -> Iterator[str]:
    """What is known of the log of its season, and what may be wrong with the instruments."""
    line = answer.line
    if line["log_source"] == "estimated":
        factor, low, high = (line[f"log_{part}"] for part in ("factor", "lo", "hi"))
        yield speech.say("answer_log_low" if factor > 1 else "answer_log_high").format(
            season=line["season"],
            by=speech.number(100 * abs(1 - 1 / factor), 1),
            low=speech.per_cent(1 / high),
            high=speech.per_cent(1 / low),
        )
    # A search that did not settle is said once, and not of every instrument.
    yield from dict.fromkeys(_fault(fault, speech) for fault in answer.faults)


def _fault(fault: Row, speech: Speech) -> str:
    """What may be wrong with one instrument."""
    chance = fault["p_fault"]
    return speech.say(f"answer_{fault['verdict'].replace(' ', '_')}").format(
        instrument=speech.say(f"code.{fault['instrument']}"),
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
    key = "answer_place" if same else "answer_place_moved"
    yield speech.say(key).format(
        place=line["new_type_place"], old=line["old_type_place"], size=line["type_size"],
        type=line["boat_type"], people=speech.say(f"crew.{line['crew_class']}"),
    )  # fmt: skip


def _race(race: Row, speech: Speech) -> str:
    if race["new_rank"] is None:
        why = [
            f"{speech.edition(race[edition])}: {speech.say(f'code.{race[remark]}')}"
            for edition, remark in (("from_edition", "old_remark"), ("to_edition", "new_remark"))
            if race[remark]
        ]
        return speech.say("answer_race_none").format(
            race=race["race"], day=race["race_date"], why="; ".join(why)
        )
    moved = race["old_rank"] != race["new_rank"]
    return speech.say("answer_race_moved" if moved else "answer_race").format(
        race=race["race"], day=race["race_date"], size=race["race_size"],
        old=race["old_rank"], new=race["new_rank"],
    )  # fmt: skip


def _validity(line: Row, speech: Speech) -> Iterator[str]:
    """Until when it counts, and the next tow."""
    if line["valid_until"] is not None:
        key = "answer_valid" if line["status"] == "valid" else "answer_expired"
        yield speech.say(key).format(until=line["valid_until"], tow=line["tow_date"])
    if line["tow_speed_m_s"] is not None:
        yield speech.say("answer_next").format(
            speed=speech.number(line["tow_speed_m_s"], 2),
            reason=speech.say(f"code.{line['speed_reason']}"),
        )


def _objection(line: Row, speech: Speech) -> str:
    code = line["verification_code"]
    asked = speech.say("answer_with_code").format(code=code) if code else ""
    return speech.say("answer_object").format(fsn_no=line["fsn_no"], code=asked)


def _waterfall(line: Row, speech: Speech, title: str) -> Markup:
    if line["cw_ratio"] is None or line["change"] == "same":
        return Markup()
    old = line["cw_ratio"] and line["old_cw_kg_m"]
    caption = f"{speech.say('waterfall')}: {title}"
    new = old * line["cw_ratio"]
    return waterfall_picture((old, new), causes_of(line, speech), speech, caption)
