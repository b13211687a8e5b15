"""The report of a rebuild: what changed and why, and who is told."""

import datetime as dt
import json

import dagster as dg
import polars as pl
import pytest

from assets.report import Done, failed_checks
from dashboards.reports import Check, write_headlines
from tests.assets.test_rebuild import list_samples_files, spoil, tow_of
from tests.conftest import METHODS
from tests.warehouse.edition_bench import EditionBench
from warehouse.queries.change_report import (
    change_report,
    get_reported_path,
)
from warehouse.store.store import read_parquet, write_parquet

NOW = dt.datetime(2026, 11, 21, 3, 5, tzinfo=dt.UTC)


def latest(bench):
    return json.loads((bench.data / "report" / "latest.json").read_text("utf-8"))


@pytest.mark.more
def test_a_report_names_what_was_set_aside_what_changed_and_why(bench, built):
    file = list_samples_files(bench, 2009)[3]
    gone, kept = tow_of(bench, file), spoil(file)
    register = built.table("register").filter(pl.col("tow_id").str.starts_with("2009"))
    stronger = register.filter(pl.col("tow_id") != gone).row(0, named=True)
    EditionBench(bench.archive, bench.data).change_force(stronger["tow_id"], lambda n: 1.05 * n)
    report = bench.rebuild(page=True)
    assert latest(bench)["headlines"] == report.headlines
    assert {(row["tow_id"], row["what"]) for row in report.tows} == {
        (gone, "gone"),
        (stronger["tow_id"], "samples"),
    }
    assert [(r["tow_id"], r["reason_code"], r["what"]) for r in report.set_aside] == [
        (gone, "unknown_run", "new")
    ]
    assert report.factors == []
    (boat_without,) = built.table("tows").filter(tow_id=gone)["fsn_no"]  # an older tow counts now
    lines = [line for line in report.lines if line["change"] == "changed"]
    changed = [line for line in lines if line["fsn_no"] != boat_without]
    assert [(line["fsn_no"], line["to_edition"]) for line in changed] == [
        (stronger["fsn_no"], f"concept-{method}") for method in METHODS
    ]
    for line in changed:
        assert line["cw_ratio"] == pytest.approx(1.05, abs=0.02)
        (cause,) = json.loads(line["causes"])
        assert (cause["cause"], cause["factor"]) == ("input", pytest.approx(line["cw_ratio"]))
    page = (bench.data / "report" / "latest.html").read_text("utf-8").replace('"', "")
    assert "gegevens van de sleep gewijzigd +5," in page

    file.write_bytes(kept)
    report = bench.rebuild()
    assert [row["what"] for row in report.set_aside] == ["mended"]
    assert [row["what"] for row in report.tows] == ["new"]


def change_reported(bench, table, **columns):
    """Makes the last report one of other tables."""
    for name, changed in ((table, columns), ("about", {"database": pl.lit("other")})):
        path = get_reported_path(bench.store) / f"{name}.parquet"
        write_parquet(read_parquet(path).with_columns(**changed), path)


def test_a_log_factor_that_shows_the_same_did_not_move(bench):
    moved = pl.when(season=2009).then(1.00004).otherwise(1.00006)
    change_reported(bench, "log_factors", factor=pl.col("factor") * moved)
    assert {row["season"] for row in change_report(bench.store).factors} == {2014}


@pytest.mark.more
def test_a_damaged_memory_of_the_last_report_makes_the_next_the_first(bench):
    (get_reported_path(bench.store) / "tows.parquet").write_bytes(b"PAR1")
    change_reported(bench, "register")
    assert bench.rebuild().first
    assert bench.rebuild().nothing_changed


def test_a_season_that_disappeared_from_the_archive_is_named_first(bench):
    first = pl.col("tow_id") == pl.col("tow_id").min()
    was = pl.when(first).then(2002).otherwise("season").cast(pl.Int32)
    change_reported(bench, "tows", season=was)
    summary = change_report(bench.store)
    assert summary.seasons_gone == [2002]
    assert (
        write_headlines(summary, [])[0] == "Seasons of which the archive has no tow any more: 2002"
    )


@pytest.mark.more
def test_a_rebuild_killed_before_its_report_is_reported_on_by_the_next(bench, monkeypatch):
    bench.rebuild()
    spoil(list_samples_files(bench, 2009)[3])

    def killed(*args):
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr("assets.database.write_report", killed)
        with pytest.raises(KeyboardInterrupt):
            bench.rebuild()
    report = bench.rebuild()
    assert report.done == Done()
    assert [row["what"] for row in report.set_aside] == ["new"]


def test_a_failing_check_of_a_promise_is_an_error_and_a_warning_is_none():
    found = {"number": 2, "first": ["boats", "tows"]}
    for severity, failed in (
        ("ERROR", ["tables_fit_their_schemas: number 2, among them boats; tows"]),
        ("WARN", []),
    ):
        check = Check(
            "tows", "tables_fit_their_schemas", passed=False, severity=severity, found=found
        )
        assert failed_checks([check]) == failed
    assert dg.AssetCheckSeverity.ERROR.value == "ERROR"
