"""Every tow beside its type and beside its races, and Cw without a tow; against known truth."""

import datetime as dt

import numpy as np
import polars as pl
import pytest

from tests.pipeline.consistency_fleet import consistency_tables, fleet


def raced(tables, tow_id, speed_m_s):
    """A race of two hours by the crew of a tow."""
    line = tables[0].filter(tow_id=tow_id).select("fsn_no", "rowers", "crew_class")
    return line.with_columns(
        race_date=pl.lit(dt.date(2016, 6, 4)),
        distance_m=7200.0 * speed_m_s + 300.0,
        stream_m=300.0,
        rowing_time_s=7200.0,
    )


def test_a_slow_tow_raced_hard_says_whom_its_curve_favours():
    speeds = np.full(8, 2.5)
    speeds[2] = 2.0
    tables = fleet(19, boats=8, speeds_m_s=speeds, noise=1e-4)
    curves, tows, boats, points = tables
    is_slow = pl.col("tow_id") == "2016-002"
    steeper = pl.when(is_slow).then((pl.col("speed_m_s") / 2.0) ** 0.5).otherwise(1.0)
    points = points.with_columns(pl.col("cw_kg_m") * steeper)
    race = raced(tables, "2016-002", 2.8)
    compared = consistency_tables(curves, tows, boats, points, race)["compared_tows"]
    row = compared.filter("slow").row(0, named=True)
    assert row["races"] == 1
    assert row["raced_speed_m_s"] == pytest.approx(2.8)
    assert row["speed_case"] == "low"
    assert row["raced_beyond_curve"]
    # More power is computed than was delivered: that is the advantage.
    assert row["power_ratio_raced"] > 1.1
    others = compared.filter(pl.col("tow_id") != "2016-002")
    for name in ("races", "raced_speed_m_s", "raced_beyond_curve", "raced_power_w", "raced_high"):
        assert others[name].null_count() == others.height, name


@pytest.mark.parametrize(("speed_m_s", "is_high"), [(2.6, False), (3.2, True)])
def test_a_race_at_over_a_hundred_watts_is_marked(speed_m_s, is_high):
    tables = fleet(20, boats=6)
    race = raced(tables, "2016-001", speed_m_s)
    compared = consistency_tables(*tables, race)["compared_tows"].drop_nulls("races")
    row = compared.row(0, named=True)
    power = row["raced_power_w"]
    assert row["raced_high"] is (power > 100.0) is is_high


def test_cw_without_a_tow_is_that_of_boats_of_that_weight():
    tables = fleet(21, boats=40, height_sd=0.02, noise=0.005)
    predicted = consistency_tables(*tables)["predicted_cw"]
    ratio = predicted["ln_ratio"].to_numpy()
    assert ratio.std() == pytest.approx(0.02, rel=0.4)
    half = 0.5 * np.log(predicted["predicted_hi_kg_m"] / predicted["predicted_lo_kg_m"]).to_numpy()
    assert np.mean(np.abs(ratio) <= half) >= 0.85
    heavy = predicted.join(tables[1].select("tow_id", "weight_kg"), on="tow_id")
    rise = np.polyfit(np.log(heavy["weight_kg"] + 760.0), np.log(heavy["predicted_cw_kg_m"]), 1)[0]
    assert rise == pytest.approx(0.8, abs=0.25)


def test_a_boat_has_no_part_in_its_own_prediction():
    tables = fleet(22, boats=20, noise=0.005)
    curves, tows, boats, points = tables
    of_boat = pl.col("tow_id") == "2016-003"
    higher = pl.when(of_boat).then(1.2).otherwise(1.0)
    moved = (
        curves.with_columns(pl.col("a_kg_m", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m") * higher),
        tows,
        boats,
        points.with_columns(pl.col("cw_kg_m") * higher),
    )
    before, after = (
        consistency_tables(*one)["predicted_cw"].filter(of_boat).row(0, named=True)
        for one in (tables, moved)
    )
    assert after["cw_kg_m"] == pytest.approx(1.2 * before["cw_kg_m"])
    assert after["predicted_cw_kg_m"] == pytest.approx(before["predicted_cw_kg_m"], rel=0.02)
    assert after["disagrees"]
    assert not before["disagrees"]
