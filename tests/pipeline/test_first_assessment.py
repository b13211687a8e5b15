"""The seven rules of the first assessment: each fires where it should, and lets a sound tow go."""

import datetime as dt
from dataclasses import replace
from typing import Any

import numpy as np
import polars as pl
import pytest

from pipeline.assessment.checks import CODES
from pipeline.assessment.first_assessment import (
    JUDGED_BY,
    QuayTow,
    assess_first,
    explain_by_size,
    get_runs_to_redo,
    get_verdict,
)
from pipeline.assessment.run_measures import PER_RUN, measure_runs
from pipeline.assessment.run_outliers import find_runs_off_curve
from pipeline.tables.first_assessment import RULES, FirstAssessment

V0, CW = 2.5, 40.0
TARGETS = [0.9, 1.0, 1.1] * 2
WAYS = [1, 1, 1, -1, -1, -1]
A, B = 30.0, 5.0
SCATTER = [0.004, -0.006, 0.003, -0.005, 0.007, -0.002]
"""Scatter of the runs about their curve."""


def measured(runs: pl.DataFrame) -> pl.DataFrame:
    """Run points with what is judged of each run."""
    curves = pl.DataFrame({"tow_id": ["t"], "season": [2017], "declared_speed_m_s": [V0]})
    of_method = set(runs.columns) - {"season", "declared_speed_m_s", *PER_RUN.values()}
    return measure_runs(curves, runs.select(sorted(of_method)))


def run_points(**columns: Any) -> pl.DataFrame:
    """Six sound runs; `columns` replace theirs."""
    speed = V0 * np.array(TARGETS) * (1.0 + 0.01 * np.array([1, -1, 0, -1, 1, 0]))
    cw = A / (1 - (speed / B) ** 2) * (1.0 + np.array(SCATTER))
    rows = {
        "tow_id": ["t"] * 6,
        "run": range(1, 7),
        "direction": WAYS,
        "target_speed_ratio": TARGETS,
        "speed_m_s": speed,
        "speed_factor": [1.0] * 6,
        "cw_kg_m": cw,
        "gross_cw_kg_m": cw + 1.0,
        "cw_sd": 0.08 * cw,
        "cw_seconds_sd_kg_m": 0.03 * cw,
        "ends_ratio": [0.5] * 6,
        "log2_ratio": [1.0] * 6,
        "used": [True] * 6,
        "reason": [""] * 6,
        "choice": [None] * 6,
    }
    kinds = {"run": pl.Int8, "direction": pl.Int8, "choice": pl.String}
    return measured(pl.DataFrame(rows | columns, schema_overrides=kinds))


def tow_row(**changes: Any) -> dict[str, Any]:
    """What the list says of the tow."""
    row = {
        "tow_id": "t", "tow_date": dt.date(2017, 3, 4), "crew_class": "H", "altered": False,
        "declared_speed_m_s": V0, "weight_kg": 1000.0, "crew_weight_kg": 760.0,
        "waterline_length_m": 8.0, "beam_m": 2.2, "bow_height_m": 0.9,
    }  # fmt: skip
    return row | changes


def curve_row(cw_kg_m: float | None) -> dict[str, Any]:
    """A curve whose interval is 4 % to either side."""
    ends = [None] * 2 if cw_kg_m is None else [0.96 * cw_kg_m, 1.04 * cw_kg_m]
    names = ("cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m")
    known = {"method": "m", "tow_id": "t", "declared_speed_m_s": V0}
    return known | dict(zip(names, [cw_kg_m, *ends], strict=True))


def checks(*marked: str, **observed: float) -> pl.DataFrame:
    """All checks as made, those of which the names are given marked."""
    rows = [
        {
            "method": "m", "tow_id": "t", "check": check, "severity": "look",
            "observed": observed.get(check, 0.2), "limit": 0.1, "unit": "1",
            "flagged": check in marked,
        }
        for check in CODES
    ]  # fmt: skip
    return pl.DataFrame(rows)


NOTHING_SET_ASIDE = pl.DataFrame(schema={"lost": pl.String, "run": pl.Int8})
NO_MORE_RUNS = pl.DataFrame(schema={"run": pl.Int8, "log_m_s": pl.Float64})
BEFORE = tow_row(tow_date=dt.date(2015, 3, 4)) | curve_row(CW)
SOUND = QuayTow(
    tow=tow_row(),
    curve=curve_row(CW),
    run_points=run_points(),
    assessments=checks(),
    others_of_season=checks(),
    set_aside=NOTHING_SET_ASIDE,
    not_planned=NO_MORE_RUNS,
    boat_before=BEFORE,
    line_before=BEFORE,
)


def found_of(tow: QuayTow, rule: str) -> list[tuple[str, str, list[int]]]:
    """What a rule finds: code, verdict and runs."""
    return assess_first(tow).filter(rule=rule).select("finding", "verdict", "runs").rows()


def verdict_of(tow: QuayTow) -> str:
    return get_verdict(assess_first(tow))


def test_a_sound_tow_has_a_good_row_for_each_rule_and_may_go() -> None:
    rows = assess_first(SOUND)
    FirstAssessment.validate(rows)
    assert rows["rule"].to_list() == list(RULES)
    assert set(rows["verdict"]) == {"good"}
    assert (get_verdict(rows), get_runs_to_redo(rows)) == ("good", [])


def test_every_check_belongs_to_a_rule() -> None:
    assert set(JUDGED_BY) == set(CODES)


@pytest.mark.parametrize("check", CODES)
def test_a_tow_that_any_check_marks_may_not_go(check: str) -> None:
    rows = assess_first(replace(SOUND, assessments=checks(check)))
    FirstAssessment.validate(rows)
    assert check in rows["finding"]
    assert get_verdict(rows) != "good"


@pytest.mark.parametrize("check", ["season_in_doubt", "log_not_linear", "force_unusual"])
def test_what_is_wrong_all_season_asks_for_no_tow(check: str) -> None:
    assert verdict_of(replace(SOUND, assessments=checks(check))) == "look"


@pytest.mark.parametrize(
    ("observed", "others", "verdict"), [(0.05, 3, "good"), (0.09, 3, "look"), (0.05, 2, "look")]
)
def test_1_a_log_on_which_nothing_rests_may_read_as_usual(
    observed: float, others: int, verdict: str
) -> None:
    usual = pl.concat([checks("log2_differs", log2_differs=0.04)] * others)
    marked = checks("log2_differs", log2_differs=observed)
    tow = replace(SOUND, assessments=marked, others_of_season=usual)
    assert verdict_of(tow) == verdict
    assert found_of(tow, "no_malfunction")[0][0] == "log2_differs"


def test_rules_without_anything_to_compare_with_say_so() -> None:
    compared = ("near_earlier_curve", "explained_by_size", "little_variation")
    alone = checks().filter(
        ~pl.col("check").is_in([c for c, (rule, _) in JUDGED_BY.items() if rule in compared])
    )
    rows = assess_first(replace(SOUND, assessments=alone, boat_before=None, line_before=None))
    assert rows.filter(verdict="not_made")["rule"].to_list() == list(compared)
    assert get_verdict(rows) == "good"


# One rule after the other


def test_1_a_run_set_aside_is_towed_again_and_seconds_are_looked_at() -> None:
    lost = pl.DataFrame({"lost": ["run"], "run": [3]}, schema=NOTHING_SET_ASIDE.schema)
    marked = checks("runs_set_aside")
    tow = replace(SOUND, set_aside=lost, assessments=marked)
    assert found_of(tow, "no_malfunction") == [("runs_set_aside", "tow_again", [3])]
    seconds = pl.DataFrame({"lost": ["seconds"], "run": [5]}, schema=lost.schema)
    tow = replace(SOUND, set_aside=seconds)
    assert found_of(tow, "no_malfunction") == [("parts_set_aside", "look", [5])]


def test_1_a_run_that_no_plan_knows_is_named_with_those_that_it_can_replace() -> None:
    more = pl.DataFrame({"run": [7], "log_m_s": [1.01 * V0]}, schema=NO_MORE_RUNS.schema)
    row = assess_first(replace(SOUND, not_planned=more)).row(0, named=True)
    assert (row["finding"], row["verdict"], row["runs"]) == ("run_not_planned", "look", [7])
    assert row["instead_of"] == [2, 5]


def test_1_of_runs_towed_again_the_most_reliable_are_proposed() -> None:
    seven = pl.concat(
        [run_points(), run_points().filter(run=2).with_columns(run=pl.lit(7, pl.Int8))]
    )
    best = pl.when(pl.col("run") == 7).then(pl.lit("most_reliable"))
    choice = best.when(pl.col("run") == 2).then(pl.lit("more_scatter")).alias("choice")
    tow = replace(SOUND, run_points=seven.with_columns(choice))
    found = ("other_runs_proposed", "look", [1, 3, 4, 5, 6, 7])
    assert found_of(tow, "no_malfunction") == [found]
    chosen = seven.with_columns(
        choice,
        reason=pl.when(pl.col("run") == 2).then(pl.lit("not_selected")).otherwise(pl.lit("")),
    )
    assert verdict_of(replace(SOUND, run_points=chosen)) == "good"


def off(run: int, ratio: float) -> pl.DataFrame:
    """Runs of which one has another Cw."""
    factor = pl.when(pl.col("run") == run).then(1.0 + ratio).otherwise(1.0)
    return run_points().with_columns(pl.col("cw_kg_m") * factor)


@pytest.mark.parametrize("run", range(1, 7))
@pytest.mark.parametrize("ratio", [-0.12, 0.12, 0.2, 0.4])
def test_2_a_run_off_the_curve_of_the_others_is_named_alone(run: int, ratio: float) -> None:
    (found,) = find_runs_off_curve(off(run, ratio))
    assert found.runs == [run]
    assert found.ratio == pytest.approx(ratio, abs=0.03)
    tow = replace(SOUND, run_points=off(run, ratio))
    assert found_of(tow, "plausible") == [("run_off_curve", "tow_again", [run])]


@pytest.mark.parametrize("run", range(1, 7))
def test_2_ordinary_scatter_is_no_run_off_the_curve(run: int) -> None:
    for ratio in (-0.02, 0.02):
        assert find_runs_off_curve(off(run, ratio)) == []


def test_2_where_either_of_two_runs_can_be_off_both_are_named() -> None:
    apart = pl.when(pl.col("run") == 4).then(1.04).when(pl.col("run") == 1).then(0.95)
    runs = run_points().with_columns(pl.col("cw_kg_m") * apart.otherwise(1.0))
    (found,) = find_runs_off_curve(runs)
    assert sorted(found.runs) == [1, 4]
    rows = assess_first(replace(SOUND, run_points=runs))
    assert rows.filter(finding="runs_disagree")["runs"].to_list() == [[1, 4]]


@pytest.mark.parametrize("ratio", [-0.1, 0.06, 0.1, 0.25])
def test_2_a_way_that_is_off_is_no_matter_of_single_runs(ratio: float) -> None:
    back = pl.when(pl.col("direction") < 0).then(1.0 + ratio).otherwise(1.0)
    runs = run_points().with_columns(pl.col("cw_kg_m") * back)
    assert find_runs_off_curve(runs) == []
    rows = assess_first(replace(SOUND, run_points=runs, assessments=checks("out_and_back_differ")))
    assert rows.filter(finding="out_and_back_differ")["runs"].to_list() == [[]]
    assert (get_verdict(rows), get_runs_to_redo(rows)) == ("tow_again", None)


def test_2_a_run_is_found_though_a_way_is_off() -> None:
    runs = off(2, 0.15).with_columns(
        pl.col("cw_kg_m") * pl.when(pl.col("direction") < 0).then(1.08).otherwise(1.0)
    )
    assert [found.runs[0] for found in find_runs_off_curve(runs)] == [2]


def test_2_five_runs_of_which_one_is_alone_at_its_speed_are_not_judged_beyond_it() -> None:
    lost = pl.col("run") != 6
    assert find_runs_off_curve(run_points(used=[True] * 5 + [False])) == []
    assert find_runs_off_curve(off(3, 0.3).with_columns(used=lost)) != []


@pytest.mark.parametrize(
    "check", ["curve_change_unexplained", "unlike_its_type", "unlike_other_tows", "boat_changed"]
)
def test_3_another_curve_than_before_or_than_like_boats_is_looked_at(check: str) -> None:
    tow = replace(SOUND, assessments=checks(check))
    assert found_of(tow, "near_earlier_curve") == [(check, "look", [])]


def test_3_what_narrow_intervals_tell_apart_is_looked_at() -> None:
    narrow = curve_row(1.04 * CW) | {"cw_lo_kg_m": 1.03 * CW, "cw_hi_kg_m": 1.05 * CW}
    before = BEFORE | {"cw_lo_kg_m": 0.99 * CW, "cw_hi_kg_m": 1.01 * CW}
    tow = replace(SOUND, curve=narrow, line_before=before)
    assert found_of(tow, "near_earlier_curve") == [("differs_from_last", "look", [])]
    assert verdict_of(replace(SOUND, curve=curve_row(1.03 * CW))) == "good"


def test_4_a_change_is_explained_by_weight_and_the_weights_are_named() -> None:
    heavier = tow_row(weight_kg=1200.0)
    explained = (1960 / 1760) ** 0.5 - 1
    assert explain_by_size(heavier, BEFORE) == pytest.approx(explained)
    assert explain_by_size(tow_row(weight_kg=None), BEFORE) is None
    tow = replace(
        SOUND, tow=heavier, curve=curve_row(1.06 * CW), assessments=checks("weight_changed")
    )
    rows = assess_first(tow).filter(rule="explained_by_size")
    assert rows["finding"].to_list() == ["weight_changed", "change_explained"]
    assert rows["verdict"].to_list() == ["look", "good"]
    assert rows["old_value"].to_list() == [1000.0] * 2
    assert rows["new_value"].to_list() == [1200.0] * 2
    assert rows["explained_ratio"].to_list() == pytest.approx([explained] * 2)


@pytest.mark.parametrize("check", ["curve_change_unexplained", "boat_changed"])
def test_4_an_unexplained_change_comes_with_the_weights(check: str) -> None:
    tow = replace(SOUND, assessments=checks(check), curve=curve_row(1.2 * CW))
    row = assess_first(tow).filter(rule="near_earlier_curve").row(0, named=True)
    assert (row["old_value"], row["new_value"], row["explained_ratio"]) == (1000.0, 1000.0, 0.0)


def test_4_a_reported_alteration_explains_any_change() -> None:
    tow = replace(SOUND, tow=tow_row(altered=True), curve=curve_row(1.2 * CW))
    assert found_of(tow, "explained_by_size") == [("altered_reported", "good", [])]
    assert verdict_of(tow) == "good"


def test_5_the_run_that_missed_its_speed_is_named() -> None:
    speed = pl.when(pl.col("run") == 2).then(0.91 * V0).otherwise("speed_m_s")
    marked = checks("off_target_speed").with_columns(limit=0.05)
    tow = replace(
        SOUND, run_points=measured(run_points().with_columns(speed_m_s=speed)), assessments=marked
    )
    assert found_of(tow, "intended_speed") == [("off_target_speed", "tow_again", [2])]


@pytest.mark.parametrize(
    ("order", "misplaced"),
    [((2, 1, 0, 5, 4, 3), [1, 3, 4, 6]), ((0, 3, 1, 4, 2, 5), [2, 3, 4, 5])],
)
def test_5_runs_with_the_speeds_of_others_are_in_another_order(order, misplaced) -> None:
    speeds = run_points()["speed_m_s"].gather(order)
    marked = checks("off_target_speed").with_columns(limit=0.05)
    tow = replace(SOUND, run_points=run_points(speed_m_s=speeds), assessments=marked)
    assert found_of(tow, "intended_speed") == [("runs_in_other_order", "look", misplaced)]


@pytest.mark.parametrize(
    ("check", "column", "ratio"),
    [("large_scatter_in_run", "cw_seconds_sd_kg_m", 0.12), ("samples_scatter", "cw_sd", 0.22)],
)
def test_6_the_run_that_swings_is_named(check: str, column: str, ratio: float) -> None:
    limits = {"large_scatter_in_run": 0.1, "samples_scatter": 2.0}
    marked = checks(check).with_columns(limit=limits[check])
    swings = pl.when(pl.col("run") == 4).then(ratio * pl.col("gross_cw_kg_m")).otherwise(column)
    tow = replace(
        SOUND,
        run_points=measured(run_points().with_columns(swings.alias(column))),
        assessments=marked,
    )
    assert found_of(tow, "little_variation") == [(check, "tow_again", [4])]


@pytest.mark.parametrize(
    ("reason", "rule"),
    [("no_steady_window", "trimming_suffices"), ("above_target_speed", "intended_speed")],
)
def test_7_a_run_without_a_steady_part_or_far_too_fast_is_towed_again(reason, rule) -> None:
    lost = run_points(used=[True] * 5 + [False], reason=[""] * 5 + [reason])
    tow = replace(SOUND, run_points=lost)
    assert found_of(tow, rule) == [(reason, "tow_again", [6])]
    assert get_runs_to_redo(assess_first(tow)) == [6]
