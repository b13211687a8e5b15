"""The first assessment: may the boat that was just towed be let go, and if not, what now?

The rules are the seven of the federation (Sleepproef, R. Pot 2017, "Eerste beoordeling"). Each
takes what the checks of the table `assessments` found of the tow, and adds what only the runs of
this tow show: a run off the curve of the others, runs in another order than planned, runs that the
list does not know. A rule is as good as the worst that it finds, and so is the tow.

`tow_again` is only said where towing again helps: something went wrong in these runs. Where an
instrument, the papers or the season is in doubt, somebody has to `look` first.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
import polars as pl

from pipeline.assessment.checks import CHECK
from pipeline.assessment.repeated_runs import KEEP, KIND
from pipeline.assessment.run_measures import PER_RUN
from pipeline.assessment.run_outliers import MAX_OFF_CURVE_RATIO, find_runs_off_curve
from pipeline.quantiles import differ_beyond_intervals
from pipeline.run_reasons import ABOVE_TARGET, NO_STEADY_WINDOW, NOT_SELECTED
from pipeline.tables.declare import dy
from pipeline.tables.first_assessment import RULES, VERDICTS, FirstAssessment, Rule, Verdict
from pipeline.tables.frames import make_frame
from pipeline.tables.row import Row

MAX_OFF_TARGET_RATIO: Final = 0.05
"""Distance from the intended speed within which a run can be told to be meant for it: half the step
between intended speeds."""

JUDGED_BY: Final[dict[str, tuple[Rule, Verdict]]] = {
    "no_curve": ("no_malfunction", "tow_again"),
    "few_runs": ("no_malfunction", "look"),
    "runs_set_aside": ("no_malfunction", "tow_again"),
    "unusual_calibration": ("no_malfunction", "look"),
    "log_not_linear": ("no_malfunction", "look"),
    "current_changed": ("plausible", "look"),
    "season_in_doubt": ("no_malfunction", "look"),
    "coarse_readings": ("no_malfunction", "look"),
    "log2_differs": ("no_malfunction", "look"),
    "load_cell_off": ("no_malfunction", "look"),
    "lamps_burned": ("no_malfunction", "tow_again"),
    "force_not_plausible": ("plausible", "tow_again"),
    "wind_not_plausible": ("plausible", "tow_again"),
    "speed_not_plausible": ("plausible", "tow_again"),
    "force_unusual": ("plausible", "look"),
    "wind_unusual": ("plausible", "look"),
    "speed_unusual": ("plausible", "look"),
    "unbalanced_runs": ("plausible", "tow_again"),
    "out_and_back_differ": ("plausible", "tow_again"),
    "power_outside_range": ("plausible", "look"),
    "slow_tow": ("plausible", "look"),
    "crew_weight": ("plausible", "look"),
    "water_differs": ("plausible", "look"),
    "shallow_water": ("plausible", "look"),
    "unlike_other_tows": ("near_earlier_curve", "look"),
    "boat_changed": ("near_earlier_curve", "look"),
    "curve_change_unexplained": ("near_earlier_curve", "look"),
    "instrument_or_boat": ("near_earlier_curve", "look"),
    "unlike_its_type": ("near_earlier_curve", "look"),
    "pulled_askew": ("near_earlier_curve", "look"),
    "weight_changed": ("explained_by_size", "look"),
    "weight_not_recorded": ("explained_by_size", "look"),
    "heavier_after": ("explained_by_size", "look"),
    "length_changed": ("explained_by_size", "look"),
    "beam_changed": ("explained_by_size", "look"),
    "bow_height_changed": ("explained_by_size", "look"),
    "freeboard_changed": ("explained_by_size", "look"),
    "boat_list_differs": ("explained_by_size", "look"),
    "off_target_speed": ("intended_speed", "tow_again"),
    "range_not_covered": ("intended_speed", "look"),
    "declared_speed_not_covered": ("intended_speed", "tow_again"),
    "large_scatter_in_run": ("little_variation", "tow_again"),
    "samples_scatter": ("little_variation", "tow_again"),
}
"""Every check of `assessments`, with the rule that it belongs to and what is said where it marks a
tow. An instrument that reads otherwise all season, or papers that do not fit, ask for a look."""

CHANGED: Final = ("unlike_other_tows", "boat_changed", "curve_change_unexplained")
"""Checks that mark a curve unlike the boat's other ones: the weights are named beside them."""

NOT_IN_CW: Final = ("log2_differs",)
"""Checks of an instrument on which no number rests. As long as it reads as usual in its season, the
boat need not wait for it."""

MIN_OTHERS: Final = 3
MAX_TIMES_USUAL: Final = 2.0
"""What is usual in a season: up to so many times the median of at least so many other tows
(inferred)."""

ALWAYS_MADE: Final[frozenset[Rule]] = frozenset(
    ("no_malfunction", "plausible", "intended_speed", "trimming_suffices")
)
"""Rules that need no other tow and no option of the method; the others are made where one of their
checks is."""

ALONE: Final = ("heavier_after", "boat_list_differs", "weight_not_recorded")
"""Checks of a rule that compares with an earlier tow, which need none themselves."""

SIZES: Final = {
    "weight_changed": "weight_kg",
    "length_changed": "waterline_length_m",
    "beam_changed": "beam_m",
    "bow_height_changed": "bow_height_m",
}
"""Columns of `tows` that checks compare with the tow before."""


class Finding(NamedTuple):
    """One thing that a rule found; the fields are those of `FirstAssessment`."""

    rule: Rule
    finding: str
    verdict: Verdict
    observed: float | None = None
    limit: float | None = None
    unit: str = "1"
    runs: Sequence[int] = ()
    instead_of: Sequence[int] = ()
    old_value: float | None = None
    new_value: float | None = None
    explained_ratio: float | None = None
    others: int | None = None
    others_median: float | None = None


@dataclass(frozen=True)
class QuayTow:
    """A tow with all that the first assessment looks at.

    Attributes:
        tow: its row of `tows`.
        curve: its row of `curves`.
        run_points: its rows of `run_points`, of all planned runs, with the columns of
            `pipeline.assessment.assess.measure_runs`.
        assessments: its rows of `assessments`, marked or not.
        others_of_season: those of the other tows of its season.
        set_aside: its rows of `quarantine`.
        not_planned: runs in the samples that no plan knows: `run`, and `log_m_s`, the mean speed
            by log 1.
        boat_before: row of `tows` of the boat's tow before this one, with whatever crew.
        line_before: the newest earlier curve of this boat and crew: `cw_kg_m`, `cw_lo_kg_m` and
            `cw_hi_kg_m` at the declared speed of this tow, and the columns of its row of `tows`
            of which `explain_by_size` makes use.
    """

    tow: Row
    curve: Row
    run_points: pl.DataFrame
    assessments: pl.DataFrame
    others_of_season: pl.DataFrame
    set_aside: pl.DataFrame
    not_planned: pl.DataFrame
    boat_before: Row | None
    line_before: Row | None

    def is_marked(self, check: str) -> bool:
        """Whether a check marks the tow."""
        return not self.assessments.filter("flagged", check=check).is_empty()


def assess_first(tow: QuayTow) -> dy.DataFrame[FirstAssessment]:
    """Return what each rule finds, in the order of the rules, the worst finding first.

    A rule that finds nothing has one row with an empty `finding`.
    """
    findings = list(_judge_checks(tow))
    findings += _judge_set_aside(tow)
    findings += _judge_runs(tow)
    findings += _judge_runs_not_planned(tow)
    findings += _judge_choice(tow)
    findings += _judge_change(tow)
    made = {JUDGED_BY[check][0] for check in tow.assessments["check"] if check not in ALONE}
    made |= ALWAYS_MADE
    rows: list[Row] = []
    for rule in RULES:
        mine = [one for one in findings if one.rule == rule]
        mine.sort(key=lambda one: -VERDICTS.index(one.verdict))
        nothing = Finding(rule, "", "good" if rule in made else "not_made")
        rows += [one._asdict() for one in mine or [nothing]]
    key = {"method": tow.curve["method"], "tow_id": tow.tow["tow_id"]}
    placed = [key | {"place": place} | row for place, row in enumerate(rows, start=1)]
    return make_frame(FirstAssessment, placed)


def get_verdict(assessment: pl.DataFrame) -> Verdict:
    """Return the worst verdict in a first assessment; `good` where nothing is found."""
    found = set(assessment["verdict"])
    return next((one for one in reversed(VERDICTS) if one in found - {"not_made"}), "good")


def get_runs_to_redo(assessment: pl.DataFrame) -> list[int] | None:
    """Return the runs to tow again, none where there are none; None where not all are named."""
    again = assessment.filter(verdict="tow_again")
    if (again["runs"].list.len() == 0).any():
        return None
    runs: list[int] = again["runs"].explode().drop_nulls().unique().sort().to_list()
    return runs


def explain_by_size(new: Row, old: Row) -> float | None:
    """Return the change of Cw that changed weight and waterline length explain, as a ratio less 1.

    Cw goes with sqrt(displacement x waterline length), as in `pipeline.assessment.assess`. None
    where a weight is not known.
    """
    weights = (new["weight_kg"], new["crew_weight_kg"], old["weight_kg"], old["crew_weight_kg"])
    if None in weights:
        return None
    new_size = (new["weight_kg"] + new["crew_weight_kg"]) * new["waterline_length_m"]
    old_size = (old["weight_kg"] + old["crew_weight_kg"]) * old["waterline_length_m"]
    return float(np.sqrt(new_size / old_size)) - 1.0


# What the rules find


def _judge_checks(tow: QuayTow) -> Iterator[Finding]:
    """Yield a finding for every check that marks the tow, but for a better one of `_judge_runs`."""
    in_other_order = bool(_find_runs_in_other_order(tow))
    off_curve: list[int] = []
    for one in find_runs_off_curve(tow.run_points):
        off_curve += one.runs
    lost_runs = tow.set_aside.filter(lost="run")["run"].drop_nulls().unique().sort().to_list()
    for row in tow.assessments.filter("flagged").iter_rows(named=True):
        check = row["check"]
        if check == "off_target_speed" and in_other_order:
            continue
        rule, verdict = JUDGED_BY[check]
        runs: Sequence[int] = ()
        if check in PER_RUN:
            beyond = pl.col(PER_RUN[check]) > row["limit"]
            runs = tow.run_points.filter(beyond)["run"].to_list()
        elif check == "out_and_back_differ":
            runs = off_curve
        elif check == "runs_set_aside":
            runs = lost_runs
        of_others = tow.others_of_season.filter(check=check)
        others_median = _take_median(of_others["observed"])
        if (
            check in NOT_IN_CW
            and of_others.height >= MIN_OTHERS
            and others_median is not None
            and row["observed"] <= MAX_TIMES_USUAL * others_median
        ):
            verdict = "good"
        found = Finding(
            rule,
            check,
            verdict,
            observed=row["observed"],
            limit=row["limit"],
            unit=row["unit"],
            runs=runs,
            others=of_others.height,
            others_median=others_median,
        )
        yield _add_sizes(found, tow)


def _take_median(values: pl.Series) -> float | None:
    median = values.median()
    return median if isinstance(median, float) else None


def _add_sizes(found: Finding, tow: QuayTow) -> Finding:
    """Return a finding with the sizes that it is about, and the change of Cw that they explain."""
    column, before = SIZES.get(found.finding), tow.boat_before
    if found.finding in CHANGED:
        column, before = "weight_kg", tow.line_before
    if column is None or before is None:
        return found
    explained = None
    if found.finding in CHANGED:
        explained = explain_by_size(tow.tow, before)
    elif found.finding in ("weight_changed", "length_changed"):
        only_this = before | {column: tow.tow[column]}
        explained = explain_by_size(only_this, before)
    return found._replace(
        old_value=before[column], new_value=tow.tow[column], explained_ratio=explained
    )


def _judge_set_aside(tow: QuayTow) -> Iterator[Finding]:
    """Yield what is set aside of the tow besides whole runs: seconds, channels, cells of lists."""
    rest = tow.set_aside.filter(pl.col("lost") != "run")
    if not rest.is_empty():
        runs = rest["run"].drop_nulls().unique().sort().to_list()
        yield Finding(
            "no_malfunction",
            "parts_set_aside",
            "look",
            observed=float(rest.height),
            limit=0.0,
            runs=runs,
        )


def _judge_runs(tow: QuayTow) -> Iterator[Finding]:
    """Yield what the runs show among themselves."""
    reasons: tuple[tuple[str, Rule], ...] = (
        (NO_STEADY_WINDOW, "trimming_suffices"),
        (ABOVE_TARGET, "intended_speed"),
    )
    misplaced = _find_runs_in_other_order(tow)
    if misplaced:
        yield Finding("intended_speed", "runs_in_other_order", "look", runs=misplaced)
    for reason, rule in reasons:
        of_reason = tow.run_points.filter(reason=reason)["run"].to_list()
        runs = [run for run in of_reason if run not in misplaced]
        if runs:
            yield Finding(rule, reason, "tow_again", runs=runs)
    for off in find_runs_off_curve(tow.run_points):
        yield Finding(
            "plausible",
            "run_off_curve" if len(off.runs) == 1 else "runs_disagree",
            "tow_again",
            observed=off.ratio,
            limit=float(np.copysign(MAX_OFF_CURVE_RATIO, off.ratio)),
            runs=sorted(off.runs),
        )


def _find_runs_in_other_order(tow: QuayTow) -> list[int]:
    """Return the runs that have each other's speeds: files can number runs in another order."""
    runs = tow.run_points.drop_nulls("speed_m_s").filter(pl.col("reason") != NOT_SELECTED)
    if runs.height < 2:
        return []
    ratio = runs["speed_m_s"].to_numpy() / tow.tow["declared_speed_m_s"]
    target = runs["target_speed_ratio"].to_numpy()
    scale = float(np.median(np.sort(ratio) / np.sort(target)))
    in_order = np.abs(np.sort(ratio) / (scale * np.sort(target)) - 1) <= MAX_OFF_TARGET_RATIO
    misplaced = np.abs(ratio / (scale * target) - 1) > MAX_OFF_TARGET_RATIO
    return runs["run"].filter(pl.Series(misplaced)).to_list() if in_order.all() else []


def _judge_runs_not_planned(tow: QuayTow) -> Iterator[Finding]:
    """Yield every run of the samples that the plan does not know, with those it can replace."""
    known = tow.run_points.filter(pl.col("speed_m_s").is_not_null())
    log_m_s = known["speed_m_s"] / known["speed_factor"]
    on_target = log_m_s / (known["target_speed_ratio"] * tow.tow["declared_speed_m_s"])
    level = on_target.median()
    scale = level if isinstance(level, float) else 1.0
    for run, speed_m_s in tow.not_planned.select("run", "log_m_s").iter_rows():
        ratio = speed_m_s / tow.tow["declared_speed_m_s"] / scale
        distance = (tow.run_points["target_speed_ratio"] - ratio).abs()
        nearest = tow.run_points.filter(distance == distance.min())["target_speed_ratio"].first()
        alike = tow.run_points.filter(pl.col("target_speed_ratio") == nearest)["run"].to_list()
        yield Finding(
            "no_malfunction",
            "run_not_planned",
            "look",
            observed=ratio,
            runs=[run],
            instead_of=alike,
        )


def _judge_choice(tow: QuayTow) -> Iterator[Finding]:
    """Yield which runs are the most reliable, where the list selects two of one speed and way."""
    selected = tow.run_points.filter(pl.col("reason") != NOT_SELECTED)
    if selected.select(KIND).is_duplicated().any():
        is_chosen = pl.col("choice").is_null() | (pl.col("choice") == KEEP)
        proposed = tow.run_points.filter(is_chosen)["run"].to_list()
        yield Finding("no_malfunction", "other_runs_proposed", "look", runs=proposed)


def _judge_change(tow: QuayTow) -> Iterator[Finding]:
    """Yield how the curve differs from an earlier one, where no check marks it, and what explains.

    A check marks what weight and length do not explain; between two tows whose intervals are
    narrow less is more than chance.
    """
    before, now = tow.line_before, tow.curve
    if tow.tow["altered"]:
        yield Finding("explained_by_size", "altered_reported", "good")
        return
    if before is None or now["cw_kg_m"] is None or any(map(tow.is_marked, CHANGED)):
        return
    change = now["cw_kg_m"] / before["cw_kg_m"] - 1
    explained = explain_by_size(tow.tow, before)
    unexplained = (1 + change) / (1 + (explained or 0.0)) - 1
    _, highest = CHECK["curve_change_unexplained"].limits(tow.tow["crew_class"])
    most = highest or 0.0
    found: tuple[Rule, str, Verdict] | None = None
    own = (now["cw_kg_m"], now["cw_lo_kg_m"], now["cw_hi_kg_m"])
    earlier = (before["cw_kg_m"], before["cw_lo_kg_m"], before["cw_hi_kg_m"])
    if abs(change) > most >= abs(unexplained):
        found = "explained_by_size", "change_explained", "good"
    elif None not in own + earlier and differ_beyond_intervals(own, earlier):
        found = "near_earlier_curve", "differs_from_last", "look"
    if found is not None:
        rule, finding, verdict = found
        yield Finding(
            rule,
            finding,
            verdict,
            observed=change,
            limit=most,
            old_value=before["weight_kg"],
            new_value=tow.tow["weight_kg"],
            explained_ratio=explained,
        )
