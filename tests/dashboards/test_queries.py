"""What queries about boats and types give is what the tables hold."""

import duckdb
import polars as pl
import pytest

from dashboards.queries.boats import read_boat
from dashboards.queries.pages import read_changes
from dashboards.queries.results import Results
from dashboards.queries.types import compare_types
from tests.conftest import METHODS
from warehouse.queries.views import Views


@pytest.fixture(scope="module")
def built_results(built):
    with Views(built.store) as views:
        yield Results(views)


def test_figures_of_a_type_are_those_of_the_tables(built, built_results):
    types = sorted(built.table("boats")["boat_type"].drop_nulls().unique())
    for found in compare_types(built_results, types, METHODS)["types"]:
        own = pl.col("boat_type") == found["boat_type"]
        rows = built.table("type_consistency").filter(own)
        assert len(found["rows"]) == rows.height == 3 * len(METHODS)
        for row in found["rows"]:
            (kept,) = rows.filter(method=row["method"], quantity=row["quantity"]).to_dicts()
            assert kept.items() <= row.items()
        stands_out = pl.col("cw_outside").fill_null(False) | pl.col("b_outside").fill_null(False)
        outside = built.table("compared_tows").filter(stands_out, own, "newest")
        assert set(found["stand_out"]["tow_id"]) == set(outside["tow_id"])


def test_boats_without_a_type_have_a_page_without_claims(built_results):
    (found,) = compare_types(built_results, ["unknown"], METHODS)["types"]
    assert {row["verdict"] for row in found["rows"]} == {"no_type"}
    assert {row["weight_slope"] for row in found["rows"]} == {None}


def test_a_boats_page_holds_all_that_the_tables_say_of_it(built, built_results):
    fsn_no = built.table("repeat_pairs")["fsn_no"][0]
    page = read_boat(built_results, fsn_no, methods=METHODS)
    tables = {
        "tows": "tows",
        "curves": "curves",
        "in_type": "compared_tows",
        "repeat_pairs": "repeat_pairs",
        "register": "register",
    }
    for part, table in tables.items():
        assert page[part].height == built.table(table).filter(fsn_no=fsn_no).height > 0, part
    steps = built.table("correction_steps").join(page["tows"], on="tow_id", how="semi")
    assert set(page["steps"]["tow_id"]) == set(steps["tow_id"])


def test_set_aside_tows_of_a_boat_are_found_by_number_or_file_and_no_others(bench):
    with duckdb.connect(bench.store.database) as db:
        db.execute("UPDATE boats SET name = 'Razende Snol' WHERE fsn_no = 'FSN101'")
        for path, message in (
            ("a.csv", "boat FSN101 is not in the list"),
            ("b.csv", "boat FSN1010 is not in the list"),
            ("meetdata_2014/razende snol 8h 2014.csv", "a broken row"),
            ("meetdata_2014/razende snollen 8h 2014.csv", "a broken row"),
        ):
            db.execute(
                "INSERT INTO quarantine BY NAME SELECT ? AS path, 'x' AS reason_code, "
                "? AS message, 'file' AS lost, DATE '2026-01-01' AS first_seen",
                [path, message],
            )
    with Views(bench.store) as views:
        found = [row["path"] for row in read_boat(Results(views), "FSN101")["set_aside"]]
    assert found == ["a.csv", "meetdata_2014/razende snol 8h 2014.csv"]


def test_what_is_voted_on_and_what_was_decided_multiply_to_the_change(built_results):
    """Of a line that changes by nothing else, and only of drafts: an edition was decided."""
    found = read_changes(built_results)
    new = found["chosen"]["to_edition"]
    assert new == f"concept-{METHODS[-1]}"
    motion = found["motion"]
    assert {"decided", "proposed"} <= motion["voted"].keys()
    assert "temperature" in motion["voted"]["decided"]
    lines = built_results.line_changes.filter(to_edition=new, change="changed")
    both = motion["decided"] * motion["proposed"]
    assert both == pytest.approx(lines["cw_ratio"].median(), abs=0.01)
    assert read_changes(built_results, "concept-as-published")["motion"] is None
