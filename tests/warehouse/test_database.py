"""The database is swapped in whole, and says what its columns mean."""

import subprocess

import duckdb
import numpy as np
import polars as pl
import pytest

from pipeline.tables.schemas import ABOUT, TABLES
from pipeline.tables.views import VIEWS
from pipeline.uncertainty.ensemble import MEMBERS
from tests.assets.test_machine_faults import mounted
from tests.conftest import METHODS, Workbench
from warehouse.derive.database import LAKE_ONLY, build_database


def test_no_number_of_a_table_is_none(built: Workbench):
    floats = [
        (name, column.name, column)
        for name, frame in built.tables().items()
        for column in frame
        if column.dtype.is_float()
    ]
    assert len(floats) > len(TABLES)
    assert [(table, name) for table, name, column in floats if column.is_nan().any()] == []


def test_every_table_and_column_says_what_it_means(built: Workbench):
    with duckdb.connect(built.store.database, read_only=True) as db:
        columns = db.execute(
            "SELECT table_name, column_name, comment FROM duckdb_columns() WHERE NOT internal"
        ).fetchall()
        tables = db.execute("SELECT table_name, comment FROM duckdb_tables()").fetchall()
    named = {*TABLES, *ABOUT} - {*LAKE_ONLY}
    assert {name for name, comment in tables if comment} == {name for name, _ in tables} == named
    silent = [(t, c) for t, c, comment in columns if not comment]
    assert silent == []
    comments = {(t, c): comment for t, c, comment in columns}
    assert comments["curves", "cw_kg_m"] == "Cw at the declared speed [kg/m]"


def test_a_failed_build_leaves_the_old_database_and_no_litter(tmp_path):
    path = tmp_path / "warehouse.duckdb"
    build_database(path, {"t": pl.DataFrame({"x": [1]})})
    with pytest.raises(AttributeError):
        build_database(path, {"t": pl.DataFrame({"x": [2]}), "u": None})
    assert [f.name for f in tmp_path.iterdir()] == ["warehouse.duckdb"]
    with duckdb.connect(path, read_only=True) as db:
        assert db.execute("SELECT x FROM t").fetchall() == [(1,)]


def test_a_database_that_does_not_fit_on_the_disk_is_not_put_in_place(tmp_path):
    mounted(tmp_path / "disk", 1_000_000)
    try:
        path = tmp_path / "disk" / "warehouse.duckdb"
        build_database(path, {"t": pl.DataFrame({"x": [1]})})
        numbers = np.random.default_rng(1).random(200_000)
        with pytest.raises(duckdb.Error):
            build_database(path, {"t": pl.DataFrame({"x": numbers})})
        with duckdb.connect(path, read_only=True) as db:
            assert db.execute("SELECT x FROM t").fetchall() == [(1,)]
    finally:
        subprocess.run(["umount", str(tmp_path / "disk")], check=True)


def test_views_answer_and_programs_of_last_year_can_open_the_file(built: Workbench):
    with duckdb.connect(built.store.database, read_only=True) as db:
        views = dict(db.execute("SELECT view_name, comment FROM duckdb_views()").fetchall())
        assert {name: views.get(name) for name in VIEWS} == {n: v.meaning for n, v in VIEWS.items()}
        for name in VIEWS:
            assert db.table(name).columns, name
        tags = db.execute("SELECT tags FROM duckdb_databases() WHERE NOT internal").fetchone()
    assert tags == ({"storage_version": "v1.0.0+"},)


def test_a_curve_at_its_declared_speed_is_its_cw(built: Workbench):
    """A curve's Cw at another speed, computed by the view, against the formula."""
    found = built.table("curves_at_standard_speed").drop_nulls("b_m_s")
    a, b, v = (found[c].to_numpy() for c in ("a_kg_m", "b_m_s", "standard_speed_m_s"))
    assert found["cw_standard_kg_m"].to_numpy() == pytest.approx(a / (1 - (v / b) ** 2), rel=1e-9)


def test_factors_of_causes_multiply_to_the_change(built: Workbench):
    found = built.table("changes_by_cause").drop_nulls("cw_ratio")
    line = ["from_edition", "to_edition", "fsn_no", "rowers", "crew_class", "cw_ratio"]
    product = found.group_by(line).agg(pl.col("factor").product())
    assert product["factor"].to_numpy() == pytest.approx(product["cw_ratio"].to_numpy(), rel=1e-9)


def test_steps_of_a_season_multiply_to_what_its_tows_change(built: Workbench):
    ladder, steps = built.table("season_ladder"), built.table("correction_steps")
    line = ["from_method", "to_method", "season"]
    steps = steps.join(built.table("tows").select("tow_id", "season"), on="tow_id")
    of_tow = steps.filter(pl.col("position") > 0).group_by(*line, "tow_id")
    total = of_tow.agg(pl.col("factor").product()).group_by(line).agg(pl.col("factor").log().mean())
    both = ladder.group_by(line).agg(pl.col("factor").log().sum()).join(total, on=line)
    assert both.height == total.height > 0
    assert both["factor"].to_numpy() == pytest.approx(both["factor_right"].to_numpy(), rel=1e-9)


def test_what_is_counted_is_what_the_tables_hold(built: Workbench):
    counts, curves = built.table("quality_counts"), built.table("curves")
    of_all, each = (counts.filter((pl.col("scope") == "all") == all_) for all_ in (True, False))
    key = ["method", "kind", "code"]
    summed = each.group_by(key).agg(pl.col("number").sum()).sort(key)
    assert of_all.drop("scope").sort(key).rows() == summed.rows()
    assert of_all.filter(kind="status")["number"].sum() == curves.height
    assert of_all.filter(kind="flag")["number"].sum() == curves["flags"].list.len().sum()
    unused = built.table("run_points").filter(~pl.col("used")).height
    assert of_all.filter(kind="run")["number"].sum() == unused
    checks, assessed = built.table("check_counts"), built.table("assessments")
    assert checks["tows"].sum() == assessed.height
    assert checks["beyond"].sum() == assessed["flagged"].sum()


def test_every_curve_has_its_members_about_its_cw(built: Workbench):
    members = built.store.read("ensemble", METHODS[1])
    curves = built.table("curves").filter(pl.col("method") == METHODS[1]).drop_nulls("cw_kg_m")
    found = members.group_by("tow_id").agg(pl.len(), pl.col("cw_kg_m").log().alias("ln").mean())
    both = curves.join(found, on="tow_id")
    assert both.height == curves.height > 0
    assert set(both["len"]) == {MEMBERS}
    # The interval is 4 to 6 standard deviations wide, the mean of the members has 1 / sqrt(200).
    width = (both["cw_hi_kg_m"] / both["cw_lo_kg_m"]).log()
    assert ((both["ln"] - both["cw_kg_m"].log()).abs() / width).max() < 1 / np.sqrt(MEMBERS)
