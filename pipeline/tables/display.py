r"""How a column of a table is shown: its title, unit, decimals and kind, each by its name.

A name means the same in every table and ends in its unit. Whoever shows a column asks here: the
comments of the database, documents, pages, terminal and paper. Which columns a table has, with
their types, limits and meaning, is declared with the table. A soft hyphen (\u00ad) or a zero-width
space (\u200b) in a title says where it may be broken.
"""

import re
from enum import Enum
from typing import Final, NamedTuple

from pipeline.messages import Sentence, pgettext, say
from pipeline.tables.causes import STEPS
from pipeline.tables.keys import MAX_THWARTS

_TITLES_LIKE_NAMES: Final = (
    say("A [kg/m]"), say("Altered"), say("As of"), say("B [m/s]"), say("Beam [m]"),
    say("Bow height [m]"), say("Cause"), say("Causes"), say("Change"), say("Check"), say("Crew"),
    say("Decision"), say("Direction"), say("Disagrees"), say("E_n"), say("Edition"),
    say("Empty thwart"), say("Equal"), say("Era"), say("Expected"), say("Factor"),
    say("First seen"), say("Flag"), say("Follows"), say("Freeboard bow [m]"),
    say("Freeboard lowest [m]"), say("Freeboard stern [m]"), say("GPS [m/s]"),
    say("HT no"), say("Hull speed [m/s]"), say("In words"), say("Interval"), say("Kind"),
    say("Last tow"),
    say("Limit"), say("Line"), say("Lines"), say("Listed"), say("Log"), say("Made again"),
    say("Mean"), say("Median"), say("Method"), say("Method hash"), say("n"), say("Name"),
    say("New winner"), say("Number"), say("Observed"), say("Old winner"), say("Outcome"),
    say("Part"), say("Published on"), say("Quantity"), say("Race"), say("Ratio"), say("Rows"),
    say("Rudder breadth [m]"), say("Rudder height [m]"), say("Rudder thickness [m]"),
    say("Run"), say("Runs set aside"), say("Runs used"), say("Salinity [g/kg]"), say("Seal"),
    say("Season"),
    say("Season before"), say("Second"), say("Severity"), say("Shared B [m/s]"), say("Size"),
    say("Slope"), say("Source"), say("Speed"), say("Speed factor"), say("Standard speed [m/s]"),
    say("Status"), say("Step"), say("Table"), say("Title"), say("Total"), say("Tows"),
    say("Unit"), say("Valid from"), say("Valid until"), say("Value"), say("Verdict"),
    say("Water depth [m]"), say("Water temperature [°C]"), say("Weight [kg]"), say("What"),
    say("Where"), say("Wind [m/s]"), say("Within"),
)  # fmt: skip
"""Titles of columns whose name is the same words, and unit, with underscores."""

STEP_CHANGE, STEP_FACTOR = "_change_ratio", "_step_factor"
"""Endings of columns with what a step of a method does to Cw: in per cent, and as a factor."""

TITLES: Final[dict[str, Sentence]] = {
    **{f"{step}{STEP_CHANGE}": name for step, name in STEPS.items()},
    **{f"{step}{STEP_FACTOR}": name for step, name in STEPS.items()},
    **{re.sub(r"\W+", "_", text.lower().rstrip("]")): text for text in _TITLES_LIKE_NAMES},
    **{f"thwart_{n}_m": say("Thwart {} [m]", n) for n in range(1, MAX_THWARTS + 1)},
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
    "fsn_no": say("Boat no"),
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
    "current_m_s": say("Current [m/s]"),
    "current_lo_m_s": say("Current low [m/s]"),
    "current_hi_m_s": say("Current high [m/s]"),
    "current_change_m_s": say("Change to the runs back [m/s]"),
    "current_change_lo_m_s": say("Change low [m/s]"),
    "current_change_hi_m_s": say("Change high [m/s]"),
    "current_verdict": say("Verdict"),
    "power_w": say("Power [W/\u200brower]"),
    "old_corrected_time_s": say("Old: corrected time"),
    "new_corrected_time_s": say("Corrected time"),
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
    "median_ratio": say("Median"),
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
    "accepted_on": say("Accepted on"),
    "accepted_by": say("Accepted by"),
    "redone_runs": say("Towed again"),
    "explanation": say("In their words"),
    "known_checks": say("Known then"),
    "newest": say("Counts"),
    "doubted_by": say("Doubted since by"),
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
    "main_cause": say("Cause"),
    "sd_lo_ratio": say("low"),
    "sd_hi_ratio": say("high"),
}
"""Titles of columns, with their unit."""


class NumberForm(NamedTuple):
    """How the numbers of a column are written: their unit, empty for a ratio, and decimals."""

    unit: str
    decimals: int


_FORMS_BY_ENDING: Final = {
    "_kg_m": NumberForm("kg/m", 2),
    "_m_s": NumberForm("m/s", 2),
    "_g_kg": NumberForm("g/kg", 1),
    "_kg": NumberForm("kg", 0),
    "_m": NumberForm("m", 2),
    "_w": NumberForm("W", 1),
    "_seconds": NumberForm("s", 0),
    "_s": NumberForm("s", 0),
    "_n": NumberForm("N", 0),
    "_c": NumberForm("°C", 1),
    "_deg": NumberForm("°", 0),
    "_hz": NumberForm("Hz", 0),
    "_percent": NumberForm("%", 1),
    "_deviation_sd": NumberForm("sd", 1),
}

_FORMS_BY_NAME: Final = {
    "cw_sd": NumberForm("kg/m", 2),
    "deviation_sd": NumberForm("sd", 1),
    "distance_sd": NumberForm("sd", 1),
    "dof": NumberForm("", 1),
    "e_n": NumberForm("", 2),
    "p_value": NumberForm("", 3),
    "size": NumberForm("", 1),
    "size_hi": NumberForm("", 1),
    "size_lo": NumberForm("", 1),
    "tow_speed_n": NumberForm("", 0),
    "weight_n": NumberForm("", 0),
}
"""Forms of columns whose ending does not tell."""

_RATIO: Final = NumberForm("", 4)


class Kind(Enum):
    """How values of a column are written."""

    PLAIN = "as they are"
    CHANGE = "a ratio of new to old, as a change in per cent"
    SHARE = "a part of a whole, in per cent"
    DURATION = "seconds, as hours, minutes and seconds"
    CHANCE = "a probability that was counted in draws"
    CODE = "codes of the tables, in words"
    CANDIDATES = "codes of possible causes, in words"
    CAUSE = "a cause of a change and, of a method, its step"
    CAUSES = "causes of a change, each with its factor"
    METHOD = "a method by its name"
    EDITION = "an edition by its name"
    DIRECTION = "out (1) or back (-1)"


_KINDS: Final = {
    Kind.CHANGE: (
        "cw_ratio", "power_ratio", "time_ratio", "shift_ratio", "total",
        "median_ratio", "lowest_ratio", "highest_ratio",
        "median_factor", "lowest_factor", "highest_factor", "median_power_ratio",
        "printed_median_ratio", "printed_largest_ratio", "farthest_ratio", "mean_factor",
    ),
    Kind.SHARE: (
        "share_within_1pct", "share_within_2pct", "sd_ratio", "sd_lo_ratio", "sd_hi_ratio",
        "within_sd_ratio", "cw_sd_ratio", "u_ratio", "p_fault", "own_weight", "weight_r2",
        "spread_ratio", "spread_lo", "spread_hi", "error_ratio", "season_sd",
        "difference_that_matters",
    ),
    Kind.DURATION: ("rowing_time_s", "old_corrected_time_s", "new_corrected_time_s"),
    Kind.CHANCE: ("change_probability",),
    Kind.CODE: (
        "status", "flags", "flag", "reason", "cut_reason", "change", "source", "step", "code",
        "component", "quantity", "explaining", "within", "severity", "check", "shared", "scope",
        "old_remark", "new_remark", "choice", "pooling", "speed_reason", "cause",
        "log", "what", "outcome", "reason_code", "lost", "instrument", "verdict", "rule",
        "confused_with", "rest_verdict", "weight_verdict", "tow_speed_verdict", "kind",
        "known_checks", "doubted_by", "current_verdict",
    ),
    Kind.CANDIDATES: ("candidates",),
    Kind.CAUSE: ("main_cause",),
    Kind.CAUSES: ("causes",),
    Kind.METHOD: ("method", "from_method", "to_method"),
    Kind.EDITION: ("edition", "from_edition", "to_edition", "previous"),
    Kind.DIRECTION: ("direction",),
}  # fmt: skip
KINDS: Final = {name: kind for kind, names in _KINDS.items() for name in names}
"""The kind of each column that is not plain."""


class Column(NamedTuple):
    """How a column is shown.

    Attributes:
        name: its name in the tables.
        title: with its unit.
        unit: empty where it has none.
        decimals: of its numbers.
        kind: how its values are written.
    """

    name: str
    title: Sentence
    unit: str
    decimals: int
    kind: Kind


def find_number_form(name: str) -> NumberForm:
    """Return the unit and decimals of the numbers in the column of a name."""
    if name in _FORMS_BY_NAME:
        return _FORMS_BY_NAME[name]
    for ending, form in _FORMS_BY_ENDING.items():
        if name.endswith(ending):
            return form
    return _RATIO


def get_column(name: str) -> Column:
    """Return how the column of a name is shown; one without a title is called by its name."""
    unit, decimals = find_number_form(name)
    return Column(
        name=name,
        title=TITLES.get(name) or say("{}", name),
        unit=unit,
        decimals=decimals,
        kind=Kind.CHANGE if name.endswith(STEP_CHANGE) else KINDS.get(name, Kind.PLAIN),
    )
