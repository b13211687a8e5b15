"""The checks of the assessment as data: code, meaning, limits, unit, severity, source.

One table, `CHECKS`; how each number is observed is in `pipeline.assessment.assess`. A source in
brackets is "inferred" where the texts ask for the check but give no number.

Severity says what a check asks of people. `refuse`: the tow gives nothing to register. `look`:
somebody must decide, as the curve may be wrong, or rest on a boat that is not what the papers say;
of sound tows one in twenty at most gets there. `note`: worth knowing when someone looks. Most sound
tows of some season exceed it (log 2, the scatter at 1000 Hz), or the method already acted on it
(runs that do not count), or it is a property of how the curve may be used.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, TypeAlias

from herijk.tables.severity import Severity

Limit: TypeAlias = float | Mapping[str, float] | None
"""One number, one for each class (`H` men, `D` women), or no limit on this side."""

LARGEST_UNSEEN_RATIO: Final = 0.10
"""Error of Cw that should not stay unseen (inferred): two tows of a boat tell one of some 6 %."""


@dataclass(frozen=True)
class Check:
    """A check and what it is compared with.

    Attributes:
        code: stable name, as in `curves.flags` and `assessments.check`.
        meaning: one line for people: what the observed number is and why it matters.
        source: where the limit comes from, or "inferred" and why.
        unit: of the observed number and its limits; 1 also for a count, and for yes (1) or no (0).
        lowest, highest: a number outside them is marked.
        severity: `note`, `look` or `refuse`.
        last_season: the check is made up to this season only.
    """

    code: str
    meaning: str
    source: str
    unit: str = "1"
    lowest: Limit = None
    highest: Limit = None
    severity: Severity = "look"
    last_season: int | None = None

    def limits(self, crew_class: str) -> tuple[float | None, float | None]:
        """Lowest and highest for a class."""
        return _of_class(self.lowest, crew_class), _of_class(self.highest, crew_class)


def _of_class(limit: Limit, crew_class: str) -> float | None:
    return limit[crew_class] if isinstance(limit, Mapping) else limit


CHECKS: Final = (
    # The curve itself
    Check(
        "no_curve",
        "whether the runs give a curve at all (1) or not (0)",
        "without a curve there is nothing to register",
        lowest=1.0,
        severity="refuse",
    ),
    Check(
        "few_runs",
        "runs that the curve is fitted through",
        "Sleepproef 2017, '6 Runs'; a note, as the method asks for enough of them itself",
        lowest=6.0,
        severity="note",
    ),
    Check(
        "runs_set_aside",
        "runs that the tow list says to use and whose samples cannot be used",
        "Sleepproef 2017, 'Eerste beoordeling': faults make runs to be towed again",
        highest=0.0,
    ),
    Check(
        "unbalanced_runs",
        "difference between the number of runs out and back; stream and wind then do not cancel",
        "Sleepproef 2017, '6 Runs': three each way; inferred: one run lost leaves 3 and 2",
        highest=1.0,
    ),
    Check(
        "residual_large",
        "scatter of the run points about the curve / Cw",
        "inferred: Sleepproef 2017, 'Berekening kromme' rejects a large sum of squares; 4 % is "
        "what fewer than one in a hundred simulated sound tows exceeds",
        highest=0.04,
    ),
    Check(
        "out_and_back_differ",
        "Cw out / Cw back, each over the curve, less 1; after the wind correction they agree",
        "inferred: Sleepproef 2017, 'Wind' says about the same; 4 % is what one in fifty simulated "
        "sound tows exceeds in the worst years",
        lowest=-0.04,
        highest=0.04,
    ),
    Check(
        "unusual_calibration",
        "GPS speed / log speed of the tow",
        "Sleepproef 2017, 'IJking snelheid'",
        lowest=0.98,
        highest=1.02,
    ),
    Check(
        "log_not_linear",
        "how GPS / log changes with speed in that season, as a power of speed: one factor does "
        "not bring such a log to true speed, and B is off",
        "inferred: 0.02 changes the bend of a usual curve by a twentieth",
        lowest=-0.02,
        highest=0.02,
    ),
    Check(
        "b_at_cap",
        "whether B was brought down to its cap (1) or not (0): the bend is then prescribed",
        "presentation 24-01-2015: B at most three times the hull speed",
        highest=0.0,
        severity="note",
    ),
    Check(
        "b_not_determined",
        "whether the curve is flat or falling and has no B (1) or has one (0)",
        "Cw at the declared speed is sound all the same",
        highest=0.0,
        severity="note",
    ),
    # The samples beside all other tows (`pipeline.assessment.plausibility`)
    Check(
        "force_not_plausible",
        "whether size, boat, day, season and type rule the force out (1) or not (0): a gain, a "
        "zero or a unit that is off, or another boat's samples",
        "inferred: 4.5 standard deviations from what all other tows let expect",
        highest=0.0,
    ),
    Check(
        "wind_not_plausible",
        "whether the wind out and back does not leave the boat's own speed (1) or does (0): a "
        "unit, a scale or a vane that is off",
        "inferred, as force_not_plausible",
        highest=0.0,
    ),
    Check(
        "speed_not_plausible",
        "whether the runs were towed at other speeds than the declared one asks (1) or not (0): a "
        "speed mistyped, or another boat's samples",
        "inferred, as force_not_plausible",
        highest=0.0,
    ),
    Check(
        "force_unusual",
        "whether the force stands out (1) or not (0) beside size, boat, day, season and type, less "
        "clearly than force_not_plausible: a small gain or zero looks so, and so does chance",
        "inferred: 3 standard deviations from what all other tows let expect",
        highest=0.0,
    ),
    Check(
        "wind_unusual",
        "whether the wind out and back stands out (1) or not (0), less clearly than "
        "wind_not_plausible",
        "inferred, as force_unusual",
        highest=0.0,
    ),
    Check(
        "speed_unusual",
        "whether the runs' speeds stand out (1) or not (0), less clearly than speed_not_plausible",
        "inferred, as force_unusual",
        highest=0.0,
    ),
    Check(
        "season_in_doubt",
        "whether an instrument of the season, or of every season with dGPS that its log factor "
        "rests on, has a fault or may have one (1) or not (0): the table `season_diagnosis` says "
        "which; so it is of all seasons where all boats seem to have changed at once",
        "inferred: a fault that the season log finds, or cannot rule out, concerns all its tows",
        highest=0.0,
    ),
    Check(
        "gps_late",
        "by how much the GPS of that season follows its log, which the method takes off",
        "inferred: a receiver of one fix a second is up to 1 s late; presentation 24-01-2015, "
        "'Meten van de sleepsnelheid': strongly delayed",
        unit="s",
        highest=1.0,
        severity="note",
    ),
    Check(
        "coarse_readings",
        "what it does to Cw if GPS or force were cut off at the steps in which they are written, "
        "and not rounded: half a step",
        "inferred: half of the 2 % by which tows of a boat agree (presentation 24-01-2015)",
        highest=0.01,
    ),
    Check(
        "ways_differ",
        "Cw out / Cw back, each over the curve, less 1, as the tows of that season share it, or 0 "
        "where chance makes as much of it in one of 1000 seasons: a load cell that drifts during a "
        "tow, or a wind that is taken off wrongly; made with 4 tows or more",
        "inferred: half of the 2 % by which tows of a boat agree (presentation 24-01-2015)",
        lowest=-0.01,
        highest=0.01,
    ),
    Check(
        "rises_with_wind",
        "what the wind of that day adds to Cw after the wind correction, by the square of the wind "
        "among the tows of each boat, or 0 where chance makes as much of it in one of 1000 "
        "archives: waves, or a wrong drag coefficient",
        "inferred: half of the 2 % by which tows of a boat agree (presentation 24-01-2015)",
        lowest=-0.01,
        highest=0.01,
    ),
    Check(
        "days_differ",
        "standard deviation of Cw that the tows of one day share in that season, against their "
        "boats' best estimates, where chance does not explain it: a load cell may have been "
        "exchanged or zeroed otherwise between days",
        "inferred: half of the 2 % by which tows of a boat agree (presentation 24-01-2015)",
        highest=0.01,
    ),
    # The runs
    Check(
        "log2_differs",
        "largest difference of a run's mean speed between log 2 and log 1",
        "Sleepproef 2017, 'Log 1 en 2'; a note, as no log 2 of 2014 met it and log 1 counts",
        unit="m/s",
        highest=0.01,
        severity="note",
    ),
    Check(
        "large_scatter_in_run",
        "largest standard deviation of a run's samples / Cw",
        "Sleepproef 2017, 'Eerste beoordeling'; a note, as samples of 1 ms scatter 8 to "
        "11 % in the printed runs of 2014, whose means are sound",
        highest=0.10,
        severity="note",
    ),
    Check(
        "off_target_speed",
        "largest difference of a run's speed from the intended one, on the scale of the tow's own "
        "runs, / that speed",
        "inferred: half the step between intended speeds; Sleepproef 2017, 'Eerste beoordeling'",
        highest=0.05,
    ),
    Check(
        "ends_differ",
        "largest difference of speed, force or wind between a window's two ends / the method's "
        "limit for it",
        "Sleepproef 2017, 'Knippen': equal speed, equal force, about equal wind; a note, as no "
        "window within the limits could be found",
        highest=1.0,
        severity="note",
    ),
    Check(
        "range_not_covered",
        "how far the runs that count fall short of the lowest or highest speed of the tow's plan, "
        "by default 90 and 110 % of the declared speed, as a part of that; used from 85 to 115 %, "
        "the curve is then extrapolated",
        "Cw-kromme 2015, 'Hyperbool als beste benadering': never over 5 % from a measured speed",
        highest=0.05,
        severity="note",
    ),
    Check(
        "declared_speed_not_covered",
        "how far the declared speed lies outside those of the runs, as a part of it: Cw at it is "
        "then extrapolated",
        "Cw-kromme 2015, 'Hyperbool als beste benadering': never over 5 % from a measured speed",
        highest=0.05,
    ),
    # Instruments, and the declared speed
    Check(
        "correction_not_used",
        "speed correction in the tow list that the method does not use in this season",
        "presentation 24-01-2015, 'Correctie [%]': entered by hand; a method that corrects no log "
        "leaves it out, and one that estimates the log's error has no need of it",
        lowest=0.0,
        highest=0.0,
        severity="note",
    ),
    Check(
        "lamps_burned",
        "largest part of a run in which a warning lamp burned: the tow line was not square",
        "inferred: Sleepproef 2017, 'Recht sturen' tows again when lamps burn too often or long",
        highest=0.2,
    ),
    Check(
        "load_cell_off",
        "load cell / known weight when it was last checked, less 1; the force is not corrected",
        "Sleepproef 2017, 'Krachtopnemer': calibrated daily or more often; inferred: 1 %",
        lowest=-0.01,
        highest=0.01,
    ),
    Check(
        "power_outside_range",
        "power per rower at the declared speed",
        "Sleepproef 2017, 'Sleepsnelheid'",
        unit="W",
        lowest={"H": 70.0, "D": 40.0},
        highest={"H": 90.0, "D": 55.0},
        severity="note",
    ),
    Check(
        "slow_tow",
        "power per rower at the declared speed: so slow that a race at full power is off the curve",
        "Cw-kromme 2015, 'Effect van verkeerde snelheid kiezen': under 60-70 W; women inferred, "
        "in proportion to the lower ends 40 and 70 W",
        unit="W",
        lowest={"H": 60.0, "D": 34.0},
    ),
    # The boat of the day
    Check(
        "crew_weight",
        "crew and ballast / rowers: the tow is for a standard crew",
        "Sleepproef 2017, 'Bemanning': 95 kg a man, 75 kg a woman on average; inferred: 15 % less, "
        "and 20 % more as the cox may be counted in",
        unit="kg",
        lowest={"H": 81.0, "D": 64.0},
        highest={"H": 114.0, "D": 90.0},
    ),
    Check(
        "heavier_after",
        "weight after the tow / before it, less 1: a boat that leaks",
        "inferred: Sleepproef 2017, 'Opmetingen en keuring' says much higher",
        highest=0.02,
    ),
    Check(
        "boat_list_differs",
        "how far waterline length or breadth that day is from the boat list, as a part of it, of a "
        "boat of which no alteration was reported: the row may name another boat",
        "inferred: measurements of one boat agree within 1 to 2 % (length_changed, beam_changed), "
        "boats of one type within 5 %",
        highest=0.05,
    ),
    Check(
        "weight_changed",
        "weight / that of the previous tow, less 1, without a reported alteration",
        "inferred: Sleepproef 2017, 'Opmetingen en keuring' says strongly different",
        lowest=-0.02,
        highest=0.02,
    ),
    Check(
        "length_changed",
        "waterline length / that of the previous tow, less 1, without a reported alteration",
        "inferred, as weight_changed",
        lowest=-0.01,
        highest=0.01,
    ),
    Check(
        "beam_changed",
        "breadth / that of the previous tow, less 1, without a reported alteration",
        "inferred, as weight_changed",
        lowest=-0.02,
        highest=0.02,
    ),
    Check(
        "bow_height_changed",
        "height of the bow / that of the previous tow, less 1, without a reported alteration",
        "inferred, as weight_changed; the height depends on trim",
        lowest=-0.05,
        highest=0.05,
    ),
    Check(
        "freeboard_changed",
        "largest change of a freeboard since the previous tow, without a reported alteration",
        "inferred, as weight_changed",
        unit="m",
        highest=0.03,
    ),
    Check(
        "weight_by_freeboard",
        "change of weight by freeboards since the previous tow, less that on the scale / weight",
        "Sleepproef 2017, 'Opmetingen en keuring': freeboards check the weight; inferred: readings "
        "to 1 cm tell 10 %, so a note beyond twice that",
        lowest=-0.2,
        highest=0.2,
        severity="note",
    ),
    Check(
        "balance_changed",
        "how far freeboards say that the centre of gravity moved forward since the previous tow / "
        "waterline length",
        "Sleepproef 2017, 'Opmetingen en keuring': freeboards check how weight lies over the "
        "length; inferred: readings to 1 cm tell 1 %, so a note beyond twice that",
        lowest=-0.02,
        highest=0.02,
        severity="note",
    ),
    # The curve against others
    Check(
        "unseen_error",
        "smallest error of Cw that would have somebody look in 19 of 20 cases: by the boat and "
        "crew's tows before and after, or by what size, type, day and all others let the force be; "
        "below it nobody can tell",
        "inferred: two tows tell some 6 %; a note beyond 10 %, as for a boat with one tow",
        highest=LARGEST_UNSEEN_RATIO,
        severity="note",
    ),
    Check(
        "curve_changed",
        "Cw / that of the boat and crew's previous tow at its declared speed, less 1",
        "inferred: tows agree within 2 % (presentation 24-01-2015), so two differ under 5 %",
        lowest=-0.05,
        highest=0.05,
        severity="note",
    ),
    Check(
        "curve_change_unexplained",
        "the same after taking off what weight and length explain, and, where nothing calibrates "
        "the logs, what all boats of the seasons share; without a reported alteration",
        "as curve_changed; Sleepproef 2017, 'Eerste beoordeling'",
        lowest=-0.05,
        highest=0.05,
    ),
    Check(
        "curve_change_significant",
        "the same / the standard uncertainty of both curves together, where the method estimates "
        "the logs, so that it knows that uncertainty",
        "inferred: chance exceeds 3 standard deviations in one tow of 400",
        lowest=-3.0,
        highest=3.0,
    ),
    Check(
        "pulled_askew",
        "excess of Cw over like boats that weight, length and season leave unexplained: the boat "
        "may have been pulled askew",
        "presentation 24-01-2015: 5 to 10 % too high; straight steering was aided from 2014 on",
        highest=0.05,
        last_season=2013,
    ),
)
"""Every check, in the order in which flags are listed."""

DOUBTS: Final = ("force_not_plausible", "wind_not_plausible", "speed_not_plausible")
"""Checks by which the rest of the archive rules a tow out."""

UNUSUAL: Final = ("force_unusual", "wind_unusual", "speed_unusual")
"""Checks by which a tow stands out among the others, though chance may do that."""

CHECK: Final = {check.code: check for check in CHECKS}
CODES: Final = tuple(CHECK)
