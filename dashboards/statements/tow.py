"""A tow on the quay: its number, whether it was to be expected, and what to do now.

What is found and how bad it is, is judged in `pipeline.assessment.first_assessment`. Here it gets
its words.
"""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final

from dashboards import labels
from dashboards.statements import Number, Statement, Value, told
from dashboards.statements.boat import interval
from pipeline.assessment.first_assessment import CHANGED
from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.messages import Sentence, say
from pipeline.tables.row import Row

if TYPE_CHECKING:
    from warehouse.queries.assess import Assessment


COUNTED: Final = ("no_curve", "few_runs", "runs_set_aside", "unbalanced_runs", "parts_set_aside")
AS_RATIO: Final = ("unusual_calibration", "log_not_linear")
SIGNED: Final = (
    *(
        "out_and_back_differ",
        "run_off_curve",
        "runs_disagree",
        "load_cell_off",
        "unlike_other_tows",
        "boat_changed",
        "curve_change_unexplained",
    ),
    *("differs_from_last", "change_explained", "unlike_its_type", "pulled_askew", "heavier_after"),
    *("weight_changed", "length_changed", "beam_changed", "bow_height_changed"),
)
IN_METRES: Final = ("length_changed", "beam_changed", "bow_height_changed")
CURVES_COMPARED: Final = (*CHANGED, "differs_from_last", "change_explained")
"""How numbers of findings are written, and which findings compare the curve with the last tow's."""

EXPLAINED: Final = say(
    "It weighed {before} kg then and weighs {now} kg now: weight and length explain {explained} % "
    "of Cw."
)
EXPLAINED_BY_THAT: Final = say("That alone explains {explained} % of Cw.")
OF_INSTRUMENTS: Final = ("log2_differs", "unusual_calibration", "load_cell_off", "coarse_readings")
OTHERS: Final = say("The median of the {others} other tows of this season is {others_median}.")
"""What is said of an instrument that may read otherwise all season."""

OUT_AND_BACK_BY_RUNS: Final = say(
    "Out and back differ: Cw of the runs out is {observed} % from that of the runs back (limit "
    "{limit} %). What is said of {runs} will be the cause."
)
LOG2_AS_USUAL: Final = say(
    "Log 2 reads up to {observed} m/s other than log 1 (at most {limit}), no more than is usual "
    "this season. No number rests on log 2; revise the set-up of the logs when you can."
)
WORDING: Final[dict[str, Sentence]] = {
    "no_curve": say("The runs give no curve: tow all of them again."),
    "few_runs": say("Only {observed} runs count; the curve should rest on {limit}."),
    "runs_set_aside": say("Samples of {runs} cannot be used, for the reason below: tow again."),
    "parts_set_aside": say("Parts of the measurements or of the lists are set aside: see below."),
    "run_not_planned": say(
        "The file also holds {runs}, which the plan does not know: nothing of it is used. How it "
        "can be used is said below."
    ),
    "other_runs_proposed": say(
        "Some runs were towed more than once. The most reliable are these: write {selection} in "
        "column 'gebruik runs'."
    ),
    "unusual_calibration": say(
        "The GPS reads {observed} times the log (limit {limit}): find out which of the two is "
        "wrong. If it was wrong during this tow, tow all runs again."
    ),
    "log_not_linear": say(
        "GPS over log changes with speed in all tows of this season (slope {observed}, at most "
        "{limit}): look at log 1."
    ),
    "season_in_doubt": say("An instrument of this season is in doubt: see herijk seasons."),
    "instrument_or_boat": say(
        "This boat alone says that an instrument of the season is off; it may have been altered "
        "instead. Nothing was taken off its number: look at the load cell and at the boat."
    ),
    "weight_not_recorded": say(
        "The weight of the boat or its crew is not in the list, so that of like boats is used: "
        "weigh it and write it down."
    ),
    "coarse_readings": say(
        "Readings are written so coarsely that Cw may be {observed} % off (at most {limit} %)."
    ),
    "log2_differs": say(
        "Log 2 reads up to {observed} m/s other than log 1 (at most {limit}): look at both logs."
    ),
    "load_cell_off": say(
        "The load cell was {observed} % off when it was last checked (at most {limit} %)."
    ),
    "lamps_burned": say(
        "A warning lamp burned for {observed} % of a run (at most {limit} %): tow that run again."
    ),
    "force_not_plausible": say(
        "The force cannot be right, all other tows say: look at the load cell and its unit, then "
        "tow all runs again."
    ),
    "wind_not_plausible": say(
        "The wind cannot be right, all other tows say: look at the anemometer and the vane, and "
        "whether the file holds the wind as felt on board. Otherwise tow all runs again."
    ),
    "speed_not_plausible": say(
        "The speed cannot be right, all other tows say: look at the log and the declared speed, "
        "then tow all runs again."
    ),
    "force_unusual": say(
        "The force of this season, or a part of it, stands out: look at the load cell."
    ),
    "wind_unusual": say(
        "The wind of this season, or a part of it, stands out: look at the anemometer."
    ),
    "speed_unusual": say("The speed stands out against the intended one: look at the log."),
    "unbalanced_runs": say(
        "Of one way {observed} runs more count than of the other (at most {limit}): wind and "
        "current do not cancel. Tow the runs that are lacking again."
    ),
    "out_and_back_differ": say(
        "Out and back differ: Cw of the runs out is {observed} % from that of the runs back (limit "
        "{limit} %). The runs of one way are off, or the wind is: look at the anemometer and the "
        "steering, and tow the runs of the disturbed way again, or all of them."
    ),
    "run_off_curve": say(
        "Cw of {runs} is {observed} % off the curve through the other runs: tow it again."
    ),
    "runs_disagree": say(
        "Of {runs} one is off the curve through the other runs, by some {observed} %; nothing "
        "tells which of them. Tow them again."
    ),
    "power_outside_range": say(
        "The declared speed asks {observed} W per rower (limit {limit} W): is it realistic?"
    ),
    "slow_tow": say(
        "The declared speed asks only {observed} W per rower (at least {limit} W): unless the crew "
        "will row no faster, tow again at a realistic speed."
    ),
    "crew_weight": say(
        "Crew and ballast are {observed} kg per rower (limit {limit} kg): weigh again."
    ),
    "water_differs": say(
        "The water is {observed} °C off that of the day (at most {limit}): measure it again."
    ),
    "unlike_other_tows": say(
        "Cw is {observed} % from what all tows of the boat together say (limit {limit} %): look at "
        "the line, the trim and the bottom, and whether the file is of this boat."
    ),
    "boat_changed": say(
        "By all of its tows together the boat's Cw is {observed} % from that at its last tow, "
        "length and weight allowed for (limit {limit} %): was it altered?"
    ),
    "curve_change_unexplained": say(
        "Cw is {observed} % from its last tow, length and weight allowed for (limit {limit} %): "
        "look at the line, the trim and the bottom."
    ),
    "differs_from_last": say(
        "That is {observed} % from its last tow, more than the uncertainty of both: look at the "
        "line, the trim and the bottom before you let go."
    ),
    "unlike_its_type": say(
        "Cw is {observed} % from that of like boats, length and weight allowed for (limit {limit} "
        "%), and there is no earlier tow to compare with: look at the line, the trim and the "
        "bottom, and whether the file is of this boat."
    ),
    "pulled_askew": say("Cw is {observed} % above like boats (at most {limit} %): pulled askew?"),
    "change_explained": say(
        "Cw is {observed} % from its last tow. What length and weight leave unexplained is within "
        "{limit} %."
    ),
    "altered_reported": say(
        "The list says that the boat was altered: it is not compared with earlier tows."
    ),
    "weight_changed": say(
        "It weighs {now} kg and weighed {before} kg ({observed} %): weigh again, or report the "
        "alteration in the list."
    ),
    "length_changed": say(
        "Its waterline is {now} m and was {before} m ({observed} %): measure again, or report the "
        "alteration in the list."
    ),
    "beam_changed": say(
        "Its beam is {now} m and was {before} m ({observed} %): measure again, or report the "
        "alteration in the list."
    ),
    "bow_height_changed": say(
        "Its bow is {now} m high and was {before} m ({observed} %): measure again, or report the "
        "alteration in the list."
    ),
    "freeboard_changed": say(
        "Its freeboard changed by {observed} m (at most {limit} m): measure and weigh again."
    ),
    "heavier_after": say(
        "It was {observed} % heavier after the tow (at most {limit} %): does it leak?"
    ),
    "boat_list_differs": say(
        "Its length or breadth is {observed} % off the boat list (at most {limit} %): measure "
        "again, or mend the list."
    ),
    "off_target_speed": say(
        "The speed of {runs} is up to {observed} % off the intended one (at most {limit} %): tow "
        "again."
    ),
    "above_target_speed": say("Far too fast: {runs}, which does not count. Tow again."),
    "runs_in_other_order": say(
        "The speeds of {runs} are those of other runs: does the file number its runs, or name its "
        "groups, in another order than planned? Then give the plan in archief.toml; else tow these "
        "runs again."
    ),
    "range_not_covered": say(
        "The runs end {observed} % short of the intended speeds (at most {limit} %): the curve is "
        "valid over less."
    ),
    "declared_speed_not_covered": say(
        "The declared speed lies {observed} % outside the speeds of the runs that count (at most "
        "{limit} %): tow those that are lacking again."
    ),
    "large_scatter_in_run": say(
        "In {runs} the measurements swing: their standard deviation is {observed} % of Cw (at most "
        "{limit} %). Look at the line and the steering, and tow again."
    ),
    "samples_scatter": say(
        "In {runs} the samples swing fast: their standard deviation is {observed} times what is "
        "usual in this season (at most {limit} times). Look at the line and the load cell, and tow "
        "again."
    ),
    "no_steady_window": say("No steady part of 30 s remains of {runs}: tow again."),
}
"""What is said of each finding of the first assessment."""


def statements(tow: "Assessment", log_known: bool) -> list[Statement]:
    """Return the number first, then what was expected, the verdict, and all that was found.

    Args:
        tow: a tow that was assessed.
        log_known: whether intervals of the method hold the error of the log.
    """
    found = [row for row in tow.first_assessment if row["finding"]]
    return [*_number(tow, log_known), *_expected(tow), _verdict(tow), *_word(found)]


def _number(tow: "Assessment", log_known: bool) -> Iterator[Statement]:
    curve = tow.curve
    if curve["cw_kg_m"] is None:
        yield told("provisional", say("These runs give no curve."), verdict="none")
        return
    wording = say("Provisional: Cw is {cw_kg_m} kg/m at {declared_speed_m_s} m/s ({method}).")
    yield told("provisional", wording, curve, "curves", method=labels.method(tow.method))
    if curve["cw_lo_kg_m"] is not None and curve["cw_hi_kg_m"] is not None:
        yield interval(curve, log_known)


def _expected(tow: "Assessment") -> Iterator[Statement]:
    """What this boat's last tow and the other boats of its type have at that speed."""
    last, like = tow.own_before, tow.of_type
    if last is not None:
        wording = say("Its tow of {tow_date} gives {cw_kg_m} kg/m at that speed.")
        yield told("own_before", wording, last, "curves")
    if like["n"] and tow.tow["boat_type"]:
        wording = say(
            "The {n} other crews of type {boat_type} ({people}) have {median} kg/m there "
            "({lowest} to {highest})."
        )
        ends = {name: Number(like[name]) for name in ("median", "lowest", "highest")}
        people = labels.crew(tow.tow["crew_class"])
        yield told("like_boats", wording, tow.tow | like | ends, "curves", people=people)


def _verdict(tow: "Assessment") -> Statement:
    if tow.verdict == "good":
        return told("let_go", say("Good: let go."), verdict="good")
    if tow.verdict == "look":
        wording = say("Do not let go yet: look first at what is said below.")
        return told("look_first", wording, verdict="look")
    if tow.redo is None:
        wording = say("Tow again: which runs, and what to look at first, is said below.")
        return told("tow_again", wording, verdict="tow_again")
    wording = say("Tow again: {runs}.")
    return told("tow_again", wording, verdict="tow_again", runs=name_runs(tow.redo))


def _word(found: Sequence[Row]) -> Iterator[Statement]:
    """Yield a sentence for every finding, with the number that was observed and its limit."""
    compares_curves = any(row["finding"] in CURVES_COMPARED for row in found)
    for row in _gather_runs_not_planned(found):
        wording = WORDING[row["finding"]]
        if row["finding"] == "out_and_back_differ" and row["runs"]:
            wording = OUT_AND_BACK_BY_RUNS
        if row["finding"] == "log2_differs" and row["verdict"] == "good":
            wording = LOG2_AS_USUAL
        values: dict[str, Value] = {
            "observed": _number_in_unit(row, row["observed"]),
            "limit": _number_in_unit(row, row["limit"]),
            "runs": name_runs(row["runs"]),
            "others": row["others"] or 0,
            "others_median": _number_in_unit(row, row["others_median"]),
            "before": _size(row, "old_value"),
            "now": _size(row, "new_value"),
            "explained": _per_cent(row["explained_ratio"]),
            "selection": ",".join(map(name_run, row["runs"])),
        }
        yield told(row["finding"], wording, values, "assessments", verdict=row["verdict"])
        explains = row["explained_ratio"] is not None
        if explains and row["finding"] in CURVES_COMPARED:
            yield told("explained_by_size", EXPLAINED, values, "tows")
        elif explains and not compares_curves:
            yield told("explained_by_size", EXPLAINED_BY_THAT, values, "tows")
        if row["finding"] in OF_INSTRUMENTS and row["others"]:
            yield told("others_of_season", OTHERS, values, "assessments")


def _gather_runs_not_planned(found: Sequence[Row]) -> list[Row]:
    """Return findings with one for all runs that the plan does not know."""
    extra = [row for row in found if row["finding"] == "run_not_planned"]
    if not extra:
        return list(found)
    runs = [run for row in extra for run in row["runs"]]
    gathered = extra[0] | {"runs": runs}
    return [gathered if row is extra[0] else row for row in found if row not in extra[1:]]


def _number_in_unit(row: Row, value: float | None) -> Number | str:
    """Return a number of the assessment as it is worded: ratios of sizes and speeds in per cent."""
    if value is None:
        return ""
    if row["finding"] in COUNTED:
        return Number(value, 0, "1")
    if row["finding"] == "samples_scatter":
        return Number(value, 1, "1")
    if row["finding"] in AS_RATIO:
        return Number(value, 3, "1")
    if row["unit"] == "1":
        return Number(100 * value, 1, "%", sign="+" if row["finding"] in SIGNED else "")
    return Number(value, 3 if row["unit"] == "m/s" else 2 if row["unit"] == "m" else 1, row["unit"])


def _size(row: Row, name: str) -> Number | str:
    value = row[name]
    if value is None:
        return ""
    return Number(value, 0, "kg") if row["finding"] not in IN_METRES else Number(value, 2, "m")


def _per_cent(ratio: float | None) -> Number | str:
    return "" if ratio is None else Number(100 * ratio, 1, "%", sign="+")


def name_runs(runs: Sequence[int]) -> Sentence:
    """Return runs as they are worded: `run 3`, or `runs 3, 4 and b5`."""
    names = [name_run(run) for run in runs]
    if len(names) < 2:
        return say("run {run}", run="".join(names))
    return say("runs {runs} and {last}", runs=", ".join(names[:-1]), last=names[-1])


def name_run(run: int) -> str:
    """Return the number of a run as lists have it: b1 is run 1 of the second file."""
    return str(run) if run <= SECOND_FILE_OFFSET else f"b{run - SECOND_FILE_OFFSET}"
