"""What codes, methods, crews and options of the tables are called.

A code without an entry is shown as it is written in the tables.
"""

from collections.abc import Mapping
from typing import Any, Final

from pipeline.assessment.checks import CHECKS
from pipeline.messages import Sentence, pgettext, say
from pipeline.register.register import name_draft
from pipeline.tables.causes import CAUSES, STEPS, name_cause

SIMULATED: Final = say(
    "SIMULATED: these boats do not exist. The numbers come from a simulated archive."
)
YES, NO = say("yes"), say("no")

_WORDS_LIKE_CODES: Final = (
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
    say("nothing unforeseen"), say("number"), say("passed"), say("prescribed"),
    say("printed"), say("recomputed"), say("refuse"), say("rejected"), say("removed"), say("run"),
    say("runs"), say("same"), say("season"), say("set aside"), say("shared"), say("speed"),
    say("steps multiply to the total"), say("tables fit their schemas"), say("temperature"),
    say("unexplained"), say("unknown"), say("valid"), say("weight"), say("wind"),
    say("window"), say("women"),
)  # fmt: skip
"""Texts whose code is the same words with underscores."""

CODES: Final[dict[str, Sentence]] = {
    **{check.code: check.sentence for check in CHECKS},
    **{text.replace(" ", "_"): text for text in _WORDS_LIKE_CODES},
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
    "sound": say("sound"),
    "would not show": say("would not show"),
    "not told": say("not told"),
    "no_change": say("no change shown"),
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
    "doubted": say("to be looked at first"),
    "newer_tow_without_samples": say("the newest tow has no samples; an older one counts"),
    "rest": say("other"),
    "complete": say("95 % interval"),
    "runs_alone": say("spread of the runs alone: the log's error is not in it"),
    "waterline_length_m": say("waterline"),
    "verdict": say("verdict"),
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

_OPTIONS_LIKE_NAMES: Final = {
    "step": (
        say("Speed"), say("Window"), say("Wind"), say("Run point"), say("Curve"), say("Assessment"),
    ),
    "status": (say("decided"), say("proposed"), say("inferred")),
    "choice": (
        say("prescribed"), say("estimated"), say("fixed"), say("mean of ratios"),
        say("ratio of means"), say("ratio of robust means"), say("free"), say("capped"),
    ),
}  # fmt: skip
"""Texts whose key is the same words: steps, where an option comes from, and values."""

OPTIONS: Final[dict[str, Sentence]] = {
    **{
        f"{kind}.{text.lower().replace(' ', '_')}": text
        for kind, texts in _OPTIONS_LIKE_NAMES.items()
        for text in texts
    },
    "group.instruments": say("Errors of log and load cell"),
    "group.selection": say("Which samples count"),
    "group.surroundings": say("Wind and water"),
    "group.fit": say("From run to curve"),
    "about.instruments": say(
        "How speed and tow force are corrected for errors of the instruments, and whether the log "
        "is calibrated on GPS."
    ),
    "about.selection": say("Which part of a run counts, and which runs."),
    "about.surroundings": say(
        "How the resistance in air comes off and how the temperature of the water counts, also "
        "where nobody recorded them."
    ),
    "about.fit": say(
        "How the samples of a run become one point, and how the curve goes through these points."
    ),
    "step.force": say("Tow force"),
    "step.calibration": say("Calibration on GPS"),
    "step.temperature": say("Water temperature"),
    "step.unrecorded": say("What nobody recorded"),
    "step.runs": say("Runs that count"),
    "speed.correction": say("Error of the log"),
    "speed.factor": say("Prescribed factor"),
    "force.ratio": say("Load cell reading / true force"),
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
    "choice.none": pgettext("option", "none"),
    "choice.gps_per_tow": say("per tow"),
    "choice.all": pgettext("option", "all"),
    "choice.steady": say("the steady part"),
    "choice.head": say("head wind"),
    "choice.oblique": say("oblique wind"),
    "choice.per_run": say("searched per run"),
    "choice.archive": say("one from all tows"),
    "choice.as_is": say("left as it is"),
    "choice.expected": say("as in other tows"),
    "choice.as_read": say("as it reads"),
    "choice.end_speeds": say("from the end speeds"),
    "choice.ittc57": say("ITTC-57"),
}
"""Steps of a method and groups of them, options, where an option comes from, and its values."""

FAILED_CHECKS: Final = {
    "tables_fit_their_schemas": say("tables do not fit their schemas"),
    "few_tows_set_aside": say("many tows are set aside"),
    "nothing_unforeseen": say(
        "Herijk itself failed; report this to its maintainer, with the folder unforeseen"
    ),
    "log_factors_stayed": say("log factors moved"),
    "boats_stayed_within_their_intervals": say("boats moved beyond their intervals"),
    "editions_can_be_made_again": say(
        "editions, or the files that they were made from, have changed"
    ),
    "every_listed_tow_accounted_for": say("listed tows are not accounted for"),
    "every_tow_has_a_curve_row": say("tows have no row among the curves"),
}
"""What it means that a check of a rebuild failed."""


def name_code(code: str) -> Sentence:
    """Return a code of the tables in words."""
    return CODES.get(code) or say("{}", code)


def name_candidate(code: str) -> Sentence:
    """Return in words what could explain why a tow is outside its type."""
    return CANDIDATES.get(code) or say("{}", code)


def name_change_cause(found: Mapping[str, Any]) -> Sentence:
    """Return the cause of a change: a step of the method by its name, or another cause.

    Args:
        found: `cause` and, where it is the method, `step`; small causes together are `rest`.
    """
    if found["cause"] == "rest":
        return name_code("rest")
    return name_cause(found["cause"], found.get("step"))


def name_method(method: str) -> Sentence:
    """Return a method as people call it."""
    return METHODS.get(method) or say("{}", method)


def name_crew(crew_class: str) -> Sentence:
    """Return the people of a class."""
    return CREWS.get(crew_class) or say("{}", crew_class)


def name_edition(edition: str) -> Sentence:
    """Return an edition as people call it: a draft by its method."""
    method = edition.removeprefix(name_draft(""))
    if method == edition:
        return say("{}", edition)
    return say("{}: {}", say("draft"), name_method(method))


def name_direction(direction: int) -> Sentence:
    """Return the way of a run: 1 is out, -1 is back."""
    return name_code(f"direction.{direction}")


def name_option(key: str) -> Sentence:
    """Return an option in words, by `step.NAME`, `STEP.OPTION`, `status.NAME` or `choice.VALUE`.

    A group of steps has `group.NAME`, and `about.NAME` for what it does.

    An option or value without a text is called by its name in the method file.
    """
    return OPTIONS.get(key) or say("{}", key.rpartition(".")[2])


def name_choice(value: str) -> Sentence:
    """Return in words a value that an option of a method can have."""
    return OPTIONS.get(f"choice.{value}") or name_code(value)
