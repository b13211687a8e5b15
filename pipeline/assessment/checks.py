"""The checks of the assessment as data: code, limits, unit and severity.

What each observes, and where its limit comes from, is in the table of docs/method-details.md, 10;
how it is observed, in `pipeline.assessment.assess`.

Severity says what a check asks of people. `refuse`: the tow gives nothing to register. `look`:
somebody must decide, as the curve may be wrong, or rest on a boat that is not what the papers say;
of sound tows one in twenty at most gets there. `note`: worth knowing when someone looks. Most sound
tows of some season exceed it (log 2, the scatter at 1000 Hz), or the method already acted on it
(runs that do not count), or it is a property of how the curve may be used.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, TypeAlias

from pipeline.history import SLOW_POWER_W, STEERED_STRAIGHT_FROM
from pipeline.tables.severity import Severity

Limit: TypeAlias = float | Mapping[str, float] | None
"""One number, one for each class (`H` men, `D` women), or no limit on this side."""


@dataclass(frozen=True)
class Check:
    """A check and what it is compared with.

    Attributes:
        code: stable name, as in `curves.flags` and `assessments.check`.
        lowest, highest: a number outside them is marked.
        unit: of the observed number and its limits; 1 also for a count, and for yes (1) or no (0).
        severity: `note`, `look` or `refuse`.
        last_season: the check is made up to this season only.
    """

    code: str
    lowest: Limit = None
    highest: Limit = None
    unit: str = "1"
    severity: Severity = "look"
    last_season: int | None = None

    def limits(self, crew_class: str) -> tuple[float | None, float | None]:
        """Lowest and highest for a class."""
        return _of_class(self.lowest, crew_class), _of_class(self.highest, crew_class)


def _of_class(limit: Limit, crew_class: str) -> float | None:
    return limit[crew_class] if isinstance(limit, Mapping) else limit


CHECKS: Final = (
    # The curve itself
    Check("no_curve", lowest=1.0, severity="refuse"),
    Check("few_runs", lowest=6.0, severity="note"),
    Check("runs_set_aside", highest=0.0),
    Check("unbalanced_runs", highest=1.0),
    Check("residual_large", highest=0.04),
    Check("out_and_back_differ", lowest=-0.04, highest=0.04),
    Check("unusual_calibration", lowest=0.98, highest=1.02),
    Check("log_not_linear", lowest=-0.02, highest=0.02),
    Check("b_at_cap", highest=0.0, severity="note"),
    Check("b_not_determined", highest=0.0, severity="note"),
    # The samples beside all other tows (`pipeline.assessment.plausibility`)
    Check("force_not_plausible", highest=0.0),
    Check("wind_not_plausible", highest=0.0),
    Check("speed_not_plausible", highest=0.0),
    Check("force_unusual", highest=0.0),
    Check("wind_unusual", highest=0.0),
    Check("speed_unusual", highest=0.0),
    Check("season_in_doubt", highest=0.0),
    Check("coarse_readings", highest=0.01),
    Check("ways_differ", lowest=-0.01, highest=0.01),
    # The runs
    Check("log2_differs", highest=0.01, unit="m/s", severity="note"),
    Check("large_scatter_in_run", highest=0.1, severity="note"),
    Check("off_target_speed", highest=0.05),
    Check("ends_differ", highest=1.0, severity="note"),
    Check("range_not_covered", highest=0.05, severity="note"),
    Check("declared_speed_not_covered", highest=0.05),
    # Instruments, and the declared speed
    Check("correction_not_used", lowest=0.0, highest=0.0, severity="note"),
    Check("lamps_burned", highest=0.2),
    Check("load_cell_off", lowest=-0.01, highest=0.01),
    Check(
        "power_outside_range",
        lowest={"H": 70.0, "D": 40.0},
        highest={"H": 90.0, "D": 55.0},
        unit="W",
        severity="note",
    ),
    Check("slow_tow", lowest=SLOW_POWER_W, unit="W"),
    # The boat of the day
    Check("crew_weight", lowest={"H": 81.0, "D": 64.0}, highest={"H": 114.0, "D": 90.0}, unit="kg"),
    Check("heavier_after", highest=0.02),
    Check("water_differs", highest=3.0, unit="C"),
    Check("boat_list_differs", highest=0.05),
    Check("weight_changed", lowest=-0.02, highest=0.02),
    Check("length_changed", lowest=-0.01, highest=0.01),
    Check("beam_changed", lowest=-0.02, highest=0.02),
    Check("bow_height_changed", lowest=-0.05, highest=0.05),
    Check("freeboard_changed", highest=0.03, unit="m"),
    # The curve against others
    Check("curve_changed", lowest=-0.05, highest=0.05, severity="note"),
    Check("curve_change_unexplained", lowest=-0.05, highest=0.05),
    Check("pulled_askew", highest=0.05, last_season=STEERED_STRAIGHT_FROM - 1),
)
"""Every check, in the order in which flags are listed."""

DOUBTS: Final = ("force_not_plausible", "wind_not_plausible", "speed_not_plausible")
"""Checks by which the rest of the archive rules a tow out."""

UNUSUAL: Final = ("force_unusual", "wind_unusual", "speed_unusual")
"""Checks by which a tow stands out among the others, though chance may do that."""

CHECK: Final = {check.code: check for check in CHECKS}
CODES: Final = tuple(CHECK)
