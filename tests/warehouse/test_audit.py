"""What is collected about a boat or a type: figures of the tables, and verdicts they bear."""

import duckdb
import polars as pl
import pytest
from warehouse.queries.audit import audit, differences

from pipeline.errors import MissingKnowledgeError
from tests.conftest import METHODS


def change(bench, *statements):
    """Writes into the bench's own copy of the database."""
    with duckdb.connect(bench.store.database) as db:
        for statement in statements:
            db.execute(statement)


def types_of(bench):
    return sorted(bench.table("boats")["boat_type"].drop_nulls().unique())


def under(bench, boat_type, method="rebased-2015"):
    return audit(bench.store, [boat_type], method).types[0]["under"][method]


def test_figures_of_a_type_are_those_of_the_tables(built):
    for boat_type in types_of(built):
        report = audit(built.store, [boat_type])
        assert report.methods == list(METHODS)
        for method in METHODS:
            own = {"method": method, "boat_type": boat_type}
            found = report.types[0]["under"][method]
            rows = built.table("type_consistency").filter(**own)
            assert [row["quantity"] for row in found["consistency"]] == [
                "cw_standard_kg_m",
                "b_m_s",
                "a_kg_m",
            ]
            for row in found["consistency"]:
                (kept,) = rows.filter(quantity=row["quantity"]).to_dicts()
                assert kept.items() <= row.items()
            stands_out = pl.col("cw_outside").fill_null(False) | pl.col("b_outside").fill_null(
                False
            )
            outside = built.table("compared_tows").filter(stands_out, **own)
            assert {row["tow_id"] for row in found["outside"]} == set(outside["tow_id"])


def of(*types):
    """Statistics of types with the given slopes and verdicts, and nothing else to compare."""
    unknown = dict.fromkeys(("tow_speed_slope", "tow_speed_slope_lo", "tow_speed_slope_hi"))
    key = {"quantity": "b_m_s"} | unknown
    return [
        {"consistency": [key | slope | {"verdict": verdict}], "eras": []}
        for slope, verdict in types
    ]


def slope(value, half):
    return {
        "weight_slope": value,
        "weight_slope_lo": value - half,
        "weight_slope_hi": value + half,
    }


def test_types_differ_where_their_slopes_lie_further_apart_than_both_intervals():
    # One follows weight and in the other no trend is seen: no difference by that alone.
    assert differences(*of((slope(1.0, 0.9), "open"), (slope(0.5, 0.9), "open"))) == []
    apart = of((slope(1.0, 0.3), "open"), (slope(0.5, 0.3), "open"))
    assert differences(*apart) == ["b_m_s weight_kg"]
    assert differences(*of((slope(1.0, 0.3), "open"), (slope(0.5, 0.41), "open"))) == []


def test_types_differ_by_a_verdict_only_where_both_have_one():
    same = slope(0.0, 1.0)
    assert differences(*of((same, "equal"), (same, "differ"))) == ["b_m_s verdict"]
    assert differences(*of((same, "equal"), (same, "open"))) == []
    assert differences(of((same, "equal"), (same, "equal"))[0]) == []


@pytest.mark.parametrize("name", ["Kuikensloep", "kuikensloep", " KUIKEN SLOEP "])
def test_a_type_is_found_whatever_its_case_and_blanks(built, name):
    assert audit(built.store, [name]).types[0]["boat_type"] == "Kuikensloep"


def test_boats_without_a_type_have_a_page_without_claims(built):
    found = under(built, "unknown")
    assert {row["verdict"] for row in found["consistency"]} == {"no_type"}
    assert {row["weight_slope"] for row in found["consistency"]} == {None}


def test_an_unknown_name_lists_the_types_and_a_boat(built):
    with pytest.raises(MissingKnowledgeError) as error:
        audit(built.store, ["Pollux"])
    for expected in (*types_of(built), "'Pollux'", "FSN1"):
        assert expected in str(error.value)


def test_a_boats_page_holds_all_that_the_tables_say_of_it(built):
    fsn_no = built.table("repeat_pairs")["fsn_no"][0]
    report = audit(built.store, [fsn_no])
    tables = {
        "tows": "tows",
        "in_type": "compared_tows",
        "repeat_pairs": "repeat_pairs",
        "register": "register",
    }
    for part, table in tables.items():
        assert len(getattr(report, part)) == built.table(table).filter(fsn_no=fsn_no).height, part
    assert len(report.repeat_pairs) > 0
    for tow in report.tows:
        assert {curve["method"] for curve in tow["curves"]} == set(METHODS)
        assert tow["steps"][0]["step"] == "start"


def test_set_aside_tows_of_a_boat_are_found_by_number_or_file_and_no_others(bench):
    change(
        bench,
        "UPDATE boats SET name = 'Razende Snol' WHERE fsn_no = 'FSN101'",
        *(
            f"INSERT INTO quarantine BY NAME SELECT '{path}' AS path, 'x' AS reason_code, "
            f"'{message}' AS message, 'file' AS lost, DATE '2026-01-01' AS first_seen"
            for path, message in (
                ("a.csv", "boat FSN101 is not in the list"),
                ("b.csv", "boat FSN1010 is not in the list"),
                ("meetdata_2014/razende snol 8h 2014.csv", "a broken row"),
                ("meetdata_2014/razende snollen 8h 2014.csv", "a broken row"),
            )
        ),
    )
    found = [row["path"] for row in audit(bench.store, ["FSN101"]).set_aside]
    assert found == ["a.csv", "meetdata_2014/razende snol 8h 2014.csv"]
