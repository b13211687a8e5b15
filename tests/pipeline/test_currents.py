"""The current of a tow, and its change: found where it is put in, by GPS and the other tows."""

import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st

from herijk.simulate import world_settings
from pipeline.assessment.currents import estimate_currents
from pipeline.method.reading import read_shipped_method
from pipeline.recompute.recompute import recompute
from tests.worlds import measure

SETTINGS = world_settings("real", seasons=(2015,), tows_per_season=10, rate_hz=10)


@pytest.fixture(scope="module")
def made():
    world = measure(SETTINGS)
    return recompute(read_shipped_method("rebased-2015"), world.tows, world.blocks)


def add_current(run_points, tow_id, out_m_s, back_m_s):
    """Return run points of which one tow met another current out and back."""
    log_m_s = pl.col("speed_m_s") / pl.col("speed_factor")
    current = pl.when(pl.col("direction") == 1).then(out_m_s).otherwise(-back_m_s)
    changed = pl.col("gps_ratio") + current / log_m_s
    is_of_tow = pl.col("tow_id") == tow_id
    return run_points.with_columns(
        gps_ratio=pl.when(is_of_tow).then(changed).otherwise("gps_ratio")
    )


def currents_by_tow(made, run_points):
    rows = estimate_currents(made.curves, run_points).to_dicts()
    return {row["tow_id"]: row for row in rows}


def test_a_tide_that_turns_during_one_tow_is_named_and_no_other_tow(made):
    sound = currents_by_tow(made, made.run_points)
    assert {row["current_verdict"] for row in sound.values()} == {"no_change"}
    tow_id = next(iter(sound))
    found = currents_by_tow(made, add_current(made.run_points, tow_id, -0.15, 0.15))
    assert [one for one, row in found.items() if row["current_verdict"] == "changed"] == [tow_id]
    assert found[tow_id]["current_change_lo_m_s"] < 0.3 < found[tow_id]["current_change_hi_m_s"]


@given(st.floats(-0.5, 0.5))
def test_a_current_that_stays_the_same_is_found_and_changes_nothing_else(made, current_m_s):
    sound = currents_by_tow(made, made.run_points)
    tow_id = next(iter(sound))
    found = currents_by_tow(made, add_current(made.run_points, tow_id, current_m_s, current_m_s))
    assert found[tow_id]["current_m_s"] - sound[tow_id]["current_m_s"] == pytest.approx(current_m_s)
    for name in ("current_change_m_s", "current_change_hi_m_s"):
        assert found[tow_id][name] == pytest.approx(sound[tow_id][name], abs=1e-9)


def test_intervals_contain_the_current_of_a_simulated_tow(made):
    """Currents of the world are a few cm/s, and hardly change within a tow."""
    rows = estimate_currents(made.curves, made.run_points)
    is_within = pl.col("current_change_m_s").abs() < pl.col("current_change_hi_m_s") - pl.col(
        "current_change_m_s"
    )
    assert rows.filter(is_within).height >= rows.height - 1
    assert rows["current_m_s"].abs().max() < 0.2


def test_with_few_other_tows_a_change_cannot_be_told(made):
    few = made.curves["tow_id"].head(4)
    points = made.run_points.filter(pl.col("tow_id").is_in(few.implode()))
    rows = estimate_currents(made.curves, points)
    assert set(rows["current_verdict"]) == {"cannot be told"}
    assert rows["current_change_m_s"].null_count() == 4
    assert rows["current_m_s"].null_count() == 0
