"""What the workbench says of a method, and what its script says.

An option or value without a text here is shown by its name in the method file.
"""

from typing import Final

from dashboards import labels
from pipeline.messages import LANGUAGES, Sentence, pgettext, say, speaker

TEXTS: Final[dict[str, Sentence]] = {
    "workbench": say("Workbench"),
    "group_methods": say("Methods"),
    "group_editions": say("Published editions"),
    "group_saved": say("Saved here"),
    "all_seasons": say("All seasons"),
    "per_season": say("Per season"),
    "and_later": say("and later"),
    "no_tows": say("no tows"),
    "differs": say("differs"),
    "fixed": say("only in the method file"),
    "nothing": say("nothing"),
    "nothing_changed": say("Nothing yet: this is the method itself."),
    "busy": say("Recomputing ..."),
    "done_in": say("Recomputed and drawn in"),
    "tows_in_all": say("tows"),
    "refused": say("Not possible:"),
    "refusal.greater_than": say("has to be greater than"),
    "refusal.greater_than_equal": say("has to be at least"),
    "refusal.less_than": say("has to be less than"),
    "refusal.less_than_equal": say("has to be at most"),
    "refusal.int_from_float": say("has to be a whole number"),
    "refusal.int_parsing": say("has to be a whole number"),
    "shared": say("The link is on the clipboard."),
    "not_shared": say("The link is in the address bar; copy it there."),
    "means.count_changed": say("Lines whose Cw changes, of all lines."),
    "means.count_gains": say("Crews that may take longer over a race for the same power."),
    "means.count_loses": say("Crews that have to be faster for the same power."),
    "means.count_added": say("Lines that gain a valid curve."),
    "means.count_removed": say("Lines that lose their valid curve."),
    "means.median_cw": say("The middle ratio of new to old Cw over all lines."),
    "means.within_1": say(
        "How often an unaltered boat that was towed again has a Cw within 1 % of the "
        "earlier one. Higher is better."
    ),
    "means.within_2": say("The same for 2 %."),
    "means.sd_tow": say(
        "How far one tow is off by chance, as a standard deviation of Cw. Lower is better."
    ),
    "failed": say("The workbench failed; the terminal it was started in says more."),
    "gone": say("The workbench no longer answers. Start it again with herijk workbench."),
    # Results
    "count_changed": say("lines changed"),
    "count_gains": say("gain time"),
    "count_loses": say("lose time"),
    "count_added": say("lines added"),
    "count_removed": say("lines removed"),
    "median_cw": say("median Cw after / before"),
    "within_1": say("repeats within 1 %"),
    "within_2": say("repeats within 2 %"),
    "sd_tow": say("sd of one tow"),
    "was": say("was"),
    "boats_inside": say("Boats inside:"),
    "saved_as": say("Saved. To see all its effects:"),
    # Columns
    "column.old_cw_kg_m": say("Cw before [kg/m]"),
    "column.new_cw_kg_m": say("Cw after [kg/m]"),
    "column.gain_in_two_hours_s": say("Time in 2 h [s]"),
    "column.old_rank": say("Rank before"),
    "column.new_rank": say("Rank after"),
    "column.exceeds_interval": say("Beyond un\u00adcer\u00adtainty"),
    # Steps
    "step.speed": say("Speed"),
    "step.calibration": say("Calibration on GPS"),
    "step.window": say("Window"),
    "step.wind": say("Wind"),
    "step.run_point": say("Run point"),
    "step.temperature": say("Water temperature"),
    "step.unrecorded": say("What nobody recorded"),
    "step.runs": say("Runs that count"),
    "step.curve": say("Curve"),
    "step.assessment": say("Assessment"),
    # Options
    "speed.correction": say("Error of the log"),
    "speed.factor": say("Prescribed factor"),
    "calibration.rule": say("GPS factor"),
    "window.rule": say("Which part of a run"),
    "wind.model": say("Wind model"),
    "wind.coefficients": say("Drag coefficients"),
    "wind.ahead": say("Coefficient from ahead"),
    "wind.behind": say("Coefficient behind"),
    "wind.side": say("Coefficient from the side"),
    "wind.averaging_s": say("Wind averaged over"),
    "wind.anemometer": say("Anemometer"),
    "run_point.estimator": say("Mean of a run"),
    "run_point.inertia": say("Correct for acceleration"),
    "temperature.rule": say("Correct for water temperature"),
    "unrecorded.rule": say("Wind, temperature or GPS that is missing"),
    "runs.highest_target_ratio": say("Fastest run / declared speed"),
    "curve.b": say("B of the curve"),
    "assessment.reject": say("Rejects a tow"),
    # Where an option comes from
    "status.decided": say("decided"),
    "status.proposed": say("proposed"),
    "status.inferred": say("inferred"),
    # Values
    "choice.none": pgettext("option", "none"),
    "choice.prescribed": say("prescribed"),
    "choice.estimated": say("estimated"),
    "choice.gps_per_tow": say("per tow"),
    "choice.all": pgettext("option", "all"),
    "choice.steady": say("the steady part"),
    "choice.head": say("head wind"),
    "choice.oblique": say("oblique wind"),
    "choice.fixed": say("fixed"),
    "choice.per_run": say("searched per run"),
    "choice.archive": say("one from all tows"),
    "choice.as_is": say("left as it is"),
    "choice.expected": say("as in other tows"),
    "choice.as_read": say("as it reads"),
    "choice.mean_of_ratios": say("mean of ratios"),
    "choice.ratio_of_means": say("ratio of means"),
    "choice.end_speeds": say("from the end speeds"),
    "choice.ittc57": say("ITTC-57"),
    "choice.free": say("free"),
    "choice.capped": say("capped"),
    "all": say("all"),
    "clear": say("Clear selection"),
    "from": say("from"),
    "to": say("to"),
    "yes": say("yes"),
    "no": say("no"),
}


def text(key: str) -> Sentence:
    """The text of a key; one without a text is called as it is."""
    return TEXTS.get(key) or say("{}", key.rpartition(".")[2])


def in_each(sentence: str) -> tuple[str, str]:
    """A text in Dutch and English."""
    nl, en = (speaker(language)(sentence) for language in LANGUAGES)
    return nl, en


def words() -> dict[str, tuple[str, str]]:
    """The texts that the script of the page asks for, in Dutch and English."""
    return {key: in_each(sentence) for key, sentence in (labels.named() | TEXTS).items()}
