"""Windows given by hand: what is read, what is faulty, and how they reach a curve."""

import datetime as dt
from pathlib import Path

import polars as pl
import pytest

from pipeline.method.definition import Method
from pipeline.method.reading import parse_method
from tests.tables import compute_tables
from tests.warehouse.archive.conftest import TOWS, Archive
from warehouse.derive.archive_tables import read_archive
from warehouse.store.store import Store

WINDOWS = "sleeplijsten/vensters_2014.csv"
HEADER = "sleep_id;run;van [s];tot [s];reden\n"
GOOD = "2014-001;2;5;45;zwaan voor de boeg\n"
TODAY = dt.date(2020, 1, 1)
BY_HAND = """
name = "hand"
title = "Met de hand"
extends = "rebased-2015"
seasons = "2014:"
[steps]
assessment = { reject = ["few_runs"] }
"""


@pytest.fixture
def method() -> Method:
    return parse_method(BY_HAND, "hand.toml")


def give(archive: Archive, rows: str, path: str = WINDOWS) -> None:
    (archive.root / path).write_text(HEADER + rows, "utf-8")


def bring_in(archive: Archive, store: Store) -> None:
    """Make the tables about the archive, as a rebuild does."""
    read_archive(store, archive.root, TODAY)


def test_windows_are_read_as_written(archive: Archive) -> None:
    give(archive, GOOD + "2014-003;6;0;31;begin gestoord\n")
    scan = archive.scan()
    assert scan.faults == []
    columns = ("tow_id", "run", "start_s", "end_s", "reason", "path", "line")
    assert scan.index.windows.select(columns).rows() == [
        ("2014-001", 2, 5, 45, "zwaan voor de boeg", WINDOWS, 2),
        ("2014-003", 6, 0, 31, "begin gestoord", WINDOWS, 3),
    ]
    assert WINDOWS in scan.index.files["path"].to_list()


def test_a_run_of_the_second_file(archive: Archive) -> None:
    text = (archive.root / "meetdata_2014/eerste boot 8h 2014.csv").read_text()
    (archive.root / "meetdata_2014/tweede.csv").write_text(text.replace(";2", ";2,", 1))
    archive.replace(TOWS, "eerste boot 8h 2014;;", "eerste boot 8h 2014;tweede;")
    give(archive, "2014-001;b2;5;45;zwaan\n")
    assert archive.scan().index.windows["run"].to_list() == [22]


FAULTY = (
    ("2014-001;1;45;5;zwaan", "bad_window_row", "ends after it begins"),
    ("2014-001;2;4,5;45;zwaan", "bad_window_row", "whole"),
    ("2014-001;3;5;45;", "bad_window_row", "'reden' is empty"),
    ("2014-001;27;5;45;zwaan", "bad_window_row", "runs are 1 to 20"),
    ("2014-009;2;5;45;zwaan", "window_unknown_tow", "2014-009"),
    ("2014-001;b2;5;45;zwaan", "window_unknown_run", "no run b2"),
)


def test_a_faulty_row_costs_no_tow_and_no_other_row(archive: Archive) -> None:
    give(archive, "\n".join([*(row for row, *_ in FAULTY), "2014-003;6;0;31;begin\n"]))
    scan = archive.scan()
    for line, (fault, (_, code, said)) in enumerate(zip(scan.faults, FAULTY, strict=True), start=2):
        found = (fault.reason_code, fault.path, fault.tow_id, fault.line)
        assert found == (code, WINDOWS, None, line)
        assert said in fault.message
    assert scan.index.windows["tow_id"].to_list() == ["2014-003"]
    assert len(scan.good) == 3


def test_two_windows_for_one_run_cost_both(archive: Archive) -> None:
    give(archive, GOOD + GOOD + "2014-003;6;0;31;begin\n")
    scan = archive.scan()
    found = [(f.reason_code, f.line) for f in scan.faults]
    assert found == [("window_given_twice", 2), ("window_given_twice", 3)]
    assert scan.index.windows["tow_id"].to_list() == ["2014-003"]


def test_a_window_of_a_tow_that_is_set_aside_is_no_fault_of_its_own(archive: Archive) -> None:
    archive.replace(TOWS, "FSN1;", "FSN9;")
    give(archive, GOOD)
    scan = archive.scan()
    assert [f.reason_code for f in scan.faults] == ["unknown_boat"]
    assert scan.index.windows.is_empty()


def test_a_window_beyond_its_run_is_set_aside_when_the_run_is_read(
    archive: Archive, tmp_path: Path
) -> None:
    store = Store(tmp_path / "data")
    give(archive, GOOD + "2014-003;6;10;51;te lang\n")
    bring_in(archive, store)
    assert store.read("hand_windows").rows() == [("2014-001", 2, 5, 45, "zwaan voor de boeg")]
    (fault,) = store.read("quarantine").to_dicts()
    assert (fault["reason_code"], fault["line"]) == ("window_outside_run", 3)
    assert "lasts 50 s" in fault["message"]
    assert store.read("tows").height == 3


def run_2(store: Store, method: Method) -> dict[str, object]:
    compute_tables(store, [method], TODAY)
    return store.read("run_points", method.name).row(
        by_predicate=(pl.col("tow_id") == "2014-001") & (pl.col("run") == 2), named=True
    )


def test_a_window_reaches_the_run_point_and_a_removed_one_leaves_it(
    archive: Archive, tmp_path: Path, method: Method
) -> None:
    store = Store(tmp_path / "data")
    give(archive, GOOD)
    bring_in(archive, store)
    given = run_2(store, method)
    assert (given["window_start_s"], given["window_end_s"]) == (5.0, 45.0)
    assert given["cut_reason"] == "by_hand: zwaan voor de boeg"
    assert given["used"]

    (archive.root / WINDOWS).unlink()
    bring_in(archive, store)
    searched = run_2(store, method)
    assert not str(searched["cut_reason"]).startswith("by_hand")
    assert given["cw_kg_m"] != searched["cw_kg_m"]
