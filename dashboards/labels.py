r"""What columns, codes and methods of the tables are called.

A code or column without a text is shown by its name. A soft hyphen (\u00ad) or no space (\u200b)
says where a heading may be broken for want of room.
"""

import re
from collections.abc import Mapping
from typing import Final

from pipeline.assessment.checks import CHECKS
from pipeline.messages import Sentence, pgettext, say, tell
from pipeline.register.words import CAUSES, STEPS, name_cause
from pipeline.tables.row import Row

_PLAIN_COLUMNS: Final = (
    say("A [kg/m]"), say("Altered"), say("As of"), say("B [m/s]"), say("Beam [m]"),
    say("Bow height [m]"), say("Cause"), say("Causes"), say("Change"), say("Check"), say("Crew"),
    say("Decision"), say("Direction"), say("Disagrees"), say("E_n"), say("Edition"),
    say("Empty thwart"), say("Equal"), say("Era"), say("Expected"), say("Factor"),
    say("First seen"), say("Flag"), say("Follows"), say("FSN no"), say("GPS [m/s]"), say("HT no"),
    say("Hull speed [m/s]"), say("In words"), say("Interval"), say("Kind"), say("Last tow"),
    say("Limit"), say("Line"), say("Lines"), say("Listed"), say("Log"), say("Made again"),
    say("Mean"), say("Median"), say("Method"), say("Method hash"), say("n"), say("Name"),
    say("New winner"), say("Number"), say("Observed"), say("Old winner"), say("Outcome"),
    say("Part"), say("Published on"), say("Quantity"), say("Race"), say("Ratio"), say("Rows"),
    say("Run"), say("Runs set aside"), say("Runs used"), say("Seal"), say("Season"),
    say("Season before"), say("Second"), say("Severity"), say("Shared B [m/s]"), say("Size"),
    say("Slope"), say("Source"), say("Speed"), say("Speed factor"), say("Standard speed [m/s]"),
    say("Status"), say("Step"), say("Study"), say("Table"), say("Title"), say("Total"), say("Tows"),
    say("Unit"), say("Valid from"), say("Valid until"), say("Value"), say("Verdict"),
    say("Weight [kg]"), say("What"), say("Where"), say("Wind [m/s]"), say("Within"),
)  # fmt: skip
"""Headings of columns whose name is the same words, and unit, with underscores."""

COLUMNS: Final[dict[str, Sentence]] = {
    **{re.sub(r"\W+", "_", text.lower().rstrip("]")): text for text in _PLAIN_COLUMNS},
    "a_lo_kg_m": say("A lowest [kg/m]"),
    "a_hi_kg_m": say("A highest [kg/m]"),
    "b_hull_ratio": say("B / hull speed"),
    "b_ratio": say("B / hull speed"),
    "b_ratio_lo": say("Lowest"),
    "b_ratio_hi": say("Highest"),
    "cw_standard_lo_kg_m": say("Lowest [kg/m]"),
    "cw_standard_hi_kg_m": say("Highest [kg/m]"),
    "sd": say("Spread"),
    "rule": say("Looked at"),
    "runs": say("Runs"),
    "slow": say("Too little power"),
    "label": say("Tow"),
    "outside": say("Outlier"),
    "tow_hull_ratio": pgettext("column", "Tow speed / hull speed"),
    "tow_ratio": pgettext("column", "Tow speed / hull speed"),
    "x": say("x of the line"),
    "y": say("y of the line"),
    "old_factor": say("Factor was"),
    "new_factor": say("Factor is"),
    "boat_type": say("Type"),
    "rowers": say("Row\u00aders"),
    "crew_class": pgettext("column", "Class"),
    "tow_id": say("Tow"),
    "tow_date": say("Date"),
    "declared_speed_m_s": say("De\u00adclared v [m/s]"),
    "b_lo_m_s": say("B low [m/s]"),
    "b_hi_m_s": say("B high [m/s]"),
    "cw_kg_m": say("Cw at de\u00adclared v [kg/m]"),
    "cw_lo_kg_m": say("Cw low [kg/m]"),
    "cw_hi_kg_m": say("Cw high [kg/m]"),
    "gross_cw_kg_m": say("Cw gross [kg/m]"),
    "air_cw_kg_m": say("wind off [kg/m]"),
    "still_air_cw_kg_m": say("still air on [kg/m]"),
    "run_cw_kg_m": say("Cw [kg/m]"),
    "cw_sd": say("sd in the run [kg/m]"),
    "power_w": say("Power [W/\u200brower]"),
    "flags": pgettext("column", "Flags"),
    "old_remark": say("Old: remark"),
    "new_remark": say("New: remark"),
    "waterline_length_m": say("Water\u00adline [m]"),
    "speed_m_s": say("v [m/s]"),
    "window_start_s": say("Window from [s]"),
    "window_end_s": say("to [s]"),
    "lost": say("Costs"),
    "lost_s": say("Left out [s]"),
    "choice": say("Of more runs"),
    "cut_reason": say("Why cut"),
    "wind_angle_deg": say("Wind angle [deg]"),
    "used": say("Counts"),
    "reason": say("Why not"),
    "path": say("File"),
    "sha256": say("SHA-256"),
    "content_hash": say("Hash"),
    "code_version": say("Code"),
    "lo": say("low"),
    "hi": say("high"),
    "option": say("Choice"),
    "median_ratio": say("Median"),
    "lo_ratio": say("5 %"),
    "hi_ratio": say("95 %"),
    "lowest_ratio": say("Lowest"),
    "highest_ratio": say("Highest"),
    "from_method": say("From"),
    "to_method": say("To"),
    "from_edition": say("From"),
    "to_edition": say("To"),
    "cw_ratio": say("Cw new / old"),
    "time_ratio": say("Time new / old"),
    "reason_code": say("Code"),
    "message": say("Reason"),
    "messages": say("Reason"),
    "explaining": say("Against"),
    "n_boats": say("Boats"),
    "n_pairs": say("Pairs"),
    "slope_lo": say("low"),
    "slope_hi": say("high"),
    "deviation_sd": say("Deviation [sd]"),
    "cw_expected_kg_m": say("Cw expected [kg/m]"),
    "cw_deviation_sd": say("Cw off [sd]"),
    "cw_outside": say("Stands out in Cw"),
    "b_expected_m_s": say("B expected [m/s]"),
    "b_deviation_sd": say("B off [sd]"),
    "b_outside": say("Stands out in B"),
    "difference_that_matters": say("What matters"),
    "spread_ratio": say("Boats differ by"),
    "spread_lo": say("at least"),
    "spread_hi": say("at most"),
    "error_ratio": say("Measuring error"),
    "repeat_pairs": say("Pairs of repeat tows"),
    "noise_ratio": say("Error by repeats / by runs"),
    "zero_sd_n": say("Added by repeats [N]"),
    "season_sd": say("Shared by a season"),
    "rest_verdict": say("Without those that stand out"),
    "farthest": say("Farthest boat"),
    "farthest_ratio": say("Farthest / expected"),
    "weight_verdict": say("On weight"),
    "tow_speed_verdict": say("On tow speed"),
    "races": say("Races until the next tow"),
    "raced_beyond_curve": say("Raced beyond the curve"),
    "raced_power_w": say("Power when raced [W/\u200brower]"),
    "raced_high": say("Much power when raced"),
    "power_ratio_raced": say("Power / with the bend of its type"),
    "candidates": say("Possible cause"),
    "scope": say("Group"),
    "sd_ratio": say("sd / Cw"),
    "share_within_1pct": say("Share within 1 %"),
    "share_within_2pct": say("Share within 2 %"),
    "component": say("Cause"),
    "predicted_cw_kg_m": say("Predicted [kg/m]"),
    "shared": say("Shared by"),
    "u_ratio": say("Uncertainty"),
    "start_s": say("from [s]"),
    "end_s": say("to [s]"),
    "n_tows": say("Tows"),
    "n_links": say("Boats also elsewhere"),
    "verification_code": pgettext("column", "Verification code"),
    "previous": say("Compared with"),
    "race_date": say("Date"),
    "rowing_time_s": say("Time"),
    "old_power_w": say("Before [W/rower]"),
    "new_power_w": say("After [W/rower]"),
    "old_rank": say("Place before"),
    "new_rank": say("Place after"),
    "podium_changed": say("In or out of the first three"),
    "code": say("What"),
    "beyond": say("Beyond the limit"),
    "dof": say("Degrees of freedom"),
    "flagged": say("Beyond"),
    "speed_reason": say("Why this speed"),
    "raced_speed_m_s": say("Raced [m/s]"),
    "lowest_speed_m_s": say("Low\u00adest [m/s]"),
    "highest_speed_m_s": say("High\u00adest [m/s]"),
    "tow_speed_m_s": say("Tow at [m/s]"),
    "beyond_curve": say("Beyond the curve"),
    "position": say("Order"),
    "seasons": say("Towed in"),
    "size_lo": say("low"),
    "size_hi": say("high"),
    "instrument": say("What"),
    "p_fault": say("Chance"),
    "estimate": say("Size"),
    "first_tow": say("From tow"),
    "confused_with": say("Or else"),
    "shown_by": say("Shown only by"),
    "shift_ratio": say("Cw new / old"),
    "apart": say("Stands apart"),
    "ageing_per_year": say("Ageing a year"),
    "tow": say("Tow and crew"),
    "stage": say("Air"),
    "force_n": say("Tow force [N]"),
    "within_sd_ratio": say("sd within a tow / Cw"),
    "tow_id_before": say("Tow before"),
    "cw_sd_ratio": say("sd / Cw of the tow"),
    "predicted_lo_kg_m": say("Predicted low [kg/m]"),
    "predicted_hi_kg_m": say("Predicted high [kg/m]"),
    "inertia_cw_kg_m": say("acceler\u00adation off [kg/m]"),
    "temperature_cw_kg_m": say("temper\u00adature on [kg/m]"),
    "old_cw_kg_m": say("Cw old [kg/m]"),
    "new_cw_kg_m": say("Cw new [kg/m]"),
    "gain_in_two_hours_s": say("In 2 h [s]"),
    "exceeds_interval": say("Beyond un\u00adcertainty"),
    "cw_standard_kg_m": say("Cw at stan\u00addard speed [kg/m]"),
    "old_speed_rank": say("Speed rank before"),
    "new_speed_rank": say("Speed rank after"),
    "run_end_s": say("End of run [s]"),
    "fitted_cw_kg_m": say("Cw of the curve [kg/m]"),
    "cw_effect_ratio": say("Cw new / old"),
    "ln_ratio": say("Cw new / old"),
    "power_ratio": say("Power new / old"),
    "n_disagree": say("Disagree"),
    "median_factor": say("Median"),
    "lowest_factor": say("Lowest"),
    "highest_factor": say("Highest"),
    "published_cw_kg_m": say("Cw as pub\u00adlished [kg/m]"),
    "published_rank": say("Speed rank as pub\u00adlished"),
    "rank": say("Speed rank"),
    "published_winner": say("Winner then"),
    "winner": say("Winner by the method"),
    "year": say("Year"),
    "changed": say("Changed lines"),
    "rank_changed": say("Other speed rank"),
    "printed_lines": say("Lines in print"),
    "printed_median_ratio": say("Print: median ratio"),
    "printed_largest_ratio": say("Print: largest ratio"),
    "winner_changed": say("Another wins"),
    "change_probability": say("Chance that another wins"),
    "old_a_kg_m": say("A old [kg/m]"),
    "new_a_kg_m": say("A new [kg/m]"),
    "old_b_m_s": say("B old [m/s]"),
    "new_b_m_s": say("B new [m/s]"),
    "median_power_ratio": say("Power new / old"),
    "median_seconds": say("In 2 h [s]"),
}
"""Headings of columns by their names in the warehouse."""

_PLAIN: Final = (
    say("above target speed"), say("accepted"), say("added"), say("ageing"), say("alarm"),
    say("all"), say("anemometer"), say("as printed"), say("boat"),
    say("boats stayed within their intervals"), say("by hand"), say("calibration"), say("changed"),
    say("closed form"), say("code"), say("curve"), say("ends differ"), say("ends differ more"),
    say("equal values"), say("estimated"), say("every listed tow accounted for"), say("excluded"),
    say("expired"), say("fault"), say("few tows set aside"), say("flagged"), say("force"),
    say("force peak"), say("gone"), say("gust"), say("input"), say("input and code"), say("length"),
    say("log"), say("log factors stayed"), say("look"), say("mass"), say("men"), say("mended"),
    say("method"), say("more scatter"), say("most reliable"), say("never towed"), say("new"),
    say("no steady part"), say("no steady window"), say("no type"),
    say("no valid curve"), say("none"), say("not calibrated"), say("note"),
    say("nothing unforeseen"), say("number"), say("optimisation"), say("passed"), say("prescribed"),
    say("printed"), say("recomputed"), say("refuse"), say("rejected"), say("removed"), say("run"),
    say("runs"), say("same"), say("season"), say("set aside"), say("shared"), say("speed"),
    say("steps multiply to the total"), say("tables fit their schemas"), say("temperature"),
    say("trimming"), say("unexplained"), say("unknown"), say("valid"), say("weight"), say("wind"),
    say("window"), say("women"),
)  # fmt: skip
"""Texts whose code is the same words with underscores."""

CODES: Final[dict[str, Sentence]] = {
    **{check.code: check.sentence for check in CHECKS},
    **{text.replace(" ", "_"): text for text in _PLAIN},
    "no_malfunction": say("No malfunction"),
    "plausible": say("Results plausible"),
    "near_earlier_curve": say("Near its earlier curve, or like boats"),
    "explained_by_size": say("Changes explained by length and weight"),
    "intended_speed": say("Near the intended speeds"),
    "little_variation": say("Standard deviation under 10 %"),
    "trimming_suffices": say("A steady part of 30 s in each run"),
    "good": pgettext("verdict", "good"),
    "tow_again": pgettext("verdict", "tow again"),
    "not_made": pgettext("verdict", "nothing to compare with"),
    "newest": say("the newest of each crew"),
    "as_read": say("log as read"),
    "dgps": say("calibrated on dGPS"),
    "multiply": say("log \u00d7 (1 + correction)"),
    "divide": say("log / (1 - correction)"),
    "vane": say("wind-vane correction"),
    "b_from_length": say("B from length"),
    "correction": say("speed correction"),
    "operation": say("dividing, not multiplying"),
    "estimate": say("estimated log factor"),
    "low": say("low (under 67 %)"),
    "middle": say("middle (67 to 80 %)"),
    "high": say("high (80 % and above)"),
    "first": say("among them"),
    "lost": say("missing"),
    "listed": say("on the list"),
    "limit": say("largest share allowed"),
    "samples": say("samples changed"),
    "list": say("list changed"),
    "warn": say("WARNING"),
    "error": say("ERROR"),
    "tow": CAUSES["tow"],
    **STEPS,
    "editions_can_be_made_again": say("editions are what they were and can be made again"),
    "every_tow_has_a_curve_row": say(
        "every tow has a row among the curves, even one without a curve"
    ),
    "in_range": say("as declared"),
    "brought_down": say("declared too fast: upper end"),
    "brought_up": say("low, but rowed faster"),
    "low_but_rowed": say("low, and rowed so"),
    "low_not_raced": say("low, no race: lower end, ask the crew"),
    "like_boats": say("no curve: middle of its type"),
    "nothing_known": say("nothing known: committee decides"),
    "log_scale": say("log"),
    "log_trend": say("log drifts within the season"),
    "log_change": say("log replaced"),
    "gps_scale": say("plain GPS"),
    "force_scale": say("scale of the load cell"),
    "force_zero": say("zero of the load cell"),
    "force_zero_drift": say("zero drifts within the season"),
    "anemometer_scale": say("anemometer"),
    "season_bend": say("bend of all curves"),
    "water_temperature": say("water temperature not recorded"),
    "fleet_step": say("all boats changed at once"),
    "season_level": say("level of all tows of the season"),
    "mass_on_board": say("mass on board"),
    "water_depth": say("depth of the water"),
    "waves": say("waves"),
    "force_not_linear": say("load cell not linear"),
    "altered_boat": say("boat altered"),
    "cannot be told": say("cannot be told"),
    "would not show": say("would not show"),
    "not told": say("not told"),
    "not determined": say("not determined"),
    "not settled": say("not settled"),
    "gps": say("GPS"),
    "boat_season": say("boat in season"),
    "fleet": say("all boats"),
    "within_type": say("within a type"),
    "speed_drift": say("speed drifts"),
    "more_left_out": say("more seconds left out"),
    "not_selected": say("not selected in the list"),
    "cw_standard_kg_m": say("Cw at standard speed"),
    "q": say("bend q"),
    "bend": say("bend (v/B)²"),
    "a_kg_m": say("A"),
    "b_m_s": say("B"),
    "cw_kg_m": say("Cw"),
    "weight_kg": say("weight"),
    "displacement_kg": say("displacement"),
    "declared_speed_m_s": say("declared speed"),
    "few_boats": say("too few boats"),
    "equal": say("equal"),
    "differ": say("not equal"),
    "open": say("cannot be told"),
    "rises": say("rises"),
    "falls": say("falls"),
    "no_b": say("no B: Cw hardly rises"),
    "few_pairs": say("fewer than six pairs"),
    "no_scatter": say("runs without scatter"),
    "not_settled": say("the search did not settle"),
    "lost_seconds": say("seconds"),
    "lost_run": say("run"),
    "lost_tow": pgettext("what is lost", "tow"),
    "lost_file": say("file"),
    "lost_row": say("row"),
    "lost_cell": say("cell"),
    "between_tows": say("from tow to tow"),
    "misfit": say("hull is not a hyperbola"),
    "random": say("scatter of the runs"),
    "season_log": say("log of the season"),
    "straightness": say("straight towing"),
    "altered": pgettext("boat", "altered"),
    "askew": say("pulled askew"),
    "line": say("curve"),
    "point": say("run point"),
    "declared": say("at the declared speed"),
    "trace": say("second"),
    "gross": say("gross: F/v²"),
    "net": say("after acceleration, wind, temperature"),
    "direction.1": say("out"),
    "direction.-1": say("back"),
    "single": say("one tow"),
    "archive": say("all tows"),
    "b_not_determined": say("B not determined"),
    "not_in_register": say("not in the register"),
    "no_line_that_day": say("no line was valid that day"),
    "thwart_not_given": say("more than one line, and the result names no empty thwart"),
    "speed_not_below_b": say("faster than B"),
    "beyond_curve": say("outside 85-115 % of the declared speed, where the curve does not hold"),
    "b_at_cap": say("B at its cap"),
    "printed_rebased": say("printed, re-based in closed form"),
    "speed.factor": say("divide instead of multiply"),
    "run_point.estimator": say("run point from means"),
    "wind.averaging_s": say("wind averaged over 3 s"),
    "curve.b": say("B without cap"),
    "doubted": say("to be looked at first"),
    "newer_tow_without_samples": say("the newest tow has no samples; an older one counts"),
    "rest": say("other"),
    "complete": say("95 % interval"),
    "runs_alone": say("spread of the runs alone: the log's error is not in it"),
    "waterline_length_m": say("waterline"),
}

CANDIDATES: Final[dict[str, Sentence]] = {
    "length": say("unusual length"),
    "log": say("unusual calibration of its log"),
    "altered": say("altered before this tow"),
    "slow_tow": pgettext("candidate", "slow tow"),
    "askew": say("perhaps pulled askew"),
    "b_at_cap": say("B at its cap"),
    "b_not_determined": say("B not determined"),
}
"""What could explain why a tow is outside its type."""

METHODS: Final[dict[str, Sentence]] = {
    "as-printed": say("as printed, not re-based"),
    "as-published": say("as published"),
    "as-published-2014": say("as published, 2014 at first"),
    "corrected-2013": say("corrected 2013"),
    "werkbank": say("workbench"),
    "rebased": say("re-based"),
    "rebased-2015": say("rules of 2015"),
}
"""Methods that ship, and that of the workbench."""

CREWS: Final[dict[str, Sentence]] = {"H": say("men"), "D": say("women")}

FIGURES: Final[dict[str, Sentence]] = {
    "b_weight": say("B against weight"),
    "b_speed": say("B against declared speed"),
    "a_weight": say("A against weight"),
    "cw_standard_weight": say("Cw at the standard speed against weight"),
    "cw_standard_speed": say("Cw at the standard speed against declared speed"),
    "history": say("Through the years"),
    "repeats": say("Every pair"),
    "eras": say("Does an era differ?"),
}
"""Captions of figures that several pages have, by their names."""

SIMULATED: Final = say(
    "SIMULATED: these boats do not exist. The numbers come from a simulated archive."
)


def column(name: str) -> Sentence:
    """The heading of a column."""
    return _text(COLUMNS, name)


def code(name: str) -> Sentence:
    """A code of the tables."""
    return _text(CODES, name)


def code_in_words(name: str) -> str:
    """A code in the language of this command."""
    return tell(code(name))


def candidate(name: str) -> Sentence:
    """What could explain a place outside the type."""
    return _text(CANDIDATES, name)


def cause(found: Row) -> Sentence:
    """Return what a change comes from: a step of the method by its name, or another cause.

    Args:
        found: `cause` and, where it is the method, `step`; small causes together are `rest`.
    """
    if found["cause"] == "rest":
        return code("rest")
    return name_cause(found["cause"], found.get("step"))


def method(name: str) -> Sentence:
    """A method as people call it."""
    return _text(METHODS, name)


def crew(crew_class: str) -> Sentence:
    """The people of a class."""
    return _text(CREWS, crew_class)


def _text(texts: Mapping[str, Sentence], name: str) -> Sentence:
    return texts.get(name) or say("{}", name)


def named() -> dict[str, Sentence]:
    """Every column, code and method, as the scripts of pages ask for them: `code.none`."""
    kinds = {"column": COLUMNS, "code": CODES, "method": METHODS}
    return {f"{kind}.{name}": text for kind, texts in kinds.items() for name, text in texts.items()}


def unbroken(heading: str) -> str:
    """A heading without the places where it may be broken."""
    return heading.replace("\u00ad", "").replace("\u200b", "")
