"""The checks of the assessment as one table of rules: code, what is measured, limits, sentence.

What each measures is an expression over the measures of a tow that `pipeline.assessment.assess`
gathers. Nothing here needs Polars: methods and labels name checks too. Where a limit comes from is
in the table of docs/method-details.md, 10.

Severity says what a check asks of people. `refuse`: the tow gives nothing to register. `look`:
somebody must decide, as the curve may be wrong, or rest on a boat that is not what the papers say;
of sound tows 2 to 3 in a hundred get there (docs/accuracy.md). `note`: worth knowing when someone
looks. Most sound tows of some season exceed it (log 2), or the method already acted on it (runs
that do not count), or it is a property of how the curve may be used.
"""

from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

from pipeline.history import STEERED_STRAIGHT_FROM
from pipeline.messages import Sentence, say
from pipeline.tables.severity import Severity

if TYPE_CHECKING:
    import polars as pl

Limit: TypeAlias = float | str | None
"""One number, a column of `crew_classes` with one for each class, or no limit on this side."""


class Check(NamedTuple):
    """A check and what it is compared with.

    Attributes:
        code: stable name, as in `curves.flags` and `assessments.check`.
        measured: the number of each tow, in SQL; null where it is not known.
        sentence: what it says of a tow that is marked.
        lowest, highest: a number outside them is marked.
        unit: of the number and its limits; 1 also for a count, and for yes (1) or no (0).
        severity: `note`, `look` or `refuse`.
        last_season: the check is made up to this season only.
    """

    code: str
    measured: str
    sentence: Sentence
    lowest: Limit = None
    highest: Limit = None
    unit: str = "1"
    severity: Severity = "look"
    last_season: int | None = None

    def limits(
        self, crew_class: str, crew_classes: "pl.DataFrame | None" = None
    ) -> tuple[float | None, float | None]:
        """Return the lowest and highest limit for a class, one of `crew_classes`.

        Args:
            crew_class: its code.
            crew_classes: the table of that name; the default classes when left out.
        """
        lowest = _get_limit(self.lowest, crew_class, crew_classes)
        return lowest, _get_limit(self.highest, crew_class, crew_classes)


def _get_limit(limit: Limit, crew_class: str, crew_classes: "pl.DataFrame | None") -> float | None:
    if not isinstance(limit, str):
        return limit
    from pipeline.crews import STANDARD_CREWS, get_limits  # noqa: PLC0415 - help needs no Polars

    classes = STANDARD_CREWS if crew_classes is None else crew_classes
    return get_limits(classes, limit)[crew_class]


MAX_WEIGHT_CHANGE: Final = 0.02
MAX_FREEBOARD_CHANGE_M: Final = 0.03
"""Change of a boat since its previous tow, or on a race day, that is allowed: of weight as a ratio
(inferred)."""
WAYS_LIMIT: Final = 0.05
"""Least difference of Cw out from Cw back that is marked; more where all tows of an archive differ
(`assess`)."""
MIN_CURRENT_CHANGE_M_S: Final = 0.1
"""Change of the current from out to back that matters: 2 % of the calibrated speed, and so 4 to 5 %
of Cw (inferred)."""


def _make_plausibility_check(code: str, sentence: Sentence) -> Check:
    """Return the check of what all other tows say of a tow (`plausibility`)."""
    verdict = "doubts" if code.endswith("_not_plausible") else "unusual"
    return Check(code, f"array_contains({verdict}, '{code}')", sentence, highest=0.0)


CHECKS: Final = (
    # code, measured, sentence, lowest, highest
    # The curve itself
    Check("no_curve", "a_kg_m IS NOT NULL", say("no curve"), 1.0, severity="refuse"),
    Check("few_runs", "runs_used", say("few runs"), 6.0, severity="note"),
    Check("runs_set_aside", "runs_set_aside", say("runs set aside"), None, 0.0),
    Check("unbalanced_runs", "unbalanced", say("unbalanced runs"), None, 1.0),
    Check(
        "out_and_back_differ",
        "out_over_back - 1",
        say("out and back differ"),
        -WAYS_LIMIT,
        WAYS_LIMIT,
    ),
    Check("unusual_calibration", "calibration_factor", say("unusual calibration"), 0.98, 1.02),
    Check("log_not_linear", "log_slope", say("log not in proportion"), -0.015, 0.015),
    Check(
        "current_changed",
        "current_change_m_s",
        say("current changed, or log read otherwise"),
        None,
        MIN_CURRENT_CHANGE_M_S,
        unit="m/s",
    ),
    # The samples beside all other tows
    _make_plausibility_check("force_not_plausible", say("force cannot be right")),
    _make_plausibility_check("wind_not_plausible", say("wind cannot be right")),
    _make_plausibility_check("speed_not_plausible", say("speed cannot be right")),
    _make_plausibility_check("force_unusual", say("force stands out")),
    _make_plausibility_check("wind_unusual", say("wind stands out")),
    _make_plausibility_check("speed_unusual", say("speed stands out")),
    Check("season_in_doubt", "season_doubted", say("season's instrument in doubt"), None, 0.0),
    Check(
        "instrument_or_boat", "alone_shows_fault", say("instrument off or boat altered"), None, 0.0
    ),
    Check("coarse_readings", "by_half_a_step", say("coarse readings"), None, 0.01),
    # The runs
    Check(
        "log2_differs",
        "log2_off_m_s",
        say("log 2 differs"),
        None,
        0.01,
        unit="m/s",
        severity="note",
    ),
    Check("off_target_speed", "off_target", say("off target speed"), None, 0.05),
    Check("large_scatter_in_run", "scatter", say("large scatter in a run"), None, 0.1),
    Check("samples_scatter", "samples_scatter", say("samples scatter widely"), None, 2.0),
    Check("range_not_covered", "shortfall", say("range not covered"), None, 0.05, severity="note"),
    Check(
        "declared_speed_not_covered", "beyond", say("declared speed outside the runs"), None, 0.05
    ),
    # Instruments, and the declared speed
    Check("lamps_burned", "lamp_ratio", say("warning lamps burned long"), None, 0.2),
    Check("load_cell_off", "load_cell_ratio - 1", say("load cell off"), -0.01, 0.01),
    Check(
        "power_outside_range",
        "power_w",
        say("power outside range"),
        "lowest_power_w",
        "highest_power_w",
        unit="W",
        severity="note",
    ),
    Check("slow_tow", "power_w", say("slow tow"), "slow_power_w", unit="W"),
    # The boat of the day
    Check(
        "crew_weight",
        "crew_weight_kg / rowers",
        say("crew weight unusual"),
        "lightest_rower_kg",
        "heaviest_rower_kg",
        unit="kg",
    ),
    Check(
        "weight_not_recorded",
        "weight_kg IS NULL OR crew_weight_kg IS NULL",
        say("weight not recorded: that of like boats"),
        None,
        0.0,
        severity="note",
    ),
    Check("heavier_after", "weight_after_kg / weight_kg - 1", say("heavier after"), None, 0.02),
    Check("water_differs", "water_off_c", say("water unlike its day's"), None, 3.0, unit="C"),
    Check("shallow_water", "needed_depth_ratio", say("water too shallow"), None, 1.0),
    Check("boat_list_differs", "off_boat_list", say("differs from the boat list"), None, 0.05),
    Check(
        "weight_changed",
        "weight_kg_change",
        say("weight changed"),
        -MAX_WEIGHT_CHANGE,
        MAX_WEIGHT_CHANGE,
    ),
    Check("length_changed", "waterline_length_m_change", say("length changed"), -0.01, 0.01),
    Check("beam_changed", "beam_m_change", say("beam changed"), -0.02, 0.02),
    Check("bow_height_changed", "bow_height_m_change", say("bow height changed"), -0.05, 0.05),
    Check(
        "freeboard_changed",
        "freeboard_change_m",
        say("freeboard changed"),
        None,
        MAX_FREEBOARD_CHANGE_M,
        unit="m",
    ),
    # The curve against others
    Check("unlike_other_tows", "over_best", say("unlike its other tows"), -0.035, 0.035),
    Check("boat_changed", "boat_change", say("boat changed"), -0.03, 0.03),
    Check("curve_change_unexplained", "curve_change", say("unexplained curve change"), -0.05, 0.05),
    Check("unlike_its_type", "over_type", say("unlike its type"), -0.1, 0.1, severity="note"),
    Check(
        "pulled_askew",
        "over_like_boats",
        say("pulled askew"),
        None,
        0.05,
        last_season=STEERED_STRAIGHT_FROM - 1,
    ),
)
"""Every check, in the order in which flags are listed."""

CHECK: Final = {check.code: check for check in CHECKS}
CODES: Final = tuple(CHECK)
