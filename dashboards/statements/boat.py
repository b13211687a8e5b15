"""What an owner asks of a boat: what changes, why, how certainly, and what follows."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate
from operator import mul
from typing import Final, NamedTuple

from dashboards import labels
from dashboards.speech import Speech
from dashboards.statements import Change, EditionName, Number, Statement, Value, number, told
from dashboards.statements.edition import NEGLIGIBLE, causes_of_line
from dashboards.statements.race import place_in_race
from pipeline.messages import Sentence, say
from pipeline.tables.row import Row
from warehouse.queries.answers import answers, season_faults, select_own_races
from warehouse.queries.views import DRAFT, Views

LEAST_RANKED: Final = 2
"""A place among fewer says nothing."""


NUMBER: Final = say("Your number")
WHY: Final = say("Why")
FAIR: Final = say("Is it fair?")


class Block(NamedTuple):
    """The statements that answer one question of an owner, the main one first."""

    title: Sentence
    statements: Sequence[Statement]


class Bar(NamedTuple):
    """A row of the picture that leads from an old number to the new one.

    Attributes:
        kind: `number`, which is a mark; `more` or `less`, a bar.
        start, width: in per cent of the room.
    """

    kind: str
    name: Sentence
    value: Number | Change
    start: float
    width: float = 0.0


@dataclass(frozen=True)
class Answer:
    """What there is to say of a boat and crew under an edition.

    Attributes:
        line: a row of `warehouse.queries.answers.answers`.
        races: rows of `select_own_races` of this boat and crew.
        faults: rows of `season_diagnosis` of its season that a person should look at.
    """

    line: Row
    races: Sequence[Row]
    faults: Sequence[Row] = ()

    @property
    def blocks(self) -> list[Block]:
        """The number, or why there is none; where it comes from; how far it can be trusted."""
        line = self.line
        number = [
            headline(line),
            *_flags(line),
            *_power(line),
            *_place(line),
            *_validity(line),
        ]
        why = [*_change(line), *_log(line), *map(place_in_race, self.races)]
        fair = [*_certainty(line), *_best(line), *_faults(self.faults)]
        fair += [*_predicted(line), *_next_tow(line)]
        if line["cw_kg_m"] is None:
            why, fair = list(map(place_in_race, self.races)), list(_next_tow(line))
        found = [(NUMBER, number), (WHY, why), (FAIR, [*fair, _objection(line)])]
        return [Block(title, statements) for title, statements in found if statements]

    @property
    def statements(self) -> list[Statement]:
        """All that is said, in the order of the blocks."""
        return [statement for block in self.blocks for statement in block.statements]

    def crew(self, speech: Speech) -> str:
        """Which crew it is about."""
        return crew_name(self.line, speech)

    @property
    def waterfall(self) -> list[Bar]:
        """What each cause did to the number; nothing where it did not change.

        The axis need not begin at zero: both numbers are marks on it, and only changes have a
        length.
        """
        line, old = self.line, self.line["old_cw_kg_m"]
        if line["cw_ratio"] is None or line["change"] == "same":
            return []
        causes, new = causes_of_line(line), old * line["cw_ratio"]
        ends = list(accumulate((factor for _, factor in causes), mul, initial=old))
        room = 0.25 * (max(ends) - min(ends)) or 0.01 * old
        places = [
            100 * (end - min(ends) + room) / (max(ends) - min(ends) + 2 * room)
            for end in (*ends, new)
        ]
        return [
            Bar("number", say("was"), Number(old), places[0]),
            *(
                Bar(
                    "more" if factor > 1 else "less",
                    name,
                    Change(factor),
                    min(span),
                    max(span) - min(span),
                )
                for (name, factor), *span in zip(causes, places, places[1:], strict=False)
            ),
            Bar("number", say("becomes"), Number(new), places[-1]),
        ]


def answers_by_boat(views: Views, edition: str, only: str | None = None) -> dict[str, list[Answer]]:
    """The answers about crews in an edition or draft, by boat.

    Args:
        only: the number of the one boat that is asked for; all when left out.
    """
    lines = answers(views, edition)
    races = select_own_races(views, next(iter(lines["from_edition"].drop_nulls()), None), edition)
    crew = ["fsn_no", "rowers", "crew_class"]
    by_crew = races.partition_by(crew, as_dict=True, maintain_order=True)
    faults = season_faults(views) if edition.startswith(DRAFT) else {}  # an edition holds none
    by_boat: dict[str, list[Answer]] = defaultdict(list)
    for line in (lines if only is None else lines.filter(fsn_no=only)).to_dicts():
        own = by_crew.get(tuple(line[name] for name in crew), races.head(0)).to_dicts()
        of_season = faults.get((line["method"], line["season"]), ())
        by_boat[line["fsn_no"]].append(Answer(line, own, of_season))
    return by_boat


def crew_name(line: Row, speech: Speech) -> str:
    """How many rowers of which class: 8 rowers, women."""
    return speech.say(
        "{rowers} rowers, {people}", rowers=line["rowers"], people=labels.crew(line["crew_class"])
    )


def headline(line: Row) -> Statement:
    """The number of a line and by how much it changes, or why there is none."""
    rests_on = ("register", "register_changes")
    if line["cw_kg_m"] is None:
        wording = say("No valid number: {status}.")
        return told("no_number", wording, status=labels.code(line["status"]))
    if line["cw_ratio"] is None:
        return told("cw", say("Cw is {cw_kg_m} kg/m."), line, *rests_on)
    ratio = line["cw_kg_m"] / line["old_cw_kg_m"]  # of the two that are shown, each at its speed
    if abs(ratio - 1) <= NEGLIGIBLE:
        return told("cw", say("Cw stays {cw_kg_m} kg/m."), line, *rests_on, verdict="same")
    wording = (
        say("Cw goes from {old_cw_kg_m} to {cw_kg_m} kg/m: {by} % lower.")
        if ratio < 1
        else say("Cw goes from {old_cw_kg_m} to {cw_kg_m} kg/m: {by} % higher.")
    )
    by, verdict = Number(100 * abs(ratio - 1), 1, "%"), "lower" if ratio < 1 else "higher"
    return told("cw", wording, line, *rests_on, verdict=verdict, by=by)


def _flags(line: Row) -> Iterator[Statement]:
    """State what somebody still has to look at before the number is trusted."""
    if line["flags"]:
        flags: list[Value] = [labels.code(flag) for flag in line["flags"]]
        yield told("flags", say("Still to be looked at: {flags}."), {}, "register", flags=flags)


def _power(line: Row) -> Iterator[Statement]:
    """What it asks of each rower."""
    if line["new_power_w"] is not None:
        wording = say("That takes {power} W per rower at {declared_speed_m_s} m/s.")
        yield told("power", wording, line, "register", power=number(line, "new_power_w", 0))


def _change(line: Row) -> Iterator[Statement]:
    """Compared with what, why, and what it is worth in a race."""
    if line["cw_ratio"] is None:
        return
    yield told(
        "compared",
        say("Compared: \u201c{new}\u201d with \u201c{old}\u201d."),
        new=EditionName(line["edition"]),
        old=EditionName(line["from_edition"]),
    )
    yield from _tows(line)
    if line["old_declared_speed_m_s"] != line["declared_speed_m_s"]:
        wording = say(
            "The declared speed has changed: {declared_speed_m_s} instead of "
            "{old_declared_speed_m_s} m/s. At the old speed Cw changes by {by}; the rest is"
            " about that change."
        )
        yield told("declared_speed", wording, line, by=Change(line["cw_ratio"]))
    if line["change"] == "same":
        return
    each: list[Value] = [
        told("cause", say("{name} {by}"), name=name, by=Change(factor))
        for name, factor in causes_of_line(line)
    ]
    yield told("causes", say("Why: {causes}."), line, "register_changes", causes=each)
    if line["gain_in_two_hours_s"] is not None:
        yield two_hours(line["gain_in_two_hours_s"])


def _tows(line: Row) -> Iterator[Statement]:
    """Which tows the numbers come from where they are two, and why the newer one counts."""
    days = line["old_tow_date"], line["tow_date"]
    if None in days or days[0] == days[1]:
        return
    wording = (
        say(
            "The old number comes from the tow of {old_tow_date}, the new one from that of "
            "{tow_date}: the boat was reported as altered in between."
        )
        if line["altered"]
        else say(
            "The old number comes from the tow of {old_tow_date}, the new one from that of "
            "{tow_date}."
        )
    )
    verdict = "altered" if line["altered"] else ""
    yield told("two_tows", wording, line, "tows", "register", verdict=verdict)


def two_hours(seconds: float) -> Statement:
    """What a change is worth in a race of two hours [s]."""
    wording = (
        say("At the same power the crew may take {seconds} s longer over a two-hour race.")
        if seconds > 0
        else say("At the same power the crew must finish a two-hour race {seconds} s sooner.")
    )
    by = Number(abs(seconds), 0, "s")
    return told("two_hours", wording, {}, "register_changes", seconds=by)


def _certainty(line: Row) -> Iterator[Statement]:
    """The interval, what it leaves out, and whether the change exceeds it."""
    if line["cw_lo_kg_m"] is not None and line["cw_hi_kg_m"] is not None:
        yield interval(line, line["new_log_known"])
    if line["change"] != "changed":
        return
    exceeds, of_one_tow = line["exceeds_interval"], line["old_tow_id"] == line["tow_id"]
    verdict = {True: "beyond", False: "within", None: "not known"}[exceeds]
    yield told("exceeds", VERDICTS[exceeds][of_one_tow], verdict=verdict)
    if exceeds is not None and not line["old_log_known"]:
        yield told(
            "old_log_unknown",
            say(
                "The uncertainty of the old number leaves out the error of the log: it is too "
                "small."
            ),
        )


def interval(line: Row, log_known: bool) -> Statement:
    """The interval of Cw, and whether the error of the log is in it."""
    if log_known:
        wording = say("With 95 % confidence Cw lies between {cw_lo_kg_m} and {cw_hi_kg_m} kg/m.")
        return told("interval", wording, line, "curves", verdict="complete")
    wording = say(
        "The scatter of the runs alone leaves Cw between {cw_lo_kg_m} and {cw_hi_kg_m} kg/m; the "
        "error of the log comes on top of that and is not known under this method."
    )
    return told("interval", wording, line, "curves", verdict="runs_alone")


UNKNOWN_VERDICT: Final = say(
    "Whether the change is larger than the uncertainty is not known: one of the numbers has none."
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


def _best(line: Row) -> Iterator[Statement]:
    """What the whole archive makes of the tow, and of its difference from the last one."""
    if line["cw_best_kg_m"] is None or line["own_weight"] is None:
        return
    wording = say(
        "The best estimate from all tows of the archive is {cw_best_kg_m} kg/m ({cw_best_lo_kg_m} "
        "to {cw_best_hi_kg_m}); {share} % of it rests on this tow."
    )
    share = Number(100 * line["own_weight"], 0, "%")
    yield told("best_estimate", wording, line, "curves", "best_estimate_weights", share=share)
    if line["best_moved_ratio"] is not None and abs(line["moved_ratio"] - 1) >= NEGLIGIBLE:
        wording = say(
            "Compared with the tow of {season_before}, Cw at equal speed is {moved}; by the"
            " best estimate {kept}. That difference comes from the measurement rather than "
            "the boat."
        )
        moved, kept = Change(line["moved_ratio"]), Change(line["best_moved_ratio"])
        yield told("since_last_tow", wording, line, "repeat_pairs", moved=moved, kept=kept)


def _predicted(line: Row) -> Iterator[Statement]:
    """What the other boats predict of Cw without a tow, beside what the tow gives."""
    if line["predicted_cw_kg_m"] is None:
        return
    wording = (
        say(
            "By its weight, length, beam and type the other boats predict a Cw of "
            "{predicted_cw_kg_m} kg/m at {predicted_speed_m_s} m/s ({predicted_lo_kg_m} to "
            "{predicted_hi_kg_m}); this tow gives {cw_there_kg_m}: they disagree."
        )
        if line["disagrees"]
        else say(
            "By its weight, length, beam and type the other boats predict a Cw of "
            "{predicted_cw_kg_m} kg/m at {predicted_speed_m_s} m/s ({predicted_lo_kg_m} to "
            "{predicted_hi_kg_m}); this tow gives {cw_there_kg_m}."
        )
    )
    verdict = "disagrees" if line["disagrees"] else "agrees"
    yield told("predicted", wording, line, "predicted_cw", verdict=verdict)


def _log(line: Row) -> Iterator[Statement]:
    """What is known of the log of its season."""
    if line["log_source"] != "estimated":
        return
    factor = line["log_factor"]
    wording = (
        say("In {season} the log read {by} % too low (95 %: {low} to {high}); that is corrected.")
        if factor > 1
        else say(
            "In {season} the log read {by} % too high (95 %: {low} to {high}); that is corrected."
        )
    )
    yield told(
        "log_read",
        wording,
        line,
        "log_factors",
        verdict="low" if factor > 1 else "high",
        by=Number(100 * abs(1 - 1 / factor), 1, "%"),
        low=Change(1 / line["log_hi"]),
        high=Change(1 / line["log_lo"]),
    )


def _faults(faults: Sequence[Row]) -> Iterator[Statement]:
    """What may be wrong with the instruments of its season."""
    # A search that did not settle is said once, and not of every instrument.
    found = [_fault(fault) for fault in faults]
    unsettled = [one for one in found if one.verdict == "not settled"][:1]
    yield from (one for one in found if one.verdict != "not settled")
    yield from unsettled


FAULTS: Final = {
    "fault": say(
        "In {season} something is probably wrong: {instrument}, {size} (chance {chance} %)."
    ),
    "cannot be told": say(
        "Something may have been wrong in {season} ({instrument}; chance {chance} %)."
    ),
    "not settled": say(
        "The estimate of the instrument errors did not converge: the numbers of {season} "
        "are unreliable."
    ),
    "alarm": say(
        "In {season} an instrument is far from what is assumed: {instrument}, {size}. "
        "Someone should look at it."
    ),
}
"""What is said of a season, by the verdict on an instrument."""
SEASON_LEVEL: Final = say(
    "All boats towed in {season} lie {size} from what they show in other seasons. It may be mass "
    "on board, the depth of the water, waves, or a load cell that is not linear. Someone should "
    "look at it."
)

INSTRUMENT_OR_BOAT: Final = say(
    "In {season} {shown_by} came out unlike its other tows, and too few boats tell why: either an "
    "instrument was off ({instrument}, up to {size}), or the boat was altered. Nothing is "
    "corrected; the interval allows for both."
)
"""What is said of a fault that one boat alone shows."""


def _fault(fault: Row) -> Statement:
    """What may be wrong with one instrument."""
    chance = fault["p_fault"]
    wording, largest = FAULTS[fault["verdict"]], fault["size"]
    if fault["instrument"] == "season_level" and fault["verdict"] == "alarm":
        wording = SEASON_LEVEL
    if fault["shown_by"] is not None:
        wording, largest = INSTRUMENT_OR_BOAT, max(fault["size_lo"], fault["size_hi"], key=abs)
    size = Number(largest, 1, fault["unit"], sign="+")
    return told(
        "fault",
        wording,
        fault,
        "season_diagnosis",
        verdict=fault["verdict"],
        instrument=labels.code(fault["instrument"]),
        chance="" if chance is None else Number(100 * chance, 0, "%"),
        size=told("size", say("{size}\u00a0{unit}"), fault, size=size),
    )


def _place(line: Row) -> Iterator[Statement]:
    """Its place at equal power, within its type."""
    if line["new_type_place"] is None or not line["boat_type"] or line["type_size"] < LEAST_RANKED:
        return
    same = line["old_type_place"] in (None, line["new_type_place"])
    wording = (
        say(
            "At equal power per rower this boat ranks {new_type_place} of {type_size} of type "
            "{boat_type} by speed ({people})."
        )
        if same
        else say(
            "At equal power per rower this boat now ranks {new_type_place} of {type_size} of type "
            "{boat_type} by speed ({people}); it was {old_type_place}."
        )
    )
    people, verdict = labels.crew(line["crew_class"]), "same" if same else "moved"
    yield told("place_in_type", wording, line, "register_changes", verdict=verdict, people=people)


def _validity(line: Row) -> Iterator[Statement]:
    """Until when it counts."""
    if line["valid_until"] is not None:
        wording = (
            say("The tow of {tow_date} counts up to and including {valid_until}.")
            if line["status"] == "valid"
            else say("The tow of {tow_date} counted up to and including {valid_until}.")
        )
        yield told("validity", wording, line, "register", verdict=line["status"])


def _next_tow(line: Row) -> Iterator[Statement]:
    """At what speed to tow next."""
    if line["tow_speed_m_s"] is not None:
        wording, reason = say("Next tow: at {tow_speed_m_s} m/s ({reason})."), line["speed_reason"]
        yield told("next_tow", wording, line, "due_list", reason=labels.code(reason))


def _objection(line: Row) -> Statement:
    asked: Value = ""
    if line["verification_code"]:
        asked = told("code", say(" and verification code {verification_code}"), line)
    wording = say(
        "Is something wrong? Tell the committee, and name {fsn_no}{code}. How the "
        "number was made is shown below."
    )
    return told("objection", wording, line, code=asked)
