"""Which runs to keep of more (Sleepproef 2017, "Eerste beoordeling")."""

import polars as pl
import pytest

from pipeline.assessment.repeated_runs import choose_repeated_runs


def point(run, target=1.0, direction=1, **differs):
    return {
        "tow_id": "t",
        "run": run,
        "target_speed_ratio": target,
        "direction": direction,
        "window_start_s": 0.0,
        "window_end_s": 50.0,
        "ends_ratio": 0.5,
        "lost_s": 0.0,
        "cw_kg_m": 40.0,
        "cw_sd": 3.0,
    } | differs


@pytest.mark.parametrize(
    ("worse", "reason"),
    [
        ({"cw_kg_m": None, "cw_sd": None}, "no_steady_part"),
        ({"ends_ratio": 1.4, "cw_sd": 1.0}, "ends_differ_more"),
        ({"lost_s": 0.4, "cw_sd": 1.0}, "more_left_out"),
        ({"cw_sd": 3.5}, "more_scatter"),
        ({"window_end_s": 32.0}, "more_scatter"),
        ({"ends_ratio": 0.9, "cw_sd": 3.1}, "more_scatter"),
    ],
)
def test_the_most_reliable_run_of_each_kind_is_kept(worse, reason):
    points = pl.DataFrame([point(1, **worse), point(21), point(2, 1.1), point(4, direction=-1)])
    found = dict(choose_repeated_runs(points).select("run", "choice").rows())
    assert found == {1: reason, 21: "most_reliable", 2: None, 4: None}


def test_of_equal_runs_the_first_counts_and_no_number_changes():
    points = pl.DataFrame([point(21), point(1)])
    found = choose_repeated_runs(points)
    assert found.drop("choice").equals(points)
    assert found["choice"].to_list() == ["more_scatter", "most_reliable"]
