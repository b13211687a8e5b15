"""Two drafts beside each other: counted, ordered, and the numbers of the warehouse."""

import polars as pl
import pytest
from polars.testing import assert_frame_equal

from pipeline.method.reading import parse_method, read_shipped_method
from pipeline.register.register import LINE
from tests.conftest import METHODS
from warehouse.queries.history import History
from warehouse.queries.scenario import Scenario

UNTOWABLE = """
name = "none"
title = "no tow has runs enough"
extends = "{base}"
"""


@pytest.fixture(scope="module")
def history(built):
    return History.from_store(built.store)


@pytest.fixture(scope="module")
def scenario(history):
    before, after = METHODS
    return Scenario(
        history.recompute_under(read_shipped_method(before)),
        history.recompute_under(read_shipped_method(after)),
    )


def test_a_draft_is_the_register_of_the_warehouse(scenario, built):
    for draft in (scenario.before, scenario.after):
        stored = built.table("register").filter(method=draft.method.name)
        columns = [c for c in draft.register.columns if c in stored.columns]
        assert_frame_equal(
            draft.register.select(columns), stored.select(columns), check_row_order=False
        )


@pytest.mark.parametrize("table", ["reproducibility", "type_consistency"])
def test_statistics_are_those_of_the_warehouse(scenario, built, table):
    found = scenario.concat_both(lambda draft: getattr(draft, table))
    assert_frame_equal(found, built.table(table).select(found.columns), check_row_order=False)


def test_changes_are_counted_and_the_largest_stands_above(scenario, built):
    lines, summary = scenario.register_lines, scenario.summary()
    stored = built.table("register_changes")
    counts = dict(stored["change"].value_counts().iter_rows())
    assert {name: summary[name] for name in ("same", "changed", "added", "removed")} == {
        name: counts.get(name, 0) for name in ("same", "changed", "added", "removed")
    }
    assert summary["gains"] + summary["loses"] == summary["changed"] > 0
    sizes = lines["cw_ratio"].drop_nulls().log().abs().to_list()
    assert sizes == sorted(sizes, reverse=True)
    assert_frame_equal(
        lines.select(*LINE, "cw_ratio", "time_ratio").sort(LINE),
        stored.select(*LINE, "cw_ratio", "time_ratio").sort(LINE),
    )


def test_a_boat_has_its_curves_under_both_methods(scenario, built):
    curves = built.table("curves").drop_nulls("cw_kg_m")
    fsn_no, tow_id = curves.row(0, named=True)["fsn_no"], curves["tow_id"][0]
    drawn = scenario.boat_figure(fsn_no).filter(tow_id=tow_id)
    assert set(drawn["method"]) == set(METHODS)
    for method in METHODS:
        own = drawn.filter(method=method)
        stored = curves.filter(method=method, tow_id=tow_id).row(0, named=True)
        assert own.filter(kind="declared")["cw_kg_m"].item() == stored["cw_kg_m"]
        middle = own.filter(kind="line").sort("speed_m_s").row(6, named=True)
        assert middle["speed_m_s"] == pytest.approx(stored["declared_speed_m_s"])
        assert middle["cw_kg_m"] == pytest.approx(stored["cw_kg_m"])
        assert own.filter(kind="point").height == 6


def test_a_method_that_no_tow_survives_is_shown_too(history, scenario, monkeypatch):
    monkeypatch.setattr("pipeline.recompute.computed.FEWEST_RUNS", 7)
    nothing = history.recompute_under(
        parse_method(UNTOWABLE.format(base="rebased-2015"), "none.toml")
    )
    both = Scenario(scenario.before, nothing)
    summary = both.summary()
    assert summary["removed"] == summary["lines"] > 0
    assert summary["median_ratio"] is None
    kinds = (lambda draft: draft.type_consistency, lambda draft: draft.reproducibility)
    for frame in (both.season_change(), *map(both.concat_both, kinds)):
        assert isinstance(frame, pl.DataFrame)
    fsn_no = history.tows["fsn_no"][0]
    assert set(both.boat_figure(fsn_no)["method"]) == {scenario.before.method.name}
